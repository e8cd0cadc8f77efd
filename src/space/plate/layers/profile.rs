//! Layerwise plate theory as forms on fields: a mean w of the deflection over the thickness, and rotations of the
//! layers. With one layer it is a Reissner–Mindlin plate, and without transverse shear Kirchhoff's plate, whose rotation is
//! −∇w.
//!
//! Each layer is a plate with transverse shear, bonded to the next layer. The in-plane displacement at the height ζ
//! along w is u = Σ φ_k(ζ) θ_k. Each φ_k is continuous, with slope 1 in the layers of one group and constant in the others, so
//! that θ_k is the rotation of that group's layers. In a mirror-symmetric stack that is loaded and supported normal to
//! its plane, u is odd in ζ: a layer and its mirror image are one group, and φ_k is odd. Otherwise each layer is a
//! group, and one additional φ is constant, for the in-plane displacement of the whole plate.
//!
//! With plane stress in each layer, twice the elastic energy is
//!
//! ∫ λ* (∇·u)² + 2μ (ε_x² + ε_y²) + μ (2ε_xy)² dV + Σ f_i μ_i ∫ |γ_i|² dA,   λ* = 2λμ/(λ + 2μ).
//!
//! The shear strains γ_i = ∇w + Σ a_ik θ_k + Σ b_ik ∇∇·θ_k and the factors f_i are those of
//! [`crate::stack::Transverse`]. Twice the kinetic energy contains the deflection w + Σ r_ik ∇·θ_k of each layer, its mean
//! over the layer.
//!
//! Integrals across the thickness are exact.

use crate::form::Lame;
use crate::form::plate::{AREA, DEFLECTION, deflection};
use crate::form::tensor::{Derivative, Square};
use crate::stack::{ShearStrain, Transverse};

/// Factor of a rotation in a shear strain below which it is rounding error: those factors sum to 1.
const NEGLIGIBLE: f64 = 1e-12;

/// Functions φ_k for the variation of in-plane displacements through the layers.
#[derive(Debug, Clone, PartialEq)]
pub struct Profile {
    /// Heights of the faces and interfaces along w, ascending from −H/2 to H/2, m.
    pub heights: Vec<f64>,
    /// Values of each φ_k at these heights, m.
    shapes: Vec<Vec<f64>>,
    /// Layers in which the slope of each φ_k is 1.
    groups: Vec<Vec<usize>>,
    /// Whether the rotation is −∇w, and not a field of its own: Kirchhoff's theory, for one layer.
    is_thin: bool,
}

/// Elastic moduli of a layer in the layerwise theory.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct LayerModuli {
    /// Plane-stress modulus λ*, Pa.
    pub volume: f64,
    /// Shear modulus μ, Pa.
    pub shear: f64,
}

impl LayerModuli {
    /// Moduli from Lamé's constants.
    pub fn new(constants: Lame) -> Self {
        let Lame { lambda, mu } = constants;
        Self { volume: 2.0 * lambda * mu / (lambda + 2.0 * mu), shear: mu }
    }

    /// Moduli per unit shear modulus of a viscoelastic layer. The volumetric response is elastic with the bulk modulus
    /// `bulk`. The shear modulus relaxes from `instantaneous` to `relaxed` (all in Pa).
    ///
    /// λ* = 2G (3K − 2G)/(3K + 4G) is not linear in G. It is replaced by its chord, which is exact at both ends.
    /// Between them the chord is too small by at most (G₀ − G∞)²/K. In the middle this is a fraction (G₀ − G∞)/2K of
    /// the layer's in-plane stiffness. For a soft layer, this is a small fraction of the stiffness of the stack.
    pub fn of_distortion(bulk: f64, [relaxed, instantaneous]: [f64; 2]) -> Self {
        let volume = |shear: f64| Self::new(Lame::of_moduli(bulk, shear)).volume;
        let chord = (volume(instantaneous) - volume(relaxed)) / (instantaneous - relaxed);
        Self { volume: chord, shear: 1.0 }
    }
}

