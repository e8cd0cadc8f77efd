//! A box hit on a face, as a thin plate: small linear systems of Kirchhoff's or of Reissner's and Mindlin's theory.
//!
//! Kirchhoff's deflection w lies in C¹ cubics (the space of bicubic Hermite elements). Mindlin's w lies in splines of degree p, each
//! rotation in those of one degree and one continuous derivative less along its own axis: then ∇w is among the rotations and
//! nothing locks (Beirão da Veiga, Buffa, Lovadina, Martinelli & Sangalli, An isogeometric method for the Reissner–Mindlin plate
//! bending problem, Comput. Methods Appl. Mech. Eng. 209–212, 2012).

mod boundary;
mod frame;
mod grid;
pub mod layer;

use boundary::{Boundary, Clamp, Spring};
use frame::Frame;
use layer::Layer;

use crate::error::Result;
use crate::form::plate::{self, DEFLECTION, Section, deflection, rotation};
use crate::form::tensor::{AREA, Entries, Linear, Part, Square, Tensor};
use crate::form::{Spline, pressure_rule};
use crate::scene::{Fault, Scene};

/// What a plate is made to be.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Theory {
    /// No shear, no rotary inertia; hit at a point.
    Kirchhoff,
    /// Shear and rotary inertia; hit on a disc.
    Mindlin,
}

/// Choices that a scene does not make.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Settings {
    /// Size of all cells over the default's.
    pub fineness: f64,
    /// κ of Mindlin's theory: 5/6 is Reissner's static one, 5/(6 − ν) that of long waves (Stephen, Mindlin plate theory: best
    /// shear coefficient and higher spectra validity, J. Sound Vib. 202, 1997).
    pub shear_factor: f64,
    /// Radius of Mindlin's disc over the thickness.
    pub disc: f64,
    /// r_p of the solid that is to be matched, m; 0 for its limit.
    pub patch_radius: f64,
}

impl Default for Settings {
    fn default() -> Self {
        Self { fineness: 1.0, shear_factor: 5.0 / 6.0, disc: 0.5, patch_radius: 0.0 }
    }
}

/// The body's side of M ü + C u̇ + K u = a F + f, as plain numbers in SI units.
///
/// The unknowns are coefficients of splines: of w along the impactor's direction (m), then of Mindlin's rotations θ along the two
/// axes of the plane, ascending (rad); a slope's coefficient is one of w. Matrices are those of all unknowns, held ones included.
#[derive(Debug, Clone)]
pub struct Plate {
    /// Number of unknowns.
    pub unknowns: usize,
    /// M; kg for those of w.
    pub mass: Entries,
    /// K of the plate alone; N/m for those of w.
    pub elastic: Entries,
    /// K of the elastic supports (11); `None` when zero.
    pub support: Option<Entries>,
    /// C of the dampers (13); `None` when zero.
    pub damping: Option<Entries>,
    /// Held unknowns with their value: clamped sides (2) and planes of symmetry; ascending.
    pub held: Vec<(usize, f64)>,
    /// Body force and tractions, N for those of w.
    pub load: Vec<f64>,
    /// ∫ k ū·v of the elastic supports.
    pub support_load: Vec<f64>,
    /// ½ ∫ k ū·ū of the elastic supports, J.
    pub support_offset: f64,
    /// a: aᵀu is the displacement of the surface along the impactor's direction, a F the load.
    pub localization: Vec<f64>,
    /// c of α = δ + c F for the part that is modelled, m/N: −c_M times [`Self::copies`]; 0 for Kirchhoff's theory.
    pub compliance: f64,
    /// A translation by one along the impactor's direction.
    pub translation: Vec<f64>,
    /// How many such parts make the whole: 1, or 4 for a quarter.
    pub copies: f64,
    /// Cells along both axes of the modelled part.
    pub cells: [usize; 2],
    /// How Mindlin's plate is hit.
    pub local: Option<Local>,
}

/// What stands for the local field on a Reissner–Mindlin plate; see [`layer`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Local {
    /// κ.
    pub shear_factor: f64,
    /// r_m, m.
    pub radius: f64,
    /// s: the surface is read as w + s h² ∇·θ.
    pub reading: f64,
    /// c_M of the whole plate, m/N: α = δ − c_M F.
    pub compliance: f64,
}

