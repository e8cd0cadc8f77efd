//! What holds and loads a plate, on its discretisation.

use nalgebra_sparse::CsrMatrix;

use super::boundary::{Boundary, Clamp, Place, Spring};
use super::frame::Frame;
use super::{Local, Theory};
use crate::form::plate::{AREA, DEFLECTION, EDGE_STRIP, Section, deflection, mindlin_edge, rotation};
use crate::form::tensor::{Along, Linear, Part, Square, Tensor};

/// A plate's discretisation, with what lives on it.
pub(super) struct Site<'a> {
    pub frame: &'a Frame,
    pub section: &'a Section,
    pub lines: &'a [Vec<f64>; 2],
    pub tensor: &'a Tensor<2>,
    pub theory: Theory,
}

impl Site<'_> {
    /// Ends of the modelled part along both axes.
    fn ends(&self) -> [[f64; 2]; 2] {
        self.lines.each_ref().map(|lines| [lines[0], lines[lines.len() - 1]])
    }

    /// h for a side face, 1 for a face.
    fn height(&self, place: Place) -> f64 {
        match place {
            Place::Face => 1.0,
            Place::Side { .. } => self.section.thickness,
        }
    }

    /// Twice the elastic energy that Mindlin's theory lacks along free edges. A clamp of the rotation along an edge leaves no boundary
    /// layer there; where it holds the rotation across the edge too, there is no twist, and nothing to be left out. Springs have the layer:
    /// they are far softer than the plate's sections, or hold the twist itself.
    pub fn edges(&self, shear_factor: f64, clamps: &[Clamp]) -> Vec<Square<2>> {
        let width = EDGE_STRIP * self.section.thickness;
        let mut forms = Vec::new();
        for (axis, [start, end]) in self.ends().into_iter().enumerate() {
            for (upper, strip) in [(false, [start, start + width]), (true, [end - width, end])] {
                let is_symmetry_plane = self.frame.quarter && !upper;
                let holds = |clamp: &Clamp| {
                    let is_here = (clamp.axis, clamp.upper) == (axis, upper);
                    is_here && clamp.in_plane[1 - axis] && !clamp.in_plane[axis]
                };
                if !is_symmetry_plane && !clamps.iter().any(holds) {
                    let mut place = AREA;
                    place[axis] = Along::Within(strip);
                    forms.push(mindlin_edge(self.section, shear_factor, axis, place));
                }
            }
        }
        forms
    }

    /// Springs k: k h on w along a side, and k h³/12 on the rotations; k on w over a face.
    pub fn springs(&self, springs: &[Spring]) -> Option<CsrMatrix<f64>> {
        let mut forms = Vec::new();
        for Spring { place, in_plane, across, .. } in springs {
            let along = place.along(self.ends());
            let mut add = |factor: f64, part: Part<2>| {
                if factor != 0.0 {
                    forms.push(Square { factor, parts: vec![part], place: along });
                }
            };
            add(across * self.height(*place), deflection([0, 0]));
            for (axis, k) in in_plane.iter().enumerate() {
                add(k * self.section.inertia(), self.theory.rotation(axis));
            }
        }
        (!forms.is_empty()).then(|| self.tensor.matrix(&forms))
    }

    /// ∫ k ū v and ½ ∫ k ū².
    pub fn support_load(&self, springs: &[Spring]) -> (Vec<f64>, f64) {
        let forms: Vec<(Linear<2>, f64)> = springs
            .iter()
            .map(|Spring { place, across, displacement, .. }| {
                let factor = across * displacement * self.height(*place);
                (Linear { factor, part: deflection([0, 0]), place: place.along(self.ends()) }, *displacement)
            })
            .collect();
        let one = self.tensor.one(DEFLECTION);
        let work = |form: Linear<2>| dot(&self.tensor.vector(&[form]), &one);
        let offset = forms.iter().map(|(form, displacement)| 0.5 * displacement * work(*form)).sum();
        let forms: Vec<Linear<2>> = forms.into_iter().map(|(form, _)| form).collect();
        (self.tensor.vector(&forms), offset)
    }

    /// Body force and tractions.
    pub fn load(&self, boundary: &Boundary) -> Vec<f64> {
        let part = deflection([0, 0]);
        let body = Linear { factor: boundary.body_force * self.section.thickness, part, place: AREA };
        let tractions = boundary.tractions.iter().map(|(place, value)| Linear {
            factor: value * self.height(*place),
            part,
            place: place.along(self.ends()),
        });
        let forms: Vec<Linear<2>> = tractions.chain([body]).filter(|form| form.factor != 0.0).collect();
        self.tensor.vector(&forms)
    }

    /// Unknowns of clamped sides, the last clamp's value for each, and those of planes of symmetry.
    pub fn held(&self, clamps: &[Clamp]) -> Vec<(usize, f64)> {
        let one = self.tensor.one(DEFLECTION);
        let mut values = vec![None; self.tensor.unknowns()];
        let mut hold = |(field, depth): (usize, usize), axis: usize, upper: bool, value: f64| {
            let splines = self.tensor.splines(field);
            let last = splines[axis].functions() - 1;
            for along in 0..splines[1 - axis].functions() {
                let mut functions = [along; 2];
                functions[axis] = if upper { last - depth } else { depth };
                let unknown = self.tensor.unknown(field, functions);
                values[unknown] = Some(if value == 0.0 { 0.0 } else { value * one[unknown] });
            }
        };
        for Clamp { axis, upper, in_plane, across } in clamps {
            if let Some(displacement) = across {
                hold((DEFLECTION, 0), *axis, *upper, *displacement);
            }
            for rotation in (0..2).filter(|&i| in_plane[i]) {
                if let Some(place) = self.theory.rotation_at_end(rotation, *axis) {
                    hold(place, *axis, *upper, 0.0);
                }
            }
        }
        if self.frame.quarter {
            for axis in 0..2 {
                if let Some(place) = self.theory.rotation_at_end(axis, axis) {
                    hold(place, axis, false, 0.0);
                }
            }
        }
        values.into_iter().enumerate().filter_map(|(unknown, value)| Some((unknown, value?))).collect()
    }

    /// a: a point for Kirchhoff's theory, a disc for Mindlin's.
    pub fn localization(&self, local: Option<&Local>, copies: f64) -> Vec<f64> {
        let mut a = vec![0.0; self.tensor.unknowns()];
        let Some(Local { spread, radius, reading, .. }) = local else {
            self.tensor.add_point(deflection([0, 0]), self.frame.hit, 1.0, &mut a);
            return a;
        };
        let [x, y] = self.lines;
        let of_stretch = reading * self.section.thickness.powi(2);
        let parts = [(deflection([0, 0]), 1.0), (rotation(0, [1, 0]), of_stretch), (rotation(1, [0, 1]), of_stretch)];
        for (x, line) in spread.strips(self.frame.hit, *radius, [x, y]) {
            for (part, factor) in parts {
                self.tensor.add_line((part, copies * factor), ([x, 0.0], 1), &line, &mut a);
            }
        }
        a
    }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Springs on the sides against a rotation of all of Mindlin's plate along one axis: k h³/12 a unit of length.
    #[test]
    fn springs_resist_rotations() {
        let frame = Frame {
            axes: [0, 1],
            normal: 2,
            sign: -1.0,
            thickness: 0.03,
            edges: [0.6, 0.4],
            hit: [0.0; 2],
            quarter: false,
        };
        let section = Section { thickness: 0.03, young: 70e9, poisson: 0.23, density: 2500.0 };
        let lines = [vec![-0.3, 0.0, 0.3], vec![-0.2, 0.1, 0.2]];
        let theory = Theory::Mindlin;
        let tensor = theory.tensor(&lines);
        let site = Site { frame: &frame, section: &section, lines: &lines, tensor: &tensor, theory };
        let spring = |axis, upper| {
            let place = Place::Side { axis, upper };
            Spring { place, in_plane: [2e9, 3e9], across: 0.0, displacement: 0.0 }
        };
        let entries = site.springs(&[spring(0, true), spring(1, false)]).expect("springs");
        for (axis, k) in [2e9, 3e9].into_iter().enumerate() {
            let one = tensor.one(rotation(axis, [0, 0]).field);
            let sum: f64 = entries.triplet_iter().map(|(i, j, value)| one[i] * value * one[j]).sum();
            let exact = k * 0.03_f64.powi(3) / 12.0 * (0.4 + 0.6);
            // Rounding of a hundred terms.
            assert!((sum / exact - 1.0).abs() < 1e-13, "{sum} {exact}");
        }
    }
}
