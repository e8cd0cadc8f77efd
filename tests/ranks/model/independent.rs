//! Results with default settings are compared with solids computed without this program: tests/fixtures/independent.

use crate::glass;
use mpi_test::{Test, tests};

use crate::glass::{scene, sides};
use crate::modelled::{Ran, run};
use petsc_wrap::{Comm, Session};
use ricochet::model::name;

pub const RANKS: &[usize] = &[1];
pub const TESTS: &[Test<Session>] = tests![
    the_spline_is_of_fourth_order,
    default_answers_are_within_their_tolerance,
    straight_lines_between_rows_are_within_the_tolerance
];

pub const FOLDER: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/fixtures/independent");

/// An impact of the fixture.
struct Case {
    /// Name of the fixture's file, without its extension.
    name: &'static str,
    size: &'static str,
    /// Stiffness of the supports of all sides, N/m³.
    stiffness: f64,
    /// Impact point on the top.
    point: &'static str,
}

const CASES: [Case; 8] = [
    Case { name: "plate100-k0", size: "[1.5, 1.5, 0.1]", stiffness: 0.0, point: "[0.0, 0.0, 0.05]" },
    Case { name: "plate100-k1e9", size: "[1.5, 1.5, 0.1]", stiffness: 1e9, point: "[0.0, 0.0, 0.05]" },
    Case { name: "plate40-k0", size: "[1.5, 1.5, 0.04]", stiffness: 0.0, point: "[0.0, 0.0, 0.02]" },
    Case { name: "plate40-k1e9", size: "[1.5, 1.5, 0.04]", stiffness: 1e9, point: "[0.0, 0.0, 0.02]" },
    Case { name: "plate40-k1e9-off", size: "[1.5, 1.5, 0.04]", stiffness: 1e9, point: "[0.3, 0.2, 0.02]" },
    Case { name: "plate20-k0", size: "[0.5, 0.5, 0.02]", stiffness: 0.0, point: "[0.0, 0.0, 0.01]" },
    Case { name: "plate20-k1e9", size: "[0.5, 0.5, 0.02]", stiffness: 1e9, point: "[0.0, 0.0, 0.01]" },
    Case { name: "plate20-k0-off", size: "[0.5, 0.5, 0.02]", stiffness: 0.0, point: "[0.1, 0.0, 0.01]" },
];

/// A time history of the fixture, as a natural cubic spline through its rows.
pub struct History {
    times: Vec<f64>,
    accelerations: Vec<f64>,
    /// Second derivatives at the rows.
    curvatures: Vec<f64>,
}

impl History {
    fn read(name: &str) -> Self {
        let (times, accelerations) = numbers(&format!("{FOLDER}/{name}.csv"), |fields| (fields[0], fields[1]));
        Self::new(times, accelerations)
    }

    /// Solves for the curvatures by elimination: the matrix has three diagonals and is diagonally dominant.
    pub fn new(times: Vec<f64>, accelerations: Vec<f64>) -> Self {
        let rows = times.len();
        let width = |row: usize| times[row + 1] - times[row];
        let slope = |row: usize| (accelerations[row + 1] - accelerations[row]) / width(row);
        let (mut ratios, mut curvatures) = (vec![0.0; rows], vec![0.0; rows]);
        for row in 1..rows - 1 {
            let diagonal = 2.0 * (width(row - 1) + width(row)) - width(row - 1) * ratios[row - 1];
            ratios[row] = width(row) / diagonal;
            curvatures[row] = (6.0 * (slope(row) - slope(row - 1)) - width(row - 1) * curvatures[row - 1]) / diagonal;
        }
        for row in (1..rows - 1).rev() {
            curvatures[row] -= ratios[row] * curvatures[row + 1];
        }
        Self { times, accelerations, curvatures }
    }

    pub fn at(&self, time: f64) -> f64 {
        let next = self.times.partition_point(|row| *row <= time).clamp(1, self.times.len() - 1);
        let width = self.times[next] - self.times[next - 1];
        let after = (time - self.times[next - 1]) / width;
        [(next - 1, 1.0 - after), (next, after)]
            .map(|(row, part)| {
                part * self.accelerations[row] + (part.powi(3) - part) * width * width / 6.0 * self.curvatures[row]
            })
            .iter()
            .sum()
    }

    fn peak(&self) -> f64 {
        self.accelerations.iter().copied().fold(0.0, f64::max)
    }

    /// Largest difference over the peak, at the time steps of a run. The rows end shortly after the first contact.
    fn difference(&self, ran: &Ran) -> f64 {
        let steps = ran.steps.iter().filter(|step| step.time <= self.times[self.times.len() - 1]);
        steps.map(|step| (self.at(step.time) - step.impactor.acceleration).abs()).fold(0.0, f64::max) / self.peak()
    }

