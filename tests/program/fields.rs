//! Tests of field output, read like ParaView does: with PyPI's vtk, by scripts/readers.

use crate::bricks;
use crate::results;
use mpi_test::{PlainTest, tests};
use std::fs;
use std::path::Path;
use std::process::{Command, Stdio};

use crate::glass::{plate, sides};
use crate::program::{BOX, LIMIT, children, ricochet, run, send};
use crate::results::{column, difference, folder, good, long, text, words};
use ricochet::element::Shape;
use serde_json::Value;

pub const TESTS: &[PlainTest] = tests![
    fields_near_the_hit_are_what_probes_read,
    ranks_write_the_same_fields,
    a_kill_leaves_fields_that_can_be_read,
    names_that_fields_cannot_have
];
pub const BY_VTK: &[PlainTest] = tests![vtk_reads_what_the_series_tells];

/// VTK's description of a result's fields, for each way of opening them.
fn by_vtk(result: &Path) -> Value {
    let scripts = Path::new(env!("CARGO_MANIFEST_DIR")).join("scripts/readers");
    let output = Command::new(scripts.join("python"))
        .args([&scripts.join("fields.py"), result])
        .stderr(Stdio::inherit())
        .output()
        .expect("bash starts");
    assert!(output.status.success(), "{output:?}");
    serde_json::from_slice(&output.stdout).unwrap_or_else(|error| panic!("{error}: {output:?}"))
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("no number: {value}"))
}

/// A test case: overrides, localisation, the mesh file if there is one, and VTK's type of the cells.
type Case = (&'static str, &'static str, Option<(Shape, usize)>, u64);

const SIZE: [f64; 3] = [0.5, 0.4, 0.05];

/// VTK reads the same data as the series, for every kind of body and of time integration. There is one frame for every
/// fifth time step, at its time. The bounds and the volume are taken from the whole undeformed body. Under a point
/// force, no point deflects more than the loaded one, whose deflection is in the series. With a patch the same holds
/// except for the dent of the patch.
fn vtk_reads_what_the_series_tells() {
    let scene = plate(&format!("size = {SIZE:?}"), "end = 1e-3", &sides(1e9, 0.0)) + "[output]\nfields = 5\n";
    let folder = folder(&scene);
    let point = "--set contact.localization=point";
    let solid = "--set body.model=solid --set body.reduction=none";
    let cases: [Case; 8] = [
        ("", "", None, 12),
        ("--set body.model=kirchhoff", point, None, 12),
        ("--set body.model=solid", "", None, 12),
        ("--set body.cells=[6,6,2] --set time.step=2e-5", point, None, 29),
        ("--set body.cells=[6,6,2] --set body.order=1 --set body.symmetry=none", point, None, 12),
        ("--set body.cells=[6,6,1] --set body.model=solid --set body.reduction=20", point, None, 29),
        ("--set time.step=2e-5", point, Some((Shape::Tetrahedron, 1)), 10),
        ("--set time.step=2e-5", point, Some((Shape::Tetrahedron, 2)), 24),
    ];
    for (number_of_case, (overrides, localization, mesh, cell_type)) in cases.into_iter().enumerate() {
        let mut line = format!("run scene.toml -o out.h5 {overrides} {localization}");
        if let Some((shape, order)) = mesh {
            fs::write(folder.path().join("bricks.msh"), bricks::bricks(shape, SIZE, [6, 4, 2], 0.0)).unwrap();
            line += &format!(
                " --set body.size= --set body.mesh=bricks.msh --set body.order={order} --set impactor.point=[0,0,0.025]"
            );
        }
        if overrides.contains("time.step") || overrides.contains("order=1") {
            line += &format!(" {solid}");
        }
        good(&folder, [0, 2][number_of_case % 2], &line);
        let result = folder.path().join("out.h5");
        let (time, deflection) = (column(&result, "time"), column(&result, "contact/surface_displacement"));
        let ways = by_vtk(&result);
        for way in ["result", "vtkhdf", "xdmf"] {
            let frames = ways[way].as_array().unwrap_or_else(|| panic!("{way}: {ways}"));
            assert_eq!(frames.len(), (time.len() - 1) / 5 + 1, "{line}: {way}");
            for (n, frame) in frames.iter().enumerate() {
                // The XDMF file has the time as text.
                assert!((number(&frame["time"]) - time[5 * n]).abs() <= 1e-15 * time[5 * n], "{way}: {frame}");
                for axis in 0..3 {
                    let bounds = [0, 1].map(|end| number(&frame["bounds"][2 * axis + end]));
                    assert!((0..2).all(|i| (bounds[i] + [0.5, -0.5][i] * SIZE[axis]).abs() < 1e-12), "{way}: {frame}");
                }
                assert!((number(&frame["volume"]) / SIZE.iter().product::<f64>() - 1.0).abs() < 1e-9, "{way}: {frame}");
                assert_eq!(frame["cell_type"], cell_type, "{way}");
                let down = -number(&frame["least"]["displacement"][2]);
                let up = number(&frame["largest"]["displacement"][2]);
                let felt = deflection[5 * n];
                let largest = deflection.iter().fold(0.0_f64, |m, u| m.max(u.abs()));
                // The tolerance depends on the localisation. A patch gives a mean deflection, and the part that a wide
                // disc does not resolve is in the contact law. On a mesh without symmetry, a point next to the loaded
                // one may deflect more.
                let dent = if localization.is_empty() {
                    0.03
                } else if mesh.is_some() {
                    1e-3
                } else {
                    1e-12
                };
                if n > 0 && felt > 0.5 * largest {
                    assert!(
                        (down - felt).abs() < dent * largest,
                        "{line}: {way}: {felt:e} under the impactor, {down:e} of {frame}"
                    );
                }
                assert!(down.max(up) < 1.5 * largest, "{line}: {way}: {frame}");
                let [least, most] = ["least", "largest"].map(|end| &frame[end]["principal_stress"]);
                assert!(number(&most[0]) >= number(&most[1]) && number(&least[1]) >= number(&least[2]), "{frame}");
            }
            let peak = frames.iter().map(|frame| number(&frame["largest"]["principal_stress"][0])).fold(0.0, f64::max);
            assert!(peak > 1e6, "{line}: {way}: {peak:e} Pa");
        }
        // All ways of opening give the same data; then the units are checked.
        assert_eq!(ways["result"], ways["vtkhdf"]);
        let file = results::open(&result);
        for (field, units) in [("displacement", "m"), ("velocity", "m/s"), ("principal_stress", "Pa")] {
            let dataset = file.dataset(&format!("fields/PointData/{field}")).unwrap();
            assert_eq!(text(&dataset, "units"), units);
        }
    }
}

