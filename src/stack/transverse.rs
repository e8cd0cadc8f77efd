//! Transverse shear and thickness strain in a stack whose in-plane displacements are linear across each layer.
//!
//! The layerwise theory has the in-plane displacements u_j of the faces and interfaces and a mean w of the deflection over
//! the thickness. Two fields follow from them.
//!
//! **Deflection.** In bending σ_zz is small, so ε_zz = −ν/(1 − ν) ∇·u. The deflection is quadratic across each layer:
//! w(z) = w + Σ r_j(z) ∇·u_j. The mean w has the weights of the shear stress of long waves, so that a transverse force at
//! an edge does its work on it (as in Reissner's theory of one layer). With another mean, supports of edges would act on
//! ∇·u along a line, for which the energy has no bound: finer cells would yield more and more.
//!
//! **Shear stress.** It is zero on the faces and quadratic across each layer. The mean stress τ_i of each layer is unknown.
//! At an interface the softer of the two layers determines the stress: its ratio to the mean stress of that layer is the
//! ratio in long waves ([`Section::shear`]). Between layers of equal shear modulus it is the ratio to each layer's own
//! mean stress.
//!
//! In Reissner's mixed principle (E. Reissner, On a certain mixed variational theorem and a proposed application, Int.
//! J. Numer. Methods Eng. 20, 1984), the shear energy is the stationary value of
//!
//! ∫ τ (∂u/∂z + ∇w(z)) dz − ½ ∫ τ²/μ dz.
//!
//! It is τᵀy − ½ τᵀAτ with linear forms y of u, ∇w and ∇∇·u, and the stationary value is ½ yᵀA⁻¹y. With A = L D Lᵀ it is a
//! sum of one square for each layer, of the form (L⁻¹y)_i. Stiffer layers come first: the stress of a ply is expressed by
//! its own shear strain and the stresses of its interlayers, so that a part of its shear belongs to the strain of the
//! interlayer. Their squares do not depend on the moduli of softer layers.
//!
//! For one layer γ = ∇w + θ, κ = 5/6, and the unweighted mean of w(z) is w − ν h²/(60 (1 − ν)) ∇·θ. In long waves this is
//! Mindlin's plate with κ = 5/(6 − ν), but its waves are more accurate: at ξh = 1.6 the frequency is off by 6e-5, for
//! ν = 0.23, in place of 8e-4.

use nalgebra::DMatrix;

use super::{Layer, Section, Stack};

/// Shear factor κ of layers that are rigid in shear.
const RIGID: f64 = 1e3;

/// Relative difference of two means of the deflection that is rounding error.
const ROUNDING: f64 = 1e-12;

/// Shear and thickness strain of a stack.
#[derive(Debug, Clone, PartialEq)]
pub struct Transverse {
    /// Shear strain of each layer, from the loaded face down.
    pub shear: Vec<ShearStrain>,
    /// Mean of r_j over each layer, for all faces and interfaces j, m, without weights.
    pub layer_deflections: Vec<Vec<f64>>,
    /// r_j on the loaded face, m. A mirror-symmetric stack is loaded antisymmetrically, by half of the force on each
    /// face, so that it only bends. Squeezing is a part of the local field.
    pub face_deflection: Vec<f64>,
    /// Shear stress in each layer, as distributions of the mean stresses of some layers.
    distributions: Vec<Vec<(usize, Parabola)>>,
    /// L⁻ᵀ, which gives the mean stresses from D⁻¹ L⁻¹ y.
    means: DMatrix<f64>,
}

/// Shear strain ∇w + Σ a_j u_j + Σ b_j ∇∇·u_j of a layer, over all faces and interfaces j. Twice the shear energy per
/// unit of area is `factor` · μ times its square, with the layer's shear modulus μ.
#[derive(Debug, Clone, PartialEq)]
pub struct ShearStrain {
    /// Thickness times the shear factor κ, m.
    pub factor: f64,
    /// Factors a_j, 1/m.
    pub of_displacements: Vec<f64>,
    /// Factors b_j, m.
    pub of_dilatations: Vec<f64>,
    /// Thickness to which the strain belongs, m: the thickness of the layer and parts of the thicknesses of stiffer ones.
    thickness: f64,
}

