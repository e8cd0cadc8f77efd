//! Tests of the search against a search point by point.

use std::f64::consts::FRAC_PI_2;

use super::*;
use crate::form::Spread;
use crate::form::spline::WIDTH;
use crate::space::evaluate::{AtPlace, Face, FaceGrid, FaceLines, LinePart, Lines, LocalPoint, Map, StressMap};
use crate::stack::{Carrier, Layer, LocalField, Pressure, Stack};

/// Pseudo-random numbers between −1 and 1.
struct Numbers(u64);

impl Numbers {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(0x5851_f42d_4c95_7f2d).wrapping_add(0x1405_7b7e_f767_814f);
        (self.0 >> 33) as f64 / f64::from(1_u32 << 30) - 1.0
    }
}

const COUNT: usize = 37;
const LINES: usize = 19;

/// A plate with bending stresses that vary over a face, impacted at the corner of its quarter. Stresses are symmetric
/// in x and y, so that points that mirror each other have the same tension up to rounding. A soft layer also has
/// stresses across its faces.
fn plate() -> (FaceStresses, Vec<f64>) {
    let lines: Vec<f64> = (0..LINES).map(|i| 0.05 * i as f64).collect();
    let points: Vec<[f64; 3]> = lines.iter().flat_map(|a| lines.iter().map(move |b| [*a, *b, 0.05])).collect();
    let layer = Layer { thickness: 0.1, young: 70e9, poisson: 0.23 };
    let pressure = Pressure::Spread { spread: Spread::new(0.0), radius: 0.1 };
    let carrier = Carrier::Plate { pressure };
    let field = LocalField::new(Stack::new(&[layer]).expect("an elastic layer"), carrier, 0.04);
    let near = |point: &[f64; 3], depth: f64| {
        let radius = point[0].hypot(point[1]);
        let radial = if radius > 0.0 { [point[0] / radius, point[1] / radius, 0.0] } else { [1.0, 0.0, 0.0] };
        (radius < 0.2).then(|| LocalPoint::new(field.at(radius, depth), radial, [0.0, 0.0, -1.0]).without_ring())
    };
    let mut numbers = Numbers(7);
    let waves: Vec<[f64; 3]> =
        (0..COUNT).map(|_| [8.0 * numbers.next(), 8.0 * numbers.next(), 1e9 * numbers.next()]).collect();
    let row = |x: &[f64; 3], component: usize| -> Vec<f64> {
        let of_wave = |[p, q, size]: &[f64; 3]| {
            let along = |a: f64, b: f64| (p * a).cos() * (q * b).cos();
            let twist = (p * x[0]).sin() * (q * x[1]).sin() + (p * x[1]).sin() * (q * x[0]).sin();
            match component {
                0 => size * (along(x[0], x[1]) + 0.3 * along(x[1], x[0])),
                1 => size * (along(x[1], x[0]) + 0.3 * along(x[0], x[1])),
                2 => 0.4 * size * twist,
                3 => 0.5 * size * (p * x[0]).sin() * (q * x[1]).cos(),
                4 => 0.5 * size * (p * x[1]).sin() * (q * x[0]).cos(),
                _ => 0.2 * size * along(x[0], x[1]) * along(x[1], x[0]),
            }
        };
        waves.iter().map(of_wave).collect()
    };
    let rows_of = |components: std::ops::Range<usize>| {
        let of_point = move |x| components.clone().flat_map(|component| row(x, component)).collect::<Vec<_>>();
        points.iter().flat_map(of_point).collect::<Vec<f64>>()
    };
    let rows = [rows_of(0..3), rows_of(3..6)].concat();
    let face = |name: &str, sign: f64, depth: f64| Face {
        name: name.to_owned(),
        first: 0,
        across: name.starts_with('2').then_some(points.len()),
        local: points.iter().enumerate().filter_map(|(i, x)| Some((i, near(x, depth)?))).collect(),
        left_out: points.iter().map(|x| (0.0..0.08).contains(&(x[0].hypot(x[1]) - 1e-9))).collect(),
        sign,
        grid: Some(FaceGrid { axes: [0, 1], lines: [lines.clone(), lines.clone()], is_mirrored: [true; 2] }),
        points: points.clone(),
    };
    let faces = [("1-upper", -1.0, 0.0), ("2-upper", -1.0, 0.04), ("2-lower", 1.0, 0.06), ("3-lower", 1.0, 0.1)];
    let faces = faces.into_iter().map(|(name, sign, depth)| face(name, sign, depth)).collect();
    let map = StressMap::Forms { map: Map::Dense(COUNT, rows.clone()), components: 3 };
    (FaceStresses::new(map, faces), rows)
}