/// Fields near the impact point agree with probes, for every kind of body, because they include the local field of the
/// contact: on both faces under the impact point, and away from it. Without the local field they would differ by a
/// tenth and more below, and by the contact pressure above. The remaining difference is rounding.
fn fields_near_the_hit_are_what_probes_read() {
    let points = [[0.0, 0.0, -0.025], [0.0, 0.0, 0.025], [0.25, 0.2, -0.025]];
    let probes = points.iter().enumerate().map(|(n, point)| format!("{{ name = \"{n}\", point = {point:?} }}"));
    let scene = plate(&format!("size = {SIZE:?}"), "end = 2e-4", &sides(1e9, 0.0))
        + &format!("[output]\nfields = 3\nprobes = [{}]\n", probes.collect::<Vec<_>>().join(", "));
    let folder = folder(&scene);
    let mesh = "--set body.model=solid --set body.reduction=none --set body.cells=[8,8,2] --set time.step=1e-5";
    for overrides in ["--set body.model=mindlin", "--set body.model=solid", mesh] {
        good(&folder, 0, &format!("run scene.toml -o out.h5 --force {overrides}"));
        let file = results::open(folder.path().join("out.h5"));
        let read = |name: &str| file.dataset(name).unwrap().read_raw::<f64>().unwrap();
        let (places, stresses) = (read("fields/Points"), read("fields/PointData/principal_stress"));
        let frames = stresses.len() / places.len();
        let mut most = 0.0_f64;
        for (n, point) in points.iter().enumerate() {
            let is_here = |place: &&[f64]| (0..3).all(|i| (place[i] - point[i]).abs() < 1e-9);
            let number = places.chunks_exact(3).position(|place| is_here(&place)).expect("a point of the grid");
            let of_probe = read(&format!("series/probe/{n}/principal_stress"));
            for frame in 0..frames {
                let of_field = &stresses[3 * (frame * places.len() / 3 + number)..][..3];
                let of_probe = &of_probe[3 * 3 * frame..][..3];
                let scale = of_probe.iter().fold(1e5_f64, |most, stress| most.max(stress.abs()));
                assert!((0..3).all(|i| (of_field[i] - of_probe[i]).abs() < 1e-9 * scale), "{overrides} {n} {frame}");
                most = most.max(of_probe[0]);
            }
        }
        assert!(frames > 3 && most > 1e6, "{overrides}: {frames} frames, {most:e} Pa");
    }
}

