//! A body that is its own mirror image across the diagonal plane x = y, as a square plate is that is hit at its centre.
//!
//! Its motion is its mirror image too: an unknown and its image are equal, and one stands for both. With u = P v, where P gives each
//! unknown the one that stands for it, M becomes PᵀMP, a becomes Pᵀa, and all energies stay as they are: nothing is left out.

use nalgebra_sparse::CsrMatrix;
use nalgebra_sparse::csr::CsrRow;

use super::System;
use super::deviates::normal;

/// What rounding may leave between a matrix or a vector and its image, over its largest entry.
const ROUNDING: f64 = 1e-11;

/// Which unknown stands for each one of a body.
#[derive(Debug, Clone, PartialEq)]
pub struct Diagonal {
    standing: Vec<usize>,
    /// Of those that stand for themselves, by their new number, the old one and how many unknowns it stands for.
    kept: Vec<(usize, f64)>,
}

impl Diagonal {
    /// Of a body whose unknowns have these images, which have them in turn; `None` where its supports or loads have other images.
    pub fn new(system: &System, image: &[usize]) -> Option<Self> {
        let is_plain = system.classes == 1 && system.pads.is_empty() && system.infinite_plate.is_none();
        (is_plain && is_its_image(system, image)).then(|| Self::of(image))
    }

    fn of(image: &[usize]) -> Self {
        let (mut standing, mut kept): (Vec<usize>, Vec<(usize, f64)>) = (Vec::with_capacity(image.len()), Vec::new());
        for (unknown, &other) in image.iter().enumerate() {
            if other < unknown {
                standing.push(standing[other]);
            } else {
                standing.push(kept.len());
                kept.push((unknown, if other == unknown { 1.0 } else { 2.0 }));
            }
        }
        Self { standing, kept }
    }

    /// How many unknowns are left.
    pub fn unknowns(&self) -> usize {
        self.kept.len()
    }

    /// The new number of the unknown that stands for one.
    pub fn standing(&self, unknown: usize) -> usize {
        self.standing[unknown]
    }

    /// The body by the unknowns that are left.
    pub fn halved(&self, system: &System) -> System {
        let square = |matrix: &CsrMatrix<f64>| self.matrix(matrix);
        let force = |vector: &Vec<f64>| self.force(vector);
        let is_kept = |unknown: usize| self.kept[self.standing[unknown]].0 == unknown;
        let held = system.held.iter().filter(|(unknown, _)| is_kept(*unknown));
        System {
            mass: square(&system.mass),
            elastic: square(&system.elastic),
            relaxations: system.relaxations.iter().map(|(d, chain)| (square(d), chain.clone())).collect(),
            support: system.support.as_ref().map(square),
            damping: system.damping.as_ref().map(square),
            pads: Vec::new(),
            held: held.map(|(unknown, value)| (self.standing[*unknown], *value)).collect(),
            load: force(&system.load),
            support_load: force(&system.support_load),
            localization: force(&system.localization),
            hit_stress: system.hit_stress.iter().map(force).collect(),
            translation: self.kept.iter().map(|(unknown, _)| system.translation[*unknown]).collect(),
            infinite_plate: None,
            ..*system
        }
    }

    /// Pᵀ f.
    fn force(&self, whole: &[f64]) -> Vec<f64> {
        let mut sums = vec![0.0; self.kept.len()];
        self.standing.iter().zip(whole).for_each(|(&standing, value)| sums[standing] += value);
        sums
    }

    /// PᵀAP of a matrix that is its own image: of the two rows that become one either does, twice.
    fn matrix(&self, whole: &CsrMatrix<f64>) -> CsrMatrix<f64> {
        let count = self.kept.len();
        let (mut offsets, mut columns, mut values) = (vec![0], Vec::new(), Vec::new());
        let (mut sums, mut is_in) = (vec![0.0; count], vec![false; count]);
        for &(unknown, times) in &self.kept {
            let (row, begin) = (whole.row(unknown), columns.len());
            for (column, value) in row.col_indices().iter().zip(row.values()) {
                let standing = self.standing[*column];
                if !std::mem::replace(&mut is_in[standing], true) {
                    columns.push(standing);
                }
                sums[standing] += times * value;
            }
            columns[begin..].sort_unstable();
            values.extend(columns[begin..].iter().map(|&column| {
                is_in[column] = false;
                std::mem::take(&mut sums[column])
            }));
            offsets.push(columns.len());
        }
        CsrMatrix::try_from_csr_data(count, count, offsets, columns, values).expect("rows in order, columns ascending")
    }
}