/// Coordinates of steps (of all magnitudes, all zero, or only one non-zero), with forces from zero to the main part of
/// the stress.
fn steps() -> (Vec<f64>, Vec<ContactNow>) {
    let mut numbers = Numbers(11);
    let (mut coordinates, mut contacts) = (Vec::new(), Vec::new());
    for step in 0..300 {
        let size = match step % 7 {
            0 => 0.0,
            1 => 1e-60,
            2 => 1e-9,
            _ => 1.0,
        };
        for coordinate in 0..COUNT {
            let is_there = step % 7 != 3 || coordinate == step % COUNT;
            // A number is drawn whether or not the coordinate is used.
            let number = numbers.next() / (1.0 + coordinate as f64);
            coordinates.push(if is_there { size * number } else { 0.0 });
        }
        let force = if step % 3 == 0 { 0.0 } else { 1e6 * (1.0 + numbers.next()) };
        contacts.push(ContactNow { force, radius: 0.02 * (1.0 + 1.2 * numbers.next().abs()) });
    }
    (coordinates, contacts)
}

/// Sum of the magnitudes of the products in a stress of a step, at most, Pa.
fn size(rows: &[f64], of_step: &[f64]) -> f64 {
    let of_row = |row: &[f64]| row.iter().zip(of_step).map(|(a, b)| (a * b).abs()).sum::<f64>();
    rows.chunks_exact(COUNT).map(of_row).fold(0.0, f64::max)
}

/// The result agrees with a search point by point.
#[test]
fn what_is_found_is_what_a_search_of_all_points_finds() {
    let (faces, rows) = plate();
    let (coordinates, contacts) = steps();
    let search = TensionSearch::new(&faces, COUNT, &rows).expect("faces of a box");
    let found = search.tensions(&coordinates, &contacts, None).steps;
    assert_eq!(found.len(), contacts.len());
    let mut places = std::collections::BTreeSet::new();
    for (step, (found, contact)) in found.iter().zip(&contacts).enumerate() {
        let of_step = &coordinates[step * COUNT..(step + 1) * COUNT];
        let (all, _) = faces.tensions(&faces.map.apply(of_step), contact, 0.0);
        for ((one, other), face) in found.iter().zip(&all).zip(&faces.faces) {
            // Sums of some forty products in another order. With stresses across the face, the arc cosine of two equal
            // principal stresses, as under the impact point, has half of the digits.
            let digits = if face.across.is_some() { 1e-8 } else { 1e-13 };
            let rounding = digits * (size(&rows, of_step) + other.largest.abs());
            assert!((one.largest - other.largest).abs() <= rounding, "{step}: {one:?} {other:?}");
            let apart = (0..3).map(|i| (one.point[i] - other.point[i]).abs()).fold(0.0, f64::max);
            assert!(apart < 1e-9, "{step}: {one:?} {other:?}");
            // Among points that mirror each other, the one with the larger x.
            assert!(one.point[0] >= one.point[1] - 1e-9, "{step}: {one:?}");
            places.insert(one.point.map(|x| (x * 20.0).round() as i64));
        }
    }
    // Otherwise the steps would not test the search.
    assert!(places.len() > 30, "{}", places.len());
}