/// Fields do not depend on the partition: points, cells and values are the same on any number of ranks.
fn ranks_write_the_same_fields() {
    let scene = BOX.replace("order = 1", "order = 2").replace("[4, 4, 1]", "[6, 5, 1]") + "[output]\nfields = 10\n";
    let folder = folder(&scene);
    let read = |ranks: usize| {
        good(&folder, ranks, &format!("run scene.toml -o {ranks}.h5"));
        let file = results::open(folder.path().join(format!("{ranks}.h5")));
        let reals =
            ["Points", "PointData/displacement", "PointData/velocity", "PointData/principal_stress", "Steps/Values"]
                .map(|name| file.dataset(&format!("fields/{name}")).unwrap().read_raw::<f64>().unwrap());
        (reals, file.dataset("fields/Connectivity").unwrap().read_raw::<i64>().unwrap())
    };
    let (alone, cells) = read(0);
    assert_eq!((alone[0].len() / 3, cells.len(), alone[4].len()), (13 * 11 * 3, 27 * 30, 6));
    for ranks in [2, 3] {
        let (others, other_cells) = read(ranks);
        assert_eq!(cells, other_cells);
        for (a, b) in alone.iter().zip(&others) {
            // Same tolerance as for the series: the residual's tolerance, and rounding that bending amplifies.
            assert!(difference(a, b) < 1e-7, "{ranks}");
        }
    }
}

/// After a kill at any moment both files can be read, and the fields have all frames that they announce.
fn a_kill_leaves_fields_that_can_be_read() {
    let scene = long().replace("end = 10", "end = 1")
        + "[output]\nfields = 2\nprobes = [{ name = \"a\", point = [0.1, 0, -0.01] }]\n";
    for delay in [0, 400, 1100, 1900] {
        let folder = folder(&scene);
        let mut command = ricochet(folder.path(), 0);
        let mut child =
            command.args(words("run scene.toml")).stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap();
        let (result, begin) = (folder.path().join("scene.h5"), std::time::Instant::now());
        while !result.exists() {
            assert!(begin.elapsed() < LIMIT);
            std::thread::sleep(std::time::Duration::from_millis(5));
        }
        std::thread::sleep(std::time::Duration::from_millis(delay));
        assert!(children(child.id()).is_empty());
        send("KILL", &child.id().to_string());
        child.wait().unwrap();
        let rows = column(&result, "time").len();
        let file = results::open(&result);
        assert!(file.dataset("series/probe/a/principal_stress").unwrap().shape()[0] >= rows && rows > 0);
        let steps = file.group("fields/Steps").unwrap().attr("NSteps").unwrap().read_scalar::<i64>().unwrap() as usize;
        let times = file.dataset("fields/Steps/Values").unwrap().read_raw::<f64>().unwrap();
        let values = file.dataset("fields/PointData/velocity").unwrap();
        println!("after {delay} ms: {rows} rows, {steps} frames");
        assert!(steps > 0 && times.len() == steps && values.shape() == [steps * 162, 3]);
        assert!(times.iter().enumerate().all(|(n, t)| (t - 4e-5 * n as f64).abs() < 1e-12));
        let last = values.read_raw::<f64>().unwrap();
        assert!(last[(steps - 1) * 162 * 3..].iter().any(|v| *v != 0.0) || steps == 1);
    }
}

/// Fields whose file names conflict with the result, or that cannot be written, are refused before anything is
/// computed.
fn names_that_fields_cannot_have() {
    let folder = folder(&(BOX.to_owned() + "[output]\nfields = 10\n"));
    fs::create_dir(folder.path().join("taken.xdmf")).unwrap();
    for (name, said) in [
        ("out.vtkhdf", "out.vtkhdf: is a name for what goes with a result"),
        ("out.xdmf", "out.xdmf: is a name for what goes with a result"),
        ("out.checkpoint.h5", "out.checkpoint.h5: is a name for what goes with a result"),
        ("taken.h5", "taken.xdmf: is a folder"),
    ] {
        let outcome = run(ricochet(folder.path(), 2).args(words(&format!("run scene.toml -o {name}"))));
        assert_eq!(outcome.status, Some(4), "{outcome:#?}");
        assert!(outcome.stderr.contains(said), "{outcome:#?}");
        assert!(!folder.path().join(name).exists());
    }
}
