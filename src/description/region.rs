//! Regions of the body's surface on which supports and loads act.

use crate::scene::{Geometry, Scene, Vec3, Within, faces};

/// Region of the surface: a union of convex places that do not overlap.
pub type Region = Vec<Place>;

/// Named surface, or the part of it within a convex extent.
#[derive(Debug, Clone, PartialEq)]
pub struct Place {
    /// Name of the surface: a face or group of faces of a box, or a physical name of a mesh.
    pub surface: String,
    /// Extent within which the surface belongs to the place.
    pub extent: Extent,
}

/// Convex extent of space.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Extent {
    /// Whole space.
    All,
    /// Box with faces normal to the axes: smallest and largest coordinates, m.
    Box([Vec3; 2]),
    /// Ball.
    Ball {
        /// Centre, m.
        centre: Vec3,
        /// Radius, m.
        radius: f64,
    },
}

/// Region for a surface of a scene and its optional `within`.
pub fn region(scene: &Scene, surface: &str, within: Option<Within>) -> Region {
    let all = |extent: Extent| vec![Place { surface: surface.to_owned(), extent }];
    match (within, &scene.body.geometry) {
        (None, _) => all(Extent::All),
        (Some(Within::Box(corners)), _) => all(Extent::Box(corners)),
        (Some(Within::Ball { centre, radius }), _) => all(Extent::Ball { centre, radius }),
        // The check of the scene rejects a rim on a mesh file.
        (Some(Within::Rim(_)), Geometry::Gmsh(_)) => Vec::new(),
        (Some(Within::Rim(width)), Geometry::Box { size, .. }) => {
            let of_face = |&(axis, upper): &faces::Face| {
                let name = faces::name((axis, upper)).to_owned();
                rim(*size, axis, width).into_iter().map(move |extent| Place { surface: name.clone(), extent })
            };
            faces::faces(surface).iter().flat_map(of_face).collect()
        }
    }
}

/// Strips of a width (m) along the four edges of a face normal to an axis. Two strips have the full length of their
/// edges; the other two lie between these.
fn rim(size: Vec3, across: usize, width: f64) -> Vec<Extent> {
    let everything = [[f64::NEG_INFINITY; 3], [f64::INFINITY; 3]];
    let [first, second] = faces::along(across);
    let inner = [first, second].map(|axis| 0.5 * size[axis] - width);
    // Opposite strips meet: they cover the whole face.
    if inner.iter().any(|inner| *inner <= 0.0) {
        return vec![Extent::All];
    }
    let strip = |axis: usize, ends: [f64; 2], mut corners: [Vec3; 2]| {
        (corners[0][axis], corners[1][axis]) = (ends[0], ends[1]);
        corners
    };
    let ends = |inner: f64| [[f64::NEG_INFINITY, -inner], [inner, f64::INFINITY]];
    let long = ends(inner[0]).map(|ends| strip(first, ends, everything));
    let between = strip(first, [-inner[0], inner[0]], everything);
    let short = ends(inner[1]).map(|ends| strip(second, ends, between));
    long.into_iter().chain(short).map(Extent::Box).collect()
}