/// The stresses of [`plate`] on lines, with one function for each line and one crossing that is evaluated separately.
fn on_lines(rows: &[f64]) -> LineStresses {
    let points = LINES * LINES;
    let row = |point: usize, component: usize| &rows[(3 * point + component) * COUNT..][..COUNT];
    let basis: Vec<Vec<f64>> = (0..COUNT)
        .map(|i| (0..3 * points).map(|unknown| row(unknown % points, unknown / points)[i]).collect())
        .collect();
    let at_place = |first: usize| {
        let mut values = [0.0; WIDTH];
        values[0] = 1.0;
        AtPlace { first, count: 1, values }
    };
    let along: Vec<AtPlace> = (0..LINES).map(at_place).collect();
    let part = |field: usize| LinePart {
        field,
        functions: LINES,
        along: [along.clone(), along.clone()],
        flips: [false; 2],
        stresses: std::array::from_fn(|component| if component == field { 1.0 } else { 0.0 }),
    };
    let lines = Lines { places: vec![0.0; LINES], lines: (0..LINES).map(|line| (line, false)).collect() };
    let face = FaceLines {
        fields: (0..3).map(|field| field * points..(field + 1) * points).collect(),
        parts: (0..3).map(part).collect(),
        lines: [lines.clone(), lines],
    };
    let apart = (0..3).flat_map(|component| row(0, component).to_vec()).collect();
    LineStresses::new(face, vec![(0, Map::Dense(COUNT, apart))], &basis)
}

/// A search on lines finds the same as a search with rows, and the same largest tensions over time.
#[test]
fn lines_are_searched_as_rows_are() {
    let (FaceStresses { mut faces, .. }, rows) = plate();
    faces.retain(|face| face.across.is_none());
    let lines = on_lines(&rows);
    let faces = FaceStresses::new(StressMap::Lines(lines.clone()), faces);
    let (coordinates, contacts) = steps();
    let by_rows = TensionSearch::new(&faces, COUNT, &rows).expect("faces of a box");
    let sizes: Vec<f64> = coordinates.chunks(COUNT).map(|of_step| size(&rows, of_step)).collect();
    let times: Vec<f64> = (0..contacts.len()).map(|step| step as f64).collect();
    let of_lines = TensionSearch::on_lines(&faces, &lines).expect("faces of a box");
    let [of_lines, by_rows] = [of_lines, by_rows].map(|search| search.tensions(&coordinates, &contacts, None));
    for (step, (one, other)) in of_lines.steps.iter().zip(&by_rows.steps).enumerate() {
        for (one, other) in one.iter().zip(other) {
            // Sums of some forty products in another order.
            let rounding = 1e-13 * (sizes[step] + other.largest.abs());
            assert!((one.largest - other.largest).abs() <= rounding, "{step}: {one:?} {other:?}");
            let apart = (0..3).map(|i| (one.point[i] - other.point[i]).abs()).fold(0.0, f64::max);
            assert!(apart < 1e-9, "{step}: {one:?} {other:?}");
        }
    }
    let largest = sizes.iter().copied().fold(0.0, f64::max) as f32;
    let [one, other] = [of_lines.map(&times), by_rows.map(&times)].map(|map| map.tension);
    assert!(one.iter().any(|tension| *tension > 0.0));
    for (point, (one, other)) in one.iter().zip(&other).enumerate() {
        // Rounding of single precision, in which maps are kept.
        assert!(one == other || (one - other).abs() < 1e-6 * largest, "{point}: {one} {other}");
    }
}

