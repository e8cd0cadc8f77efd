//! Mesh files that must be refused.

use std::path::Path;

/// A mesh that must be refused, and the expected message.
pub struct BadMesh {
    /// Description of the fault.
    pub name: &'static str,
    /// Content of the mesh file.
    pub bytes: Vec<u8>,
    /// Texts that the message must contain.
    pub fragments: Vec<&'static str>,
}

/// Two stacked hexahedra, 0 ≤ z ≤ 2, with unit squares as tops and bottoms.
pub const TWO: &str = r#"$MeshFormat
2.2 0 8
$EndMeshFormat
$PhysicalNames
3
2 1 "top"
2 2 "middle"
3 3 "block"
$EndPhysicalNames
$Nodes
12
1 0 0 0
2 1 0 0
3 1 1 0
4 0 1 0
5 0 0 1
6 1 0 1
7 1 1 1
8 0 1 1
9 0 0 2
10 1 0 2
11 1 1 2
12 0 1 2
$EndNodes
$Elements
3
1 3 2 1 1 9 10 11 12
2 5 2 3 1 1 2 3 4 5 6 7 8
3 5 2 3 1 5 6 7 8 9 10 11 12
$EndElements
"#;

/// The text of one of the project's meshes.
pub fn sample(name: &str) -> String {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("meshes").join(name);
    std::fs::read_to_string(path).expect("a mesh of the project")
}

fn edit(name: &'static str, good: &str, (from, to): (&str, &str), fragments: &[&'static str]) -> BadMesh {
    assert!(good.contains(from), "{name}: `{from}` is not there");
    BadMesh { name, bytes: good.replacen(from, to, 1).into_bytes(), fragments: fragments.to_vec() }
}

/// A mesh without the text between the middle of a section and `to`.
fn gap(name: &'static str, mesh: &str, section: &str, to: &str, fragments: &[&'static str]) -> BadMesh {
    let text = sample(mesh);
    let place = |mark: &str| text.find(mark).unwrap_or_else(|| panic!("{mesh} has no {mark}"));
    let middle = (place(&format!("${section}")) + place(&format!("$End{section}"))) / 2;
    let middle = middle + text[middle..].find('\n').expect("lines") + 1;
    let rest = if to.is_empty() { "" } else { &text[place(to)..] };
    BadMesh { name, bytes: format!("{}{rest}", &text[..middle]).into_bytes(), fragments: fragments.to_vec() }
}

