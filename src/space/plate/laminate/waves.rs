//! Straight-crested waves of an infinite layerwise plate.
//!
//! A wave w exp(iξx), θ_k exp(iξx) with θ_k = iψ_k along x has the amplitudes y = (w, ψ_1, …), and satisfies K(ξ) y =
//! ω² M(ξ) y. Both matrices are the symbols of the forms that the finite plate is assembled from: a derivative along x
//! is a factor iξ. Rotations along the other axis, and derivatives along it, are zero.

use nalgebra::{Complex, DMatrix, DVector, DVectorView, SymmetricEigen};

use super::Laminate;
use super::form::{ROTATIONS, is_rotation};
use crate::form::plate::DEFLECTION;
use crate::form::tensor::{Part, Square};
use crate::material::Maxwell;
use crate::space::plate::geometry::PlateGeometry;
use crate::space::plate::waves::Wave;

/// Eigenvalues below this fraction of the largest one are rounding errors. If the eigenvalues are 1/ω², these waves are left
/// out; if they are ω², their frequency is 0.
const ROUNDING: f64 = 1e-14;

/// Waves of a laminate.
pub struct LayerwiseWaves<'a> {
    laminate: &'a Laminate,
    /// Forms of twice the elastic energy after all relaxation.
    relaxed: Vec<Square<2>>,
    /// Forms of twice the energy of each viscoelastic part for a unit shear modulus.
    distortions: Vec<Vec<Square<2>>>,
    /// Modulus of each viscoelastic part beyond that after all relaxation, Pa.
    moduli: Vec<f64>,
    /// Forms of twice the kinetic energy.
    inertia: Vec<Square<2>>,
    /// Terms of the displacement that is loaded and read, with their factors.
    reading: Vec<(f64, Part<2>)>,
}

impl<'a> LayerwiseWaves<'a> {
    /// Waves of a laminate whose viscoelastic layers have their moduli at a rate (1/s). `relaxations` holds the numbers
    /// of these layers, counted from below, with their Prony series.
    pub fn new(
        laminate: &'a Laminate,
        geometry: &PlateGeometry,
        relaxations: &[(&Maxwell, Vec<usize>)],
        rate: f64,
    ) -> Self {
        let distortions = relaxations.iter().map(|(_, layers)| laminate.distortion(geometry, layers)).collect();
        let moduli = relaxations.iter().map(|(chain, _)| chain.transformed_terms(rate)).collect();
        let mut reading = vec![(1.0, Part { field: DEFLECTION, derivatives: [0, 0] })];
        reading.extend(laminate.face_deflection());
        Self { laminate, relaxed: laminate.elastic(), distortions, moduli, inertia: laminate.inertia(), reading }
    }

    /// Radius of the loaded disc, m.
    pub fn radius(&self) -> f64 {
        self.laminate.radius
    }

    /// The waves of a wavenumber ξ (1/m), by ascending frequency. If the stiffness K is positive definite, waves with more than
    /// 10⁷ times the lowest frequency are left out. Otherwise waves with less than 10⁻⁷ of the highest frequency have the
    /// frequency 0.
    ///
    /// With K = L Lᵀ and y = L⁻ᵀ x, the matrix L⁻¹ M L⁻ᵀ has the eigenvalues 1/ω². Its largest ones belong to the slowest waves,
    /// which are therefore accurate also beside the shear waves of a layer of some µm, 10⁸ times as fast. If K is numerically
    /// singular, M is factorised.
    ///
    /// # Panics
    /// If the mass is not positive definite where the stiffness is not.
    pub fn at(&self, wavenumber: f64) -> Vec<Wave> {
        let symbol = |forms: &[Square<2>]| self.symbol(forms, wavenumber);
        let mass = symbol(&self.inertia);
        let parts = self.moduli.iter().zip(&self.distortions);
        let stiffness = parts.fold(symbol(&self.relaxed), |sum, (modulus, forms)| sum + symbol(forms) * *modulus);
        let spread = self.laminate.spread.transform(wavenumber * self.laminate.radius);
        let reading = self.row(self.reading.iter().copied(), wavenumber).map(|value| value.re) * spread;
        let (is_stiffness_factorised, factor, other) = match stiffness.clone().cholesky() {
            Some(factor) => (true, factor, mass),
            None => (false, mass.cholesky().expect("all layers have mass"), stiffness),
        };
        let lower = factor.unpack();
        let reduced = |rows: &DMatrix<f64>| lower.solve_lower_triangular(rows).expect("a factor has no zeros");
        let SymmetricEigen { eigenvalues, eigenvectors } = SymmetricEigen::new(reduced(&reduced(&other).transpose()));
        let shapes = lower.tr_solve_lower_triangular(&eigenvectors).expect("a factor has no zeros");
        let least = ROUNDING * eigenvalues.amax();
        let wave = |(&value, shape): (&f64, DVectorView<f64>)| {
            let displacement = reading.dot(&shape);
            match is_stiffness_factorised {
                true if value <= least => None,
                // Shapes with yᵀMy = 1.
                true => Some(Wave { frequency: value.sqrt().recip(), of_force: displacement.powi(2) / value }),
                false if value <= least => Some(Wave { frequency: 0.0, of_force: displacement.powi(2) }),
                false => Some(Wave { frequency: value.sqrt(), of_force: displacement.powi(2) }),
            }
        };
        let mut waves: Vec<Wave> = eigenvalues.iter().zip(shapes.column_iter()).filter_map(wave).collect();
        waves.sort_by(|one, other| one.frequency.total_cmp(&other.frequency));
        waves
    }