/// The largest tension of a time history that is smooth from step to step is found by a search of few steps.
#[test]
fn some_steps_of_a_smooth_history_are_searched() {
    let (faces, rows) = plate();
    let count: u32 = 400;
    let of_step = |step: usize| {
        let time = step as f64 / f64::from(count);
        let decay = (-4.0 * time).exp();
        (0..COUNT).map(move |i| decay * ((3.0 + 2.0 * i as f64) * time + i as f64).sin() / (1.0 + i as f64).powi(3))
    };
    let coordinates: Vec<f64> = (0..count as usize).flat_map(of_step).collect();
    let contacts = vec![ContactNow::default(); count as usize];
    let search = TensionSearch::new(&faces, COUNT, rows).expect("faces of a box");
    let [all, found] = [None, Some(f64::INFINITY)].map(|least| search.tensions(&coordinates, &contacts, least));
    let [all, found] = [all, found].map(|searched| -> Vec<f64> {
        let each = searched.steps.iter().map(|faces| faces.iter().map(|face| face.largest).fold(f64::NAN, f64::max));
        each.collect()
    });
    let largest = all.iter().copied().fold(0.0, f64::max);
    assert_eq!(
        all.iter().position(|tension| *tension == largest),
        found.iter().position(|tension| *tension == largest)
    );
    let searched = found.iter().filter(|tension| !tension.is_nan()).count();
    assert!(searched < found.len() / 2, "{searched}");
}

/// A short maximum of the vibration and a short contact, both late and between the steps that are looked at first, are
/// found: the largest tension of all steps, and the first one above a smallest tension of interest.
#[test]
fn short_maxima_between_the_first_steps_are_found() {
    let (faces, rows) = plate();
    let count = 400_usize;
    let near = |step: usize, middle: f64, width: f64| ((step as f64 - middle) / width).powi(2);
    for (of_vibration, of_force) in [(1.0, 0.0), (0.05, 1e9), (1.0, 3e8)] {
        // Half a period of a sine, with its maximum of 1 at step 212, halfway between two multiples of eight; four steps away
        // it is 0.4. A slow maximum of 0.95 is therefore larger at the steps that are evaluated first.
        let short = |step: usize| (0.29 * (step as f64 - 212.0)).clamp(-FRAC_PI_2, FRAC_PI_2).cos();
        let slow = |step: usize| 0.95 * (-near(step, 320.0, 30.0)).exp();
        let size = |step: usize| of_vibration * short(step).max(slow(step));
        let of_step = |step: usize| (0..COUNT).map(move |i| size(step) * (i as f64).sin() / (1.0 + i as f64).powi(2));
        let coordinates: Vec<f64> = (0..count).flat_map(of_step).collect();
        let force = |step: usize| of_force * (1.0 - near(step, 101.0, 3.0)).max(0.0);
        let contacts: Vec<ContactNow> =
            (0..count).map(|step| ContactNow { force: force(step), radius: 0.02 }).collect();
        let search = TensionSearch::new(&faces, COUNT, &rows).expect("faces of a box");
        let all = search.tensions(&coordinates, &contacts, None);
        let largest_of = |searched: &Searched| -> Vec<f64> {
            let each =
                searched.steps.iter().map(|faces| faces.iter().map(|face| face.largest).fold(f64::NAN, f64::max));
            each.collect()
        };
        let all = largest_of(&all);
        let largest = all.iter().copied().fold(0.0, f64::max);
        for least in [f64::INFINITY, 0.7 * largest] {
            let found = largest_of(&search.tensions(&coordinates, &contacts, Some(least)));
            let first = |tensions: &[f64], level: f64| tensions.iter().position(|tension| *tension >= level);
            assert_eq!(first(&found, largest), first(&all, largest), "{of_vibration} {of_force}");
            assert_eq!(first(&found, least), first(&all, least), "{of_vibration} {of_force}");
            let searched = found.iter().filter(|tension| !tension.is_nan()).count();
            assert!(searched < count / 2, "{searched}");
        }
    }
}

