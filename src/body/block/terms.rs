//! What holds, loads and hits a block, on its discretisation.

use nalgebra_sparse::CsrMatrix;

use super::frame::Frame;
use crate::form::elastic::{VOLUME, displacement};
use crate::form::tensor::{Along, Linear, Square, Tensor};
use crate::form::{Spline, Spread};
use crate::scene::{Scene, SupportKind, Vec3, faces};

/// A place, and a value by component there.
type Term = ([Along; 3], Vec3);

/// A block's discretisation, with what the scene says of it.
pub(super) struct Terms<'a> {
    pub scene: &'a Scene,
    pub frame: &'a Frame,
    pub lines: &'a [Vec<f64>; 3],
    pub tensor: &'a Tensor<3>,
}

impl Terms<'_> {
    /// The faces of the modelled part that a surface stands for: the axis across, and whether it is the upper one.
    fn faces(&self, surface: &str) -> impl Iterator<Item = (usize, bool)> {
        faces(surface).iter().copied().filter(|(axis, upper)| *upper || !self.frame.mirrors.contains(axis))
    }

    /// The same as places.
    fn places(&self, surface: &str) -> impl Iterator<Item = [Along; 3]> {
        self.faces(surface).map(|(axis, upper)| {
            let mut place = VOLUME;
            place[axis] = Along::At(self.frame.ends(axis)[usize::from(upper)]);
            place
        })
    }

    /// The elastic supports: place, k, ū.
    fn springs(&self) -> impl Iterator<Item = ([Along; 3], Vec3, Vec3)> {
        self.scene.supports.iter().flat_map(|support| {
            let stiffness = match support.kind {
                SupportKind::Elastic { stiffness } => stiffness,
                _ => [0.0; 3],
            };
            self.places(&support.surface).map(move |place| (place, stiffness, support.displacement))
        })
    }

    /// ∫ k u·v of the elastic supports; `None` where every k is zero.
    pub fn support(&self) -> Option<CsrMatrix<f64>> {
        self.matrix(self.springs().map(|(place, k, _)| (place, k)))
    }

    /// ∫ c u·v of the dampers; `None` where every c is zero.
    pub fn damping(&self) -> Option<CsrMatrix<f64>> {
        let supports = self.scene.supports.iter();
        self.matrix(supports.flat_map(|support| self.places(&support.surface).map(|place| (place, support.damping))))
    }

    /// ∫ k ū·v and ½ ∫ k ū·ū of the elastic supports.
    pub fn support_load(&self) -> (Vec<f64>, f64) {
        let load = self.vector(self.springs().map(|(place, k, u)| (place, [0, 1, 2].map(|i| k[i] * u[i]))));
        let length = |axis: usize, along: Along| match along {
            Along::All => self.frame.ends(axis)[1] - self.frame.ends(axis)[0],
            Along::Within([start, end]) => end - start,
            Along::At(_) => 1.0,
        };
        let area = |place: [Along; 3]| (0..3).map(|axis| length(axis, place[axis])).product::<f64>();
        let square = |k: Vec3, u: Vec3| (0..3).map(|i| k[i] * u[i] * u[i]).sum::<f64>();
        (load, self.springs().map(|(place, k, u)| 0.5 * area(place) * square(k, u)).sum())
    }

    /// Body force (1) and tractions (3).
    pub fn load(&self) -> Vec<f64> {
        let load = &self.scene.load;
        let tractions = load.traction.iter();
        let tractions = tractions.flat_map(|entry| self.places(&entry.surface).map(|place| (place, entry.value)));
        self.vector(tractions.chain([(VOLUME, load.body_force)]))
    }

    fn matrix(&self, terms: impl Iterator<Item = Term>) -> Option<CsrMatrix<f64>> {
        let forms: Vec<Square<3>> = terms
            .flat_map(|(place, k)| (0..3).map(move |i| Square { factor: k[i], parts: vec![displacement(i)], place }))
            .filter(|form| form.factor != 0.0)
            .collect();
        (!forms.is_empty()).then(|| self.tensor.matrix(&forms))
    }

    fn vector(&self, terms: impl Iterator<Item = Term>) -> Vec<f64> {
        let forms: Vec<Linear<3>> = terms
            .flat_map(|(place, f)| (0..3).map(move |i| Linear { factor: f[i], part: displacement(i), place }))
            .filter(|form| form.factor != 0.0)
            .collect();
        self.tensor.vector(&forms)
    }

    /// Unknowns of clamped faces (2), the last clamp's value for each, and those of planes of symmetry; ascending.
    pub fn held(&self) -> Vec<(usize, f64)> {
        let mut values = vec![None; self.tensor.unknowns()];
        // At an end of an axis one function alone is not zero, and functions sum to one.
        let mut hold = |component: usize, (axis, upper): (usize, bool), value: f64| {
            let counts = self.tensor.splines(component).each_ref().map(Spline::functions);
            let [first, second] = [[1, 2], [0, 2], [0, 1]][axis];
            for (i, j) in (0..counts[first]).flat_map(|i| (0..counts[second]).map(move |j| (i, j))) {
                let mut functions = [0; 3];
                functions[axis] = if upper { counts[axis] - 1 } else { 0 };
                (functions[first], functions[second]) = (i, j);
                values[self.tensor.unknown(component, functions)] = Some(value);
            }
        };
        for support in &self.scene.supports {
            let SupportKind::Clamped { components } = support.kind else { continue };
            for face in self.faces(&support.surface) {
                (0..3).filter(|i| components[*i]).for_each(|i| hold(i, face, support.displacement[i]));
            }
        }
        self.frame.mirrors.iter().for_each(|&axis| hold(axis, (axis, false), 0.0));
        values.into_iter().enumerate().filter_map(|(unknown, value)| Some((unknown, value?))).collect()
    }

    /// The body moved as a whole by one in the impactor's direction.
    pub fn translation(&self) -> Vec<f64> {
        let mut sum = vec![0.0; self.tensor.unknowns()];
        for (component, d) in self.scene.impactor.direction.into_iter().enumerate() {
            sum.iter_mut().zip(self.tensor.one(component)).for_each(|(sum, one)| *sum += d * one);
        }
        sum
    }

    /// a: the spread pressure on a disc (m) of the struck face, with total 1, times the direction.
    pub fn localization(&self, spread: &Spread, disc: f64) -> Vec<f64> {
        let (frame, plane) = (self.frame, self.frame.plane());
        let centre = plane.map(|axis| frame.hit[axis]);
        let mut a = vec![0.0; self.tensor.unknowns()];
        for (x, line) in spread.strips(centre, disc, plane.map(|axis| &self.lines[axis][..])) {
            let mut place = frame.hit;
            place[plane[0]] = x;
            for (component, d) in self.scene.impactor.direction.into_iter().enumerate().filter(|(_, d)| *d != 0.0) {
                let part = (displacement(component), frame.copies() * d);
                self.tensor.add_line(part, (place, plane[1]), &line, &mut a);
            }
        }
        a
    }
}
