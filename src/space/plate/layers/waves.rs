//! Straight-crested waves of an infinite layerwise plate.
//!
//! A wave w exp(iξx), θ_k exp(iξx) with θ_k = iψ_k along x has the amplitudes y = (w, ψ_1, …), and satisfies K(ξ) y =
//! ω² M(ξ) y. Both matrices are the symbols of the forms that the finite plate is assembled from: a derivative along x
//! is a factor iξ. Rotations along the other axis, and derivatives along it, are zero.

use nalgebra::{Complex, DMatrix, DVector, DVectorView, SymmetricEigen};

use super::profile::{ROTATIONS, is_rotation};
use super::{Disc, Layers};
use crate::form::plate::DEFLECTION;
use crate::form::tensor::{Derivative, Square};
use crate::material::Maxwell;
use crate::space::plate::geometry::PlateGeometry;
use crate::space::plate::waves::Wave;

/// Highest derivative along the wave in the forms: ∇∇·θ has two.
const HIGHEST_DERIVATIVE: usize = 2;

/// Eigenvalues below this fraction of the largest one are rounding errors. If the eigenvalues are 1/ω², these waves are left
/// out; if they are ω², their frequency is 0.
const ROUNDING: f64 = 1e-14;

/// Waves of the layers of a plate with transverse shear.
pub struct LayerwiseWaves {
    /// Disc on which the plate is loaded and read.
    disc: Disc,
    stiffness: Symbol,
    mass: Symbol,
    /// The displacement that is loaded and read, for each power of the wavenumber.
    reading: Vec<DVector<f64>>,
}

/// Matrix of a quadratic form on the amplitudes of a wave, for each power of the wavenumber.
struct Symbol(Vec<DMatrix<f64>>);

/// Linear form on the amplitudes of a wave, for each power of the wavenumber.
type Row = [DVector<Complex<f64>>; HIGHEST_DERIVATIVE + 1];

impl LayerwiseWaves {
    /// Waves of layers of which the viscoelastic layers have their moduli at a rate (1/s). `relaxations` holds the numbers
    /// of these layers, counted from below, with their Prony series. `None` without transverse shear.
    pub fn new(
        layers: &Layers,
        geometry: &PlateGeometry,
        relaxations: &[(&Maxwell, Vec<usize>)],
        rate: f64,
    ) -> Option<Self> {
        let disc = layers.disc?;
        let size = 1 + layers.profile.functions();
        let mut stiffness = Symbol::new(&layers.elastic(), size);
        for (chain, relaxing) in relaxations {
            let distortion = Symbol::new(&layers.distortion(geometry, relaxing), size);
            let modulus = chain.transformed_terms(rate);
            stiffness.0.iter_mut().zip(distortion.0).for_each(|(sum, part)| *sum += part * modulus);
        }
        let mut reading = vec![(1.0, Derivative { field: DEFLECTION, derivatives: [0, 0] })];
        reading.extend(layers.face_deflection());
        let reading = row(&reading, size).map(|power| power.map(|value| value.re)).into();
        Some(Self { disc, stiffness, mass: Symbol::new(&layers.inertia(), size), reading })
    }

    /// Radius of the loaded disc, m.
    pub fn radius(&self) -> f64 {
        self.disc.radius
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
        let [stiffness, mass] = [&self.stiffness, &self.mass].map(|symbol| symbol.at(wavenumber));
        let Disc { spread, radius } = self.disc;
        let reading = polynomial(&self.reading, wavenumber) * spread.transform(wavenumber * radius);
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
}

impl Symbol {
    /// Symbol of some forms on a number of amplitudes.
    fn new(forms: &[Square<2>], size: usize) -> Self {
        let mut powers = vec![DMatrix::zeros(size, size); 2 * HIGHEST_DERIVATIVE + 1];
        for form in forms {
            let row = row(&form.parts, size);
            for (i, one) in row.iter().enumerate() {
                for (j, other) in row.iter().enumerate() {
                    powers[i + j] += (one * other.adjoint()).map(|entry| entry.re) * form.factor;
                }
            }
        }
        Self(powers)
    }

    fn at(&self, wavenumber: f64) -> DMatrix<f64> {
        polynomial(&self.0, wavenumber)
    }
}

/// Value of a polynomial of the wavenumber.
fn polynomial<T>(powers: &[T], wavenumber: f64) -> T
where
    T: Clone + std::ops::MulAssign<f64> + for<'a> std::ops::AddAssign<&'a T>,
{
    let mut value = powers[powers.len() - 1].clone();
    for power in powers.iter().rev().skip(1) {
        value *= wavenumber;
        value += power;
    }
    value
}

/// Linear form of some derivatives of fields with their factors, on a number of amplitudes.
fn row(parts: &[(f64, Derivative<2>)], size: usize) -> Row {
    let mut row: Row = std::array::from_fn(|_| DVector::zeros(size));
    for (factor, Derivative { field, derivatives: [order, beside] }) in parts {
        if *beside > 0 {
            continue;
        }
        let along = Complex::i().powi(*order as i32) * *factor;
        if *field == DEFLECTION {
            row[*order][0] += along;
        } else if is_rotation(*field, 0) {
            row[*order][1 + (field - ROTATIONS) / 2] += along * Complex::i();
        }
    }
    row
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
            let (layers, geometry) = super::super::of_scene(&scene).expect("layers");
            let waves = LayerwiseWaves::new(&layers, &geometry, &[], 1e3).expect("transverse shear");
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
