//! Physical groups of Gmsh files, in both formats, as text and binary: whatever their tags and names, no element is lost
//! or counted twice.

use std::path::Path;

use mpi_test::{Test, tests};
use petsc_wrap::Session;
use ricochet::error::Error;
use ricochet::mesh::{Measures, Mesh};
use ricochet::scene::Scene;

pub const RANKS: &[usize] = &[1, 2, 3];
pub const TESTS: &[Test<Session>] = tests![
    areas_are_those_of_the_groups,
    volumes_are_those_of_the_groups,
    what_cannot_be_read,
    a_curved_surface_is_measured
];

/// An element with Gmsh's type, the positions of its nodes and its physical tags.
struct Element {
    kind: i32,
    nodes: &'static [i32],
    tags: &'static [i32],
}

/// A mesh to be written in each format.
struct Written {
    nodes: Vec<[f64; 3]>,
    /// Dimension, number and name of physical groups.
    names: Vec<(i32, i32, &'static str)>,
    elements: Vec<Element>,
}

/// The formats: 4.1 or 2.2, and whether it is binary.
const FORMATS: [(bool, bool); 4] = [(false, false), (false, true), (true, false), (true, true)];

/// Writes numbers as text or binary.
struct Numbers {
    bytes: Vec<u8>,
    is_binary: bool,
}

impl Numbers {
    fn text(&mut self, text: &str) {
        self.bytes.extend(text.bytes());
    }

    fn int(&mut self, value: i32) {
        if self.is_binary { self.bytes.extend(value.to_le_bytes()) } else { self.text(&format!("{value} ")) }
    }

    /// A count, or a number of a node or element, in format 4.1.
    fn size(&mut self, value: usize) {
        if self.is_binary { self.bytes.extend((value as u64).to_le_bytes()) } else { self.text(&format!("{value} ")) }
    }

    fn real(&mut self, value: f64) {
        if self.is_binary { self.bytes.extend(value.to_le_bytes()) } else { self.text(&format!("{value} ")) }
    }
}

impl Element {
    fn dimension(&self) -> i32 {
        if self.kind < 4 { 2 } else { 3 }
    }
}

impl Written {
    /// The file. In format 4.1 each element is on an entity of its own, which has the tags. In 2.2 Gmsh writes an
    /// element once for each tag.
    fn file(&self, (is_modern, is_binary): (bool, bool)) -> Vec<u8> {
        let mut out = Numbers { bytes: Vec::new(), is_binary: false };
        out.text(&format!("$MeshFormat\n{} {} 8\n", if is_modern { "4.1" } else { "2.2" }, i32::from(is_binary)));
        if is_binary {
            out.bytes.extend(1_i32.to_le_bytes());
        }
        out.text("$EndMeshFormat\n");
        if !self.names.is_empty() {
            out.text(&format!("$PhysicalNames\n{}\n", self.names.len()));
            self.names
                .iter()
                .for_each(|(dimension, number, name)| out.text(&format!("{dimension} {number} \"{name}\"\n")));
            out.text("$EndPhysicalNames\n");
        }
        out.is_binary = is_binary;
        if is_modern {
            self.write_41(&mut out)
        } else {
            self.write_22(&mut out)
        }
        out.bytes
    }

    fn write_22(&self, out: &mut Numbers) {
        out.text(&format!("$Nodes\n{}\n", self.nodes.len()));
        for (i, node) in self.nodes.iter().enumerate() {
            out.int(i as i32 + 1);
            node.iter().for_each(|x| out.real(*x));
        }
        let copies: Vec<(&Element, i32)> = self
            .elements
            .iter()
            .flat_map(|element| {
                let tags = if element.tags.is_empty() { &[0][..] } else { element.tags };
                tags.iter().map(move |tag| (element, *tag))
            })
            .collect();
        out.text(&format!("\n$EndNodes\n$Elements\n{}\n", copies.len()));
        for (i, (element, tag)) in copies.iter().enumerate() {
            let number = i as i32 + 1;
            let head = if out.is_binary { [element.kind, 1, 2, number] } else { [number, element.kind, 2, *tag] };
            head.iter().chain(out.is_binary.then_some(tag)).chain(&[1]).for_each(|word| out.int(*word));
            element.nodes.iter().for_each(|node| out.int(node + 1));
        }
        out.text("\n$EndElements\n");
    }

