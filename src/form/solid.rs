//! Linear elasticity and inertia over one cell, equations (1), (4) and (5).

use nalgebra::Vector3;

use crate::element::{Element, Quadrature, Shape, Table};

/// Linear isotropic elastic material.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Material {
    /// Young's modulus E, Pa.
    pub young: f64,
    /// Poisson's ratio ν, in (−1, 1/2).
    pub poisson: f64,
    /// Density ρ, kg/m³.
    pub density: f64,
}

impl Material {
    /// Returns Lamé's constants of (4).
    pub fn lame(&self) -> Lame {
        let Self { young, poisson, .. } = *self;
        Lame { lambda: young * poisson / ((1. + poisson) * (1. - 2. * poisson)), mu: young / (2. * (1. + poisson)) }
    }

    /// Returns the bulk modulus K, Pa.
    pub fn bulk(&self) -> f64 {
        self.young / (3. * (1. - 2. * self.poisson))
    }
}

/// Lamé's constants of (4).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Lame {
    /// First constant λ, Pa.
    pub lambda: f64,
    /// Shear modulus μ, Pa.
    pub mu: f64,
}

impl Lame {
    /// Deviatoric part of the stress, without the volumetric part, for a shear modulus of 1 Pa.
    pub const DEVIATORIC: Self = Self { lambda: -2. / 3., mu: 1. };

    /// Lamé's constants from the bulk modulus and the shear modulus, Pa.
    pub fn of_moduli(bulk: f64, shear: f64) -> Self {
        Self { lambda: bulk - 2. / 3. * shear, mu: shear }
    }
}

/// Error: the map from the reference cell is not one-to-one, because its Jacobian determinant is not positive at a
/// quadrature point.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[error("the cell is flat or turned inside out: its Jacobian determinant is {determinant:e}")]
pub struct Tangled {
    /// Jacobian determinant found, m³.
    pub determinant: f64,
}

/// Values at two consecutive nodes, stored together so that the compiler can use vector instructions.
type Pair = [f64; 2];

/// Stiffness, mass and body force of one cell, with their work arrays.
#[derive(Debug, Clone)]
pub struct SolidForms {
    lame: Lame,
    density: f64,
    /// Shape functions at the centre of the cell.
    middle: Table,
    /// Shape functions at the points of the stiffness, exact for affine cells.
    strain: Table,
    /// Shape functions at the points of mass and load, exact for affine cells.
    inertia: Table,
    /// √(weight × determinant) ∇φ in physical space, by pair of nodes, then point, then direction.
    gradients: Vec<[Pair; 3]>,
    scale: Vec<f64>,
    block: Vec<f64>,
}

impl SolidForms {
    /// Forms for a cell shape with elements of order 1 or 2.
    ///
    /// Quadrature: on tetrahedra, exact up to degree 2(order−1) for the stiffness and 2·order for mass and load; on
    /// hexahedra, (order+1)³ Gauss points.
    pub fn new(shape: Shape, order: usize, material: Material) -> Self {
        Self::of_lame(shape, order, material.lame(), material.density)
    }

    /// Same as [`SolidForms::new`], from Lamé's constants and a density, kg/m³.
    pub fn of_lame(shape: Shape, order: usize, lame: Lame, density: f64) -> Self {
        let element = Element::new(shape, order);
        let inertia = Table::new(&element, &Quadrature::exact(shape, 2 * order));
        let strain = match shape {
            Shape::Tetrahedron => Table::new(&element, &Quadrature::exact(shape, 2 * order - 2)),
            _ => inertia.clone(),
        };
        let n = element.nodes();
        Self {
            middle: Table::new(&element, &Quadrature::exact(shape, 1)),
            lame,
            density,
            gradients: vec![[[0.; 2]; 3]; n.div_ceil(2) * strain.points()],
            scale: vec![0.; inertia.points()],
            block: vec![0.; n * n],
            strain,
            inertia,
        }
    }

    /// Number of nodes of the cell.
    pub fn nodes(&self) -> usize {
        self.strain.nodes()
    }

    /// Computes the stiffness ∫ σ(u) : ε(v) dx, N/m.
    ///
    /// With H_{ia,jb} = ∫ ∂_a φ_i ∂_b φ_j dx the entry is λ H_{ia,jb} + μ H_{ib,ja} + μ δ_ab Σ_c H_{ic,jc}.
    ///
    /// # Errors
    /// If the map is [`Tangled`]; `out` is then in an undefined state.
    pub fn stiffness(&mut self, x: &[[f64; 3]], out: &mut [f64]) -> Result<(), Tangled> {
        self.scale_gradients(x)?;
        let Lame { lambda, mu } = self.lame;
        let (n, points) = (self.nodes(), self.strain.points());
        let size = 3 * n;
        for i in 0..n {
            let one = &self.gradients[i / 2 * points..][..points];
            for (pair, other) in self.gradients.chunks_exact(points).enumerate().skip(i / 2) {
                let h = gradient_products(one, i % 2, other);
                for (lane, j) in (2 * pair..n.min(2 * pair + 2)).enumerate() {
                    let trace = mu * (h[0][0][lane] + h[1][1][lane] + h[2][2][lane]);
                    for a in 0..3 {
                        for b in 0..3 {
                            let shear = if a == b { trace } else { 0. };
                            let entry = lambda * h[a][b][lane] + mu * h[b][a][lane] + shear;
                            out[(3 * i + a) * size + 3 * j + b] = entry;
                            out[(3 * j + b) * size + 3 * i + a] = entry;
                        }
                    }
                }
            }
        }
        Ok(())
    }

