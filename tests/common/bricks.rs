//! Boxes of hexahedra or tetrahedra as Gmsh files.

use std::fmt::Write;

use ricochet::element::Shape;

/// Gmsh text (MSH 2.2) of a box centred on the origin and divided into bricks. The cells are hexahedra, or six
/// tetrahedra for each brick around its diagonal (Kuhn 1960). Surfaces are "side", "top" and "bottom".
///
/// Vertices are moved at random by up to `distortion` of a brick's edge, and stay in their faces. Half of the
/// tetrahedra are listed in mirrored order.
pub fn bricks(shape: Shape, size: [f64; 3], cells: [usize; 3], distortion: f64) -> String {
    let number = |v: [usize; 3]| 1 + v[0] + (cells[0] + 1) * (v[1] + (cells[1] + 1) * v[2]);
    let mut nodes = String::new();
    for v in lattice(cells.map(|n| n + 1)) {
        let x = [0, 1, 2].map(|axis| {
            let inside = v[axis] > 0 && v[axis] < cells[axis];
            let shift = if inside { distortion * random(3 * number(v) + axis) } else { 0.0 };
            size[axis] * ((v[axis] as f64 + shift) / cells[axis] as f64 - 0.5)
        });
        writeln!(nodes, "{} {:.17e} {:.17e} {:.17e}", number(v), x[0], x[1], x[2]).unwrap();
    }
    let tetrahedra = shape == Shape::Tetrahedron;
    let mut elements = Vec::new();
    for base in lattice(cells) {
        let corner = |axes: &[usize]| number([0, 1, 2].map(|axis| base[axis] + usize::from(axes.contains(&axis))));
        if tetrahedra {
            for [a, b, c] in [[0, 1, 2], [1, 2, 0], [2, 0, 1], [0, 2, 1], [2, 1, 0], [1, 0, 2]] {
                elements.push((4, 4, vec![corner(&[]), corner(&[a]), corner(&[a, b]), corner(&[a, b, c])]));
            }
        } else {
            let ring = [vec![], vec![0], vec![0, 1], vec![1]];
            let above = ring.iter().map(|axes| [&axes[..], &[2]].concat());
            elements.push((5, 4, ring.iter().cloned().chain(above).map(|axes| corner(&axes)).collect()));
        }
        for (normal, upper) in lattice([3, 2, 1]).map(|[normal, upper, _]| (normal, upper == 1)) {
            if base[normal] + 1 != if upper { cells[normal] } else { 1 } {
                continue;
            }
            let at = |axes: &[usize]| if upper { corner(&[axes, &[normal]].concat()) } else { corner(axes) };
            let (a, b) = ((normal + 1) % 3, (normal + 2) % 3);
            let surface = if normal < 2 { 1 } else { 3 - usize::from(upper) };
            if tetrahedra {
                elements.push((2, surface, vec![at(&[]), at(&[a]), at(&[a, b])]));
                elements.push((2, surface, vec![at(&[]), at(&[a, b]), at(&[b])]));
            } else {
                elements.push((3, surface, vec![at(&[]), at(&[a]), at(&[a, b]), at(&[b])]));
            }
        }
    }
    let mut list = String::new();
    for (i, (kind, physical, vertices)) in elements.iter().enumerate() {
        let vertices: Vec<String> = vertices.iter().map(usize::to_string).collect();
        writeln!(list, "{} {kind} 2 {physical} {physical} {}", i + 1, vertices.join(" ")).unwrap();
    }
    format!(
        "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n\
         $PhysicalNames\n4\n2 1 \"side\"\n2 2 \"top\"\n2 3 \"bottom\"\n3 4 \"body\"\n$EndPhysicalNames\n\
         $Nodes\n{}\n{nodes}$EndNodes\n$Elements\n{}\n{list}$EndElements\n",
        nodes.lines().count(),
        elements.len()
    )
}

/// All index triples below the counts.
fn lattice([nx, ny, nz]: [usize; 3]) -> impl Iterator<Item = [usize; 3]> {
    (0..nz).flat_map(move |k| (0..ny).flat_map(move |j| (0..nx).map(move |i| [i, j, k])))
}

/// A pseudo-random number in (−1, 1), always the same for the same index.
fn random(index: usize) -> f64 {
    let mixed = (index as u64 + 1).wrapping_mul(0x9E37_79B9_7F4A_7C15);
    let mixed = (mixed ^ (mixed >> 29)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    (mixed >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
}
