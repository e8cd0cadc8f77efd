//! What holds and loads a block, on its discretisation.

use nalgebra_sparse::CsrMatrix;

use super::frame::Frame;
use crate::form::elastic::{VOLUME, displacement};
use crate::form::pressure_rule;
use crate::form::tensor::{Along, Linear, Square, Tensor};
use crate::scene::{Scene, SupportKind, Vec3, faces};

/// A block's discretisation, with what lives on it.
pub(super) struct Site<'a> {
    pub scene: &'a Scene,
    pub frame: &'a Frame,
    pub lines: &'a [Vec<f64>; 3],
    pub tensor: &'a Tensor<3>,
}

impl Site<'_> {
    /// The modelled faces of a surface: axis, whether it is the upper one, place.
    fn places(&self, surface: &str) -> impl Iterator<Item = (usize, bool, [Along; 3])> {
        faces(surface).iter().filter(|(axis, upper)| *upper || !self.frame.mirrors.contains(axis)).map(
            |&(axis, upper)| {
                let mut place = VOLUME;
                place[axis] = Along::At(self.frame.ends(axis)[usize::from(upper)]);
                (axis, upper, place)
            },
        )
    }

    /// The springs of the elastic supports: place, k, ū.
    fn springs(&self) -> impl Iterator<Item = ([Along; 3], Vec3, Vec3)> {
        self.scene
            .supports
            .iter()
            .filter_map(|support| match support.kind {
                SupportKind::Elastic { stiffness } => Some((support, stiffness)),
                _ => None,
            })
            .flat_map(|(support, stiffness)| {
                self.places(&support.surface).map(move |(_, _, place)| (place, stiffness, support.displacement))
            })
    }

    fn matrix(&self, terms: impl Iterator<Item = ([Along; 3], Vec3)>) -> Option<CsrMatrix<f64>> {
        let squares: Vec<Square<3>> = terms
            .flat_map(|(place, k)| (0..3).map(move |i| Square { factor: k[i], parts: vec![displacement(i)], place }))
            .filter(|square| square.factor != 0.0)
            .collect();
        (!squares.is_empty()).then(|| self.tensor.matrix(&squares))
    }

    /// ∫ k u·v.
    pub fn stiffness(&self) -> Option<CsrMatrix<f64>> {
        self.matrix(self.springs().map(|(place, k, _)| (place, k)))
    }

    /// ∫ c u·v.
    pub fn damping(&self) -> Option<CsrMatrix<f64>> {
        self.matrix(
            self.scene
                .supports
                .iter()
                .flat_map(|support| self.places(&support.surface).map(|(_, _, place)| (place, support.damping))),
        )
    }

    fn vector(&self, terms: impl Iterator<Item = ([Along; 3], Vec3)>) -> Vec<f64> {
        let forms: Vec<Linear<3>> = terms
            .flat_map(|(place, f)| (0..3).map(move |i| Linear { factor: f[i], part: displacement(i), place }))
            .filter(|form| form.factor != 0.0)
            .collect();
        self.tensor.vector(&forms)
    }

    /// ∫ k ū·v and ½ ∫ k ū·ū.
    pub fn support_load(&self) -> (Vec<f64>, f64) {
        let pull = |k: Vec3, u: Vec3| [0, 1, 2].map(|i| k[i] * u[i]);
        let load = self.vector(self.springs().map(|(place, k, u)| (place, pull(k, u))));
        let area = |place: [Along; 3]| -> f64 {
            (0..3)
                .filter(|i| place[*i] == Along::All)
                .map(|i| {
                    let [a, b] = self.frame.ends(i);
                    b - a
                })
                .product()
        };
        let offset = self
            .springs()
            .map(|(place, k, u)| 0.5 * area(place) * (0..3).map(|i| k[i] * u[i] * u[i]).sum::<f64>())
            .sum();
        (load, offset)
    }

    /// Body force and tractions.
    pub fn load(&self) -> Vec<f64> {
        let load = &self.scene.load;
        let tractions = load
            .traction
            .iter()
            .flat_map(|traction| self.places(&traction.surface).map(|(_, _, place)| (place, traction.value)));
        self.vector(tractions.chain([(VOLUME, load.body_force)]))
    }

    /// Unknowns of clamped faces, the last clamp's value for each, and those of planes of symmetry.
    pub fn held(&self) -> Vec<(usize, f64)> {
        let mut values = vec![None; self.tensor.unknowns()];
        let mut hold = |component: usize, axis: usize, upper: bool, value: f64| {
            let splines = self.tensor.splines(component);
            let counts = splines.each_ref().map(|s| s.functions());
            let others: Vec<usize> = (0..3).filter(|i| *i != axis).collect();
            for j in 0..counts[others[0]] {
                for k in 0..counts[others[1]] {
                    let mut functions = [0; 3];
                    functions[axis] = if upper { counts[axis] - 1 } else { 0 };
                    (functions[others[0]], functions[others[1]]) = (j, k);
                    values[self.tensor.unknown(component, functions)] = Some(value);
                }
            }
        };
        for support in &self.scene.supports {
            let SupportKind::Clamped { components } = support.kind else { continue };
            for (axis, upper, _) in self.places(&support.surface) {
                (0..3).filter(|i| components[*i]).for_each(|i| hold(i, axis, upper, support.displacement[i]));
            }
        }
        self.frame.mirrors.iter().for_each(|&axis| hold(axis, axis, false, 0.0));
        values.into_iter().enumerate().filter_map(|(unknown, value)| Some((unknown, value?))).collect()
    }

    /// A unit translation.
    pub fn translation(&self, direction: Vec3) -> Vec<f64> {
        let mut sum = vec![0.0; self.tensor.unknowns()];
        for i in 0..3 {
            sum.iter_mut().zip(self.tensor.one(i)).for_each(|(sum, one)| *sum += direction[i] * one);
        }
        sum
    }

    /// a.
    pub fn localization(&self, radius: f64, settings: &super::Settings) -> Vec<f64> {
        let struck = self.frame.struck;
        let plane: [usize; 2] = [[1, 2], [0, 2], [0, 1]][struck];
        let hit = self.frame.hit;
        let copies = self.frame.copies();
        let lines = plane.map(|axis| &self.lines[axis][..]);
        let mut a = vec![0.0; self.tensor.unknowns()];
        let f = if settings.spread > 0.0 { settings.spread } else { 1.0 };
        let n = settings.power as f64;
        let w = weights(settings);
        let centre = plane.map(|axis| hit[axis]);
        for (point, weight) in pressure_rule(centre, f * radius, lines) {
            let mut at = hit;
            (at[plane[0]], at[plane[1]]) = (point[0], point[1]);
            let s = ((point[0] - centre[0]).powi(2) + (point[1] - centre[1]).powi(2)) / (f * radius).powi(2);
            // Hertz 3/(2 pi) sqrt(1-s); powers (n+1)/pi (1-s)^n.
            let ratio = if settings.spread > 0.0 {
                let t: f64 = (1.0 - s).max(0.0);
                (0..3).map(|i| w[i] * (n + 1.0 + i as f64) * t.powf(n - 0.5 + i as f64)).sum::<f64>() / 1.5
            } else {
                1.0
            };
            for (i, d) in self.scene.impactor.direction.iter().enumerate().filter(|(_, d)| **d != 0.0) {
                self.tensor.add_point(displacement(i), at, copies * weight * ratio * d, &mut a);
            }
        }
        a
    }
}