    /// Computes the mass ∫ ρ u·v dx, kg.
    ///
    /// # Errors
    /// If the map is [`Tangled`].
    pub fn mass(&mut self, x: &[[f64; 3]], out: &mut [f64]) -> Result<(), Tangled> {
        let mut block = std::mem::take(&mut self.block);
        let done = self.mass_by_node(x, &mut block);
        out.fill(0.);
        (0..3).for_each(|component| add_component(&block, self.nodes(), component, 1., out));
        self.block = block;
        done
    }

    /// Computes the mass for one component, ∫ ρ φ_i φ_j dx, kg: an n×n matrix for n nodes.
    ///
    /// # Errors
    /// If the map is [`Tangled`].
    pub fn mass_by_node(&mut self, x: &[[f64; 3]], out: &mut [f64]) -> Result<(), Tangled> {
        for q in 0..self.inertia.points() {
            self.scale[q] = self.density * volume(&self.inertia, q, x)?;
        }
        scalar_products(&self.inertia, &self.scale, out);
        Ok(())
    }

    /// Computes the load ∫ f·v dx, N, for the body force `f` (N/m³), a function of the position.
    ///
    /// # Errors
    /// If the map is [`Tangled`].
    pub fn load(&self, x: &[[f64; 3]], f: impl Fn([f64; 3]) -> [f64; 3], out: &mut [f64]) -> Result<(), Tangled> {
        out.fill(0.);
        for q in 0..self.inertia.points() {
            let volume = volume(&self.inertia, q, x)?;
            let force = f(self.inertia.position(q, x)).map(|f| volume * f);
            add_point_load(self.inertia.values(q), force, out);
        }
        Ok(())
    }

    fn scale_gradients(&mut self, x: &[[f64; 3]]) -> Result<(), Tangled> {
        let points = self.strain.points();
        // If opposite faces of a hexahedron are twisted by half a turn, the determinant is positive at all Gauss points
        // of an even rule and zero at the centre. So the centre is checked too.
        positive(self.middle.jacobian(0, x).determinant())?;
        for q in 0..points {
            let jacobian = self.strain.jacobian(q, x);
            let determinant = positive(jacobian.determinant())?;
            let inverse = jacobian.try_inverse().ok_or(Tangled { determinant })?;
            let to_space = inverse.transpose() * (self.strain.weight(q) * determinant).sqrt();
            for (i, &gradient) in self.strain.gradients(q).iter().enumerate() {
                let gradient = to_space * Vector3::from(gradient);
                let target = &mut self.gradients[i / 2 * points + q];
                for a in 0..3 {
                    target[a][i % 2] = gradient[a];
                }
            }
        }
        Ok(())
    }
}

/// Σ_q of the products of each derivative at one node (a lane of `one`) with each derivative at the two nodes in
/// `other`.
fn gradient_products(one: &[[Pair; 3]], lane: usize, other: &[[Pair; 3]]) -> [[Pair; 3]; 3] {
    let mut sum = [[[0.; 2]; 3]; 3];
    for (one, other) in one.iter().zip(other) {
        for a in 0..3 {
            let factor = one[a][lane];
            for b in 0..3 {
                for l in 0..2 {
                    sum[a][b][l] += factor * other[b][l];
                }
            }
        }
    }
    sum
}

/// Quadrature weight times Jacobian determinant at point `q`, m³.
fn volume(table: &Table, q: usize, x: &[[f64; 3]]) -> Result<f64, Tangled> {
    Ok(table.weight(q) * positive(table.jacobian(q, x).determinant())?)
}

fn positive(determinant: f64) -> Result<f64, Tangled> {
    if determinant > 0. { Ok(determinant) } else { Err(Tangled { determinant }) }
}

/// Σ_q s_q φ_a φ_b, with a scale s_q for each point, written to the n×n slice `out`.
///
/// The lower triangle is copied from the upper one, so that rounding does not break the symmetry.
fn scalar_products(table: &Table, scale: &[f64], out: &mut [f64]) {
    let n = table.nodes();
    out.fill(0.);
    for (q, &scale) in scale.iter().enumerate() {
        let values = table.values(q);
        for (a, row) in out.chunks_exact_mut(n).enumerate() {
            let factor = scale * values[a];
            for (entry, b) in row[a..].iter_mut().zip(&values[a..]) {
                *entry += factor * b;
            }
        }
    }
    for a in 1..n {
        for b in 0..a {
            out[a * n + b] = out[b * n + a];
        }
    }
}

/// Adds `factor` times the n×n `block` to the entries of `out` that couple a component with the same component.
fn add_component(block: &[f64], n: usize, component: usize, factor: f64, out: &mut [f64]) {
    let rows = out.chunks_exact_mut(3 * n).skip(component).step_by(3);
    for (row, block) in rows.zip(block.chunks_exact(n)) {
        for (entry, value) in row[component..].iter_mut().step_by(3).zip(block) {
            *entry += factor * value;
        }
    }
}

/// Adds the load at a point, times the values of the shape functions there, to a vector.
fn add_point_load(values: &[f64], load: [f64; 3], out: &mut [f64]) {
    for (entries, value) in out.chunks_exact_mut(3).zip(values) {
        for (entry, load) in entries.iter_mut().zip(load) {
            *entry += value * load;
        }
    }
}
