//! Tests of meshes, on one to three ranks.

use std::process::ExitCode;

use mpi::collective::SystemOperation;
use mpi::traits::CommunicatorCollectives;
use petsc_wrap::{CellType, Error, Int, LabelledPoint, Plex, Session};

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
            ("cells_stay_where_they_are_given", cells_stay_where_they_are_given),
            ("cells_that_petsc_takes_on_trust_are_refused", cells_that_petsc_takes_on_trust_are_refused),
            ("a_file_that_is_no_mesh_is_an_error", a_file_that_is_no_mesh_is_an_error),
            ("physical_groups_are_found_by_number", physical_groups_are_found_by_number),
            ("a_file_that_breaks_its_promise_is_refused", a_file_that_breaks_its_promise_is_refused),
            ("any_name_is_one_of_a_file", any_name_is_one_of_a_file),
            ("rank_0_reads_the_file", rank_0_reads_the_file),
            ("hexahedra_that_do_not_fit_are_an_error", hexahedra_that_do_not_fit_are_an_error),
            ("values_are_given_to_points_that_are_there", values_are_given_to_points_that_are_there),
            ("shapes_that_petsc_takes_on_trust_are_refused", shapes_that_petsc_takes_on_trust_are_refused),
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
        // The cells have unit edges and integer coordinates: the result is exact.
        assert_eq!(length, 1.0);
    }
}

fn the_boundary_is_that_of_the_whole(session: &Session) {
    let plex = block(session);
    let skin = plex.points(2).unwrap().filter(|&face| plex.has_label("skin", face).unwrap()).count();
    // Faces between ranks are not counted: a boundary face has one cell, so it is on one rank.
    assert_eq!(sum(session, skin), 2 * (4 * 3 + 4 * 2 + 3 * 2));
}

