//! A Gmsh mesh, distributed over the ranks: its volume, the area of a physical surface, and numbers for its unknowns.
//!
//!     mpirun -n 2 cargo run --example mesh

use mpi::collective::SystemOperation;
use mpi::traits::CommunicatorCollectives;
use petsc_wrap::{CellType, Int, Plex, Session, mpi};

pub(crate) fn main() -> Result<(), Box<dyn std::error::Error>> {
    let options: Vec<String> = std::env::args().skip(1).collect();
    let session = Session::start(&options).ok_or("MPI has been started before")??;
    let world = session.world();
    let sum = |mine: f64| -> f64 {
        let mut all = 0.0;
        world.mpi().all_reduce_into(&mine, &mut all, SystemOperation::sum());
        all
    };

    // A unit cube of six tetrahedra; its bottom is physical surface 1.
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/cube.msh");
    let plex = Plex::gmsh(&world, path.as_ref())?.plex;
    let vertices = plex.points(0)?;
    let places = plex.vertex_coordinates()?.ok_or("the cells are curved")?;
    let corners = |point: Int| -> petsc_wrap::Result<Vec<[f64; 3]>> {
        let of_point = plex.closure(point)?.into_iter().filter(|p| vertices.contains(p));
        Ok(of_point.map(|vertex| places[(vertex - vertices.start) as usize]).collect())
    };
    let edges = |corners: &[[f64; 3]]| -> Vec<[f64; 3]> {
        corners[1..].iter().map(|corner| [0, 1, 2].map(|i| corner[i] - corners[0][i])).collect()
    };

    let mut volume = 0.0;
    for cell in plex.points(3)? {
        assert_eq!(plex.cell_type(cell)?, CellType::Tetrahedron);
        let e = edges(&corners(cell)?);
        let normal = cross(e[0], e[1]);
        volume += (0..3).map(|i| normal[i] * e[2][i]).sum::<f64>().abs() / 6.0;
    }
    let mut area = 0.0;
    for face in plex.points(2)? {
        if plex.has_label_value("Face Sets", 1, face)? {
            let e = edges(&corners(face)?);
            area += cross(e[0], e[1]).iter().map(|c| c * c).sum::<f64>().sqrt() / 2.0;
        }
    }
    // Three unknowns at each vertex.
    let numbering = plex.number(|dimension| if dimension == 0 { 3 } else { 0 })?;
    let (volume, area, unknowns) = (sum(volume), sum(area), sum(numbering.owned as f64));
    if world.is_root() {
        println!("volume {volume}, area of the bottom {area}, {unknowns} unknowns");
    }
    // Sums of sixths and of halves: the only error is rounding.
    assert!((volume - 1.0).abs() < 1e-15 && (area - 1.0).abs() < 1e-15);
    assert_eq!(unknowns, 24.0);
    Ok(())
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [0, 1, 2].map(|i| a[(i + 1) % 3] * b[(i + 2) % 3] - a[(i + 2) % 3] * b[(i + 1) % 3])
}