    fn write_41(&self, out: &mut Numbers) {
        out.text("$Entities\n");
        let facets: Vec<usize> = (0..self.elements.len()).filter(|i| self.elements[*i].dimension() == 2).collect();
        let cells: Vec<usize> = (0..self.elements.len()).filter(|i| self.elements[*i].dimension() == 3).collect();
        [0, 0, facets.len(), cells.len()].iter().for_each(|count| out.size(*count));
        for &i in facets.iter().chain(&cells) {
            out.int(i as i32 + 1);
            (0..6).for_each(|_| out.real(0.5));
            out.size(self.elements[i].tags.len());
            self.elements[i].tags.iter().for_each(|tag| out.int(*tag));
            out.size(0);
        }
        out.text("\n$EndEntities\n$Nodes\n");
        let count = self.nodes.len();
        [1, count, 1, count].iter().for_each(|word| out.size(*word));
        [3, cells[0] as i32 + 1, 0].iter().for_each(|word| out.int(*word));
        out.size(count);
        (1..=count).for_each(|number| out.size(number));
        self.nodes.iter().flatten().for_each(|x| out.real(*x));
        out.text("\n$EndNodes\n$Elements\n");
        let count = self.elements.len();
        [count, count, 1, count].iter().for_each(|word| out.size(*word));
        for (i, element) in self.elements.iter().enumerate() {
            [element.dimension(), i as i32 + 1, element.kind].iter().for_each(|word| out.int(*word));
            [1, i + 1].iter().for_each(|word| out.size(*word));
            element.nodes.iter().for_each(|node| out.size(*node as usize + 1));
        }
        out.text("\n$EndElements\n");
    }
}

/// Two unit cubes, one on the other, with these tags on the lower and the upper cell, on one side of each, and on the
/// top.
fn cubes(names: &[(i32, i32, &'static str)], [lower, upper, one, other, top]: [&'static [i32]; 5]) -> Written {
    let square = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
    Written {
        nodes: (0..12).map(|i| [square[i % 4][0], square[i % 4][1], (i / 4) as f64]).collect(),
        names: names.to_vec(),
        elements: vec![
            Element { kind: 3, nodes: &[0, 1, 5, 4], tags: one },
            Element { kind: 3, nodes: &[4, 5, 9, 8], tags: other },
            Element { kind: 3, nodes: &[8, 9, 10, 11], tags: top },
            Element { kind: 5, nodes: &[0, 1, 2, 3, 4, 5, 6, 7], tags: lower },
            Element { kind: 5, nodes: &[4, 5, 6, 7, 8, 9, 10, 11], tags: upper },
        ],
    }
}

/// Two tetrahedra of 1/6 m³ with a common face; the tagged faces have half a square metre each.
fn tetrahedra(names: &[(i32, i32, &'static str)], [lower, upper, one, other, top]: [&'static [i32]; 5]) -> Written {
    Written {
        nodes: vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [0.0, 0.0, -1.0]],
        names: names.to_vec(),
        elements: vec![
            Element { kind: 2, nodes: &[0, 1, 3], tags: one },
            Element { kind: 2, nodes: &[0, 1, 4], tags: other },
            Element { kind: 2, nodes: &[0, 2, 3], tags: top },
            Element { kind: 4, nodes: &[0, 1, 2, 4], tags: lower },
            Element { kind: 4, nodes: &[0, 1, 2, 3], tags: upper },
        ],
    }
}

fn measures(session: &Session, bytes: &[u8], materials: &str) -> Result<Measures, Error> {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("mesh.msh");
    std::fs::write(&path, bytes).expect("a file");
    let scene = scene(&path, materials);
    Ok(Mesh::new(&session.world(), &scene.body)?.measures(&scene.impactor))
}

fn scene(mesh: &Path, materials: &str) -> Scene {
    let text = format!(
        "[body]\nmesh = {mesh:?}\n{materials}\n[impactor]\nmass = 1.0\nradius = 0.05\nstiffness = 1e10\nspeed = 1.0\n\
         point = [0.0, 0.0, 1.0]\n[time]\nend = 5e-5\n"
    );
    Scene::parse("test", &text, &[]).unwrap_or_else(|error| panic!("{error}")).0
}

const ONE: &str = "young = 70e9\npoisson = 0.23\ndensity = 2500.0";

/// A test: its groups, the tags of its elements, and its surfaces with their numbers of faces.
struct Case<'a> {
    what: &'a str,
    names: &'a [(i32, i32, &'static str)],
    tags: [&'static [i32]; 5],
    surfaces: &'a [(&'a str, f64)],
}

