//! Symmetry classes of motion: motions that are symmetric or antisymmetric about the planes of symmetry of a body.
//!
//! If a body with its supports and loads is symmetric about a plane, any motion is the sum of a symmetric and an
//! antisymmetric motion, which do not couple. Each is the motion of the part on one side, with its own boundary
//! conditions on the plane. A force at any point excites both, by half of its value there and half at the mirror image.

use nalgebra_sparse::CsrMatrix;

use crate::form::Parity;

/// Parities of the displacement normal to a plate, along both axes of the plate.
pub type ParityClass = [Parity; 2];

/// All symmetry classes, the most symmetric first. An axis has two parities if a plane of symmetry is normal to it. If
/// the impact lies on that plane (`is_shared`), only even motions are excited.
pub fn classes(has_plane: [bool; 2], is_shared: [bool; 2]) -> Vec<ParityClass> {
    let of = |axis: usize| -> &[Parity] {
        if has_plane[axis] && !is_shared[axis] { &[Parity::Even, Parity::Odd] } else { &[Parity::Even] }
    };
    of(0).iter().flat_map(|first| of(1).iter().map(move |second| [*first, *second])).collect()
}

/// Block-diagonal matrix with a copy of `matrix` for each symmetry class.
pub fn repeated(matrix: CsrMatrix<f64>, times: usize) -> CsrMatrix<f64> {
    if times == 1 {
        return matrix;
    }
    let (size, entries) = (matrix.nrows(), matrix.nnz());
    let of_class = |class: usize| matrix.row_offsets()[1..].iter().map(move |end| class * entries + end);
    let offsets = std::iter::once(0).chain((0..times).flat_map(of_class)).collect();
    let columns = (0..times).flat_map(|class| matrix.col_indices().iter().map(move |j| class * size + j)).collect();
    let total = times * size;
    CsrMatrix::try_from_csr_data(total, total, offsets, columns, matrix.values().repeat(times))
        .expect("rows in order, columns ascending")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn classes_are_those_that_the_impact_excites() {
        use Parity::{Even, Odd};
        let all = [[Even, Even], [Even, Odd], [Odd, Even], [Odd, Odd]];
        assert_eq!(classes([true; 2], [false; 2]), all);
        assert_eq!(classes([true; 2], [false, true]), [all[0], all[2]]);
        assert_eq!(classes([false, true], [false; 2]), all[..2]);
        assert_eq!(classes([true; 2], [true; 2]), all[..1]);
        assert_eq!(classes([false; 2], [false; 2]), all[..1]);
    }

    #[test]
    fn repeated_blocks_do_not_meet() {
        let matrix = CsrMatrix::try_from_csr_data(2, 2, vec![0, 2, 3], vec![0, 1, 1], vec![1.0, 2.0, 3.0]);
        let found = repeated(matrix.expect("a matrix"), 2);
        let entries: Vec<_> = found.triplet_iter().map(|(i, j, value)| (i, j, *value)).collect();
        assert_eq!(entries, [(0, 0, 1.0), (0, 1, 2.0), (1, 1, 3.0), (2, 2, 1.0), (2, 3, 2.0), (3, 3, 3.0)]);
    }
}
