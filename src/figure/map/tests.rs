//! Tests of the colours, limits and cells of heat maps.

use super::*;

#[test]
fn colours_darken_with_the_value_and_end_with_the_scale() {
    let light = |value: f64| {
        let RGBColor(r, g, b) = colour(value);
        0.3 * f64::from(r) + 0.6 * f64::from(g) + 0.1 * f64::from(b)
    };
    let shades: Vec<f64> = (-60..=0).map(|n| light(10_f64.powf(0.1 * f64::from(n)))).collect();
    assert!(shades.windows(2).all(|pair| pair[1] < pair[0]));
    assert_eq!((light(0.0), light(1e-9)), (shades[0], shades[0]));
    assert_eq!((light(f64::INFINITY), light(f64::NAN)), (shades[60], shades[60]));
}

/// A limit within the axis is drawn as a line, a limit beyond it as an arrow, and no limit as neither.
#[test]
fn limits_are_drawn_where_they_are() {
    let cell = |step| Cell { step, values: vec![Value::Number(0.1)], is_good: true };
    let row = |limit| Row { label: "scheme".into(), note: String::new(), limit, cells: [1e-5, 1e-4].map(cell).into() };
    let thick = |limits: &[f64], width: &str| {
        let map = Map {
            title: "plate".into(),
            panels: vec!["error".into()],
            rows: limits.iter().copied().map(row).collect(),
            contact: 1e-3,
            marks: vec![(1e-9, "too short".into())],
            good: "good".into(),
        };
        let folder = tempfile::tempdir().unwrap();
        let out = folder.path().join("map.svg");
        draw(&map, &out).unwrap();
        let svg = std::fs::read_to_string(&out).unwrap();
        assert!(!svg.contains("too short"));
        svg.matches(&format!("stroke-width=\"{width}\"")).count()
    };
    let (lines, arrows) = ("25", "20");
    // Including the line in the legend.
    assert_eq!((thick(&[3e-5], lines), thick(&[3e-5], arrows)), (2, 0));
    // An arrow consists of two strokes.
    for limit in [1e-9, 1e-6, 1e-2] {
        assert_eq!((thick(&[limit], lines), thick(&[limit], arrows)), (0, 4), "{limit}");
    }
    for limit in [0.0, f64::INFINITY] {
        assert_eq!((thick(&[limit], lines), thick(&[limit], arrows)), (0, 0), "{limit}");
    }
}

#[test]
fn cells_meet_their_near_neighbours_and_stay_apart_from_far_ones() {
    let cell = |step| Cell { step, values: vec![Value::Number(0.1)], is_good: true };
    let cells = [1.0, 1.2, 2.0, 16.0].map(cell).into();
    let row = Row { label: String::new(), note: String::new(), limit: 0.0, cells };
    let extents: Vec<_> = (0..4).map(|n| row.extent(n)).collect();
    assert_eq!(extents[0], (1.0 / REACH, 1.2_f64.sqrt()));
    assert_eq!((extents[0].1, extents[1].1), (extents[1].0, extents[2].0));
    assert_eq!((extents[2].1, extents[3].0), (2.0 * REACH, 16.0 / REACH));
}
