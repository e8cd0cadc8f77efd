//! Plate theories: their fields, and the coefficients that are rotations at an edge.

use super::layers::profile::ROTATIONS;
use crate::form::Spline;
use crate::form::plate::DEFLECTION;
use crate::form::tensor::Tensor;

/// Theory of a plate.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PlateTheory {
    /// Kirchhoff's theory: no shear, no rotary inertia; loaded at a point.
    Kirchhoff,
    /// Reissner–Mindlin theory in each layer (`space/plate/layers/profile.rs`): shear and rotary inertia; loaded on a disc.
    Layerwise,
}

/// Degree p of the splines of the deflection, which have p − 1 continuous derivatives. Among the degrees 3 to 5,
/// including C¹ cubics (bicubic Hermite elements), the highest needs the fewest unknowns for an error of 0.1% of the
/// time history of an impact. For 1%, degree 4 is as good. For 0.01%, degree 4 has three to five times the error on the
/// same number of cells.
pub(super) const DEGREE: usize = 5;

impl PlateTheory {
    /// Fields of the theory between the lines of a grid, with `rotations` rotations along each axis.
    ///
    /// With shear, w is approximated by splines of degree p. Each rotation has one degree and one continuous derivative
    /// less along its own axis. Then ∇w is contained in the space of the rotations, and there is no shear locking
    /// (Beirão da Veiga, Buffa, Lovadina, Martinelli & Sangalli, An isogeometric method for the Reissner–Mindlin plate
    /// bending problem, Comput. Methods Appl. Mech. Eng. 209–212, 2012).
    pub(super) fn tensor(self, lines: &[Vec<f64>; 2], rotations: usize) -> Tensor<2> {
        let splines = |degree: usize| lines.each_ref().map(|lines| Spline::new(lines, degree, degree - 1));
        Tensor::new(match self {
            Self::Kirchhoff => vec![lines.each_ref().map(|lines| Spline::with_slopes(lines, DEGREE, DEGREE - 1))],
            Self::Layerwise => {
                let ([x, y], [less_x, less_y]) = (splines(DEGREE), splines(DEGREE - 1));
                let of_rotation = [[less_x, y.clone()], [x.clone(), less_y]];
                let all = (0..rotations).flat_map(|_| of_rotation.iter().cloned());
                std::iter::once([x, y]).chain(all).collect()
            }
        })
    }

