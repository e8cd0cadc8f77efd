//! A plate's displacement and stress at its points.
//!
//! A point at the height ζ along w moves by ζ θ in the plane, Kirchhoff's θ being −∇w. Stresses are plane, those of bending: across the
//! plate there is none but Mindlin's shear, on the parabola that is zero on both faces.

use super::frame::Frame;
use super::{Local, Theory};
use crate::body::block::divided;
use crate::body::gauge::{Form, Forms, add, summed};
use crate::form::plate::{Section, deflection, rotation};
use crate::form::stress::place;
use crate::form::tensor::{Part, Tensor};
use crate::scene::Vec3;

/// Hexahedra in a cell of splines along each axis, where fields are written: splines of degree 5 bend within a cell.
const PIECES: usize = 3;

/// A plate's discretisation, to be read anywhere in the modelled part.
#[derive(Debug, Clone)]
pub struct Points {
    pub(super) frame: Frame,
    pub(in crate::body) section: Section,
    pub(super) lines: [Vec<f64>; 2],
    pub(super) tensor: Tensor<2>,
    pub(super) theory: Theory,
    pub(in crate::body) local: Option<Local>,
}

impl Points {
    /// The forms at a point, m.
    pub(in crate::body) fn at(&self, x: Vec3) -> Forms {
        let Self { frame: Frame { axes, normal, sign, .. }, section, .. } = self;
        let (point, height) = (axes.map(|axis| x[axis]), sign * x[*normal]);
        let form = |(factor, part): (f64, Part<2>)| self.tensor.at_point(part, point, factor);
        let mut displacement: [Form; 3] = Default::default();
        displacement[*normal] = self.tensor.at_point(deflection([0, 0]), point, *sign);
        let mut stress: [Form; 6] = Default::default();
        let Section { young, poisson, thickness, .. } = *section;
        let (plane, shear) = (young / (1.0 - poisson * poisson), 0.5 * young / (1.0 + poisson));
        for (i, &axis) in axes.iter().enumerate() {
            displacement[axis] = form(self.turned(i, [0, 0], height));
            let mut along = [0, 0];
            along[i] = 1;
            let stretch = form(self.turned(i, along, height));
            add(&mut stress[axis], plane, &stretch);
            add(&mut stress[axes[1 - i]], plane * poisson, &stretch);
            add(&mut stress[place(axes[0], axes[1])], shear, &form(self.turned(i, [along[1], along[0]], height)));
            if let Some(local) = &self.local {
                let over_mean = 1.5 * (1.0 - (2.0 * height / thickness).powi(2));
                let factor = sign * over_mean * local.shear_factor * shear;
                let to = &mut stress[place(axis, *normal)];
                add(to, factor, &form((1.0, deflection(along))));
                add(to, factor, &form((1.0, rotation(i, [0, 0]))));
            }
        }
        Forms { displacement: displacement.map(summed), stress: stress.map(summed) }
    }

    /// ζ times the rotation along an axis of the plane, differentiated.
    fn turned(&self, axis: usize, derivatives: [usize; 2], height: f64) -> (f64, Part<2>) {
        match self.theory {
            Theory::Mindlin => (height, rotation(axis, derivatives)),
            Theory::Kirchhoff => {
                let mut all = derivatives;
                all[axis] += 1;
                (-height, deflection(all))
            }
        }
    }

    /// Coordinates along the axes on which fields are written, m.
    pub(in crate::body) fn lines(&self) -> [Vec<f64>; 3] {
        let half = 0.5 * self.section.thickness;
        let mut lines: [Vec<f64>; 3] = Default::default();
        lines[self.frame.normal] = vec![-half, 0.0, half];
        (0..2).for_each(|i| lines[self.frame.axes[i]] = divided(&self.lines[i], PIECES));
        lines
    }
}
