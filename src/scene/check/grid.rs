//! Grid planes of a box: its cells, graded towards the impact point.

use super::super::values::{ByComponent, Three, Whole};
use super::super::{Composition, Contact, Impactor, Parts, SceneError, Source, Vec3, faces, layout, raw};
use super::layers;

/// Largest number of hexahedra in a box. Quadratic ones have 24 unknowns each, so that all unknowns fit in 32-bit
/// indices with room to spare.
const MOST_CELLS: usize = 10_000_000;

/// Largest number of cells along an edge.
const MOST_ALONG_EDGE: usize = 10_000;

/// Largest allowed ratio of the largest to the smallest cell along an edge.
const LARGEST_RATIO: f64 = 1e4;

/// Data that determine the cells of a box, in addition to the keys that give them.
#[derive(Clone, Copy)]
pub(super) struct Hit<'a> {
    /// Edge lengths, m.
    pub size: Vec3,
    /// Materials of the box.
    pub composition: &'a Composition,
    /// Impact point, direction and contact stiffness.
    pub impactor: &'a Impactor,
    /// The contact, whose patch the cells must resolve.
    pub contact: Contact,
    /// Polynomial degree of the elements.
    pub order: usize,
}

impl Hit<'_> {
    /// Thickness of the impacted layer, or of the box without layers that differ, m.
    pub fn thickness(&self) -> f64 {
        match &self.composition.parts {
            Parts::Layers(layers) if !self.composition.interfaces().is_empty() => {
                layers[self.composition.struck_layer].thickness
            }
            _ => self.size[2],
        }
    }
}

/// Coordinates of the grid planes across each axis, m.
///
/// # Errors
/// If a number is out of range, or if cells are so thin that their coordinates do not differ.
pub(super) fn check(source: &Source, raw: &raw::Body, hit: Hit) -> Result<[Vec<f64>; 3], SceneError> {
    let Hit { size, impactor: Impactor { point, .. }, .. } = hit;
    let given = raw.cells.map(|cells| whole_cells(source, cells)).transpose()?;
    let ratios = raw.grading.map(|grading| ratios(source, grading)).transpose()?;
    let planes: [Vec<f64>; 3] = match (given, ratios) {
        (None, None) => default::planes(hit),
        (cells, ratios) => {
            let cells = cells.unwrap_or_else(|| default::planes(hit).map(|planes| planes.len() - 1));
            let ratios = ratios.unwrap_or([1.0; 3]);
            let mut planes = std::array::from_fn(|i| layout::geometric(size[i], point[i], cells[i], ratios[i]));
            if !hit.composition.interfaces().is_empty() {
                planes[2] = layers::given(source, raw, (cells[2], ratios[2]), hit)?;
            }
            planes
        }
    };
    if planes.iter().any(|planes| planes.len() < 2 || planes.windows(2).any(|pair| pair[0] >= pair[1])) {
        let message = "the cells are too thin for their coordinates to differ";
        return Err(source.error("body.size", message, "edges of like orders of magnitude, in m"));
    }
    Ok(planes)
}

fn whole_cells(source: &Source, Three(given): Three<Whole>) -> Result<[usize; 3], SceneError> {
    let mut cells = [0; 3];
    for (cells, Whole(given)) in cells.iter_mut().zip(given) {
        *cells = source.whole("body.cells", given, 1..=MOST_ALONG_EDGE)?;
    }
    let total: usize = cells.iter().product();
    if total > MOST_CELLS {
        return Err(source.error(
            "body.cells",
            format!("{total} cells are too many"),
            format!("at most {MOST_CELLS} cells in all, so that unknowns can be numbered"),
        ));
    }
    Ok(cells)
}

fn ratios(source: &Source, ByComponent(ratios): ByComponent) -> Result<Vec3, SceneError> {
    let path = "body.grading";
    let help = format!("the largest cell edge over the smallest, from 1 to {LARGEST_RATIO}; 1 is uniform");
    source.finite(path, &ratios)?;
    for ratio in ratios {
        source.in_range(path, ratio, 1.0..=LARGEST_RATIO, help.as_str())?;
    }
    Ok(ratios)
}

/// Default cells.
mod default {
    use super::{Contact, Hit, Vec3, faces, layers, layout};

    /// Number of cells along a long edge for a point force, which no mesh resolves.
    const UNIFORM: f64 = 20.0;

    // Constants of a mesh that resolves the patch.

