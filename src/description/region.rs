//! Where on the body's surface a term acts.

use crate::scene::{Geometry, Scene, Vec3, Within, faces};

/// A part of the surface, as convex parts that do not overlap.
pub type Region = Vec<Place>;

/// A named surface, or what a convex extent of space has of it.
#[derive(Debug, Clone, PartialEq)]
pub struct Place {
    /// Name of the surface: of a box, or a physical name of a mesh.
    pub surface: String,
    /// The space within which it counts.
    pub extent: Extent,
}

/// A convex extent of space.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Extent {
    /// All of it.
    All,
    /// A box with its faces along the axes: least and largest coordinates, m.
    Box([Vec3; 2]),
    /// A ball.
    Ball {
        /// Its centre, m.
        centre: Vec3,
        /// Its radius, m.
        radius: f64,
    },
}

/// What a scene means by a surface and `within`.
pub fn region(scene: &Scene, surface: &str, within: Option<Within>) -> Region {
    let all = |extent: Extent| vec![Place { surface: surface.to_owned(), extent }];
    match (within, &scene.body.geometry) {
        (None, _) => all(Extent::All),
        (Some(Within::Box(corners)), _) => all(Extent::Box(corners)),
        (Some(Within::Ball { centre, radius }), _) => all(Extent::Ball { centre, radius }),
        // The check of a scene leaves no rim to a mesh file.
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

/// The strips along the four edges of the faces across an axis: two as long as their edges, and two between these.
fn rim(size: Vec3, across: usize, width: f64) -> Vec<Extent> {
    let everything = [[f64::NEG_INFINITY; 3], [f64::INFINITY; 3]];
    let [first, second] = faces::along(across);
    let inner = [first, second].map(|axis| 0.5 * size[axis] - width);
    // Strips that meet in the middle are the whole face.
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
