//! Surface of a box centred on the origin: names, points and faces.

use super::Vec3;

/// Names of the surfaces of a box; "side" is all four faces with a horizontal normal.
pub(super) const SURFACES: [&str; 9] = ["side", "top", "bottom", "x-min", "x-max", "y-min", "y-max", "z-min", "z-max"];

/// A face of a box: the axis normal to it, and whether it is on the positive side.
pub(crate) type Face = (usize, bool);

/// The two axes along the faces that are normal to an axis, ascending.
pub(crate) fn along(across: usize) -> [usize; 2] {
    [[1, 2], [0, 2], [0, 1]][across]
}

/// Name of a face, for example `z-max`.
pub(crate) fn name((axis, is_upper): Face) -> &'static str {
    [["x-min", "x-max"], ["y-min", "y-max"], ["z-min", "z-max"]][axis][usize::from(is_upper)]
}

/// Faces that belong to the named surface of a box; empty for an unknown name.
pub(crate) fn faces(name: &str) -> &'static [Face] {
    match name {
        "side" => &[(0, false), (0, true), (1, false), (1, true)],
        "x-min" => &[(0, false)],
        "x-max" => &[(0, true)],
        "y-min" => &[(1, false)],
        "y-max" => &[(1, true)],
        "z-min" | "bottom" => &[(2, false)],
        "z-max" | "top" => &[(2, true)],
        _ => &[],
    }
}

/// Distance of `point` from the surface of the box, from inside or outside, m.
pub(super) fn distance(size: Vec3, point: Vec3) -> f64 {
    let beyond = beyond(size, point);
    let depth = beyond.into_iter().fold(f64::NEG_INFINITY, f64::max);
    if depth <= 0.0 {
        -depth
    } else {
        let [x, y, z] = beyond.map(|b| b.max(0.0));
        x.hypot(y).hypot(z)
    }
}

/// Distance from the surface up to which a point counts as on it, m: 1e-9 of the longest edge, for the rounding of
/// typed numbers.
pub(super) fn tolerance(size: Vec3) -> f64 {
    1e-9 * size.into_iter().fold(0.0, f64::max)
}

/// Moves coordinates within 1e-9 of the edge length from the middle or an end of their edge exactly there.
pub(super) fn snap(size: Vec3, point: Vec3) -> Vec3 {
    std::array::from_fn(|i| {
        let (half, near) = (size[i] / 2.0, 1e-9 * size[i]);
        match point[i] {
            x if x.abs() <= near => 0.0,
            x if (x.abs() - half).abs() <= near => half.copysign(x),
            x => x,
        }
    })
}

/// Sine of the least angle between a direction and the face that is hit: 1°.
const LEAST_ANGLE: f64 = 0.01745;

/// Whether a unit `direction` at a `point` on the surface leads into the box, through any of the faces there: by 1° or more, since
/// what slides along a face is no impact.
pub(super) fn leads_inside(size: Vec3, point: Vec3, direction: Vec3) -> bool {
    inward(size, point, direction).into_iter().any(|inward| inward > LEAST_ANGLE)
}

/// Axis normal to the face through which a unit `direction` leads into the box at a `point` on its surface. At an edge
/// or a corner: the face whose normal is closest to the direction.
pub(super) fn struck_axis(size: Vec3, point: Vec3, direction: Vec3) -> usize {
    let inward = inward(size, point, direction);
    (0..3).fold(0, |best, i| if inward[i] >= inward[best] { i } else { best })
}

/// Component of the direction along the inward normal of the face across each axis; −∞ if the point is not on that
/// face.
fn inward(size: Vec3, point: Vec3, direction: Vec3) -> Vec3 {
    let beyond = beyond(size, point);
    std::array::from_fn(|i| match beyond[i].abs() <= tolerance(size) {
        true => -direction[i] * point[i].signum(),
        false => f64::NEG_INFINITY,
    })
}