    /// Default radius of the patch over the thickness.
    const PATCH: f64 = 0.25;
    /// Smallest default radius of the patch over the shortest edge, for points near an edge.
    const LEAST_PATCH: f64 = 1.0 / 64.0;
    /// Smallest cell over the radius of the patch.
    const SMALLEST: f64 = 0.5;
    /// Growth factor from cell to cell: along the impacted face, and into the body.
    const CELL_GROWTH: [f64; 2] = [1.4, 1.5];
    /// Largest cell over the shortest edge, for elements of order 1 and 2. The cells must resolve the flexural waves.
    const LARGEST: [f64; 2] = [0.75, 1.5];
    /// Largest allowed ratio of the smallest cell to the thickness: it gives at least two layers of cells.
    const LAYER: f64 = 0.4;
    /// Largest number of cells in the whole body.
    const MAX_CELLS: usize = 30_000;

    /// Coordinates of the default grid planes across each axis, m.
    pub(super) fn planes(hit: Hit) -> [Vec<f64>; 3] {
        let Hit { size, composition, impactor, contact, order } = hit;
        let interfaces = composition.interfaces();
        if contact == Contact::Point {
            let mut planes = uniform(size);
            if !interfaces.is_empty() {
                planes[2] = layers::uniform(&interfaces, hit.thickness());
            }
            return planes;
        }
        let given = if let Contact::Patch { radius, .. } = contact { radius } else { None };
        let radius = contact.area().map(|area| area.half_width).or(given);
        let axis = faces::struck_axis(size, impactor.point, impactor.direction);
        let longest = size.into_iter().fold(size[0], f64::max);
        let thinnest = size.into_iter().fold(hit.thickness(), f64::min);
        // The impacted layer lies like a separate body on softer layers.
        let depth = if axis == 2 { hit.thickness() } else { size[axis] };
        // The disc has to fit on the face.
        let reach = (0..3).filter(|i| *i != axis).map(|i| 0.5 * size[i] - impactor.point[i].abs());
        let fitting = || reach.fold(PATCH * depth, f64::min).max(LEAST_PATCH * thinnest);
        // Not so small that coordinates would be equal after rounding.
        let smallest = (SMALLEST * radius.unwrap_or_else(fitting)).max(1e-12 * longest).max(f64::MIN_POSITIVE);
        let mut smallest = size.map(|edge| smallest.min(0.5 * edge));
        smallest[axis] = smallest[axis].min(LAYER * depth);
        let mut growth = [CELL_GROWTH[0]; 3];
        growth[axis] = CELL_GROWTH[1];
        // A smaller value would give more than `MAX_CELLS` cells along the longest edge.
        let mut largest = (LARGEST[order - 1] * thinnest).max(longest / MAX_CELLS as f64).max(f64::MIN_POSITIVE);
        loop {
            let planes: [Vec<f64>; 3] = std::array::from_fn(|i| match i {
                2 if !interfaces.is_empty() && axis == 2 => {
                    layers::growing(&interfaces, impactor.point[2], (smallest[2], growth[2], largest), depth)
                }
                2 if !interfaces.is_empty() => layers::uniform(&interfaces, depth.min(largest)),
                _ => layout::growing(size[i], impactor.point[i], smallest[i], growth[i], largest),
            });
            if planes.iter().map(|planes| planes.len() - 1).product::<usize>() <= MAX_CELLS {
                return planes;
            }
            // Distant cells are coarsened first.
            if largest < longest {
                largest *= 1.1;
            } else {
                growth = growth.map(|growth| growth.powf(1.1));
            }
        }
    }

