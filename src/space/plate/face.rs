//! Stresses at the crossings of grid lines on a face of a plate, as products of functions along the axes.

use super::layers::profile::is_rotation;
use crate::form::{Parity, Spline};
use crate::space::evaluate::{AtPlace, FaceLines, LinePart, Lines};

use super::points::{Law, Points};

impl Points {
    /// In-plane stresses σ_a, σ_b and σ_ab at the crossings of lines along the axes of the plane. `height` (m) is along
    /// the axis of the scene normal to the plate.
    pub(super) fn stress_on_lines(&self, lines: [&[f64]; 2], height: f64) -> FaceLines {
        let height = self.geometry.sign * height;
        let Law { plane, poisson, shear, .. } = self.law(height);
        // Derivatives of u_a and u_b along a and b, with their factors in σ_a, σ_b and σ_ab.
        let slopes = [
            (0, [1, 0], [plane, plane * poisson, 0.0]),
            (1, [0, 1], [plane * poisson, plane, 0.0]),
            (0, [0, 1], [0.0, 0.0, shear]),
            (1, [1, 0], [0.0, 0.0, shear]),
        ];
        let lines = [0, 1].map(|i| Lines::new(lines[i], self.geometry.halved[i]));
        let mut all = FaceLines { fields: Vec::new(), parts: Vec::new(), lines };
        for (axis, derivatives, stresses) in slopes {
            for (factor, part) in self.turned(axis, derivatives, height) {
                let splines = self.tensor.splines(part.field);
                let functions = splines.each_ref().map(Spline::functions);
                for (number, class) in self.geometry.classes.iter().enumerate() {
                    let first = number * self.tensor.unknowns() + self.tensor.unknown(part.field, [0, 0]);
                    let of_field = first..first + functions[0] * functions[1];
                    let known = all.fields.iter().position(|field| *field == of_field);
                    let field = known.unwrap_or(all.fields.len());
                    if known.is_none() {
                        all.fields.push(of_field);
                    }
                    let flips = [0, 1].map(|i| {
                        // A rotation is a slope: it is odd if the deflection is even.
                        let is_turned = (part.derivatives[i] + usize::from(is_rotation(part.field, i))) % 2 == 1;
                        (class[i] == Parity::Odd) != is_turned
                    });
                    let along = [0, 1].map(|i| along(&splines[i], part.derivatives[i], &all.lines[i].places));
                    let stresses = stresses.map(|stress| factor * stress);
                    all.parts.push(LinePart { field, functions: functions[1], along, flips, stresses });
                }
            }
        }
        all
    }
}

/// A derivative of the functions of an axis at some places.
fn along(spline: &Spline, derivative: usize, places: &[f64]) -> Vec<AtPlace> {
    let at = |x: &f64| {
        let (first, values) = spline.at(*x, derivative);
        AtPlace { first, count: values.len().min(spline.functions() - first), values }
    };
    places.iter().map(at).collect()
}

#[cfg(test)]
mod tests {
    use crate::scene::Scene;
    use crate::space::evaluate::{LineStresses, PointEvaluator};
    use crate::space::plate::{Plate, PlateTheory, Settings};

    /// On a quarter, and on a whole plate with four symmetry classes, the stresses on lines equal the stresses
    /// evaluated point by point.
    #[test]
    fn stresses_on_lines_are_those_of_their_points() {
        for point in [[0.0, 0.0], [0.07, -0.05]] {
            let text = format!(
                "[body]\nyoung = 70e9\npoisson = 0.23\ndensity = 2500.0\nsize = [0.6, 0.4, 0.03]\n\
                 [impactor]\nmass = 1.0\nradius = 0.05\nstiffness = 1e10\nspeed = 1.0\npoint = [{}, {}, 0.015]\n[time]\nend = 1e-3\n",
                point[0], point[1]
            );
            let scene = Scene::parse("test", &text, &[]).expect("a scene").0;
            let settings = Settings { cell_size_factor: 2.4, ..Settings::default() };
            let points = Plate::new(&scene, PlateTheory::Layerwise, &settings).expect("a plate").points;
            let count = points.all_unknowns();
            // One vector in each symmetry class, and one in all of them.
            let classes = points.geometry.classes.len();
            let number = |i: usize| ((i * 7919) % 101) as f64 / 50.0 - 1.0;
            let basis: Vec<Vec<f64>> = (0..=classes)
                .map(|class| {
                    let is_in = |i: usize| class == classes || i / (count / classes) == class;
                    (0..count).map(|i| if is_in(i) { number(i + class) } else { 0.0 }).collect()
                })
                .collect();
            let all = points.lines_of_whole();
            let lines = [0, 1].map(|i| {
                let mut lines = all[i].clone();
                lines.insert(1, 0.5 * (lines[0] + lines[1]));
                lines
            });
            let height = -0.015;
            let face = points.stress_on_lines(lines.each_ref().map(Vec::as_slice), height);
            let stresses = LineStresses::new(face, Vec::new(), &basis);
            let coordinates: Vec<f64> = (0..basis.len()).map(|i| 1.0 - 0.3 * i as f64).collect();
            let moved: Vec<f64> =
                (0..count).map(|i| basis.iter().zip(&coordinates).map(|(v, y)| v[i] * y).sum()).collect();
            let found = stresses.apply(&coordinates);
            let crossings = lines[0].iter().flat_map(|x| lines[1].iter().map(move |y| [*x, *y, height]));
            let largest = found.iter().fold(0.0_f64, |largest, stress| largest.max(stress.abs()));
            let mut seen = 0;
            for (x, found) in crossings.zip(found.chunks_exact(3)) {
                let forms = points.face_stress(x);
                for (form, found) in [0, 1, 5].map(|component| &forms[component]).into_iter().zip(found) {
                    let exact: f64 = form.iter().map(|(unknown, value)| value * moved[*unknown]).sum();
                    // Rounding error of some hundred products.
                    assert!((exact - found).abs() < 1e-12 * largest, "{x:?}: {exact} {found}");
                    seen += 1;
                }
            }
            assert_eq!(seen, found.len());
        }
    }
}
