//! XDMF: an XML text that locates the grid and the fields in the fields' file (xdmf.org, model and format, version 2).

use std::fmt::{self, Display, Formatter};
use std::fs;
use std::path::Path;

use crate::element::Shape;
use crate::error::{Error, Result};
use crate::record::target;

use super::vtkhdf::{FIELDS, GROUP, VtkHdf};

/// Writes the XDMF file `path` for the content of the fields' file `fields`. The file appears complete or not at all.
///
/// # Errors
/// [`Error::Io`] if writing fails.
pub fn write(path: &Path, fields: &Path, file: &VtkHdf) -> Result<()> {
    let name = fields.file_name().unwrap_or_default().to_string_lossy();
    let text = Text { name: escaped(&name), file }.to_string();
    let write =
        |part: &Path| fs::write(part, text).and_then(|()| fs::rename(part, path)).map_err(|e| Error::io(path, e));
    target::write_part(path, write).map(|_| ())
}

struct Text<'a> {
    /// Name of the fields' file, which has the numbers and is in the same folder.
    name: String,
    file: &'a VtkHdf,
}

impl Display for Text<'_> {
    fn fmt(&self, f: &mut Formatter) -> fmt::Result {
        let Self { name, file } = self;
        let VtkHdf { points, cells: [cells, each], shape, order, .. } = file;
        writeln!(f, "<?xml version=\"1.0\"?>\n<Xdmf Version=\"2.2\">\n<Domain>")?;
        writeln!(f, "<Grid Name=\"fields\" GridType=\"Collection\" CollectionType=\"Temporal\">")?;
        for (number, time) in file.times.iter().enumerate() {
            writeln!(f, "<Grid Name=\"body\" GridType=\"Uniform\">\n<Time Value=\"{time:e}\"/>")?;
            writeln!(f, "<Topology TopologyType=\"{}\" NumberOfElements=\"{cells}\">", topology(*shape, *order))?;
            item(f, "Int", 8, &format!("{cells} {each}"), &format!("{name}:/{GROUP}/Connectivity"))?;
            writeln!(f, "</Topology>\n<Geometry GeometryType=\"XYZ\">")?;
            item(f, "Float", 8, &format!("{points} 3"), &format!("{name}:/{GROUP}/Points"))?;
            writeln!(f, "</Geometry>")?;
            for (field, _, _) in FIELDS {
                writeln!(f, "<Attribute Name=\"{field}\" AttributeType=\"Vector\" Center=\"Node\">")?;
                writeln!(f, "<DataItem ItemType=\"HyperSlab\" Dimensions=\"{points} 3\" Type=\"HyperSlab\">")?;
                writeln!(
                    f,
                    "<DataItem Dimensions=\"3 2\" Format=\"XML\">{} 0 1 1 {points} 3</DataItem>",
                    number * points
                )?;
                let all = format!("{} 3", file.times.len() * points);
                item(f, "Float", 8, &all, &format!("{name}:/{GROUP}/PointData/{field}"))?;
                writeln!(f, "</DataItem>\n</Attribute>")?;
            }
            writeln!(f, "</Grid>")?;
        }
        writeln!(f, "</Grid>\n</Domain>\n</Xdmf>")
    }
}

fn item(f: &mut Formatter, kind: &str, bytes: usize, dimensions: &str, place: &str) -> fmt::Result {
    writeln!(
        f,
        "<DataItem NumberType=\"{kind}\" Precision=\"{bytes}\" Dimensions=\"{dimensions}\" Format=\"HDF\">{place}</DataItem>"
    )
}

/// Name of a cell type in XDMF.
fn topology(shape: Shape, order: usize) -> &'static str {
    match (shape, order) {
        (Shape::Tetrahedron, 1) => "Tetrahedron",
        (Shape::Tetrahedron, _) => "Tet_10",
        (_, 1) => "Hexahedron",
        _ => "Hexahedron_27",
    }
}

/// Name with the special characters of XML escaped.
fn escaped(name: &str) -> String {
    name.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}
