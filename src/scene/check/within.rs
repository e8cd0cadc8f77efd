//! Checks a part of a surface.

use super::super::faces::{Face, faces};
use super::super::{SceneError, Source, Vec3, Within, raw};
use super::body::Outline;

/// Part of a surface given by the key `path`. On a box it is checked not to be empty.
pub(super) fn check(
    source: &Source,
    path: &str,
    raw: &Option<raw::Within>,
    surface: &str,
    outline: &Outline,
) -> Result<Option<Within>, SceneError> {
    let Some(raw) = raw else { return Ok(None) };
    let within = match (&raw.rim, &raw.corners, &raw.disc) {
        (Some(width), None, None) => rim(source, &format!("{path}.rim"), width.0, outline)?,
        (None, Some(corners), None) => {
            let corners: Vec<Vec3> = corners.0.iter().map(|corner| corner.numbers()).collect();
            in_box(source, &format!("{path}.box"), &corners)?
        }
        (None, None, Some(disc)) => {
            let (centre, radius) = (disc.centre.numbers(), disc.radius.0);
            source.finite(&format!("{path}.disc.centre"), &centre)?;
            let radius = source.positive(&format!("{path}.disc.radius"), radius, "the radius of the disc in m")?;
            Within::Ball { centre, radius }
        }
        _ => {
            let help = "one of `rim`, `box` and `disc`";
            return Err(source.error(path, "a part of a surface is given in one way", help));
        }
    };
    if let Outline::Box(size) = outline
        && !faces(surface).iter().any(|face| meets(&within, *size, *face))
    {
        let message = format!("nothing of the surface \"{surface}\" lies within");
        let help =
            format!("the box reaches from {:?} to {:?} m", size.map(|edge| -edge / 2.0), size.map(|edge| edge / 2.0));
        return Err(source.error(path, message, help));
    }
    Ok(Some(within))
}

fn rim(source: &Source, path: &str, width: f64, outline: &Outline) -> Result<Within, SceneError> {
    match outline {
        Outline::Box(_) => Ok(Within::Rim(source.positive(path, width, "the width of the strips in m")?)),
        Outline::Gmsh(_) => {
            let help = "`box` or `disc`, or a physical surface that is the strip";
            Err(source.error(path, "a rim is along the edges of a box's faces, and the body is a mesh file", help))
        }
    }
}

fn in_box(source: &Source, path: &str, corners: &[Vec3]) -> Result<Within, SceneError> {
    let help = "two corners, [[x, y, z], [x, y, z]], the first one with the smaller coordinates";
    let [low, high] = *corners else {
        return Err(source.error(path, format!("{} corners", corners.len()), help));
    };
    source.finite(path, &[low, high].concat())?;
    match (0..3).find(|i| low[*i] >= high[*i]) {
        None => Ok(Within::Box([low, high])),
        Some(axis) => {
            let message = format!("the first corner's {} is not smaller than the second's", ["x", "y", "z"][axis]);
            Err(source.error(path, message, help))
        }
    }
}

/// Whether a part of a surface covers some area of a face of a box.
fn meets(within: &Within, size: Vec3, (axis, is_upper): Face) -> bool {
    let height = if is_upper { 0.5 * size[axis] } else { -0.5 * size[axis] };
    let near = 1e-9 * size[axis];
    let along = (0..3).filter(|other| *other != axis);
    match within {
        Within::Rim(_) => true,
        Within::Box([low, high]) => {
            let is_in_plane = along.clone().all(|i| low[i].max(-0.5 * size[i]) < high[i].min(0.5 * size[i]));
            is_in_plane && (low[axis] - near..=high[axis] + near).contains(&height)
        }
        Within::Ball { centre, radius } => {
            let beyond = |i: usize| (centre[i].abs() - 0.5 * size[i]).max(0.0);
            let square: f64 = along.map(|i| beyond(i).powi(2)).sum();
            square + (centre[axis] - height).powi(2) < radius * radius * (1.0 - 1e-9)
        }
    }
}