fn weights(settings: &super::Settings) -> [f64; 3] {
    let n = settings.power as f64;
    let f = settings.spread.powi(-2);
    // <s^k> of m (1-s)^(m-1).
    let moment = |m: f64, k: i32| match k {
        0 => 1.0,
        1 => 1.0 / (m + 1.0),
        _ => 2.0 / ((m + 1.0) * (m + 2.0)),
    };
    let a = nalgebra::Matrix3::from_fn(|k, i| moment(n + 1.0 + i as f64, k as i32));
    let w = a.lu().solve(&nalgebra::Vector3::new(1.0, 0.4 * f, 8.0 / 35.0 * f * f)).unwrap();
    [w[0], w[1], w[2]]
}

pub(super) fn ratio(settings: &super::Settings) -> f64 {
    if settings.spread == 0.0 {
        return 1.0;
    }
    let r = |m: usize| (1..=m).fold(std::f64::consts::PI.sqrt().recip(), |r, k| r * k as f64 / (k as f64 - 0.5));
    let i = |mu: usize, nu: usize| std::f64::consts::PI.sqrt() * r(mu) * r(nu) * r(mu + nu) / (mu + nu) as f64;
    let w = weights(settings);
    let n = settings.power + 1;
    let sum: f64 = (0..3).flat_map(|a| (0..3).map(move |b| (a, b))).map(|(a, b)| w[a] * w[b] * i(n + a, n + b)).sum();
    sum / std::f64::consts::PI / settings.spread / 0.6
}