fn areas_are_those_of_the_groups(session: &Session) {
    let named = [(2, 1, "side"), (2, 2, "top"), (3, 1, "block")];
    let one_name = [(2, 1, "side"), (2, 7, "side"), (2, 2, "top")];
    let a_number = [(2, 1, "side"), (2, 2, "9")];
    let case = |what, names, tags, surfaces| Case { what, names, tags, surfaces };
    let cases = [
        case("plain", &named, [&[1], &[1], &[1], &[1], &[2]], &[("side", 2.0), ("top", 1.0)]),
        case("a reversed surface", &named, [&[1], &[-1], &[1], &[-1], &[-2]], &[("side", 2.0), ("top", 1.0)]),
        case("faces in two groups", &named, [&[1], &[1], &[1, 2], &[-2, 1], &[2]], &[("side", 2.0), ("top", 3.0)]),
        case("groups of one name", &one_name, [&[], &[], &[1], &[7], &[2]], &[("side", 2.0), ("top", 1.0)]),
        case("no name", &named, [&[1], &[1], &[1], &[33], &[2]], &[("33", 1.0), ("side", 1.0), ("top", 1.0)]),
        // The name wins.
        case("a number as a name", &a_number, [&[], &[], &[1], &[9], &[2]], &[("9", 1.0), ("side", 1.0)]),
    ];
    for Case { what, names, tags, surfaces } in cases {
        for (shape, face, volume) in [(0, 1.0, 2.0), (1, 0.5, 1.0 / 3.0)] {
            let written = if shape == 0 { cubes(names, tags) } else { tetrahedra(names, tags) };
            for format in FORMATS {
                let what = format!("{what}, shape {shape}, {format:?}");
                let measures =
                    measures(session, &written.file(format), ONE).unwrap_or_else(|error| panic!("{what}: {error}"));
                // Rounding.
                assert!((measures.volume - volume).abs() < 1e-14, "{what}: {measures:?}");
                let found: Vec<(&str, f64)> = measures.surfaces.iter().map(|s| (&s.name[..], s.area / face)).collect();
                assert_eq!(found.len(), surfaces.len(), "{what}: {found:?}");
                for ((name, area), (right, faces)) in found.into_iter().zip(surfaces) {
                    assert!(name == *right && (area - faces).abs() < 1e-14, "{what}: {name} {area}");
                }
            }
        }
    }
}

/// A cell in two groups is one cell. It has the material of its only group that has one; two are refused by name.
fn volumes_are_those_of_the_groups(session: &Session) {
    let names = [(3, 1, "glass"), (3, 2, "all"), (3, 3, "glass")];
    let tags: [&[i32]; 5] = [&[1, 2], &[-2, 3], &[], &[], &[]];
    let material =
        |names: &[&str]| -> String { names.iter().map(|name| format!("[material.{name}]\n{ONE}\n")).collect() };
    let contact = |name: &str| format!("[contact]\nmaterial = \"{name}\"\n");
    for written in [cubes(&names, tags), tetrahedra(&names, tags)] {
        for format in FORMATS {
            let file = written.file(format);
            for name in ["glass", "all", "2"] {
                let measured = measures(session, &file, &(material(&[name]) + &contact(name)));
                match measured {
                    Ok(measures) => {
                        let right = if written.nodes.len() == 12 { 2.0 } else { 1.0 / 3.0 };
                        assert!(
                            name != "2" && (measures.volume - right).abs() < 1e-14,
                            "{format:?} {name}: {measures:?}"
                        );
                    }
                    // A named group is not known by its number.
                    Err(error) => {
                        assert!(name == "2" && error.to_string().contains("no physical volume \"2\""), "{error}")
                    }
                }
            }
            let error = measures(session, &file, &(material(&["glass", "all"]) + &contact("glass")))
                .expect_err("two materials");
            let message = error.to_string();
            assert!(
                message.contains("\"glass\"") && message.contains("in another one that has a material"),
                "{message}"
            );
        }
    }
}