/// Why a plate theory does not stand for a scene: one clause.
///
/// # Errors
/// That clause.
pub fn admits(scene: &Scene, theory: Theory) -> std::result::Result<(), String> {
    parts(scene, theory, &Settings::default()).map(|_| ())
}

fn parts(scene: &Scene, theory: Theory, settings: &Settings) -> std::result::Result<(Frame, Boundary), String> {
    let frame = Frame::new(scene)?;
    let boundary = Boundary::new(scene, &frame, theory)?;
    let radius = settings.disc * frame.thickness;
    if theory == Theory::Mindlin && radius > frame.room() * (1.0 + 1e-9) {
        return Err(format!(
            "the hit is {:.3e} m from an edge, and the disc that it spreads over has a radius of {radius:.3e} m",
            frame.room()
        ));
    }
    Ok((frame, boundary))
}

impl Plate {
    /// Builds a scene's plate.
    ///
    /// # Errors
    /// A fault of `body.model` where the theory does not stand for the scene, or where the plate would take very many cells.
    pub fn new(scene: &Scene, theory: Theory, settings: &Settings) -> Result<Self> {
        let name = match theory {
            Theory::Kirchhoff => "Kirchhoff",
            Theory::Mindlin => "Mindlin",
        };
        let fault = |reason: String| {
            Fault::new(
                "body.model",
                format!("{name}'s plate does not stand for this scene: {reason}"),
                "model = \"solid\"",
            )
        };
        let (frame, boundary) = parts(scene, theory, settings).map_err(fault)?;
        let body = &scene.body;
        let section =
            Section { thickness: frame.thickness, young: body.young, poisson: body.poisson, density: body.density };
        let lines = grid::lines(&frame, &section, &scene.impactor, settings.fineness)
            .map_err(|cells| fault(format!("{cells:.0} cells along an edge are needed")))?;
        let tensor = theory.tensor(&lines);
        let (elastic, mass) = match theory {
            Theory::Kirchhoff => (plate::kirchhoff_elastic(&section), plate::kirchhoff_mass(&section)),
            Theory::Mindlin => (plate::mindlin_elastic(&section, settings.shear_factor), plate::mindlin_mass(&section)),
        };
        let copies = if frame.quarter { 4.0 } else { 1.0 };
        let local = (theory == Theory::Mindlin).then(|| Local::new(&section, settings));
        let site = Site { frame: &frame, section: &section, lines: &lines, tensor: &tensor, theory };
        let (support_load, support_offset) = site.support_load(&boundary.springs);
        Ok(Self {
            unknowns: tensor.unknowns(),
            mass: tensor.matrix(&mass),
            elastic: tensor.matrix(&elastic),
            support: site.springs(&boundary.springs),
            damping: site.springs(&boundary.dampers),
            held: site.held(&boundary.clamps),
            load: site.load(&boundary),
            support_load,
            support_offset,
            localization: site.localization(local.as_ref(), copies),
            compliance: local.map_or(0.0, |local| -local.compliance * copies),
            translation: tensor.one(DEFLECTION),
            copies,
            cells: lines.each_ref().map(|lines| lines.len() - 1),
            local,
        })
    }
}

impl Local {
    fn new(section: &Section, settings: &Settings) -> Self {
        let h = section.thickness;
        let Settings { shear_factor, disc, patch_radius, .. } = *settings;
        let layer = Layer { poisson: section.poisson, shear_factor, disc, patch: patch_radius / h };
        let compliance = layer.compliance() / (section.young * h);
        Self { shear_factor, radius: disc * h, reading: layer.reading(), compliance }
    }
}

/// Degree of Mindlin's deflection.
const DEGREE: usize = 4;

impl Theory {
    /// The theory's fields between the lines of a grid.
    fn tensor(self, lines: &[Vec<f64>; 2]) -> Tensor {
        let [x, y] = lines;
        match self {
            Self::Kirchhoff => Tensor::new(vec![[x, y].map(|lines| Spline::with_slopes(lines, 3, 1))]),
            Self::Mindlin => {
                let [full, less] = [DEGREE, DEGREE - 1].map(|p| [x, y].map(|lines| Spline::new(lines, p, p - 1)));
                let ([fx, fy], [lx, ly]) = (full, less);
                Tensor::new(vec![[fx.clone(), fy.clone()], [lx, fy], [fx, ly]])
            }
        }
    }

