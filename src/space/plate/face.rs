//! Stresses at the crossings of lines on a face of a plate, on a basis: products of values along the axes.

use nalgebra::{DMatrix, Dyn, MatrixView};

use crate::form::plate::{Section, rotation};
use crate::form::tensor::Part;
use crate::form::{Parity, Spline};

use super::points::Points;

impl Points {
    /// The stresses along the face, σ_a, σ_b and σ_ab, at a height (m, along the scene's axis across the plate), for 1 of each vector of a
    /// basis: a row for each crossing of the lines along the axes of the plane, the second's fastest, and in it for each component.
    pub(super) fn stress_on_lines(&self, lines: [&[f64]; 2], height: f64, basis: &[Vec<f64>]) -> Vec<f64> {
        let height = self.geometry.sign * height;
        let Section { young, poisson, .. } = self.section;
        let (plane, shear) = (young / (1.0 - poisson * poisson), 0.5 * young / (1.0 + poisson));
        let values = |axis: usize, derivatives: [usize; 2]| {
            let parts = self.turned(axis, derivatives, height).into_iter();
            let values = parts.map(|(factor, part)| factor * self.on_lines(part, lines, basis));
            values.reduce(|sum, part| sum + part).expect("a displacement along each axis")
        };
        let stretches = [values(0, [1, 0]), values(1, [0, 1])];
        let turn = values(0, [0, 1]) + values(1, [1, 0]);
        let (count, crossings) = (basis.len(), lines[0].len() * lines[1].len());
        let mut rows = vec![0.0; 3 * crossings * count];
        for point in 0..crossings {
            for vector in 0..count {
                let [a, b] = [0, 1].map(|i| stretches[i][(point, vector)]);
                let stresses = [plane * (a + poisson * b), plane * (b + poisson * a), shear * turn[(point, vector)]];
                (0..3).for_each(|i| rows[(3 * point + i) * count + vector] = stresses[i]);
            }
        }
        rows
    }

    /// A part at the crossings, a column for each vector.
    fn on_lines(&self, part: Part<2>, lines: [&[f64]; 2], basis: &[Vec<f64>]) -> DMatrix<f64> {
        let splines = self.tensor.splines(part.field);
        let functions = splines.each_ref().map(Spline::functions);
        let first = self.tensor.unknown(part.field, [0, 0]);
        let mut sum = DMatrix::zeros(lines[0].len() * lines[1].len(), basis.len());
        for (number, class) in self.geometry.classes.iter().enumerate() {
            let start = number * self.tensor.unknowns() + first;
            let [a, b] = [0, 1].map(|i| {
                // A rotation is a slope: odd where the deflection is even.
                let is_slope = part.field == rotation(i, [0, 0]).field;
                let is_turned = (part.derivatives[i] + usize::from(is_slope)) % 2 == 1;
                let flips = (class[i] == Parity::Odd) != is_turned;
                let is_mirrored = self.geometry.halved[i];
                along(&splines[i], part.derivatives[i], lines[i], is_mirrored.then_some(if flips { -1.0 } else { 1.0 }))
            });
            for (vector, mut column) in basis.iter().zip(sum.column_iter_mut()) {
                let of_field = &vector[start..start + functions[0] * functions[1]];
                // The second axis runs fastest: it is the rows'.
                let of_field = MatrixView::<f64, Dyn, Dyn>::from_slice(of_field, functions[1], functions[0]);
                let values = &b * (of_field * &a.transpose());
                column.iter_mut().zip(&values).for_each(|(sum, value)| *sum += value);
            }
        }
        sum
    }
}

/// A derivative of all functions of an axis at the places of lines, a row each; `image` is the sign with which places below 0 have the
/// values of their images, where they have some.
fn along(spline: &Spline, derivative: usize, lines: &[f64], image: Option<f64>) -> DMatrix<f64> {
    let mut values = DMatrix::zeros(lines.len(), spline.functions());
    for (row, &x) in lines.iter().enumerate() {
        let (x, sign) = match image {
            Some(sign) if x < 0.0 => (-x, sign),
            _ => (x, 1.0),
        };
        let (first, of_cell) = spline.at(x, derivative);
        for (i, value) in of_cell.into_iter().enumerate().take(spline.functions() - first) {
            values[(row, first + i)] = sign * value;
        }
    }
    values
}