    /// Matrix of a quadratic form on the amplitudes of a wave.
    fn symbol(&self, forms: &[Square<2>], wavenumber: f64) -> DMatrix<f64> {
        let size = 1 + self.laminate.profile.functions();
        let mut symbol = DMatrix::zeros(size, size);
        for form in forms {
            let row = self.row(form.parts.iter().copied(), wavenumber);
            symbol += (&row * row.adjoint()).map(|entry| entry.re) * form.factor;
        }
        symbol
    }

    /// Linear form on the amplitudes of a wave.
    fn row(&self, parts: impl Iterator<Item = (f64, Part<2>)>, wavenumber: f64) -> DVector<Complex<f64>> {
        let mut row = DVector::zeros(1 + self.laminate.profile.functions());
        for (factor, Part { field, derivatives }) in parts {
            let along = Complex::new(0.0, wavenumber).powi(derivatives[0] as i32) * factor;
            if derivatives[1] > 0 {
                continue;
            }
            if field == DEFLECTION {
                row[0] += along;
            } else if is_rotation(field, 0) {
                row[1 + (field - ROTATIONS) / 2] += along * Complex::i();
            }
        }
        row
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Scene;

    /// A coat of 1 µm of steel on the far side has shear waves 10¹⁰ times as fast as a long bending wave. The bending waves
    /// of the bare and of the coated pane differ only by the coat's share of the rigidity and the mass, about 1e-3.
    #[test]
    fn long_waves_are_accurate_beside_a_thin_coat() {
        let slowest = |coat: &str| {
            let text = format!(
                "[body]\nsize = [0.6, 0.4]\n[[body.layer]]\nthickness = 0.004\nmaterial = \"glass\"\n\
                 [[body.layer]]\nthickness = 0.001\nmaterial = \"soft\"\n\
                 [[body.layer]]\nthickness = 0.004\nmaterial = \"glass\"\n{coat}\
                 [material.glass]\nyoung = 70e9\npoisson = 0.23\ndensity = 2500.0\n\
                 [material.soft]\nyoung = 30e6\npoisson = 0.49\ndensity = 1100.0\n\
                 [impactor]\nmass = 1.0\nradius = 0.05\nstiffness = 1e10\nspeed = 1.0\n[time]\nend = 1e-3\n"
            );
            let (scene, _) = Scene::parse("test", &text, &[]).expect("a scene");
            let (laminate, geometry) = super::super::of_scene(&scene).expect("layers");
            let waves = LayerwiseWaves::new(&laminate, &geometry, &[], 1e3);
            [0.1, 1.0, 10.0].map(|wavenumber| {
                let slowest = &waves.at(wavenumber)[0];
                [slowest.frequency, slowest.of_force]
            })
        };
        let bare = slowest("");
        let coated = slowest(
            "[[body.layer]]\nthickness = 1e-6\nmaterial = \"steel\"\n\
             [material.steel]\nyoung = 210e9\npoisson = 0.3\ndensity = 7800.0\n",
        );
        for (bare, coated) in bare.iter().zip(&coated) {
            assert!((0..2).all(|i| (coated[i] / bare[i] - 1.0).abs() < 2e-3), "{coated:?} {bare:?}");
        }
    }
}