impl Profile {
    /// Profile of layers with these thicknesses (m), from the impacted face on; `is_mirrored` if the stack is
    /// mirror-symmetric.
    pub fn new(thicknesses: &[f64], is_mirrored: bool) -> Self {
        let (count, total) = (thicknesses.len(), thicknesses.iter().sum::<f64>());
        let groups: Vec<Vec<usize>> = if is_mirrored {
            (0..count.div_ceil(2)).map(|i| if 2 * i + 1 == count { vec![i] } else { vec![i, count - 1 - i] }).collect()
        } else {
            (0..count).map(|i| vec![i]).collect()
        };
        let of_group = |group: &Vec<usize>| -> Vec<f64> {
            let ramp = |i: usize| if group.contains(&i) { thicknesses[i] } else { 0.0 };
            let half = 0.5 * (0..count).map(ramp).sum::<f64>();
            (0..=count).map(|i| (0..i).map(ramp).sum::<f64>() - half).collect()
        };
        let mut shapes: Vec<Vec<f64>> = groups.iter().map(of_group).collect();
        if !is_mirrored {
            shapes.push(vec![total; count + 1]);
        }
        let mut heights: Vec<f64> = (0..=count).map(|i| thicknesses[..i].iter().sum::<f64>() - 0.5 * total).collect();
        // The faces are set exactly, without the rounding of a sum.
        (heights[0], heights[count]) = (-0.5 * total, 0.5 * total);
        Self { heights, shapes, groups, is_thin: false }
    }

    /// Profile of one layer of a thickness (m) that does not shear.
    pub fn thin(thickness: f64) -> Self {
        Self { is_thin: true, ..Self::new(&[thickness], true) }
    }

    /// Whether the plate has no transverse shear.
    pub fn is_thin(&self) -> bool {
        self.is_thin
    }

    /// A derivative of θ_k along an axis, with its factor.
    pub fn rotation(&self, k: usize, axis: usize, mut derivatives: [usize; 2]) -> (f64, Derivative<2>) {
        if self.is_thin {
            derivatives[axis] += 1;
            return (-1.0, deflection(derivatives));
        }
        (1.0, rotation(k, axis, derivatives))
    }

    /// Sum of derivatives of θ_k along some axes, up to its sign.
    fn rotations<const N: usize>(&self, k: usize, sum: [(usize, [usize; 2]); N]) -> Vec<Derivative<2>> {
        sum.into_iter().map(|(axis, derivatives)| self.rotation(k, axis, derivatives).1).collect()
    }

    /// Number of functions φ_k; each has a rotation along both axes.
    pub fn functions(&self) -> usize {
        self.shapes.len()
    }

    /// Whether all φ_k are odd, so that the stack only bends.
    pub fn is_mirrored(&self) -> bool {
        self.shapes.len() == self.groups.len()
    }

    /// Thickness of a layer, m.
    fn thickness(&self, layer: usize) -> f64 {
        self.heights[layer + 1] - self.heights[layer]
    }

    /// Number of layers.
    pub fn layers(&self) -> usize {
        self.heights.len() - 1
    }

    /// Number of the layer at a height. An interface belongs to the layer nearer to the impacted face.
    pub fn layer_at(&self, height: f64) -> usize {
        let inner = &self.heights[1..self.layers()];
        inner.partition_point(|end| *end < height)
    }

    /// φ_k at a height, m.
    pub fn at(&self, k: usize, height: f64) -> f64 {
        let layer = self.layer_at(height);
        let [from, to] = [self.shapes[k][layer], self.shapes[k][layer + 1]];
        from + (to - from) * (height - self.heights[layer]) / self.thickness(layer)
    }

    /// Number k of the rotation θ_k of a layer.
    #[cfg(test)]
    pub fn group_of(&self, layer: usize) -> usize {
        self.groups.iter().position(|group| group.contains(&layer)).unwrap_or_default()
    }

    /// ∫ φ_k φ_l dζ over a layer, m³.
    fn integral(&self, [k, l]: [usize; 2], layer: usize) -> f64 {
        let [[a, b], [c, d]] = [k, l].map(|k| [self.shapes[k][layer], self.shapes[k][layer + 1]]);
        self.thickness(layer) / 6.0 * (2.0 * a * c + a * d + b * c + 2.0 * b * d)
    }

    /// Σ c_j u_j over the faces and interfaces j, as the factors of all θ_k.
    fn of_rotations<'a>(&'a self, of_faces: &'a [f64]) -> impl Iterator<Item = f64> + 'a {
        self.shapes.iter().map(move |shape| shape.iter().zip(of_faces).map(|(phi, factor)| phi * factor).sum())
    }

    /// Σ c_j ∇·u_j over the faces and interfaces j, differentiated in addition, as factors of derivatives of rotations.
    pub fn dilatation(&self, of_faces: &[f64], derivatives: [usize; 2]) -> Vec<(f64, Derivative<2>)> {
        let [x, y] = derivatives;
        let of = |(k, factor): (usize, f64)| {
            [self.rotation(k, 0, [x + 1, y]), self.rotation(k, 1, [x, y + 1])].map(|(sign, part)| (sign * factor, part))
        };
        self.of_rotations(of_faces).enumerate().flat_map(of).filter(|(factor, _)| *factor != 0.0).collect()
    }