/// Axis normal to the face that is hit by a body moving along `direction` from outside: the axis of the largest component.
pub(super) fn across(direction: Vec3) -> usize {
    (0..3).fold(0, |best, i| if direction[i].abs() >= direction[best].abs() { i } else { best })
}

/// Centre of the face that is hit by a body moving along `direction` from outside.
pub(super) fn struck_centre(size: Vec3, direction: Vec3) -> Vec3 {
    let axis = across(direction);
    let mut centre = [0.0; 3];
    centre[axis] = -direction[axis].signum() * size[axis] / 2.0;
    centre
}

/// Distance of the point beyond the faces across each axis, m; negative between the faces.
fn beyond(size: Vec3, point: Vec3) -> Vec3 {
    std::array::from_fn(|i| point[i].abs() - size[i] / 2.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    const SIZE: Vec3 = [2.0, 4.0, 6.0];

    #[test]
    fn distance_is_to_the_nearest_point_of_the_surface() {
        for (point, expected) in [
            ([0.0, 0.0, 0.0], 1.0),
            ([0.9, 0.0, 0.0], 0.1),
            ([0.0, 1.8, 2.9], 0.1),
            ([0.0, 0.0, -3.0], 0.0),
            ([4.0, 6.0, 0.0], 5.0),
            ([-2.0, 4.0, 5.0], 3.0),
        ] {
            // Tolerance: rounding of the decimals.
            assert!((distance(SIZE, point) - expected).abs() < 1e-15, "{point:?}");
        }
    }

    #[test]
    fn at_an_edge_any_face_lets_the_impactor_in() {
        let edge = [1.0, 0.0, 3.0];
        assert!(leads_inside(SIZE, edge, [-1.0, 0.0, 0.0]));
        assert!(leads_inside(SIZE, edge, [0.0, 0.0, -1.0]));
        assert!(leads_inside(SIZE, edge, [0.8, 0.0, -0.6]));
        assert!(!leads_inside(SIZE, edge, [0.0, 1.0, 0.0]));
        assert!(!leads_inside(SIZE, edge, [0.6, 0.0, 0.8]));
        assert!(!leads_inside(SIZE, [0.0, 0.0, 3.0], [-1.0, 0.0, 0.0]));
    }

    #[test]
    fn the_struck_axis_is_that_of_a_face_at_the_point() {
        assert_eq!(struck_axis(SIZE, [0.0, 0.5, 3.0], [0.8, 0.0, -0.6]), 2);
        assert_eq!(struck_axis(SIZE, [1.0, 0.0, 3.0], [-0.8, 0.0, -0.6]), 0);
        assert_eq!(struck_axis(SIZE, [0.0, -2.0, 0.0], [0.0, 1.0, 0.0]), 1);
    }

    #[test]
    fn a_point_snaps_to_the_middle_and_to_the_faces() {
        assert_eq!(snap(SIZE, [1e-9, -1.999_999_999, 3.0]), [0.0, -2.0, 3.0]);
        let free = [1e-8, -1.999_999_98, 1.5];
        assert_eq!(snap(SIZE, free), free);
    }

    #[test]
    fn every_surface_has_its_faces() {
        assert!(SURFACES.iter().all(|name| !faces(name).is_empty()));
    }

    #[test]
    fn the_struck_face_is_across_the_largest_component() {
        assert_eq!(struck_centre(SIZE, [0.0, 0.0, -1.0]), [0.0, 0.0, 3.0]);
        assert_eq!(struck_centre(SIZE, [0.8, 0.0, -0.6]), [-1.0, 0.0, 0.0]);
        for direction in [[0.0, 1.0, 0.0], [0.48, -0.6, 0.64]] {
            let centre = struck_centre(SIZE, direction);
            assert_eq!(distance(SIZE, centre), 0.0);
            assert!(leads_inside(SIZE, centre, direction));
        }
    }
}
