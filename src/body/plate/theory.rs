//! The two theories: their fields, and which coefficients are rotations at an edge.

use crate::form::Spline;
use crate::form::plate::{
    DEFLECTION, Section, deflection, kirchhoff_elastic, kirchhoff_mass, mindlin_elastic, mindlin_mass, rotation,
};
use crate::form::tensor::{Part, Square, Tensor};

/// What a plate is made to be.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Theory {
    /// No shear, no rotary inertia; hit at a point.
    Kirchhoff,
    /// Shear and rotary inertia; hit on a disc.
    Mindlin,
}

/// Degree of the deflection, with as many continuous derivatives but one. Of 3 to 5, C¹ cubics (bicubic Hermite elements) among
/// them, the highest needs the fewest unknowns for an error of 0.1% of an impact's history.
const DEGREE: usize = 5;

impl Theory {
    /// The name behind it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Kirchhoff => "Kirchhoff",
            Self::Mindlin => "Mindlin",
        }
    }

    /// The theory's fields between the lines of a grid.
    ///
    /// Mindlin's w lies in splines of degree p, each rotation in those of one degree and one continuous derivative less along its
    /// own axis: then ∇w is among the rotations and nothing locks (Beirão da Veiga, Buffa, Lovadina, Martinelli & Sangalli, An
    /// isogeometric method for the Reissner–Mindlin plate bending problem, Comput. Methods Appl. Mech. Eng. 209–212, 2012).
    pub(super) fn tensor(self, lines: &[Vec<f64>; 2]) -> Tensor<2> {
        let splines = |degree: usize| lines.each_ref().map(|lines| Spline::new(lines, degree, degree - 1));
        Tensor::new(match self {
            Self::Kirchhoff => vec![lines.each_ref().map(|lines| Spline::with_slopes(lines, DEGREE, DEGREE - 1))],
            Self::Mindlin => {
                let ([x, y], [less_x, less_y]) = (splines(DEGREE), splines(DEGREE - 1));
                vec![[x.clone(), y.clone()], [less_x, y], [x, less_y]]
            }
        })
    }

    /// Twice the elastic energy; κ is Mindlin's.
    pub(super) fn elastic(self, section: &Section, shear_factor: f64) -> Vec<Square<2>> {
        match self {
            Self::Kirchhoff => kirchhoff_elastic(section),
            Self::Mindlin => mindlin_elastic(section, shear_factor),
        }
    }

    /// Twice the kinetic energy.
    pub(super) fn mass(self, section: &Section) -> Vec<Square<2>> {
        match self {
            Self::Kirchhoff => kirchhoff_mass(section),
            Self::Mindlin => mindlin_mass(section),
        }
    }

    /// The rotation of the normal along an axis, up to its sign.
    pub(super) fn rotation(self, axis: usize) -> Part<2> {
        match self {
            Self::Kirchhoff => deflection([[1, 0], [0, 1]][axis]),
            Self::Mindlin => rotation(axis, [0, 0]),
        }
    }

    /// Where the rotation along an axis is a coefficient at an end of an axis: the field, and how many functions from the end.
    /// `None` where it follows from the deflection's.
    pub(super) fn rotation_at_end(self, axis: usize, of_end: usize) -> Option<(usize, usize)> {
        match self {
            Self::Kirchhoff => (axis == of_end).then_some((DEFLECTION, 1)),
            Self::Mindlin => Some((rotation(axis, [0, 0]).field, 0)),
        }
    }
}