    /// Shear strain of a layer along an axis, as factors of derivatives of fields.
    pub fn shear_strain(&self, strain: &ShearStrain, axis: usize) -> Vec<(f64, Derivative<2>)> {
        let mut along = [0, 0];
        along[axis] = 1;
        let of_slopes = self.of_rotations(&strain.of_displacements).enumerate();
        let of_slopes = of_slopes.map(|(k, factor)| (factor, rotation(k, axis, [0, 0])));
        let mut parts = vec![(1.0, deflection(along))];
        parts.extend(of_slopes.filter(|(factor, _)| factor.abs() > NEGLIGIBLE));
        parts.extend(self.dilatation(&strain.of_dilatations, along));
        parts
    }

    /// Forms of twice the elastic energy of layers with these moduli and with the shear strains of a stack.
    pub fn elastic(&self, moduli: &[LayerModuli], transverse: &Transverse) -> Vec<Square<2>> {
        let of = |value: fn(&LayerModuli) -> f64| {
            move |pair: [usize; 2]| -> f64 {
                moduli.iter().enumerate().map(|(layer, moduli)| value(moduli) * self.integral(pair, layer)).sum()
            }
        };
        let (volume, twist) = (of(|moduli| moduli.volume), of(|moduli| moduli.shear));
        let mut forms = self.products(volume, |k| self.rotations(k, [(0, [1, 0]), (1, [0, 1])]));
        for (axis, along) in [[1, 0], [0, 1]].into_iter().enumerate() {
            forms.extend(self.products(|pair| 2.0 * twist(pair), |k| self.rotations(k, [(axis, along)])));
        }
        forms.extend(self.products(twist, |k| self.rotations(k, [(0, [0, 1]), (1, [1, 0])])));
        if self.is_thin {
            return forms;
        }
        for (strain, moduli) in transverse.shear.iter().zip(moduli) {
            let factor = strain.factor * moduli.shear;
            for axis in (0..2).filter(|_| factor != 0.0) {
                forms.push(Square { factor, parts: self.shear_strain(strain, axis), place: AREA });
            }
        }
        forms
    }

    /// Forms of twice the kinetic energy of layers with these densities (kg/m³) and with the deflections of a stack.
    pub fn mass(&self, densities: &[f64], transverse: &Transverse) -> Vec<Square<2>> {
        let all = densities.iter().enumerate();
        let of = |pair: [usize; 2]| -> f64 {
            all.clone().map(|(layer, density)| density * self.integral(pair, layer)).sum()
        };
        // Layers of one group have the same deflection.
        let of_group = |group: &Vec<usize>| {
            let mut parts = vec![(1.0, deflection([0, 0]))];
            parts.extend(self.dilatation(&transverse.layer_deflections[group[0]], [0, 0]));
            let factor = group.iter().map(|&layer| densities[layer] * self.thickness(layer)).sum();
            Square { factor, parts, place: AREA }
        };
        let mut forms: Vec<Square<2>> = self.groups.iter().map(of_group).collect();
        // Kirchhoff's theory has no rotary inertia.
        let rotating = if self.is_thin { 0 } else { 2 };
        (0..rotating).for_each(|axis| forms.extend(self.products(of, |k| vec![rotation(k, axis, [0, 0])])));
        forms
    }

    /// Writes Σ A_kl f_k f_l as a sum of squares, by 2 f_k f_l = (f_k + f_l)² − f_k² − f_l².
    fn products(
        &self,
        entry: impl Fn([usize; 2]) -> f64,
        parts: impl Fn(usize) -> Vec<Derivative<2>>,
    ) -> Vec<Square<2>> {
        let mut forms = Vec::new();
        for k in 0..self.functions() {
            let beside: f64 = (0..self.functions()).filter(|&l| l != k).map(|l| entry([k, l])).sum();
            forms.push(square(entry([k, k]) - beside, parts(k)));
            for l in k + 1..self.functions() {
                forms.push(square(entry([k, l]), [parts(k), parts(l)].concat()));
            }
        }
        forms.retain(|form| form.factor != 0.0);
        forms
    }
}

fn square(factor: f64, parts: Vec<Derivative<2>>) -> Square<2> {
    Square::of_sum(factor, &parts, AREA)
}

/// Number of the first rotation; those along the two axes follow one another.
pub const ROTATIONS: usize = DEFLECTION + 1;