/// The map holds at each point the maximum over all steps in double precision, with its time. Its largest value is the
/// largest of all steps.
#[test]
fn the_map_is_that_of_all_points_and_steps() {
    let (faces, rows) = plate();
    let (coordinates, contacts) = steps();
    let search = TensionSearch::new(&faces, COUNT, &rows).expect("faces of a box");
    let times: Vec<f64> = (0..contacts.len()).map(|step| step as f64).collect();
    let searched = search.tensions(&coordinates, &contacts, None);
    let map = searched.map(&times);
    let (mut exhaustive, mut of_steps, mut room) = (TensionMap::default(), Vec::new(), 0.0_f32);
    for (step, contact) in contacts.iter().enumerate() {
        let of_step = &coordinates[step * COUNT..(step + 1) * COUNT];
        let (_, of_step_alone) = faces.tensions(&faces.map.apply(of_step), contact, times[step]);
        // Rounding of single precision.
        room = room.max(1e-6 * size(&rows, of_step) as f32);
        exhaustive.take(&of_step_alone);
        of_steps.push(of_step_alone);
    }
    let mut near_hit = 0;
    for (point, (found, exact)) in map.tension.iter().zip(&exhaustive.tension).enumerate() {
        assert_eq!(found.is_finite(), exact.is_finite(), "{point}");
        if exact.is_finite() {
            assert!((found - exact).abs() <= room, "{point}: {found} {exact} {room}");
            // At this time the tension was equally large.
            let then = of_steps[map.time_at(point) as usize].tension[point];
            assert!((then - exact).abs() <= 2.0 * room, "{point}: {then} {exact}");
            near_hit += usize::from(faces.faces.iter().any(|face| face.local.iter().any(|(of, _)| *of == point)));
        }
    }
    assert!(near_hit > 4, "{near_hit}");
    // The map is as symmetric as the stresses, including the maxima between points.
    for (point, tension) in map.tension.iter().enumerate().filter(|(_, tension)| tension.is_finite()) {
        let (face, row, column) = (point / (LINES * LINES), point / LINES % LINES, point % LINES);
        let image = map.tension[(face * LINES + column) * LINES + row];
        assert!((tension - image).abs() <= room, "{face} {row} {column}: {tension} {image}");
    }
    let largest = |values: &mut dyn Iterator<Item = f32>| values.fold(f32::NEG_INFINITY, f32::max);
    let of_history = largest(&mut searched.steps.iter().flatten().map(|one| one.largest as f32));
    let of_map = largest(&mut map.tension.iter().copied());
    assert!((of_map - of_history).abs() <= room, "{of_map} {of_history}");
    // Otherwise the tolerance would hide errors.
    assert!(room < 1e-4 * of_history, "{room} {of_history}");
}

/// If coordinates are computed from states only at the steps that need them, the result is the same as with all
/// coordinates given.
#[test]
fn coordinates_are_made_where_they_are_wanted() {
    let (faces, _) = plate();
    let (_, contacts) = steps();
    let mut numbers = Numbers(13);
    let columns = nalgebra::DMatrix::from_fn(COUNT, 50, |_, _| numbers.next());
    let states: Vec<f64> = (0..50 * contacts.len()).map(|i| numbers.next() * (1.0 - i as f64 / 2e4)).collect();
    let search = TensionSearch::on_basis(&faces).expect("a basis");
    for least in [None, Some(f64::INFINITY)] {
        let made = Coordinates::Of { columns: &columns, states: &states };
        let given = made.all().into_owned();
        let [made, given] = [made, Coordinates::from(&given)].map(|all| search.tensions(all, &contacts, least).steps);
        let places = made.iter().flatten().zip(given.iter().flatten());
        let mut searched = 0;
        for (one, other) in places.filter(|(one, other)| !(one.largest.is_nan() && other.largest.is_nan())) {
            // Sums of fifty products, in blocks of other sizes.
            assert!((one.largest - other.largest).abs() <= 1e-12 * other.largest.abs(), "{one:?} {other:?}");
            searched += 1;
        }
        assert!(searched > 0);
    }
}