    /// The rotation of the normal along an axis, up to its sign.
    fn rotation(self, axis: usize) -> Part {
        match self {
            Self::Kirchhoff => deflection([[1, 0], [0, 1]][axis]),
            Self::Mindlin => rotation(axis, [0, 0]),
        }
    }

    /// Where the rotation along an axis is a coefficient at an end of an axis: the field, and how many functions from the end.
    /// `None` where it follows from the deflection's.
    fn rotation_at_end(self, axis: usize, of_end: usize) -> Option<(usize, usize)> {
        match self {
            Self::Kirchhoff => (axis == of_end).then_some((DEFLECTION, 1)),
            Self::Mindlin => Some((rotation(axis, [0, 0]).field, 0)),
        }
    }
}

/// A plate's discretisation, with what lives on it.
struct Site<'a> {
    frame: &'a Frame,
    section: &'a Section,
    lines: &'a [Vec<f64>; 2],
    tensor: &'a Tensor,
    theory: Theory,
}

impl Site<'_> {
    /// Ends of the modelled part along both axes.
    fn ends(&self) -> [[f64; 2]; 2] {
        self.lines.each_ref().map(|lines| [lines[0], lines[lines.len() - 1]])
    }

    /// h for a side face, 1 for a face.
    fn height(&self, place: boundary::Place) -> f64 {
        match place {
            boundary::Place::Face => 1.0,
            boundary::Place::Side { .. } => self.section.thickness,
        }
    }

    /// Springs k: k h on w along a side, and k h³/12 on the rotations; k on w over a face.
    fn springs(&self, springs: &[Spring]) -> Option<Entries> {
        let mut forms = Vec::new();
        for Spring { place, in_plane, across, .. } in springs {
            let along = place.along(self.ends());
            let mut add = |factor: f64, part: Part| {
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
    fn support_load(&self, springs: &[Spring]) -> (Vec<f64>, f64) {
        let forms: Vec<(Linear, f64)> = springs
            .iter()
            .map(|Spring { place, across, displacement, .. }| {
                let factor = across * displacement * self.height(*place);
                (Linear { factor, part: deflection([0, 0]), place: place.along(self.ends()) }, *displacement)
            })
            .collect();
        let one = self.tensor.one(DEFLECTION);
        let work = |form: Linear| dot(&self.tensor.vector(&[form]), &one);
        let offset = forms.iter().map(|(form, displacement)| 0.5 * displacement * work(*form)).sum();
        let forms: Vec<Linear> = forms.into_iter().map(|(form, _)| form).collect();
        (self.tensor.vector(&forms), offset)
    }

    /// Body force and tractions.
    fn load(&self, boundary: &Boundary) -> Vec<f64> {
        let part = deflection([0, 0]);
        let body = Linear { factor: boundary.body_force * self.section.thickness, part, place: AREA };
        let tractions = boundary.tractions.iter().map(|(place, value)| Linear {
            factor: value * self.height(*place),
            part,
            place: place.along(self.ends()),
        });
        let forms: Vec<Linear> = tractions.chain([body]).filter(|form| form.factor != 0.0).collect();
        self.tensor.vector(&forms)
    }

    /// Unknowns of clamped sides, the last clamp's value for each, and those of planes of symmetry.
    fn held(&self, clamps: &[Clamp]) -> Vec<(usize, f64)> {
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
    fn localization(&self, local: Option<&Local>, copies: f64) -> Vec<f64> {
        let mut a = vec![0.0; self.tensor.unknowns()];
        let Some(Local { radius, reading, .. }) = local else {
            self.tensor.add_point(deflection([0, 0]), self.frame.hit, 1.0, &mut a);
            return a;
        };
        let [x, y] = self.lines;
        let of_stretch = reading * self.section.thickness.powi(2);
        for (point, weight) in pressure_rule(self.frame.hit, *radius, [x, y]) {
            let weight = copies * weight;
            self.tensor.add_point(deflection([0, 0]), point, weight, &mut a);
            self.tensor.add_point(rotation(0, [1, 0]), point, weight * of_stretch, &mut a);
            self.tensor.add_point(rotation(1, [0, 1]), point, weight * of_stretch, &mut a);
        }
        a
    }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}