    /// Two cells through the thinnest edge. Along the others 20, or fewer if these would be shorter than half the
    /// thickness. All numbers are even, so that the planes of symmetry of a centred impact lie between cells.
    fn uniform(size: Vec3) -> [Vec<f64>; 3] {
        let thickness = size.into_iter().fold(f64::INFINITY, f64::min);
        // 0.6 / 0.1 is rounded to slightly less than 6; the factor corrects this. The cast is of a number from 1 to 10.
        let pairs = |edge: f64| (edge / thickness * (1.0 + 1e-9)).min(UNIFORM / 2.0).floor() as usize;
        size.map(|edge| layout::uniform(edge, 2 * pairs(edge)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::contact::{ForceLaw, Hertz, LayerEffect};

    fn hit(size: Vec3, point: Vec3, contact: Contact, order: usize) -> [Vec<f64>; 3] {
        let direction = [0.0, 0.0, -1.0];
        let glass = crate::form::Material { young: 70e9, poisson: 0.23, density: 2500.0 };
        let composition = Composition::whole(glass);
        let impactor = Impactor {
            mass: 52.0,
            radius: Some(0.05),
            stiffness: 1.7e10,
            force_law: ForceLaw::Hertz(Hertz { stiffness: 1.7e10 }),
            layer_effect: LayerEffect::Negligible,
            damping: 0.0,
            speed: 1.0,
            point,
            direction,
            gap: 0.0,
            gravity: 0.0,
            closing: 0.0,
            timing_mass: 52.0,
        };
        default::planes(Hit { size, composition: &composition, impactor: &impactor, contact, order })
    }

    fn top(size: Vec3) -> Vec3 {
        [0.0, 0.0, 0.5 * size[2]]
    }

    #[test]
    fn under_a_point_the_cells_are_moderate_and_no_flatter_than_they_need_be() {
        for (size, cells) in [
            ([1.5, 1.5, 0.1], [20, 20, 2]),
            ([1.0, 1.0, 1.0], [2, 2, 2]),
            ([0.3, 0.1, 1e9], [6, 2, 20]),
            ([0.36, 0.1, 0.19], [6, 2, 2]),
            ([1e-300, 1e300, 1.0], [2, 20, 20]),
        ] {
            let planes = hit(size, top(size), Contact::Point, 2);
            assert_eq!(planes.each_ref().map(|planes| planes.len() - 1), cells);
            assert_eq!(planes, [0, 1, 2].map(|i| layout::uniform(size[i], cells[i])));
        }
    }

    /// For various sizes: cells at the impact point are at most half the patch radius, grow within bounds, and resolve
    /// the flexural waves.
    #[test]
    fn under_a_patch_the_cells_resolve_it() {
        let chosen = Contact::Patch { radius: None, disc: None };
        for (size, point, contact, order) in [
            ([1.5, 1.5, 0.1], [0.0, 0.0, 0.05], chosen, 2),
            ([1.5, 1.5, 0.1], [0.31, -0.62, 0.05], chosen, 2),
            ([1.5, 1.5, 0.04], [0.0, 0.0, 0.02], chosen, 1),
            ([0.5, 0.5, 0.02], [0.0, 0.0, 0.01], Contact::Patch { radius: Some(0.02), disc: None }, 2),
            ([0.15, 0.01, 0.01], [0.01, 0.0, 0.005], chosen, 2),
            ([1.0, 1.0, 1.0], [0.0, 0.0, 0.5], chosen, 2),
        ] {
            let planes = hit(size, point, contact, order);
            let patch = match contact {
                Contact::Patch { radius: Some(radius), .. } => radius,
                _ => 0.25 * size[2],
            };
            let thinnest = size.into_iter().fold(f64::INFINITY, f64::min);
            for (i, planes) in planes.iter().enumerate() {
                let edges: Vec<f64> = planes.windows(2).map(|pair| pair[1] - pair[0]).collect();
                let at = planes
                    .iter()
                    .position(|x| *x == point[i])
                    .unwrap_or_else(|| panic!("{size:?}: no plane at the point"));
                let beside = edges[at.saturating_sub(1)..(at + 1).min(edges.len())].iter();
                // 1e-8: rounding of lengths.
                assert!(beside.fold(0.0, |m, e| f64::max(m, *e)) <= 0.5 * patch * (1.0 + 1e-8), "{size:?}, axis {i}");
                assert!(
                    edges.iter().all(|e| *e <= [0.75, 1.5][order - 1] * thinnest * (1.0 + 1e-8)),
                    "{size:?}, axis {i}"
                );
                for pair in edges.windows(2) {
                    assert!((pair[0] / pair[1]).ln().abs() <= 1.5f64.ln() + 1e-6, "{size:?}, axis {i}: {edges:?}");
                }
            }
            assert!((2..=8).contains(&(planes[2].len() - 1)), "{size:?}: {} layers", planes[2].len() - 1);
        }
    }

    #[test]
    fn no_size_asks_for_more_cells_than_anyone_waits_for() {
        for size in [
            [1e3, 1e3, 1e-3],
            [0.3, 0.1, 1e9],
            [1e-300, 1e300, 1.0],
            [5e-324, 1.0, f64::MAX],
            [5e-324; 3],
            [1.0, 1.0, 1e-9],
        ] {
            for radius in [None, Some(1e-300), Some(1e-6), Some(1e300)] {
                let planes = hit(size, top(size), Contact::Patch { radius, disc: None }, 2);
                let cells = planes.each_ref().map(|planes| planes.len() - 1);
                assert!(cells.iter().product::<usize>() <= 30_000, "{size:?}, {radius:?}: {cells:?}");
            }
        }
    }
}
