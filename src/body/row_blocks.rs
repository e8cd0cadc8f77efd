//! A matrix whose rows have nonzero entries in a few sets of columns, typical of uncoupled symmetry classes.

use nalgebra::DMatrix;

/// A matrix stored as blocks of rows with nonzero entries in the same columns.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct RowBlocks(Vec<RowBlock>);

#[derive(Debug, Clone, PartialEq)]
struct RowBlock {
    columns: Vec<usize>,
    /// Entries of the rows in these columns.
    rows: DMatrix<f64>,
}

impl RowBlocks {
    /// Creates the blocks from the chosen columns of a matrix.
    pub fn new(matrix: &DMatrix<f64>, chosen: &[usize]) -> Self {
        let mut blocks: Vec<(Vec<usize>, Vec<usize>)> = Vec::new();
        for (number, row) in matrix.row_iter().enumerate() {
            let columns: Vec<usize> = (0..chosen.len()).filter(|place| row[chosen[*place]] != 0.0).collect();
            match blocks.iter_mut().find(|(of, _)| *of == columns) {
                Some((_, rows)) => rows.push(number),
                None => blocks.push((columns, vec![number])),
            }
        }
        let block = |(columns, rows): (Vec<usize>, Vec<usize>)| {
            let rows = DMatrix::from_fn(rows.len(), columns.len(), |i, j| matrix[(rows[i], chosen[columns[j]])]);
            RowBlock { columns, rows }
        };
        Self(blocks.into_iter().map(block).collect())
    }

    /// Returns |A x|² for each column x of a matrix.
    pub fn squared_norms_of_products(&self, x: &DMatrix<f64>) -> Vec<f64> {
        let mut squares = vec![0.0; x.ncols()];
        for block in &self.0 {
            let products = &block.rows * x.select_rows(&block.columns);
            squares.iter_mut().zip(products.column_iter()).for_each(|(square, of)| *square += of.norm_squared());
        }
        squares
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Rows with two sets of columns and rows without entries, for all columns and for some of them.
    #[test]
    fn norms_of_products_are_those_of_the_whole_matrix() {
        let entry = |i: usize, j: usize| if i % 3 == 2 || i % 2 != j % 2 { 0.0 } else { (3 * i + 5 * j) as f64 - 11.0 };
        let matrix = DMatrix::from_fn(7, 6, entry);
        for chosen in [vec![0, 1, 2, 3, 4, 5], vec![5, 0, 2], vec![]] {
            let blocks = RowBlocks::new(&matrix, &chosen);
            assert!(blocks.0.len() <= 3);
            let x = DMatrix::from_fn(chosen.len(), 2, |i, j| i as f64 - 1.5 + j as f64);
            let products = matrix.select_columns(&chosen) * &x;
            let exact: Vec<f64> = products.column_iter().map(|product| product.norm_squared()).collect();
            // Exact, because these are sums of a few integers and halves.
            assert_eq!(blocks.squared_norms_of_products(&x), exact);
        }
    }
}
