//! The elastic body: material, geometry, elements.

use std::path::Path;

use super::super::values::{Number, Three, Whole};
use super::super::{Body, Geometry, SceneError, Source, Vec3, raw};
use super::word;

/// The most hexahedra in a box: quadratic ones have 24 unknowns each, which leaves room in 32-bit indices.
const MOST_CELLS: usize = 10_000_000;

/// Cells along a long edge where none are given.
const CELLS_ALONG_EDGE: f64 = 20.0;

pub(super) fn check(source: &Source, raw: &raw::Body, folder: &Path) -> Result<Body, SceneError> {
    word(source, "body.model", &raw.model, &["solid"])?;
    word(source, "body.reduction", &raw.reduction, &["none"])?;
    word(source, "body.symmetry", &raw.symmetry, &["none"])?;
    let young = source.positive("body.young", raw.young.0, "Young's modulus in Pa, as 70e9 for glass")?;
    let density = source.positive("body.density", raw.density.0, "the density in kg/m3, as 2500 for glass")?;
    let Whole(order) = raw.order.unwrap_or(Whole(2));
    Ok(Body {
        young,
        poisson: poisson(source, raw.poisson.0)?,
        density,
        geometry: geometry(source, raw, folder)?,
        order: source.whole("body.order", order, 1..=2)?,
    })
}

fn poisson(source: &Source, value: f64) -> Result<f64, SceneError> {
    let path = "body.poisson";
    source.finite(path, &[value])?;
    if value > -1.0 && value < 0.5 {
        return Ok(value);
    }
    let help = "between -1 and 0.5, both excluded: at 0.5 the material is incompressible and λ of (5) infinite";
    Err(source.error(path, format!("{value} is out of range"), help))
}

fn geometry(source: &Source, raw: &raw::Body, folder: &Path) -> Result<Geometry, SceneError> {
    match (&raw.size, &raw.mesh) {
        (Some(_), Some(_)) => Err(source.error(
            "body.mesh",
            "a body has either a size or a mesh, and this one has both",
            "take out `mesh`, or take out `size` and `cells`",
        )),
        (None, None) => Err(source.error(
            "body.size",
            "the body has no geometry",
            "`size = [x, y, z]` in m for a box, or `mesh = \"file.msh\"` for a Gmsh file",
        )),
        (Some(size), None) => box_of(source, *size, raw.cells),
        (None, Some(_)) if raw.cells.is_some() => Err(source.error(
            "body.cells",
            "a mesh file has its own cells",
            "take out `cells`: it cuts a box, and goes with `size`",
        )),
        (None, Some(mesh)) if mesh.is_empty() => Err(source.error(
            "body.mesh",
            "the file's name is empty",
            "a Gmsh file (2.2 or 4.1), relative to the scene file",
        )),
        (None, Some(mesh)) => Ok(Geometry::Gmsh(folder.join(mesh))),
    }
}

fn box_of(source: &Source, size: Three<Number>, cells: Option<Three<Whole>>) -> Result<Geometry, SceneError> {
    let size = size.numbers();
    for edge in size {
        source.positive("body.size", edge, "three edge lengths [x, y, z] in m")?;
    }
    let Some(Three(given)) = cells else {
        return Ok(Geometry::Box { size, cells: default_cells(size) });
    };
    let mut cells = [0; 3];
    for (cells, Whole(given)) in cells.iter_mut().zip(given) {
        *cells = source.whole("body.cells", given, 1..=10_000)?;
    }
    let total: usize = cells.iter().product();
    if total > MOST_CELLS {
        return Err(source.error(
            "body.cells",
            format!("{total} cells are too many"),
            format!("at most {MOST_CELLS} cells in all, so that unknowns can be numbered"),
        ));
    }
    Ok(Geometry::Box { size, cells })
}

/// Two cells through the thinnest edge; along the others 20, or fewer where these would be shorter than half the
/// thickness.
fn default_cells(size: Vec3) -> [usize; 3] {
    let thickness = size.into_iter().fold(f64::INFINITY, f64::min);
    // 0.6 / 0.1 is a little less than 6: the rounding is undone. The cast is of a number from 2 to 20.
    let fitting = |edge: f64| (2.0 * edge / thickness * (1.0 + 1e-9)).min(CELLS_ALONG_EDGE);
    size.map(|edge| fitting(edge).floor() as usize)
}

#[cfg(test)]
mod tests {
    use super::default_cells;

    #[test]
    fn cells_left_out_are_moderate_and_no_flatter_than_they_need_be() {
        assert_eq!(default_cells([1.5, 1.5, 0.1]), [20, 20, 2]);
        assert_eq!(default_cells([1.0, 1.0, 1.0]), [2, 2, 2]);
        assert_eq!(default_cells([0.3, 0.1, 1e9]), [6, 2, 20]);
        assert_eq!(default_cells([1e-300, 1e300, 1.0]), [2, 20, 20]);
    }
}
