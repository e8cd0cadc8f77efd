//! Which rank has which cells of a mesh: each those that lie near each other.
//!
//! Ranks have stretches of Hilbert's curve through the box around the mesh: equally many cells each, in compact parts, whatever their order was.

use mpi::collective::SystemOperation;
use mpi::traits::CommunicatorCollectives;

use crate::Int;
use crate::comm::Comm;

use super::share::{Cells, share};

/// Bits of a place on the curve for each axis.
const BITS: u32 = 21;

/// Sends each cell, which has so many `corners`, to its rank; the order in the file is kept. `places` are those of this rank's share of all nodes.
/// Collective.
pub(super) fn spread(comm: &Comm, cells: &Cells, corners: usize, nodes: usize, places: &[[f64; 3]]) -> Cells {
    let keys = along_curve(comm, &middles(comm, cells, corners, nodes, places));
    let ends = ends_of_parts(comm, &keys);
    let rank_of: Vec<usize> = keys.iter().map(|key| ends.partition_point(|end| end <= key)).collect();
    let mut counts = vec![0; comm.size()];
    rank_of.iter().for_each(|&rank| counts[rank] += 1);
    let mut order: Vec<usize> = (0..keys.len()).collect();
    order.sort_by_key(|&cell| rank_of[cell]);
    let vertices: Vec<Int> =
        order.iter().flat_map(|&cell| &cells.vertices[corners * cell..corners * (cell + 1)]).copied().collect();
    let regions: Vec<i32> = order.iter().map(|&cell| cells.regions[cell]).collect();
    let of_vertices: Vec<usize> = counts.iter().map(|count| corners * count).collect();
    Cells { vertices: comm.exchange(&vertices, &of_vertices).items, regions: comm.exchange(&regions, &counts).items }
}

/// The middle of each of this rank's cells. Collective.
fn middles(comm: &Comm, cells: &Cells, corners: usize, nodes: usize, places: &[[f64; 3]]) -> Vec<[f64; 3]> {
    let mut wanted = cells.vertices.clone();
    wanted.sort_unstable();
    wanted.dedup();
    let (mut counts, mut begin) = (Vec::new(), 0);
    for rank in 0..comm.size() {
        let end = wanted.partition_point(|node| (*node as usize) < share(nodes, comm.size(), rank).end);
        counts.push(end - begin);
        begin = end;
    }
    let asked = comm.exchange(&wanted, &counts);
    let first = share(nodes, comm.size(), comm.rank()).start;
    let told: Vec<f64> = asked.items.iter().flat_map(|node| places[*node as usize - first]).collect();
    let of_told: Vec<usize> = asked.counts.iter().map(|count| 3 * count).collect();
    let found = comm.exchange(&told, &of_told).items;
    let place = |node: &Int| wanted.binary_search(node).map_or([0.0; 3], |i| [0, 1, 2].map(|axis| found[3 * i + axis]));
    let middle = |cell: &[Int]| {
        let sum = cell.iter().map(place).fold([0.0; 3], |sum, x| [0, 1, 2].map(|axis| sum[axis] + x[axis]));
        sum.map(|sum| sum / corners as f64)
    };
    cells.vertices.chunks_exact(corners).map(middle).collect()
}

/// Where points lie on the curve through the cube around all of them. Collective.
fn along_curve(comm: &Comm, points: &[[f64; 3]]) -> Vec<u64> {
    let mut bounds = [f64::NEG_INFINITY; 6];
    for point in points {
        for axis in 0..3 {
            bounds[axis] = bounds[axis].max(point[axis]);
            bounds[3 + axis] = bounds[3 + axis].max(-point[axis]);
        }
    }
    let mut all = [0.0; 6];
    comm.mpi().all_reduce_into(&bounds, &mut all, SystemOperation::max());
    let size = (0..3).map(|axis| all[axis] + all[3 + axis]).fold(f64::MIN_POSITIVE, f64::max);
    let steps = f64::from((1_u32 << BITS) - 1);
    // A cast of what is out of range, or no number, gives the nearest number there is, or 0.
    let step = |point: &[f64; 3]| [0, 1, 2].map(|axis| ((point[axis] + all[3 + axis]) / size * steps) as u32);
    points.iter().map(|point| place_on_curve(step(point))).collect()
}

/// The place on Hilbert's curve of a point whose coordinates have [`BITS`] bits (J. Skilling, Programming the Hilbert curve, AIP Conf. Proc. 707,
/// 381, 2004).
fn place_on_curve(mut x: [u32; 3]) -> u64 {
    for bit in (1..BITS).rev() {
        let (q, below) = (1 << bit, (1 << bit) - 1);
        for axis in 0..3 {
            if x[axis] & q != 0 {
                x[0] ^= below;
            } else {
                let exchanged = (x[0] ^ x[axis]) & below;
                x[0] ^= exchanged;
                x[axis] ^= exchanged;
            }
        }
    }
    x[1] ^= x[0];
    x[2] ^= x[1];
    let flips = (1..BITS).filter(|bit| x[2] & (1 << bit) != 0).fold(0, |flips, bit| flips ^ ((1_u32 << bit) - 1));
    let x = x.map(|x| x ^ flips);
    let bits = (0..BITS).rev().flat_map(|bit| x.map(|x| u64::from((x >> bit) & 1)));
    bits.fold(0, |place, bit| place << 1 | bit)
}

/// The keys at which the parts of all ranks but the last end, so that each has equally many. Collective.
fn ends_of_parts(comm: &Comm, keys: &[u64]) -> Vec<u64> {
    let mut sorted = keys.to_vec();
    sorted.sort_unstable();
    let mut total = 0;
    comm.mpi().all_reduce_into(&keys.len(), &mut total, SystemOperation::sum());
    let due: Vec<usize> = (1..comm.size()).map(|rank| share(total, comm.size(), rank).start).collect();
    let (mut least, mut most) = (vec![0; due.len()], vec![1_u64 << (3 * BITS); due.len()]);
    // The least ends below which there are as many keys as are due, by bisection.
    for _ in 0..=3 * BITS {
        let middles: Vec<u64> = least.iter().zip(&most).map(|(least, most)| least + (most - least) / 2).collect();
        let below: Vec<usize> = middles.iter().map(|end| sorted.partition_point(|key| key < end)).collect();
        let mut all = vec![0; below.len()];
        comm.mpi().all_reduce_into(&below[..], &mut all[..], SystemOperation::sum());
        for i in 0..due.len() {
            if all[i] >= due[i] {
                most[i] = middles[i];
            } else {
                least[i] = middles[i] + 1;
            }
        }
    }
    most
}

#[cfg(test)]
mod tests {
    use super::{BITS, place_on_curve};

    /// The curve goes through every point of a corner of the cube once, from one to the next beside it.
    #[test]
    fn the_curve_goes_from_neighbour_to_neighbour() {
        let mut points: Vec<[u32; 3]> = (0..512).map(|i| [i % 8, i / 8 % 8, i / 64]).collect();
        points.sort_by_key(|point| place_on_curve(*point));
        assert_eq!(place_on_curve(points[511]), 511);
        for pair in points.windows(2) {
            let distance: u32 = (0..3).map(|axis| pair[0][axis].abs_diff(pair[1][axis])).sum();
            assert_eq!(distance, 1, "{pair:?}");
        }
        let far = (1 << BITS) - 1;
        assert!(place_on_curve([far; 3]) < 1 << (3 * BITS));
    }
}
