use super::*;

/// A face with stresses at the points of a grid, without a local field.
pub fn on_grid(grid: FaceGrid, points: Vec<Vec3>) -> Face {
    Face {
        name: String::new(),
        left_out: vec![false; points.len()],
        points,
        first: 0,
        across: None,
        local: Vec::new(),
        sign: 1.0,
        grid: Some(grid),
    }
}

/// The height of a maximum between grid points has an error of third order in the spacing; the error of its position is
/// below the square of the spacing. This holds on a plane of symmetry too.
#[test]
fn a_largest_value_between_points_is_found() {
    let errors = [0.1, 0.05].map(|spacing: f64| {
        let lines: Vec<f64> = (0..=(1.0 / spacing) as usize).map(|i| spacing * i as f64).collect();
        let grid = FaceGrid { axes: [0, 1], lines: [lines.clone(), lines], is_mirrored: [true, false] };
        let mut worst = 0.0_f64;
        for [x, y] in [[0.0, 0.437], [0.317, 0.518], [0.731, 0.283]] {
            let points = grid.points(2, 0.5);
            let bump = |p: &Vec3| (-((p[0] - x).powi(2) + 2.0 * (p[1] - y).powi(2))).exp();
            let stresses: Vec<f64> = points.iter().flat_map(|p| [bump(p), 0.2, 0.0]).collect();
            let face = on_grid(grid.clone(), points);
            let map = StressMap::Forms { map: Map::Dense(0, Vec::new()), components: 3 };
            let faces = FaceStresses::new(map, vec![face]);
            let (found, of_points) = faces.tensions(&stresses, &ContactNow::default(), 0.0);
            let [found] = found.try_into().expect("one face");
            // The map contains the largest value too.
            assert_eq!(of_points.tension.iter().copied().fold(0.0, f32::max), found.largest as f32);
            worst = worst.max((found.largest - 1.0).abs());
            assert!((found.point[0] - x).abs() < spacing.powi(2) && (found.point[1] - y).abs() < spacing.powi(2));
        }
        worst
    });
    assert!(errors[0] / errors[1] > 7.0 && errors[1] < 1e-4, "{errors:?}");
}