/// Quadratic distribution across a layer, by its values at both faces and its mean.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
struct Parabola {
    upper: f64,
    mean: f64,
    lower: f64,
}

impl Parabola {
    /// Coefficients of 1, s and s², with s from −1 at the upper face to 1.
    fn coefficients(&self) -> [f64; 3] {
        let bend = 1.5 * (0.5 * (self.upper + self.lower) - self.mean);
        [self.mean - bend / 3.0, 0.5 * (self.lower - self.upper), bend]
    }

    /// Value at a part (0 to 1) of the thickness.
    fn at(&self, part: f64) -> f64 {
        let s = 2.0 * part - 1.0;
        let [constant, linear, square] = self.coefficients();
        constant + s * (linear + s * square)
    }

    /// Mean of the product with another distribution.
    fn mean_of_product(&self, other: &Self) -> f64 {
        let ([_, a, b], [_, c, d]) = (self.coefficients(), other.coefficients());
        self.mean * other.mean + a * c / 3.0 + 4.0 / 45.0 * b * d
    }
}

impl Transverse {
    /// Shear and thickness strain of a stack.
    pub fn new(stack: &Stack) -> Self {
        let layers = stack.layers();
        let count = layers.len();
        let moduli: Vec<f64> = layers.iter().map(Layer::shear).collect();
        let stresses = long_waves(stack);
        let distributions = distributions(&stresses, &moduli);
        let deflections = deflections(stack);
        // A, and the forms y as their factors of ∇w (m), u_j and ∇∇·u_j (m²).
        let mut compliance = DMatrix::zeros(count, count);
        let mut forms = DMatrix::zeros(count, 2 * count + 3);
        for (i, parts) in distributions.iter().enumerate() {
            let thickness = layers[i].thickness;
            for (a, one) in parts {
                for (b, other) in parts {
                    compliance[(*a, *b)] += thickness / moduli[i] * one.mean_of_product(other);
                }
                for (j, of_face) in deflections[i].iter().enumerate() {
                    forms[(*a, count + 2 + j)] += thickness * one.mean_of_product(of_face);
                }
            }
            forms[(i, 0)] = thickness;
            (forms[(i, 1 + i)], forms[(i, 2 + i)]) = (-1.0, 1.0);
        }
        // From the mean without weights to that with the weights of the shear stress.
        let of_face = |j: usize| -> f64 {
            stresses.iter().enumerate().map(|(i, stress)| stress.mean * forms[(i, count + 2 + j)]).sum()
        };
        let force: f64 = stresses.iter().zip(layers).map(|(stress, layer)| stress.mean * layer.thickness).sum();
        let to_weighted: Vec<f64> = (0..=count).map(|j| of_face(j) / force).collect();
        let (inverse, pivots) = eliminated(compliance, &moduli);
        let forms = &inverse * forms;
        let strain = |i: usize| {
            let thickness = forms[(i, 0)];
            let over_thickness = |column: usize| forms[(i, column)] / thickness;
            ShearStrain {
                factor: thickness * thickness / (pivots[i] * moduli[i]),
                of_displacements: (1..count + 2).map(over_thickness).collect(),
                of_dilatations: weighted((count + 2..2 * count + 3).map(over_thickness), &to_weighted),
                thickness,
            }
        };
        let means =
            deflections.iter().map(|layer| weighted(layer.iter().map(|shape| shape.mean), &to_weighted)).collect();
        let mut face = weighted(deflections[0].iter().map(|shape| shape.upper), &to_weighted);
        if is_mirrored(layers) {
            // Half of the load on each face.
            face = (0..=count).map(|j| 0.5 * (face[j] - face[count - j])).collect();
        }
        Self {
            shear: (0..count).map(strain).collect(),
            layer_deflections: means,
            face_deflection: face,
            distributions,
            means: inverse.transpose(),
        }
    }

