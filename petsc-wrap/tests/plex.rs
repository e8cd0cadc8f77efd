//! Meshes, on one to three ranks.

use std::process::ExitCode;

use mpi::collective::SystemOperation;
use mpi::traits::CommunicatorCollectives;
use petsc_wrap::{CellType, Plex, Session};

fn start() -> Session {
    Session::start(&[]).expect("the first session").expect("PETSc starts")
}

fn main() -> ExitCode {
    mpi_test::run(
        &[1, 2, 3],
        start,
        &[
            ("a_box_has_its_points_once", a_box_has_its_points_once),
            ("closures_hold_what_bounds_a_cell", closures_hold_what_bounds_a_cell),
            ("coordinates_stay_with_their_vertices", coordinates_stay_with_their_vertices),
            ("the_boundary_is_that_of_the_whole", the_boundary_is_that_of_the_whole),
            ("unknowns_are_numbered_once", unknowns_are_numbered_once),
            ("a_file_that_is_no_mesh_is_an_error", a_file_that_is_no_mesh_is_an_error),
            ("physical_groups_are_found_by_number", physical_groups_are_found_by_number),
        ],
    )
}

const CELLS: [usize; 3] = [4, 3, 2];

fn block(session: &Session) -> Plex {
    let plex = Plex::hexahedral_box(&session.world(), CELLS, [0.0; 3], [4.0, 3.0, 2.0]).unwrap();
    plex.label_boundary("skin").unwrap();
    plex.distribute().unwrap()
}

fn sum(session: &Session, local: usize) -> usize {
    let mut total = 0;
    session.world().mpi().all_reduce_into(&local, &mut total, SystemOperation::sum());
    total
}

fn a_box_has_its_points_once(session: &Session) {
    let plex = block(session);
    assert_eq!(plex.dimension().unwrap(), 3);
    let cells = plex.points(3).unwrap();
    assert!(!cells.is_empty(), "a rank without cells");
    assert_eq!(sum(session, cells.clone().count()), 24);
    for cell in cells {
        assert_eq!(plex.cell_type(cell).unwrap(), CellType::Hexahedron);
        assert_eq!(plex.cone(cell).unwrap().len(), 6);
        assert_eq!(plex.cell_type(plex.cone(cell).unwrap()[0]).unwrap(), CellType::Quadrilateral);
    }
}

fn closures_hold_what_bounds_a_cell(session: &Session) {
    let plex = block(session);
    for cell in plex.points(3).unwrap() {
        let closure = plex.closure(cell).unwrap();
        let count = |dimension: usize| {
            let range = plex.points(dimension).unwrap();
            closure.iter().filter(|point| range.contains(point)).count()
        };
        assert_eq!([count(0), count(1), count(2), count(3)], [8, 12, 6, 1]);
    }
}

fn coordinates_stay_with_their_vertices(session: &Session) {
    let plex = block(session);
    let x = plex.vertex_coordinates().unwrap().expect("straight cells");
    let first = plex.points(0).unwrap().start;
    for edge in plex.points(1).unwrap() {
        let ends = plex.cone(edge).unwrap();
        let [a, b] = [ends[0], ends[1]].map(|vertex| x[(vertex - first) as usize]);
        let length: f64 = (0..3).map(|i| (a[i] - b[i]).powi(2)).sum();
        // Unit cells at integer coordinates: exact.
        assert_eq!(length, 1.0);
    }
}

fn the_boundary_is_that_of_the_whole(session: &Session) {
    let plex = block(session);
    let skin = plex.points(2).unwrap().filter(|&face| plex.has_label("skin", face).unwrap()).count();
    // Faces between ranks are not among them: a boundary face has one cell, so it is on one rank.
    assert_eq!(sum(session, skin), 2 * (4 * 3 + 4 * 2 + 3 * 2));
}

fn unknowns_are_numbered_once(session: &Session) {
    let plex = block(session);
    // Quadratic hexahedra with three unknowns a node: a node on every point.
    let numbering = plex.number(|_| 3).unwrap();
    let total = sum(session, numbering.owned);
    assert_eq!(total, 3 * 9 * 7 * 5);
    let (mut owned, mut sum_owned) = (0, 0);
    for dimension in 0..=3 {
        for point in plex.points(dimension).unwrap() {
            let (first, ours) = numbering.first(point);
            assert!((0..total as petsc_wrap::Int).contains(&first));
            if ours {
                owned += 3;
                sum_owned += (first..first + 3).map(|n| n as usize).sum::<usize>();
            }
        }
    }
    assert_eq!(owned, numbering.owned);
    // Every number from 0 to total − 1 is owned exactly once.
    assert_eq!(sum(session, sum_owned), total * (total - 1) / 2);
}

fn a_file_that_is_no_mesh_is_an_error(session: &Session) {
    // On its own communicator, since only the reading rank returns the error.
    let error = Plex::gmsh(&session.alone(), "no-such-mesh.msh".as_ref(), true).err().expect("an error");
    assert!(error.to_string().contains("no-such-mesh.msh"), "{error}");
}

fn physical_groups_are_found_by_number(session: &Session) {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../tests/fixtures/reference/plate20-k0/mesh.msh");
    let plex = Plex::gmsh(&session.world(), path.as_ref(), true).unwrap().distribute().unwrap();
    // Side, top and bottom, a number without faces, and a label that is not there.
    for (label, number, faces) in
        [("Face Sets", 1, 80), ("Face Sets", 2, 200), ("Face Sets", 3, 200), ("Face Sets", 77, 0), ("no label", 1, 0)]
    {
        let here = plex.points(2).unwrap().filter(|&face| plex.has_label_value(label, number, face).unwrap()).count();
        assert_eq!(sum(session, here), faces, "{label} {number}");
    }
    let cells = plex.points(3).unwrap();
    assert_eq!(sum(session, cells.clone().count()), 600);
    assert!(cells.into_iter().all(|cell| plex.cell_type(cell).unwrap() == CellType::Tetrahedron));
}