fn unknowns_are_numbered_once(session: &Session) {
    let plex = block(session);
    // Quadratic hexahedra with three unknowns at each node have a node on every point.
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

/// A row of cubes along x; some ranks may have none. Vertex 4i + j is at x = i.
fn row(session: &Session, cubes: std::ops::Range<usize>, shape: CellType) -> Result<Plex, Error> {
    let world = session.world();
    let vertices: Vec<Int> = cubes.flat_map(|i| [0, 1, 2, 3, 4, 5, 6, 7].map(|j| (4 * i + j) as Int)).collect();
    // Rank 0 gives all coordinates.
    let corner = |n: usize| [(n / 4) as f64, [0.0, 1.0, 1.0, 0.0][n % 4], [0.0, 0.0, 1.0, 1.0][n % 4]];
    let places: Vec<[f64; 3]> = (0..4 * CUBES + 4).filter(|_| world.is_root()).map(corner).collect();
    Plex::from_cells(&world, shape, &vertices, &places)
}

const CUBES: usize = 7;

/// Cells stay on the rank that gives them, even if one rank has none.
fn cells_stay_where_they_are_given(session: &Session) {
    let world = session.world();
    for makers in 1..=world.size() {
        let share = |rank: usize| (CUBES * rank / makers).min(CUBES);
        let mine = share(world.rank())..share(world.rank() + 1);
        let plex = row(session, mine.clone(), CellType::Hexahedron).unwrap();
        plex.label_boundary("skin").unwrap();
        let here = [0, 1, 2, 3].map(|dimension| plex.points(dimension).unwrap().count());
        let n = mine.len();
        assert_eq!(here, if n == 0 { [0; 4] } else { [4 * n + 4, 8 * n + 4, 5 * n + 1, n] });
        // The coordinates are in the order of the vertex numbers.
        let x = plex.vertex_coordinates().unwrap().expect("straight cells");
        assert!(x.iter().enumerate().all(|(i, x)| x[0] == (mine.start + i / 4) as f64));
        let skin = plex.points(2).unwrap().filter(|&face| plex.has_label("skin", face).unwrap()).count();
        assert_eq!(sum(session, skin), 4 * CUBES + 2);
        assert_eq!(
            sum(session, plex.number(|_| 1).unwrap().owned),
            4 * CUBES + 4 + 8 * CUBES + 4 + 5 * CUBES + 1 + CUBES
        );
        for (i, cell) in plex.points(3).unwrap().enumerate() {
            let vertices = plex.points(0).unwrap();
            let corners = plex.closure(cell).unwrap().into_iter().filter(|point| vertices.contains(point));
            let middle = corners.map(|vertex| x[(vertex - vertices.start) as usize][0] / 8.0).sum::<f64>();
            assert_eq!(middle, (mine.start + i) as f64 + 0.5);
        }
    }
}

/// Invalid cells on one rank are reported on all ranks. PETSc would use them unchecked.
fn cells_that_petsc_takes_on_trust_are_refused(session: &Session) {
    let world = session.world();
    let all = 0..if world.rank() + 1 == world.size() { CUBES } else { 0 };
    assert!(row(session, all.clone(), CellType::Hexahedron).is_ok());
    // A vertex beyond the last one, and no cells at all.
    for cubes in [0..if all.is_empty() { 0 } else { CUBES + 1 }, 0..0] {
        assert!(matches!(row(session, cubes, CellType::Hexahedron), Err(Error::Invalid { .. })));
    }
    assert!(matches!(row(session, all, CellType::Quadrilateral), Err(Error::Invalid { .. })));
    let places = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    let share = if world.is_root() { &places[..] } else { &[] };
    for (corners, is_good) in
        [([0, 1, 2, 3], true), ([0, 1, 2, 4], false), ([-1, 1, 2, 3], false), ([0, 1, 1, 3], false)]
    {
        let mine = if world.rank() + 1 == world.size() { &corners[..] } else { &[] };
        let made = Plex::from_cells(&world, CellType::Tetrahedron, mine, share);
        assert_eq!(made.is_ok(), is_good);
        let part = Plex::from_cells(&world, CellType::Tetrahedron, &mine[..mine.len().min(3)], share);
        assert!(matches!(part, Err(Error::Invalid { .. })));
    }
}

fn a_file_that_is_no_mesh_is_an_error(session: &Session) {
    let error = Plex::gmsh(&session.world(), "no-such-mesh.msh".as_ref()).err().expect("an error");
    assert!(error.to_string().contains("no-such-mesh.msh"), "{error}");
    let error = Plex::gmsh(&session.world(), &std::env::temp_dir()).err().expect("an error");
    assert!(error.to_string().contains("cannot be read"), "{error}");
}

/// Physical groups are found by number. The mesh is a unit cube of 6 tetrahedra with two triangles on each side: group
/// 1 is the bottom, 2 the top.
fn physical_groups_are_found_by_number(session: &Session) {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/cube.msh");
    let plex = Plex::gmsh(&session.world(), path.as_ref()).unwrap();
    let names = plex.surfaces.iter().map(|surface| (surface.number, surface.name.as_str()));
    assert!(names.eq([(1, "bottom"), (2, "top of it")]));
    assert_eq!((plex.shape, plex.volumes, plex.parts), (CellType::Tetrahedron, 1, 1));
    let plex = plex.plex;
    // Bottom and top, a number without faces, and a label that is not there.
    for (label, number, faces) in [("Face Sets", 1, 2), ("Face Sets", 2, 2), ("Face Sets", 77, 0), ("no label", 1, 0)] {
        let here = plex.points(2).unwrap().filter(|&face| plex.has_label_value(label, number, face).unwrap()).count();
        assert_eq!(sum(session, here), faces, "{label} {number}");
    }
    let cells = plex.points(3).unwrap();
    // All ranks have the same number of cells.
    assert_eq!(cells.clone().count() * session.world().size(), 6);
    assert!(cells.into_iter().all(|cell| plex.cell_type(cell).unwrap() == CellType::Tetrahedron));
}

/// A file that does not hold the announced nodes is refused, with the same error on all ranks. PETSc would read beyond
/// the end of the nodes, on rank 0.
fn a_file_that_breaks_its_promise_is_refused(session: &Session) {
    let world = session.world();
    let text = std::fs::read_to_string(concat!(env!("CARGO_MANIFEST_DIR"), "/tests/cube.msh")).unwrap();
    let path = std::env::temp_dir().join(format!("petsc-wrap-{}-{}.msh", std::process::id(), world.rank()));
    for (place, instead) in [
        ("1 2 4 8", "1 2 4 99"),
        ("1 2 4 8", "1 2 4 -8"),
        ("$Nodes\n8", "$Nodes\n9"),
        ("$Elements\n10", "$Elements\n-1"),
    ] {
        std::fs::write(&path, text.replacen(place, instead, 1)).unwrap();
        let error = Plex::gmsh(&world, &path).err();
        assert!(matches!(error, Some(Error::MeshFile { .. })), "{instead}: {error:?}");
    }
    std::fs::remove_file(path).unwrap();
}

/// A file may have any name. PETSc's own reader would take the name `stdin` for a stream, a backslash for a slash, and
/// would read options from a file `.info`.
fn any_name_is_one_of_a_file(session: &Session) {
    let alone = session.alone();
    let folder = std::env::temp_dir().join(format!("petsc-wrap-paths-{}", std::process::id()));
    std::fs::create_dir_all(folder.join("a")).unwrap();
    std::fs::write(folder.join("a/b.msh"), "no mesh").unwrap();
    std::fs::write(folder.join("c.msh.info"), "-malloc_dump").unwrap();
    for name in ["stdin", "stdout", "a\\b.msh", "c.msh"] {
        let path = folder.join(name);
        std::fs::copy(concat!(env!("CARGO_MANIFEST_DIR"), "/tests/cube.msh"), &path).unwrap();
        assert_eq!(Plex::gmsh(&alone, &path).unwrap().surfaces.len(), 2);
    }
    std::fs::remove_dir_all(&folder).unwrap();
}

/// Rank 0 reads the file for all ranks: the others need not have it, and get its error.
fn rank_0_reads_the_file(session: &Session) {
    let world = session.world();
    let text = std::fs::read_to_string(concat!(env!("CARGO_MANIFEST_DIR"), "/tests/cube.msh")).unwrap();
    let path = std::env::temp_dir().join(format!("petsc-wrap-one-{}-{}.msh", std::process::id(), world.rank()));
    if world.is_root() {
        std::fs::write(&path, &text).unwrap();
    }
    assert_eq!(Plex::gmsh(&world, &path).unwrap().surfaces.len(), 2);
    if world.is_root() {
        std::fs::remove_file(&path).unwrap();
    }
    let error = Plex::gmsh(&world, &path).err().expect("an error");
    assert!(error.to_string().contains("cannot be read"), "{error}");
}

/// Two cubes whose orientations of the shared face differ are an error. Only the rank that detects it gets PETSc's
/// error, and other ranks would wait for it.
fn hexahedra_that_do_not_fit_are_an_error(session: &Session) {
    let places: Vec<[f64; 3]> = (0..12).map(|n| [f64::from(n % 2), f64::from(n / 2 % 2), f64::from(n / 4)]).collect();
    let cells = [[0, 1, 3, 2, 4, 5, 7, 6], [4, 7, 5, 6, 8, 11, 9, 10]].concat();
    assert!(Plex::from_cells(&session.alone(), CellType::Hexahedron, &cells, &places).is_err());
}

fn values_are_given_to_points_that_are_there(session: &Session) {
    let plex = block(session);
    let cells = plex.points(3).unwrap();
    let first = cells.start;
    let both = [7, 9].map(|value| LabelledPoint { point: first, value });
    plex.label("two values", both).unwrap();
    assert!(both.iter().all(|of| plex.has_label_value("two values", of.value, first).unwrap()));
    assert!(!plex.has_label("two values", first + 1).unwrap());
    let beyond = LabelledPoint { point: -1, value: 1 };
    assert!(matches!(plex.label("two values", [beyond]), Err(Error::OutOfRange { .. })));
    assert!(matches!(plex.label("celltype", both), Err(Error::Invalid { .. })));
}

fn shapes_that_petsc_takes_on_trust_are_refused(session: &Session) {
    let alone = session.alone();
    let boxed = |cells| Plex::hexahedral_box(&alone, cells, [0.0; 3], [1.0; 3]);
    assert!(matches!(boxed([1, 0, 1]), Err(Error::Invalid { .. })));
    // More points than fit in 32 bits, in 64 bits, and in a usize.
    for n in [1 << 11, 1 << 22, usize::MAX] {
        let outcome = boxed([n, n, n]);
        assert!(n == 1 << 11 && petsc_wrap::Int::BITS == 64 || matches!(outcome, Err(Error::TooLarge { .. })));
    }
    let plex = boxed([1, 1, 1]).unwrap();
    assert!(matches!(plex.label_boundary("depth"), Err(Error::Invalid { .. })));
    assert!(matches!(plex.number(|_| usize::MAX), Err(Error::Invalid { .. })));
    assert!(matches!(plex.number(|_| petsc_wrap::Int::MAX as usize), Err(Error::Invalid { .. })));
    assert!(plex.points(usize::MAX).is_err());
    for point in [-1, plex.points(2).unwrap().end.max(27)] {
        assert!(plex.cone(point).is_err() && plex.closure(point).is_err() && plex.cell_type(point).is_err());
        assert!(plex.has_label("skin", point).is_err() && plex.has_label_value("skin", 1, point).is_err());
    }
    assert_eq!(plex.number(|_| 1).unwrap().owned, 27);
}