/// What is not read is refused with the cause; what some programs write beside Gmsh's own format is read.
fn what_cannot_be_read(session: &Session) {
    let names = [(2, 1, "side"), (3, 1, "block")];
    let tags: [&[i32]; 5] = [&[1], &[1], &[1], &[], &[]];
    let good = |format| String::from_utf8(cubes(&names, tags).file(format)).expect("text");
    let (old, new) = (good((false, false)), good((true, false)));
    let long = "x".repeat(200);
    let begin = new.find("$Entities").expect("entities");
    let end = new.find("$Nodes").expect("nodes");
    let (head, rest) = old.split_at(old.find("$Nodes").expect("nodes"));
    for (what, text, side) in [
        ("a byte-order mark", format!("\u{feff}{old}"), Some("side")),
        ("a long name", old.replace("side", &long), Some(&long[..])),
        ("node numbers far apart", format!("{head}{}", rest.replace(" 12 ", " 2000000000 ")), Some("side")),
        // As meshio writes it: the elements are in no physical group.
        ("no entities", format!("{}{}", &new[..begin], &new[end..]), None),
    ] {
        let measures = measures(session, text.as_bytes(), ONE).unwrap_or_else(|error| panic!("{what}: {error}"));
        let names: Vec<&str> = measures.surfaces.iter().map(|surface| &surface.name[..]).collect();
        assert_eq!(names, side.into_iter().collect::<Vec<_>>(), "{what}");
    }
    for (what, text, expected) in [
        (
            "partitions",
            new.replace("$Nodes", "$PartitionedEntities\n2 0\n0 0 0 0\n$EndPartitionedEntities\n$Nodes"),
            "partitioned",
        ),
        ("parametric nodes", old.replace("$Nodes", "$ParametricNodes"), "Mesh.SaveParametric = 0"),
        (
            "two names of a group",
            old.replace("$PhysicalNames\n2\n", "$PhysicalNames\n3\n2 1 \"other\"\n"),
            "has two names",
        ),
        ("a name that is a path", old.replace("side", "a/b"), "has the name \"a/b\""),
        ("a name of the results", old.replace("side", "ring"), "has the name \"ring\""),
        ("an escape in a name", old.replace("side", "a\u{1b}[2J"), "has the name"),
        ("a name beyond all lengths", old.replace("side", &"x".repeat(256)), "1 to 255 bytes"),
        ("the least number", new.replacen("0.5 1 1 0", "0.5 1 -2147483648 0", 1), "is not a physical group"),
    ] {
        let error = measures(session, text.as_bytes(), ONE).expect_err(what).to_string();
        assert!(error.contains(expected) && !error.contains('\u{1b}'), "{what}: {error}");
    }
}

/// A dome z = 1 − (κ₁ x² + κ₂ y²)/2 of hexahedra: its mean curvature at the top is (κ₁ + κ₂)/2, for a cylinder half of 1/R.
fn a_curved_surface_is_measured(session: &Session) {
    const CELLS: usize = 16;
    let at = |i: usize| i as f64 / 8.0 - 1.0;
    let node = |i: usize, j: usize, layer: usize| (layer * (CELLS + 1) + j) * (CELLS + 1) + i + 1;
    for [one, other] in [[0.4, 0.4], [0.4, 0.0], [-0.3, -0.1], [0.0, 0.0]] {
        let count = 2 * (CELLS + 1) * (CELLS + 1);
        let mut text = format!("$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n{count}\n");
        for number in 0..count {
            let (i, j, layer) = (number % (CELLS + 1), number / (CELLS + 1) % (CELLS + 1), number / (count / 2));
            let (x, y) = (at(i), at(j));
            let z = layer as f64 - 0.5 * (one * x * x + other * y * y);
            text += &format!("{} {x} {y} {z}\n", number + 1);
        }
        text += &format!("$EndNodes\n$Elements\n{}\n", CELLS * CELLS);
        for cell in 0..CELLS * CELLS {
            let (i, j) = (cell % CELLS, cell / CELLS);
            let nodes = [0, 1].map(|layer| [(0, 0), (1, 0), (1, 1), (0, 1)].map(|(u, v)| node(i + u, j + v, layer)));
            let nodes: Vec<String> = nodes.iter().flatten().map(usize::to_string).collect();
            text += &format!("{} 5 2 1 1 {}\n", cell + 1, nodes.join(" "));
        }
        text += "$EndElements\n";
        let measured = measures(session, text.as_bytes(), ONE).unwrap_or_else(|error| panic!("{error}")).curvature;
        // Heights are measured above the cell at the top, whose normal is turned by 1/16 of the curvature: its square.
        let right = 0.5 * (one + other);
        assert!((measured - right).abs() <= 0.01 * right.abs() + 1e-9, "{one} {other}: {measured}");
    }
}