    /// Coefficient that is the rotation along `axis` at an end of the axis `of_end`: its field and its position counted
    /// from the end. If there are several rotations, this is the first. `None` if the rotation follows from the
    /// deflection.
    pub(super) fn rotation_at_end(self, axis: usize, of_end: usize) -> Option<(usize, usize)> {
        match self {
            Self::Kirchhoff => (axis == of_end).then_some((DEFLECTION, 1)),
            Self::Layerwise => Some((ROTATIONS + axis, 0)),
        }
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use nalgebra::{DMatrix, DVector, SymmetricEigen};
    use nalgebra_sparse::CsrMatrix;

    use super::super::layers::profile::{LayerModuli, Profile};
    use super::*;
    use crate::form::plate::Section;
    use crate::form::tensor::Square;
    use crate::form::{Material, Spline};
    use crate::stack::{Layer, Layerwise, Stack};

    const SECTION: Section = Section { thickness: 0.1, young: 70e9, poisson: 0.23, density: 2500.0 };
    const EDGES: [f64; 2] = [1.0, 0.7];

    /// Forms of twice the elastic and twice the kinetic energy of a plate of one layer.
    fn forms(theory: PlateTheory, section: &Section) -> [Vec<Square<2>>; 2] {
        let Section { thickness, young, poisson, density } = *section;
        let stack = Stack::new(&[Layer { thickness, young, poisson }]).expect("an elastic layer");
        let (profile, layerwise) = match theory {
            PlateTheory::Kirchhoff => (Profile::thin(thickness), Layerwise::thin(&stack, |_| true)),
            PlateTheory::Layerwise => (Profile::new(&[thickness], true), Layerwise::new(&stack)),
        };
        let moduli = LayerModuli::new(Material { young, poisson, density }.lame());
        [profile.elastic(&[moduli], layerwise.transverse()), profile.mass(&[density], layerwise.transverse())]
    }

    fn uniform(edge: f64, cells: usize) -> Vec<f64> {
        (0..=cells).map(|i| edge * i as f64 / cells as f64).collect()
    }

    fn dense(entries: &CsrMatrix<f64>, free: &[usize], unknowns: usize) -> DMatrix<f64> {
        let mut full = DMatrix::zeros(unknowns, unknowns);
        entries.triplet_iter().for_each(|(i, j, value)| full[(i, j)] += value);
        full.select_rows(free).select_columns(free)
    }

    /// Squares of the lowest circular frequencies, ascending. The deflection w and the slope along the edge are zero on
    /// all edges.
    fn frequencies(theory: PlateTheory, cells: usize, modes: usize) -> Vec<f64> {
        let tensor = theory.tensor(&EDGES.map(|edge| uniform(edge, cells)), 1);
        let n = tensor.unknowns();
        let mut held = vec![false; n];
        for axis in 0..2 {
            let along = theory.rotation_at_end(1 - axis, axis);
            for (field, depth) in along.into_iter().chain([(DEFLECTION, 0)]) {
                let [x, y] = tensor.splines(field).each_ref().map(Spline::functions);
                for (i, j) in (0..x).flat_map(|i| (0..y).map(move |j| (i, j))) {
                    let (at, last) = ([i, j][axis], [x, y][axis] - 1);
                    held[tensor.unknown(field, [i, j])] |= at == depth || at == last - depth;
                }
            }
        }
        let free: Vec<usize> = (0..n).filter(|&i| !held[i]).collect();
        let [elastic, mass] = forms(theory, &SECTION).map(|forms| dense(&tensor.matrix(&forms), &free, n));
        let inverse = mass.cholesky().expect("a mass matrix").l().try_inverse().expect("its factor");
        let symmetric = &inverse * elastic * inverse.transpose();
        let mut values: Vec<f64> = SymmetricEigen::new(symmetric).eigenvalues.iter().copied().collect();
        values.sort_by(f64::total_cmp);
        values.truncate(modes);
        values
    }

    /// Squares of the exact circular frequencies. For a wave sin x sin y: Dξ⁴/ρh in Kirchhoff's theory. With shear, the
    /// lower root of det(K − ω²M) = 0 with K = [[S, Sc], [Sc, Dξ⁴ + Sc²]], S = ⅚μhξ², c = 1 − νh²ξ²/(60(1 − ν)) and
    /// M = diag(ρh, ρh³ξ²/12) in w and the potential of θ.
    fn exact(theory: PlateTheory, modes: usize) -> Vec<f64> {
        let wave = |m: i32, n: i32| {
            let square = [m, n].iter().zip(EDGES).map(|(m, edge)| (PI * f64::from(*m) / edge).powi(2)).sum::<f64>();
            let bending = SECTION.rigidity() * square * square;
            let mass = SECTION.density * SECTION.thickness;
            if theory == PlateTheory::Kirchhoff {
                return bending / mass;
            }
            let (shear, rotary) = (5.0 / 6.0 * SECTION.shear() * square, SECTION.density * SECTION.inertia() * square);
            let stretch = 1.0 - SECTION.poisson * SECTION.thickness.powi(2) * square / (60.0 * (1.0 - SECTION.poisson));
            let half = 0.5 * (shear / mass + (bending + shear * stretch * stretch) / rotary);
            let product = shear * bending / (mass * rotary);
            product / (half + (half * half - product).sqrt())
        };
        let mut values: Vec<f64> = (1..9).flat_map(|m| (1..9).map(move |n| wave(m, n))).collect();
        values.sort_by(f64::total_cmp);
        values.truncate(modes);
        values
    }

    /// Rotation of one end of a free strip of a given length, divided by the torque there. The width is 10 h, and the
    /// ends remain straight.
    fn torsion(length: f64, poisson: f64) -> f64 {
        let section = Section { thickness: 0.1, poisson, ..SECTION };
        let width = 1.0;
        // The cell size is the same for all lengths, so that the error at the ends is the same.
        let lines = [uniform(length, (4.0 * length).round() as usize), uniform(width, 10)];
        let tensor = PlateTheory::Layerwise.tensor(&lines, 1);
        let [forms, _] = forms(PlateTheory::Layerwise, &section);
        let all: Vec<usize> = (0..tensor.unknowns()).collect();
        let elastic = dense(&tensor.matrix(&forms), &all, all.len());
        // Coefficients of the straight line w = y: means of as many successive knots as the degree.
        let [x, y] = tensor.splines(DEFLECTION).each_ref().map(Spline::functions);
        let end = [lines[1][0], width].map(|end| vec![end; DEGREE]);
        let knots = [&end[0][..], &lines[1], &end[1][..]].concat();
        let mut given = vec![None; all.len()];
        for j in 0..y {
            let place = knots[j + 1..=j + DEGREE].iter().sum::<f64>() / DEGREE as f64;
            given[tensor.unknown(DEFLECTION, [0, j])] = Some(0.0);
            given[tensor.unknown(DEFLECTION, [x - 1, j])] = Some(place - 0.5 * width);
        }
        let (held, free): (Vec<usize>, Vec<usize>) = all.iter().partition(|&&i| given[i].is_some());
        let values = DVector::from_iterator(held.len(), held.iter().filter_map(|&i| given[i]));
        let rows = elastic.select_rows(&free);
        let factor = rows.select_columns(&free).cholesky().expect("held at two ends");
        let coupling = rows.select_columns(&held) * &values;
        let within = elastic.select_rows(&held).select_columns(&held) * &values;
        1.0 / (values.dot(&within) - coupling.dot(&factor.solve(&coupling)))
    }

    /// The twisting stiffness of the theory is G b h³/3 (1 − 2h/(√10 b)), since the twisting moment falls to zero at free
    /// edges within h/√10 = 0.3162 h. Saint-Venant's solid has G b h³/3 (1 − 0.6302 h/b), i.e. a width of 0.3151 h. It is
    /// computed from the difference of two lengths, so that the ends have no effect. The tolerance is a quarter of the
    /// difference of both.
    #[test]
    fn strips_have_the_twisting_stiffness_of_solids() {
        for poisson in [0.0, 0.23, 0.45] {
            let plain = 0.5 * SECTION.young / (1.0 + poisson) * 1e-3 / 3.0;
            let found = 1.0 / (torsion(4.0, poisson) - torsion(3.0, poisson)) / plain;
            assert!((found - (1.0 - 0.2 / 10.0_f64.sqrt())).abs() < 5e-5, "{poisson}: {found}");
            assert!((found - (1.0 - 0.06302)).abs() < 2.5e-4, "{poisson}: {found}");
        }
    }

    /// Squares of frequencies converge with the order 2 (p + 1 − m), where m is the order of the derivatives in the
    /// energy: 8 for Kirchhoff's plate. Rotations, of degree p − 1 with one derivative, reach the same order
    /// 2 (p − 1) = 8.
    #[test]
    fn simply_supported_frequencies() {
        for theory in [PlateTheory::Kirchhoff, PlateTheory::Layerwise] {
            let exact = exact(theory, 3);
            let errors = [6, 9].map(|cells| {
                let found = frequencies(theory, cells, 3);
                found.iter().zip(&exact).map(|(found, exact)| found / exact - 1.0).fold(0.0, f64::max)
            });
            let order = (errors[0] / errors[1]).ln() / 1.5_f64.ln();
            assert!(order > 7.5, "{theory:?}: order {order}, {errors:?}");
            assert!(errors[1] < 1e-7, "{theory:?}: {errors:?}");
        }
    }
}