    /// The same of straight lines between the time steps, at the rows of the fixture.
    fn difference_of_lines(&self, ran: &Ran) -> f64 {
        let rows = self.times.iter().zip(&self.accelerations);
        rows.map(|(time, exact)| (ran.at(*time) - exact).abs()).fold(0.0, f64::max) / self.peak()
    }
}

/// Two columns of a table with one header line.
fn numbers(path: &str, columns: impl Fn(&[f64]) -> (f64, f64)) -> (Vec<f64>, Vec<f64>) {
    let text = std::fs::read_to_string(path).unwrap_or_else(|error| panic!("{path}: {error}"));
    text.lines()
        .skip(1)
        .map(|line| columns(&line.split(',').map(|field| field.parse().expect("a number")).collect::<Vec<f64>>()))
        .unzip()
}

/// The fixture's own error over the peak: the last column of its table.
fn own_error(name: &str) -> f64 {
    let path = format!("{FOLDER}/errors.csv");
    let text = std::fs::read_to_string(&path).unwrap_or_else(|error| panic!("{path}: {error}"));
    let row = text.lines().find(|line| line.split(',').next() == Some(name));
    let last = row.and_then(|line| line.rsplit(',').next()).unwrap_or_else(|| panic!("{path} lacks {name}"));
    last.parse().expect("a number")
}

/// sin² has a curvature of ½ at the ends, not zero as a natural spline assumes. In the middle the spline converges with
/// h⁴. The bounds 15 and 17 around 16 allow for the next term.
fn the_spline_is_of_fourth_order(_: &Session) {
    let error = |rows: u32| {
        let times: Vec<f64> = (0..=rows).map(|row| std::f64::consts::PI * f64::from(row) / f64::from(rows)).collect();
        let history = History::new(times.clone(), times.iter().map(|time| time.sin().powi(2)).collect());
        (0..200).map(|i| 1.2 + f64::from(i) * 4e-3).map(|t| (history.at(t) - t.sin().powi(2)).abs()).fold(0.0, f64::max)
    };
    let [coarse, fine] = [40, 80].map(error);
    println!("  {coarse:.2e}, {fine:.2e}");
    assert!((15.0..17.0).contains(&(coarse / fine)), "{coarse:e}, {fine:e}");
}

/// Runs a scene that has only keys without defaults.
fn default_answer(comm: &Comm, case: &Case, end: f64, tolerance: f64) -> Ran {
    let impactor = format!("mass = {}\nspeed = 1.0\npoint = {}", glass::MASS, case.point);
    let support = if case.stiffness > 0.0 { sides(case.stiffness, 0.0) } else { String::new() };
    let rest = format!("[accuracy]\ntolerance = {tolerance:e}\n{support}");
    run(comm, &scene(&format!("size = {}", case.size), &impactor, &format!("end = {end:e}"), &rest))
}

/// Also prints the table of docs/costs.md.
fn default_answers_are_within_their_tolerance(session: &Session) {
    let comm = session.world();
    println!("| case | fixture's own error | tolerance | theory | estimated error | difference |");
    println!("| --- | --- | --- | --- | --- | --- |");
    let mut missed = Vec::new();
    for case in &CASES {
        let (history, own) = (History::read(case.name), own_error(case.name));
        let end = history.times[history.times.len() - 1];
        for tolerance in [1e-2, 1e-3] {
            let ran = default_answer(&comm, case, end, tolerance);
            let difference = history.difference(&ran);
            println!(
                "| {} | {own:.1e} | {tolerance:.0e} | {} | {:.1e} | {difference:.1e} |",
                case.name,
                name(ran.theory),
                ran.error
            );
            let lines = history.difference_of_lines(&ran);
            if difference.max(lines) > tolerance + own {
                missed.push(format!("{} at {tolerance:e}: {difference:e}, straight lines {lines:e}", case.name));
            }
        }
    }
    assert!(missed.is_empty(), "{missed:?}");
}

/// A thin pane under a steel ball, whose force rises in a tenth of the contact; the same with a damped contact. Straight
/// lines between the rows of a run with the default tolerance differ by less than this from a run with a tenth of it,
/// whose own error is about a tenth.
fn straight_lines_between_rows_are_within_the_tolerance(session: &Session) {
    for damping in [0.0, 0.05] {
        let ran = |tolerance: f64| {
            let impactor = "mass = 4.11\nspeed = 7.672";
            let rest = format!("[accuracy]\ntolerance = {tolerance:e}\n[contact]\ndamping = {damping}\n");
            run(&session.world(), &scene("size = [0.7, 0.7, 0.008]", impactor, "end = 9e-5", &rest))
        };
        let (ran, finer) = (ran(1e-2), ran(1e-3));
        let off = (0..=9000).map(|n| 1e-8 * f64::from(n)).map(|time| (ran.at(time) - finer.at(time)).abs());
        let off = off.fold(0.0, f64::max) / finer.peak();
        println!("  damping {damping}: {} rows, {off:.1e}", ran.steps.len());
        assert!(off < 1e-2, "damping {damping}: {off:e}");
    }
}