    /// Stack whose deflection is constant across the thickness, with a constant shear strain in each layer. The layers
    /// for which `is_rigid` is true do not shear.
    pub fn thin(stack: &Stack, is_rigid: impl Fn(&Layer) -> bool) -> Self {
        let layers = stack.layers();
        let zeros = vec![0.0; layers.len() + 1];
        let strain = |(i, layer): (usize, &Layer)| {
            let mut displacements = zeros.clone();
            (displacements[i], displacements[i + 1]) = (-1.0 / layer.thickness, 1.0 / layer.thickness);
            ShearStrain {
                factor: layer.thickness * if is_rigid(layer) { RIGID } else { 1.0 },
                of_displacements: displacements,
                of_dilatations: zeros.clone(),
                thickness: layer.thickness,
            }
        };
        let constant = Parabola { upper: 1.0, mean: 1.0, lower: 1.0 };
        Self {
            shear: layers.iter().enumerate().map(strain).collect(),
            layer_deflections: vec![zeros.clone(); layers.len()],
            face_deflection: zeros.clone(),
            distributions: (0..layers.len()).map(|i| vec![(i, constant)]).collect(),
            means: DMatrix::identity(layers.len(), layers.len()),
        }
    }

    /// Factors (Pa) of the shear strains of all layers in the shear stress of one layer, at a part (0 to 1) of its
    /// thickness. `moduli` are the shear moduli of all layers, Pa.
    pub fn stress(&self, layer: usize, part: f64, moduli: &[f64]) -> Vec<f64> {
        let of_strain = |(i, strain): (usize, &ShearStrain)| {
            let of_mean = |(of, shape): &(usize, Parabola)| shape.at(part) * self.means[(*of, i)];
            let sum: f64 = self.distributions[layer].iter().map(of_mean).sum();
            sum * strain.factor * moduli[i] / strain.thickness
        };
        self.shear.iter().enumerate().map(of_strain).collect()
    }
}

/// Deflections beyond the weighted mean, from those beyond the mean without weights. Rounding errors are set to zero.
fn weighted(beyond_mean: impl Iterator<Item = f64>, to_weighted: &[f64]) -> Vec<f64> {
    let beyond = |(value, shift): (f64, &f64)| {
        if (value - shift).abs() < ROUNDING * value.abs() { 0.0 } else { value - shift }
    };
    beyond_mean.zip(to_weighted).map(beyond).collect()
}

/// L⁻¹ and the diagonal of D with A = L D Lᵀ up to the order of the rows: layers with larger shear moduli are eliminated
/// first.
fn eliminated(mut compliance: DMatrix<f64>, moduli: &[f64]) -> (DMatrix<f64>, Vec<f64>) {
    let count = moduli.len();
    let mut order: Vec<usize> = (0..count).collect();
    order.sort_by(|a, b| moduli[*b].total_cmp(&moduli[*a]));
    let mut inverse = DMatrix::identity(count, count);
    for (number, &pivot) in order.iter().enumerate() {
        for &row in &order[number + 1..] {
            let factor = compliance[(row, pivot)] / compliance[(pivot, pivot)];
            for column in 0..count {
                compliance[(row, column)] -= factor * compliance[(pivot, column)];
                inverse[(row, column)] -= factor * inverse[(pivot, column)];
            }
        }
    }
    (inverse, compliance.diagonal().iter().copied().collect())
}

/// Whether each of some layers with these shear moduli is an interlayer: softer than both neighbours.
pub fn interlayers(moduli: &[f64]) -> Vec<bool> {
    let is_softer = |i: usize, other: usize| moduli[i] < moduli[other];
    let is_between = |i: usize| i > 0 && i + 1 < moduli.len() && is_softer(i, i - 1) && is_softer(i, i + 1);
    (0..moduli.len()).map(is_between).collect()
}

/// Shear stress of long waves in each layer.
fn long_waves(stack: &Stack) -> Vec<Parabola> {
    let section = Section::new(stack);
    let mut upper_face = 0.0;
    let of_layer = |layer: &Layer| {
        let at = |part: f64| section.shear(stack, upper_face + part * layer.thickness);
        let [upper, middle, lower] = [0.0, 0.5, 1.0].map(at);
        upper_face += layer.thickness;
        // Simpson's rule, exact for a quadratic function.
        Parabola { upper, mean: (upper + 4.0 * middle + lower) / 6.0, lower }
    };
    stack.layers().iter().map(of_layer).collect()
}

