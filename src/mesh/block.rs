//! Division of the cells of a grid among ranks: boxes with nearly equal numbers of cells and small interfaces.

use std::ops::Range;

/// Range of the cells along each axis for a rank. It is empty if there are fewer cells than ranks and the other ranks
/// have all cells.
///
/// The grid is cut across its longest axis into two parts. Each part is assigned ranks in proportion to its cells and
/// is divided in the same way (recursive coordinate bisection, Berger & Bokhari 1987).
pub fn block(cells: [usize; 3], ranks: usize, rank: usize) -> [Range<usize>; 3] {
    let count = |block: &[Range<usize>; 3]| block.iter().map(|range| range.len()).product::<usize>();
    let mut block = cells.map(|n| 0..n);
    let (mut ranks, mut rank) = (ranks.min(count(&block)), rank);
    if rank >= ranks {
        return [0..0, 0..0, 0..0];
    }
    while ranks > 1 {
        // Of equally long axes the first is cut.
        let longest =
            (1..3).fold(0, |longest, axis| if block[axis].len() > block[longest].len() { axis } else { longest });
        let Range { start, end } = block[longest];
        let layers = end - start;
        let cut = ((2 * layers * (ranks / 2) + ranks) / (2 * ranks)).clamp(1, layers - 1);
        let (mut lower, mut upper) = (block.clone(), block);
        lower[longest] = start..start + cut;
        upper[longest] = start + cut..end;
        // Each rank must get at least one cell.
        let below = (ranks / 2).max(ranks.saturating_sub(count(&upper))).min(count(&lower));
        if rank < below {
            (block, ranks) = (lower, below);
        } else {
            (block, ranks, rank) = (upper, ranks - below, rank - below);
        }
    }
    block
}

#[cfg(test)]
mod tests {
    use super::block;

    /// Every cell belongs to one rank, every rank has a cell if there are enough, and large grids are divided evenly.
    #[test]
    fn blocks_share_the_cells_of_a_grid() {
        for cells in [[1, 1, 1], [3, 3, 1], [7, 5, 3], [2, 1, 9], [40, 40, 8]] {
            let total: usize = cells.iter().product();
            for ranks in 1..40 {
                let mut makers = vec![0; total];
                for rank in 0..ranks {
                    let [x, y, z] = block(cells, ranks, rank);
                    let size = x.len() * y.len() * z.len();
                    assert!(size > 0 || rank >= total, "{cells:?}: rank {rank} of {ranks} has nothing");
                    // No cut divides a layer of cells; there are at least eight layers.
                    let due = total as f64 / ranks as f64;
                    assert!(total < 10_000 || (size as f64 / due - 1.0).abs() < 0.25, "{rank} of {ranks}: {size}");
                    for (k, j) in z.flat_map(|k| y.clone().map(move |j| (k, j))) {
                        x.clone().for_each(|i| makers[i + cells[0] * (j + cells[1] * k)] += 1);
                    }
                }
                assert!(makers.iter().all(|makers| *makers == 1), "{cells:?} on {ranks} ranks");
            }
        }
    }
}