/// Whether all that a body is of is the same with each unknown's image in its place. Matrices are told by their products with a vector.
fn is_its_image(system: &System, image: &[usize]) -> bool {
    let imaged = |vector: &[f64]| -> Vec<f64> { image.iter().map(|&other| vector[other]).collect() };
    let alike = |one: &[f64], other: &[f64]| {
        let largest = one.iter().fold(0.0_f64, |largest, entry| largest.max(entry.abs()));
        one.iter().zip(other).all(|(a, b)| (a - b).abs() <= ROUNDING * largest)
    };
    let vectors = [&system.load, &system.support_load, &system.localization, &system.translation];
    let is_image_held = |(unknown, value): &(usize, f64)| {
        let found = system.held.binary_search_by_key(&image[*unknown], |(other, _)| *other);
        found.is_ok_and(|place| system.held[place].1 == *value)
    };
    if !vectors.into_iter().all(|vector| alike(vector, &imaged(vector))) || !system.held.iter().all(is_image_held) {
        return false;
    }
    let vector: Vec<f64> = (0..image.len() as u64).map(normal).collect();
    let of_image = imaged(&vector);
    let relaxing = system.relaxations.iter().map(|(distortion, _)| distortion);
    let matrices = [&system.mass, &system.elastic].into_iter().chain(&system.support).chain(&system.damping);
    matrices.chain(relaxing).all(|matrix| {
        let product = |vector: &[f64]| -> Vec<f64> {
            let entries = matrix.row_iter();
            let entry =
                |row: CsrRow<f64>| row.col_indices().iter().zip(row.values()).map(|(j, a)| a * vector[*j]).sum();
            entries.map(entry).collect()
        };
        alike(&imaged(&product(&vector)), &product(&of_image))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Rows 0 and 1 are images, row 2 is its own: energies of symmetric motions, and what forces do on them, are those of the whole.
    #[test]
    fn energies_are_those_of_the_whole() {
        let image = [1, 0, 2, 4, 3];
        let entry = |i: usize, j: usize| ((i * j) % 3) as f64 + if i == j { 9.0 } else { 0.5 };
        let full =
            |i: usize, j: usize| entry(i, j) + entry(j, i) + entry(image[i], image[j]) + entry(image[j], image[i]);
        let offsets = (0..=5).map(|i| 5 * i).collect();
        let columns = (0..25).map(|n| n % 5).collect();
        let values = (0..25).map(|n| full(n / 5, n % 5)).collect();
        let whole = CsrMatrix::try_from_csr_data(5, 5, offsets, columns, values).expect("a full matrix");
        let diagonal = Diagonal::of(&image);
        assert_eq!(diagonal.unknowns(), 3);
        let (half, v) = (diagonal.matrix(&whole), [0.3, -1.1, 0.7]);
        let u: Vec<f64> = (0..5).map(|unknown| v[diagonal.standing(unknown)]).collect();
        let energy = |matrix: &CsrMatrix<f64>, u: &[f64]| -> f64 {
            matrix.triplet_iter().map(|(i, j, a)| u[i] * a * u[j]).sum()
        };
        // Rounding of some ten terms of the size of ten.
        assert!((energy(&whole, &u) - energy(&half, &v)).abs() < 1e-12);
        let force = [0.2, 0.2, 0.5, -0.4, -0.4];
        let work: f64 = force.iter().zip(&u).map(|(f, u)| f * u).sum();
        let of_half: f64 = diagonal.force(&force).iter().zip(&v).map(|(f, v)| f * v).sum();
        assert!((work - of_half).abs() < 1e-14);
    }
}