/// Shear stress in each layer for unit mean stresses: that of the layer itself, and those of softer neighbours.
fn distributions(stresses: &[Parabola], moduli: &[f64]) -> Vec<Vec<(usize, Parabola)>> {
    let of_layer = |i: usize| {
        let Parabola { upper, mean, lower } = stresses[i];
        let is_softer = |other: usize| moduli.get(other).is_some_and(|modulus| *modulus < moduli[i]);
        let mut own = Parabola { upper: upper / mean, mean: 1.0, lower: lower / mean };
        let mut parts = Vec::new();
        if let Some(above) = i.checked_sub(1).filter(|above| is_softer(*above)) {
            own.upper = 0.0;
            parts.push((above, Parabola { upper: upper / stresses[above].mean, ..Parabola::default() }));
        }
        if is_softer(i + 1) {
            own.lower = 0.0;
            parts.push((i + 1, Parabola { lower: lower / stresses[i + 1].mean, ..Parabola::default() }));
        }
        parts.push((i, own));
        parts
    };
    (0..stresses.len()).map(of_layer).collect()
}

/// r_j across each layer, for all faces and interfaces j.
fn deflections(stack: &Stack) -> Vec<Vec<Parabola>> {
    let count = stack.layers().len();
    let mut upper = vec![0.0; count + 1];
    let mut all: Vec<Vec<Parabola>> = Vec::with_capacity(count);
    for (i, layer) in stack.layers().iter().enumerate() {
        let thinning = layer.poisson / (1.0 - layer.poisson) * layer.thickness;
        let mut of_faces: Vec<Parabola> =
            upper.iter().map(|value| Parabola { upper: *value, mean: *value, lower: *value }).collect();
        // ∇·u is linear from the upper to the lower face.
        of_faces[i].mean -= thinning / 3.0;
        of_faces[i + 1].mean -= thinning / 6.0;
        of_faces[i].lower -= thinning / 2.0;
        of_faces[i + 1].lower -= thinning / 2.0;
        upper = of_faces.iter().map(|shape| shape.lower).collect();
        all.push(of_faces);
    }
    for j in 0..=count {
        let of_layer = |(layers, layer): (&Vec<Parabola>, &Layer)| layers[j].mean * layer.thickness;
        let mean = all.iter().zip(stack.layers()).map(of_layer).sum::<f64>() / stack.thickness();
        for shape in all.iter_mut().map(|layers| &mut layers[j]) {
            (shape.upper, shape.mean, shape.lower) = (shape.upper - mean, shape.mean - mean, shape.lower - mean);
        }
    }
    all
}

