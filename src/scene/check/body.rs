//! Checks the elastic body: theory, elements, and origin of the geometry.

use std::path::{Path, PathBuf};

use super::super::values::{Edges, Whole, WordOrWhole};
use super::super::{Model, Reduction, SceneError, Source, Vec3, raw};
use super::numbers::show;
use super::{composition, word};

/// Shape of a body before it is cut into cells.
pub(super) enum Outline {
    /// Edge lengths of a box centred on the origin, m.
    Box(Vec3),
    /// Path of a mesh file.
    Gmsh(PathBuf),
}

/// Polynomial degree of the elements.
pub(super) fn order(source: &Source, raw: &raw::Body) -> Result<usize, SceneError> {
    let Whole(order) = raw.order.unwrap_or(Whole(2));
    source.whole("body.order", order, 1..=2)
}

/// Largest number of basis vectors that a scene can ask for.
const MOST_VECTORS: usize = 2000;

/// Theory and reduction of the body.
pub(super) fn theory(source: &Source, raw: &raw::Body) -> Result<(Model, Reduction), SceneError> {
    let model = match word(source, "body.model", &raw.model, &raw::MODELS)? {
        "half-space" => Model::HalfSpace,
        "infinite-plate" => Model::InfinitePlate,
        "kirchhoff" => Model::Kirchhoff,
        "mindlin" => Model::Mindlin,
        "layerwise" => Model::Layerwise,
        "solid" => Model::Solid,
        _ => Model::Auto,
    };
    let path = "body.reduction";
    let reduction = match &raw.reduction {
        None => Reduction::Auto,
        Some(WordOrWhole::Whole(vectors)) => Reduction::Vectors(source.whole(path, *vectors, 1..=MOST_VECTORS)?),
        Some(WordOrWhole::Word(given)) => match word(source, path, &Some(given.clone()), &["auto", "none"])? {
            "none" => Reduction::None,
            _ => Reduction::Auto,
        },
    };
    if raw.mesh.is_some() && !matches!(model, Model::Auto | Model::Solid) {
        let name = raw.model.as_deref().unwrap_or_default();
        let message = format!("the theory \"{name}\" is for a box, and the body is a mesh file");
        return Err(source.conflict(
            "body.model",
            "body.mesh",
            message,
            "\"solid\", or `size` in place of `mesh`".into(),
        ));
    }
    Ok((model, reduction))
}

/// Edge lengths of a box, m. With layers, the third one is the sum of their thicknesses.
///
/// # Errors
/// If the number of edges does not fit the layers.
fn edges(source: &Source, raw: &raw::Body, size: Edges) -> Result<Vec3, SceneError> {
    match (size, composition::thickness(source, raw)?) {
        (Edges::All(size), None) => Ok(size),
        (Edges::AlongLayers([x, y]), Some(thickness)) => Ok([x, y, thickness]),
        (Edges::All(_), Some(thickness)) => {
            let help =
                format!("two edge lengths [x, y] in m; the thickness is the sum of the layers', {}", show(thickness));
            let message = "with layers, the thickness is theirs".to_owned();
            Err(source.conflict("body.size", "body.layer", message, help))
        }
        (Edges::AlongLayers(_), None) => {
            let help = "three edge lengths [x, y, z] in m, or [[body.layer]] with `thickness` and `material`";
            Err(source.error("body.size", "two edges are those of a box with layers, and there is none", help))
        }
    }
}

pub(super) fn outline(source: &Source, raw: &raw::Body, folder: &Path) -> Result<Outline, SceneError> {
    match (&raw.size, &raw.mesh) {
        (Some(_), Some(_)) => Err(source.conflict(
            "body.mesh",
            "body.size",
            "a body has either a size or a mesh, and this one has both".into(),
            "take out `mesh`, or take out `size` and `cells`".into(),
        )),
        (None, None) => Err(source.error(
            "body.size",
            "the body has no geometry",
            "`size = [x, y, z]` in m for a box, or `mesh = \"file.msh\"` for a Gmsh file",
        )),
        (Some(size), None) => {
            let size = edges(source, raw, *size)?;
            for edge in size {
                source.positive("body.size", edge, "edge lengths in m: three, or two with [[body.layer]]")?;
            }
            Ok(Outline::Box(size))
        }
        (None, Some(mesh)) => {
            for (key, given) in [("cells", raw.cells.is_some()), ("grading", raw.grading.is_some())] {
                if given {
                    let help = format!("take out `{key}`: it is for a box, and goes with `size`");
                    let path = format!("body.{key}");
                    return Err(source.conflict(&path, "body.mesh", "a mesh file has its own cells".into(), help));
                }
            }
            if mesh.is_empty() {
                let help = "a Gmsh file (2.2 or 4.1), relative to the scene file";
                return Err(source.error("body.mesh", "the file's name is empty", help));
            }
            Ok(Outline::Gmsh(folder.join(mesh)))
        }
    }
}
