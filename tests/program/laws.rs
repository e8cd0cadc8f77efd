//! Tests of contact laws given by a user.

use crate::program::{ricochet, run};
use crate::results::{column, difference, folder, good, open, text, words};
use crate::sweeps::members;
use mpi_test::{PlainTest, tests};

pub const TESTS: &[PlainTest] = tests![
    a_table_comes_from_a_file_and_stays_in_the_result,
    springs_much_stiffer_than_the_body_have_one_answer,
    tables_of_other_units_are_told,
    laws_are_swept,
    areas_are_swept_and_shown,
    a_member_beyond_its_table_leaves_the_others
];

/// A pane under a soft impactor, with a tabulated law.
const SOFT: &str = "[body]\nmodel = \"mindlin\"\nreduction = 10\nyoung = 70e9\npoisson = 0.23\ndensity = 2500.0\n\
                    size = [1.0, 1.0, 0.02]\n[impactor]\nmass = 50.0\nspeed = 1.0\n[contact]\nlaw = \"table\"\n\
                    table = \"curves/tyre.csv\"\n[time]\nend = 0.01\nstep = 1e-4\n";

/// A folder with the scene and its table file, of F = 2e5 α from 0 to `end`. `units` are the table's units in m and in
/// N.
fn with_table(end: f64, units: [f64; 2]) -> tempfile::TempDir {
    let folder = folder(SOFT);
    let points =
        (0..=5).map(|i| 0.2 * end * f64::from(i)).map(|x| format!("{},{}\n", x / units[0], 2e5 * x / units[1]));
    std::fs::create_dir(folder.path().join("curves")).unwrap();
    let table = format!("indentation (m),force (N)\n{}", points.collect::<String>());
    std::fs::write(folder.path().join("curves/tyre.csv"), table).unwrap();
    folder
}

/// All ranks find the table file next to the scene. The result can be repeated without the file, with the same bits.
fn a_table_comes_from_a_file_and_stays_in_the_result() {
    let folder = with_table(0.1, [1.0; 2]);
    for ranks in [0, 2] {
        good(&folder, ranks, "run scene.toml -o table.h5 --force");
        good(
            &folder,
            ranks,
            "run scene.toml -o spring.h5 --force --set contact={law=\"power\",stiffness=2e5,exponent=1}",
        );
        let [table, spring] =
            ["table.h5", "spring.h5"].map(|name| column(&folder.path().join(name), "impactor/acceleration"));
        // A table with points on a line is the line, except for rounding.
        assert!(difference(&table, &spring) < 1e-9 && table.iter().any(|a| *a > 1.0));
    }
    std::fs::remove_dir_all(folder.path().join("curves")).unwrap();
    good(&folder, 0, "run table.h5 -o again.h5");
    let [table, again] =
        ["table.h5", "again.h5"].map(|name| column(&folder.path().join(name), "impactor/acceleration"));
    assert!(difference(&table, &again) < 1e-9);
    let scene = text(&open(folder.path().join("again.h5")), "scene");
    assert!(scene.contains("table = [[0.0, 0.0], [0.02"), "{scene}");
    let outcome = run(ricochet(folder.path(), 2).args(words("run scene.toml -o none.h5")));
    assert_eq!(outcome.status, Some(2), "{outcome:?}");
    assert!(outcome.stderr.matches("tyre.csv cannot be read").count() == 1 && outcome.stderr.contains("contact.table"));
}

/// The steps of a power law are solved for the indentation, those of a table for the approach. With a spring that is much
/// stiffer than the body, indentations do not converge. (The run then ended, or took 200,000 steps.)
fn springs_much_stiffer_than_the_body_have_one_answer() {
    let folder = folder(
        "[body]\nyoung = 70e9\npoisson = 0.23\ndensity = 2500.0\nsize = [0.5, 0.5, 0.02]\nmodel = \"solid\"\n\
         cells = [8, 8, 2]\norder = 2\nreduction = 40\n[impactor]\nmass = 2.0\nspeed = 1.0\n\
         [contact]\nlocalization = \"point\"\nlaw = \"power\"\nstiffness = 1e12\nexponent = 1\n\
         [time]\nend = 3e-3\nstep = 5e-5\nscheme = \"modal\"\n",
    );
    good(&folder, 0, "run scene.toml -o power.h5 --force");
    let law = "contact={localization=\"point\",law=\"table\",table=[[0,0],[1e-6,1e6]]}";
    good(&folder, 0, &format!("run scene.toml -o table.h5 --force --set {law}"));
    let [power, table] =
        ["power.h5", "table.h5"].map(|name| column(&folder.path().join(name), "impactor/acceleration"));
    // Both stop at rounding of δ, which the stiff spring turns into a force: 1e12 N/m times 1e-16 of some millimetres.
    assert!(power.len() < 100 && difference(&power, &table) < 1e-6, "{} {}", power.len(), table.len());
}