/// Whether the layers are mirror-symmetric, up to rounding of their thicknesses.
fn is_mirrored(layers: &[Layer]) -> bool {
    let is_alike = |(one, other): (&Layer, &Layer)| {
        let is_as_thick = (one.thickness / other.thickness - 1.0).abs() < 1e-9;
        is_as_thick && (one.young, one.poisson) == (other.young, other.poisson)
    };
    layers.iter().zip(layers.iter().rev()).all(is_alike)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn stack(layers: &[(f64, f64, f64)]) -> Stack {
        let layer = |&(thickness, young, poisson): &(f64, f64, f64)| Layer { thickness, young, poisson };
        Stack::new(&layers.iter().map(layer).collect::<Vec<_>>()).expect("elastic layers")
    }

    /// One layer has κ = 5/6, a parabola of shear stress, and the deflection weighted by it, which is the mean without
    /// weights plus ν h²/(60 (1 − ν)) ∇·θ.
    #[test]
    fn one_layer() {
        let (h, young, poisson) = (0.02, 70e9, 0.23);
        let Transverse { shear, face_deflection, layer_deflections, .. } =
            &Transverse::new(&stack(&[(h, young, poisson)]));
        let ShearStrain { factor, of_displacements, of_dilatations, .. } = &shear[0];
        let thinning = poisson / (1.0 - poisson);
        // Products with u = zθ at both faces.
        let along = |of_faces: &[f64]| 0.5 * h * (of_faces[1] - of_faces[0]);
        let near = |found: f64, exact: f64| assert!((found / exact - 1.0).abs() < 1e-12, "{found} {exact}");
        near(*factor, 5.0 / 6.0 * h);
        near(along(of_displacements), 1.0);
        assert_eq!(of_dilatations, &[0.0; 2]);
        near(along(&layer_deflections[0]), -thinning * h * h / 60.0);
        // −ν/(12 (1 − ν)) h² beyond the mean without weights.
        near(along(face_deflection), -thinning * h * h / 10.0);
        let modulus = Layer { thickness: h, young, poisson }.shear();
        for part in [0.25, 0.5, 0.9] {
            let stress = Transverse::new(&stack(&[(h, young, poisson)])).stress(0, part, &[modulus]);
            near(stress[0], 6.0 * part * (1.0 - part) * 5.0 / 6.0 * modulus);
        }
    }

    /// The shear stress is zero on the faces, and continuous between layers of different moduli, for any shear strains.
    #[test]
    fn stresses_are_continuous() {
        let layers =
            [(0.006, 70e9, 0.23), (0.00076, 3e7, 0.49), (0.01, 70e9, 0.23), (0.0004, 3e8, 0.47), (0.004, 70e9, 0.2)];
        let stack = stack(&layers);
        let transverse = Transverse::new(&stack);
        let moduli: Vec<f64> = stack.layers().iter().map(Layer::shear).collect();
        let at = |layer: usize, part: f64| transverse.stress(layer, part, &moduli);
        let largest = |values: &[f64]| values.iter().fold(0.0, |most: f64, value| most.max(value.abs()));
        let size = largest(&at(2, 0.5));
        assert!(largest(&at(0, 0.0)) < 1e-12 * size && largest(&at(4, 1.0)) < 1e-12 * size);
        for upper in 0..4 {
            let jump: Vec<f64> =
                at(upper, 1.0).iter().zip(at(upper + 1, 0.0)).map(|(one, other)| one - other).collect();
            assert!(largest(&jump) < 1e-12 * size, "{upper}: {jump:?}");
        }
    }

    /// The factors in a shear strain of u_j = z_j and of w = −r: in a rotation of the whole stack no layer shears.
    #[test]
    fn rotations_cause_no_shear() {
        let stack = stack(&[(0.01, 70e9, 0.23), (0.00076, 3e7, 0.49), (0.004, 70e9, 0.23), (0.003, 3e9, 0.38)]);
        let depths = [0.0, 0.01, 0.01076, 0.01476, 0.01776];
        for ShearStrain { of_displacements, .. } in Transverse::new(&stack).shear {
            let strain: f64 = of_displacements.iter().zip(depths).map(|(factor, depth)| factor * depth).sum();
            assert!((strain - 1.0).abs() < 1e-12, "{strain}");
            assert!(of_displacements.iter().sum::<f64>().abs() < 1e-9);
        }
    }

    /// The energy is positive for a thin front ply on stiff glue, where the two interlayers of the second ply have very
    /// different stresses.
    #[test]
    fn thin_front_plies_have_a_positive_energy() {
        let glue = (2e-5, 3.5e9, 0.3);
        for front in [0.003, 0.001, 0.0003] {
            let glass = |thickness: f64| (thickness, 70e9, 0.23);
            let stack = stack(&[glass(front), glue, glass(0.01), glue, glass(0.01)]);
            for (strain, layer) in Transverse::new(&stack).shear.iter().zip(stack.layers()) {
                let ShearStrain { factor, thickness, .. } = strain;
                // A uniform stress has the factor 1, the parabola 5/6; stiff plies add to the compliance.
                assert!(*factor > 0.1 * layer.thickness && *thickness > 0.99 * layer.thickness, "{front}: {strain:?}");
            }
        }
    }
}
