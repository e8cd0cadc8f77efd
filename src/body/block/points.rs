//! A block's displacement and stress at its points.

use super::Terms;
use crate::body::gauge::{Form, Forms, add, summed};
use crate::form::Material;
use crate::form::elastic::displacement;
use crate::form::tensor::{Part, Tensor};
use crate::scene::Vec3;

/// Hexahedra in a cell of splines along each axis, where fields are written.
const PIECES: usize = 2;

/// Points of fields at most, but for one at each crossing of lines.
const MOST: usize = 20_000;

/// A block's discretisation, to be read anywhere in the modelled part.
#[derive(Debug, Clone)]
pub struct Points {
    tensor: Tensor<3>,
    lines: [Vec<f64>; 3],
    law: [[f64; 9]; 6],
    /// Radius of the disc that is pressed, m.
    pub(in crate::body) disc: f64,
}

impl Points {
    pub(super) fn new(terms: &Terms, material: &Material, disc: f64) -> Self {
        Self { tensor: terms.tensor.clone(), lines: terms.lines.clone(), law: material.stress_of_gradient(), disc }
    }

    /// The forms at a point, m.
    pub(in crate::body) fn at(&self, x: Vec3) -> Forms {
        let mut stress: [Form; 6] = Default::default();
        for (i, j) in (0..3).flat_map(|i| (0..3).map(move |j| (i, j))) {
            let mut derivatives = [0; 3];
            derivatives[j] = 1;
            let slope = self.tensor.at_point(Part { field: i, derivatives }, x, 1.0);
            stress.iter_mut().zip(&self.law).for_each(|(form, row)| add(form, row[3 * i + j], &slope));
        }
        let moved = |axis: usize| summed(self.tensor.at_point(displacement(axis), x, 1.0));
        Forms { displacement: [0, 1, 2].map(moved), stress: stress.map(summed) }
    }

    /// Coordinates along the axes on which fields are written, m.
    pub(in crate::body) fn lines(&self) -> [Vec<f64>; 3] {
        let cut = |pieces: usize| self.lines.each_ref().map(|lines| divided(lines, pieces));
        let fine = cut(PIECES);
        if fine.iter().map(Vec::len).product::<usize>() <= MOST { fine } else { cut(1) }
    }
}

/// Ends of cells, each once, and of so many equal pieces of each.
pub(in crate::body) fn divided(breaks: &[f64], pieces: usize) -> Vec<f64> {
    let cells = breaks.windows(2).filter(|pair| pair[0] < pair[1]);
    let inner =
        cells.flat_map(|pair| (0..pieces).map(move |i| pair[0] + (pair[1] - pair[0]) * i as f64 / pieces as f64));
    inner.chain(breaks.last().copied()).collect()
}