/// A table in wrong units is noticed. With mm for m, or N for kN, the impact uses a small part of the table, and there
/// is a warning. With m for mm, or kN for N, the table is too short for the impact and is refused.
fn tables_of_other_units_are_told() {
    for units in [[1e-3, 1.0], [1.0, 1e-3]] {
        let said = good(&with_table(0.1, units), 0, "check scene.toml");
        assert!(
            said.stdout.contains("is the table in m and N?") || said.stderr.contains("is the table in m and N?"),
            "{said:?}"
        );
    }
    for units in [[1e3, 1.0], [1.0, 1e3]] {
        let folder = with_table(0.03, units);
        let outcome = run(ricochet(folder.path(), 0).args(words("check scene.toml")));
        assert_eq!(outcome.status, Some(2), "{outcome:?}");
        assert!(outcome.stderr.contains("and the impactor has 2.500e1 J"), "{outcome:?}");
    }
    // The table is too short for an impact on a rigid wall. `check` warns of this, and a run stops if the pane does not
    // yield enough.
    let said = good(&with_table(0.01, [1.0; 2]), 0, "check scene.toml");
    assert!(said.stdout.contains("contact.table ends at an indentation of 0.01 m"), "{said:?}");
    let folder = with_table(0.004, [1.0; 2]);
    let outcome = run(ricochet(folder.path(), 0).args(words("run scene.toml -o out.h5")));
    assert_eq!(outcome.status, Some(3), "{outcome:?}");
    assert!(outcome.stderr.contains("the end of contact.table"), "{outcome:?}");
}

/// A key of the law can be varied in a sweep like any other key.
fn laws_are_swept() {
    let folder = with_table(0.1, [1.0; 2]);
    good(&folder, 0, "sweep scene.toml --vary contact.damping=0,0.5,1 -o s.h5");
    let rebound = members(&folder.path().join("s.h5"), "peak_acceleration");
    // More damping stops the impactor sooner.
    assert!(rebound.windows(2).all(|two| two[0] < two[1]), "{rebound:?}");
}

/// A wider area moves the mean of the surface less, so that the force is larger. `check` and the report name the area; closed
/// formulas refuse it.
fn areas_are_swept_and_shown() {
    let folder = folder(SOFT);
    std::fs::create_dir(folder.path().join("curves")).unwrap();
    std::fs::write(folder.path().join("curves/tyre.csv"), "indentation (m),force (N)\n0,0\n0.1,1e5\n").unwrap();
    good(
        &folder,
        0,
        "sweep scene.toml --set contact.area={radius=0.1} --vary contact.area.radius=0.02,0.1,0.3 -o s.h5",
    );
    let peaks = members(&folder.path().join("s.h5"), "peak_force");
    assert!(peaks.windows(2).all(|two| 1.0005 * two[0] < two[1]), "{peaks:?}");
    let shown = good(&folder, 0, "check scene.toml --set contact.area={square=0.2}");
    assert!(shown.stdout.contains("presses evenly on a square of 0.2 m"), "{shown:?}");
    good(&folder, 0, "run scene.toml --set contact.area={square=0.2} -o a.h5");
    good(&folder, 0, "report a.h5 -o a.html");
    let page = std::fs::read_to_string(folder.path().join("a.html")).unwrap();
    assert!(page.contains("presses evenly on a square of 0.2 m"));
    let line =
        "run scene.toml --set contact.area={square=0.2} --set body.model=half-space --set body.reduction= -o b.h5";
    let outcome = run(ricochet(folder.path(), 0).args(words(line)));
    assert_eq!(outcome.status, Some(2), "{outcome:?}");
    assert!(outcome.stderr.contains("contact.area is given"), "{outcome:?}");
}

/// A member whose law ends fails already when `auto` chooses the theory for all members. The others are computed.
fn a_member_beyond_its_table_leaves_the_others() {
    let folder = with_table(0.004, [1.0; 2]);
    let line = "sweep scene.toml --set body.model=auto --set body.reduction= --vary impactor.speed=0.1,0.2,1 -o s.h5";
    let outcome = run(ricochet(folder.path(), 0).args(words(line)));
    assert_eq!(outcome.status, Some(3), "{outcome:?}");
    assert!(outcome.stdout.contains("the end of contact.table"), "{outcome:?}");
    let file = folder.path().join("s.h5");
    assert_eq!(members(&file, "status"), [1.0, 1.0, 2.0]);
    let peaks = members(&file, "peak_force");
    assert!(peaks[0] > 0.0 && peaks[1] > 1.5 * peaks[0] && peaks[2].is_nan(), "{peaks:?}");
}
