//! Mirror image of a part of a body between planes of symmetry.

use crate::element::{Element, Shape};
use crate::scene::Vec3;

/// Adds the mirror image of points and cells at the plane where the coordinate `axis` is zero. Points on this plane are
/// shared. Returns the original of each added point.
pub(crate) fn add_image(
    (shape, order): (Shape, usize),
    points: &mut Vec<Vec3>,
    cells: &mut Vec<usize>,
    axis: usize,
) -> Vec<usize> {
    let reach = points.iter().map(|x| x[axis].abs()).fold(0.0, f64::max);
    let mut added = Vec::new();
    let mut image = Vec::with_capacity(points.len());
    for point in 0..points.len() {
        let mut x = points[point];
        if x[axis].abs() <= 1e-9 * reach {
            image.push(point);
            continue;
        }
        image.push(points.len());
        x[axis] = -x[axis];
        points.push(x);
        added.push(point);
    }
    // A mirrored cell would be inverted, so its points are taken in the order of a mirrored reference cell.
    let element = Element::new(shape, order);
    let places = element.reference_nodes();
    let mirrored = |[x, y, z]: Vec3| if shape == Shape::Hexahedron { [-x, y, z] } else { [y, x, z] };
    let turned: Vec<usize> = places
        .iter()
        .map(|x| places.iter().position(|other| *other == mirrored(*x)).expect("a symmetric reference cell"))
        .collect();
    let images: Vec<usize> =
        cells.chunks_exact(places.len()).flat_map(|cell| turned.iter().map(|&i| image[cell[i]])).collect();
    cells.extend(images);
    added
}