/// All faulty meshes.
#[rustfmt::skip]
pub fn table() -> Vec<BadMesh> {
    let (old, new) = (sample("block-tet22.msh"), sample("block-tet41.msh"));
    const CUT: &[&str] = &["cut off"];
    vec![
        BadMesh { name: "no mesh", bytes: b"Dear reader,\n".to_vec(), fragments: vec!["not a Gmsh mesh"] },
        BadMesh { name: "bytes", bytes: (0..5000u32).map(|i| (i * i % 251) as u8).collect(), fragments: vec!["not a Gmsh mesh"] },
        BadMesh { name: "empty file", bytes: Vec::new(), fragments: vec!["not a Gmsh mesh"] },
        edit("another version", &old, ("2.2 0 8", "4.0 0 8"), &["line 2", "\"4.0\"", "2.2 and 4.1"]),
        edit("binary by its word", &old, ("2.2 0 8", "2.2 1 8"), &["other order"]),
        gap("half of the nodes, old", "block-tet22.msh", "Nodes", "", CUT),
        gap("half of the nodes, new", "block-tet41.msh", "Nodes", "", CUT),
        gap("half of the elements, old", "block-tet22.msh", "Elements", "", CUT),
        gap("half of the elements, new", "block-tet41.msh", "Elements", "", CUT),
        gap("half of the elements, hexahedra", "block-hex.msh", "Elements", "", CUT),
        gap("half of the entities", "block-tet41.msh", "Entities", "", CUT),
        gap("nodes with a gap, old", "block-tet22.msh", "Nodes", "$EndNodes", &["found \"$EndNodes\""]),
        gap("nodes with a gap, new", "block-tet41.msh", "Nodes", "$EndNodes", &["found \"$EndNodes\""]),
        gap("elements with a gap, old", "block-tet22.msh", "Elements", "$EndElements", &["found \"$EndElements\""]),
        gap("elements with a gap, new", "block-tet41.msh", "Elements", "$EndElements", &["found \"$EndElements\""]),
        gap("from the nodes to the elements", "block-hex.msh", "Nodes", "$Elements", &["found \"$Elements\""]),
        edit("no end", &old, ("$EndElements", ""), CUT),
        edit("coordinate not a number", &old, ("\n2 0.5", "\n2 nan"), &["line 14", "not finite"]),
        edit("infinite coordinate", &new, ("\n0.5 0.5 -0.5", "\n0.5 1e400 -0.5"), &["not finite"]),
        edit("coordinate of letters", &old, ("\n2 0.5", "\n2 left"), &["line 14", "expected a number, found \"left\""]),
        edit("nodes fewer than announced", &new, ("15 14 1 14", "15 15 1 15"), &["hold 14 in all, where 15"]),
        edit("more nodes than can be", &old, ("$Nodes\n14", "$Nodes\n99999999999"), &["line 12", "expected a count"]),
        edit("a negative count", &old, ("$Elements\n", "$Elements\n-"), &["is not a count"]),
        edit("a node twice", &old, ("\n2 0.5", "\n1 0.5"), &["two nodes have the number 1"]),
        edit("a block without its entity", &new, ("2 13 0 1\n", "2 77 0 1\n"), &["no entity 77 of dimension 2"]),
        edit("an element's node missing", TWO, ("9 10 11 12\n$End", "9 10 11 77\n$End"), &["line 29", "node 77, which is not in $Nodes"]),
        edit("an element's node twice", TWO, ("9 10 11 12\n$End", "9 10 11 11\n$End"), &["has node 11 twice"]),
        edit("tags without end", TWO, ("3 5 2 3 1", "3 5 2000 3 1"), &["2000 is not a count of tags"]),
        edit("no elements", TWO, ("3\n1 3 2 1 1 9 10 11 12\n2 5 2 3 1 1 2 3 4 5 6 7 8\n3 5 2 3 1 5 6 7 8 9 10 11 12", "0"), &["no cells"]),
        edit("surfaces only", TWO, ("3\n1 3 2 1 1 9 10 11 12\n2 5 2 3 1 1 2 3 4 5 6 7 8\n3 5 2 3 1 5 6 7 8 9 10 11 12", "1\n1 3 2 1 1 9 10 11 12"), &["no cells"]),
        edit("second order", TWO, ("3 5 2 3 1 5", "3 12 2 3 1 5"), &["type 12", "Mesh.ElementOrder = 1"]),
        edit("a prism", TWO, ("3 5 2 3 1 5 6 7 8 9 10 11 12", "3 6 2 3 1 5 6 7 9 10 11"), &["prisms or pyramids"]),
        edit("mixed cells", TWO, ("3 5 2 3 1 5 6 7 8 9 10 11 12", "3 4 2 3 1 5 6 8 9"), &["belongs to a point"]),
        edit("mixed cells that meet", TWO, ("3\n1 3 2 1 1 9 10 11 12\n2 5 2 3 1 1 2 3 4 5 6 7 8\n3 5 2 3 1 5 6 7 8 9 10 11 12", "2\n2 5 2 3 1 1 2 3 4 5 6 7 8\n3 4 2 3 1 5 6 8 9"), &["mixes shapes: 1 tetrahedra, 1 hexahedra"]),
        edit("a tangled hexahedron", TWO, ("\n3 1 1 0", "\n3 1 1 3"), &["tangled cell"]),
        edit("a hexahedron with its top turned over", TWO, ("5 6 7 8 9 10 11 12", "5 6 7 8 10 9 12 11"), &["tangled cell", "inside out"]),
        edit("a hexahedron dented at a vertex", TWO, ("\n3 1 1 0", "\n3 0.45 0.45 0"), &["tangled cell", "inside out"]),
        edit("a length beyond numbers", TWO, ("\n12 0 1 2", "\n12 0 1 1e200"), &["a coordinate of 1e200 m"]),
        edit("a concave hexahedron", TWO, ("\n3 1 1 0", "\n3 -1 -1 0"), &["tangled cell"]),
        edit("hexahedra that do not fit", TWO, ("5 6 7 8 9 10 11 12", "5 7 6 8 9 11 10 12"), &["do not fit: are nodes of one exchanged?"]),
        edit("a face of no cell", TWO, ("1 3 2 1 1 9 10 11 12", "1 3 2 1 1 1 2 11 12"), &["is not a face of any cell"]),
        edit("a loose point", TWO, ("$Nodes\n12\n", "$Nodes\n13\n13 5 5 5\n"), &[]).with(("$Elements\n3\n", "$Elements\n4\n4 15 2 1 1 13\n"), &["node 13 belongs to a point"]),
        edit("a name without quotes", TWO, ("\"top\"", "top"), &["line 6", "expected a name in quotes"]),
    ]
}

impl BadMesh {
    /// Applies a second edit.
    fn with(self, (from, to): (&str, &str), fragments: &[&'static str]) -> Self {
        let text = String::from_utf8(self.bytes).expect("text");
        edit(self.name, &text, (from, to), fragments)
    }
}

/// [`TWO`] as a binary file of format 2.2, as Gmsh writes it with `-bin`.
#[allow(dead_code, reason = "not every test that shares this module reads binary files")]
pub fn binary_two() -> Vec<u8> {
    let section = |mark: &str| -> Vec<Vec<f64>> {
        let text = TWO.split(&format!("${mark}\n")).nth(1).expect("the section").split("$End").next().expect("its end");
        let numbers = |line: &str| line.split(' ').map(|word| word.parse().expect("a number")).collect();
        text.lines().skip(1).map(numbers).collect()
    };
    let int = |number: &f64| (*number as i32).to_le_bytes();
    let names = TWO.split("$EndMeshFormat\n").nth(1).expect("names").split("$Nodes").next().expect("names");
    let mut bytes = b"$MeshFormat\n2.2 1 8\n\x01\0\0\0\n$EndMeshFormat\n".to_vec();
    bytes.extend(format!("{names}$Nodes\n12\n").bytes());
    for node in section("Nodes") {
        bytes.extend(int(&node[0]));
        bytes.extend(node[1..].iter().flat_map(|x| x.to_le_bytes()));
    }
    bytes.extend(b"\n$EndNodes\n$Elements\n3\n");
    for element in section("Elements") {
        // Kind, one element in the block, number of tags; then the element's number, its tags and nodes.
        let head = [element[1], 1.0, element[2], element[0]];
        bytes.extend(head.iter().chain(&element[3..]).flat_map(int));
    }
    bytes.extend(b"\n$EndElements\n");
    bytes
}