/// Whether a field is a rotation along an axis.
pub const fn is_rotation(field: usize, axis: usize) -> bool {
    field >= ROTATIONS && (field - ROTATIONS) % 2 == axis
}

/// Field number after the two axes are exchanged: w keeps its number, and the two rotations θ_k exchange their numbers.
pub const fn exchanged_field(field: usize) -> usize {
    if field == DEFLECTION { field } else { DEFLECTION + 1 + ((field - DEFLECTION - 1) ^ 1) }
}

/// A derivative of θ_k along an axis.
pub const fn rotation(k: usize, axis: usize, derivatives: [usize; 2]) -> Derivative<2> {
    Derivative { field: DEFLECTION + 1 + 2 * k + axis, derivatives }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::form::tensor::Tensor;
    use crate::form::{Material, Spline};
    use crate::stack::{Layer, Stack};

    const GLASS: Material = Material { young: 70e9, poisson: 0.23, density: 2500.0 };

    /// With a constant shear strain in each layer, three layers of one material with equal rotations are one layer.
    #[test]
    fn layers_that_turn_together_are_one() {
        let lines: Vec<f64> = (0..=3).map(|i| 0.1 * f64::from(i)).collect();
        let matrices = |thicknesses: &[f64], is_mirrored: bool| {
            let profile = Profile::new(thicknesses, is_mirrored);
            let spline = |degree: usize| Spline::new(&lines, degree, degree - 1);
            let mut fields = vec![[spline(3), spline(3)]];
            (0..profile.functions()).for_each(|_| fields.extend([[spline(2), spline(3)], [spline(3), spline(2)]]));
            let tensor = Tensor::new(fields);
            let layer = |thickness: &f64| Layer { thickness: *thickness, young: GLASS.young, poisson: GLASS.poisson };
            let stack = Stack::new(&thicknesses.iter().map(layer).collect::<Vec<_>>()).expect("elastic layers");
            let transverse = Transverse::thin(&stack, |_| false);
            let layers = thicknesses.len();
            let elastic = profile.elastic(&vec![LayerModuli::new(GLASS.lame()); layers], &transverse);
            let mass = profile.mass(&vec![GLASS.density; layers], &transverse);
            (profile, [tensor.matrix(&elastic), tensor.matrix(&mass)], tensor)
        };
        let (_, one, tensor) = matrices(&[0.02], true);
        let u: Vec<f64> = (0..tensor.unknowns()).map(|i| ((i * 7919) % 101) as f64 / 50.0 - 1.0).collect();
        let deflections = tensor.splines(DEFLECTION).each_ref().map(Spline::functions).iter().product::<usize>();
        let energy = |matrix: &nalgebra_sparse::CsrMatrix<f64>, u: &[f64]| -> f64 {
            matrix.triplet_iter().map(|(i, j, value)| u[i] * value * u[j]).sum()
        };
        for is_mirrored in [true, false] {
            let (profile, three, _) = matrices(&[0.008, 0.004, 0.008], is_mirrored);
            // All rotations are equal, and the in-plane displacement of the middle plane is zero.
            let mut together = u[..deflections].to_vec();
            for k in 0..profile.functions() {
                let factor = if !is_mirrored && k == profile.layers() { 0.0 } else { 1.0 };
                together.extend(u[deflections..].iter().map(|x| factor * x));
            }
            for (three, one) in three.iter().zip(&one) {
                let [found, exact] = [energy(three, &together), energy(one, &u)];
                // Rounding of some hundred entries.
                assert!((found / exact - 1.0).abs() < 1e-12, "{is_mirrored}: {found:e} {exact:e}");
            }
        }
    }

    /// The chord is exact at both ends, and its error between them is below the bound.
    #[test]
    fn distortion_along_the_chord() {
        let (bulk, ends) = (2e9, [3e6, 4e8]);
        let distortion = LayerModuli::of_distortion(bulk, ends);
        let exact = |shear: f64| LayerModuli::new(Lame::of_moduli(bulk, shear));
        let start = exact(ends[0]);
        for part in [0.0, 0.3, 0.5, 0.8, 1.0] {
            let shear = ends[0] + part * (ends[1] - ends[0]);
            let off = exact(shear).volume - (start.volume + (shear - ends[0]) * distortion.volume);
            let bound = if part == 0.0 || part == 1.0 { 1e-12 * shear } else { (ends[1] - ends[0]).powi(2) / bulk };
            assert!(off >= -1e-12 * shear && off <= bound, "{part}: {off:e} {bound:e}");
        }
    }
}
