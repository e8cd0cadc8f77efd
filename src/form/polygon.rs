//! Intersections of convex polygons with rays from the centre of a disc.

use std::f64::consts::PI;

/// Line through an edge of a facet, in coordinates relative to the disc's centre. Inside the facet, normal·x ≥ offset.
/// The two facets that share an edge have the same numbers with opposite signs.
pub(crate) struct Line {
    pub normal: [f64; 2],
    pub offset: f64,
}

impl Line {
    /// Line through two points; `None` if they coincide.
    pub fn through(from: [f64; 2], to: [f64; 2]) -> Option<Self> {
        let [x, y] = [to[0] - from[0], to[1] - from[1]];
        let length = x.hypot(y);
        let offset = (from[0] * to[1] - from[1] * to[0]) / -length;
        (length > 0.).then_some(Self { normal: [-y / length, x / length], offset })
    }
}

/// Returns the edges of a polygon, each from a vertex to the next.
pub(crate) fn edges(x: &[[f64; 2]]) -> impl Iterator<Item = ([f64; 2], [f64; 2])> {
    x.iter().copied().zip(x.iter().copied().cycle().skip(1))
}

/// Whether the polygon is convex, counter-clockwise and not degenerate to a line, up to rounding.
pub(crate) fn is_convex_counter_clockwise(x: &[[f64; 2]]) -> bool {
    let along: Vec<[f64; 2]> = edges(x).map(|(from, to)| [to[0] - from[0], to[1] - from[1]]).collect();
    let longest = along.iter().map(|edge| edge[0].hypot(edge[1])).fold(0., f64::max);
    let rounding = 1e-12 * longest * longest;
    let turns = || edges(&along).map(|(one, next)| one[0] * next[1] - one[1] * next[0]);
    turns().all(|turn| turn > -rounding) && turns().sum::<f64>() > rounding
}

/// Interval of distances, in radii of the disc, where a ray from the centre is inside both the facet and the disc. It
/// is empty unless the first number is the smaller one.
pub(crate) fn crossing(lines: &[Line], ray: [f64; 2]) -> (f64, f64) {
    lines.iter().fold((0., 1.), |(enters, leaves): (f64, f64), line| {
        let slope = line.normal[0] * ray[0] + line.normal[1] * ray[1];
        if slope > 0. {
            (enters.max(line.offset / slope), leaves)
        } else if slope < 0. {
            (enters, leaves.min(line.offset / slope))
        } else {
            (enters, if line.offset > 0. { 0. } else { leaves })
        }
    })
}

/// Angles from −π to π between which the crossings are smooth functions of the angle. These are the angles of the
/// vertices and of the points where edges meet the rim. If an edge is close to the centre, rays cross it only within a
/// small range of angles, which a quadrature rule might miss. Therefore the intersections with smaller circles are
/// included too, down to a circle that contains 1e-14 of the load.
pub(crate) fn angles(x: &[[f64; 2]], lines: &[Line]) -> Vec<f64> {
    let radii = (0..9).map(|step| 0.125_f64.powi(step));
    let on_circles = radii.flat_map(|radius| {
        lines.iter().filter(move |line| line.offset.abs() < radius).flat_map(move |Line { normal, offset }| {
            let half = (radius * radius - offset * offset).sqrt();
            [-half, half].map(|t| (offset * normal[1] - t * normal[0]).atan2(offset * normal[0] + t * normal[1]))
        })
    });
    let mut angles: Vec<f64> = x.iter().map(|v| v[1].atan2(v[0])).chain([-PI, PI]).chain(on_circles).collect();
    angles.sort_by(f64::total_cmp);
    angles.dedup();
    angles
}
