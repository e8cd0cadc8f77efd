//! One-sided foundation pads (12): the nonlinear part of a body.

use std::ops::Range;

use mpi::collective::SystemOperation;
use mpi::traits::CommunicatorCollectives;
use petsc_wrap::{Comm, Gather, Insert, Int, MatrixView, Vector, VectorView};

use crate::error::Result;
use crate::form::PadElement;

use super::Clamps;

/// All pads of a scene on this rank's part of the surface.
pub struct Pads {
    comm: Comm,
    elements: Vec<PadOnSurface>,
    /// Gathers the displacements of all elements, one element after the other.
    gather: Gather,
    /// 1 for a free unknown of these displacements, 0 for a constrained one.
    free: Vec<f64>,
    block: Vec<f64>,
}

/// Pad on one element of the surface.
#[derive(Debug, Clone)]
pub struct PadOnSurface {
    /// Global numbers of the element's unknowns.
    pub unknowns: Vec<Int>,
    /// Reaction law of the pad.
    pub element: PadElement,
    /// Number of the surface region under the pad, counted over all pads.
    pub place: usize,
}

/// Quadrature points of pads, with a separate point for each displacement component. A point reacts with w ⟨g⟩ s φ_a on
/// each of its unknowns, g = Σ s φ_a u_a − s ū.
#[derive(Debug, Clone, Default)]
pub struct PadPoints {
    /// Stiffness w of each point, N/m.
    pub weights: Vec<f64>,
    /// Offset s ū of each point, m.
    pub offsets: Vec<f64>,
    /// Surface region of each point, counted over all pads.
    pub places: Vec<usize>,
    /// Number of unknowns of each point.
    pub counts: Vec<usize>,
    /// Global numbers of the unknowns, point by point.
    pub unknowns: Vec<Int>,
    /// Signed shape functions s φ_a, point by point.
    pub values: Vec<f64>,
    /// Whether each unknown is free, point by point.
    pub free: Vec<bool>,
}

impl Pads {
    /// Creates the pads from this rank's elements. Collective.
    ///
    /// # Errors
    /// If a PETSc call fails.
    pub fn new(comm: &Comm, elements: Vec<PadOnSurface>, clamps: &Clamps) -> Result<Self> {
        let indices: Vec<Int> = elements.iter().flat_map(|pad| pad.unknowns.iter().copied()).collect();
        let mut gather = Gather::new(&clamps.free, &indices)?;
        let free = gather.fetch(&clamps.free)?.to_vec();
        Ok(Self { comm: comm.clone(), elements, gather, free, block: Vec::new() })
    }

    /// Adds the reaction p of the pads on the free unknowns, N, to `f`, which may be longer than u. Without `from`, the
    /// reaction is p(u). With a previous displacement `from`, it is the discrete gradient of the potential between the
    /// two displacements. Collective; assembles `f`.
    ///
    /// # Errors
    /// If a PETSc call fails.
    pub fn add_force(&mut self, from: Option<&Vector>, u: &Vector, f: &mut VectorView) -> petsc_wrap::Result<()> {
        let from = self.fetch_from(from)?;
        self.add(u, f, |element, place, u, block| element.residual(part(&from, place), u, block))
    }

    /// Like [`Pads::add_force`], but adds the tangent of pads pressed everywhere ([`PadElement::pressed`]) times u.
    /// This is the largest possible tangent.
    ///
    /// # Errors
    /// If a PETSc call fails.
    pub fn add_pressed(&mut self, u: &Vector, f: &mut VectorView) -> petsc_wrap::Result<()> {
        self.add(u, f, |element, _, u, block| element.pressed(u, block))
    }

    /// Adds the result of a kernel for each element. The kernel gets the range of the element's values in the gathered
    /// vector.
    fn add(
        &mut self,
        u: &Vector,
        f: &mut VectorView,
        kernel: impl Fn(&PadElement, Range<usize>, &[f64], &mut [f64]),
    ) -> petsc_wrap::Result<()> {
        let Self { elements, gather, free, block, .. } = self;
        let u = gather.fetch(u)?;
        for (pad, place) in placed(elements) {
            block.resize(place.len(), 0.0);
            kernel(&pad.element, place.clone(), &u[place.clone()], block);
            block.iter_mut().zip(&free[place]).for_each(|(value, free)| *value *= free);
            f.set_values(&pad.unknowns, block, Insert::Add)?;
        }
        f.assemble()
    }

    /// Adds `factor` ∂p/∂u (semi-smooth) on the free unknowns, N/m, to a matrix, which must be assembled afterwards.
    /// The reaction p is defined in [`Self::add_force`]. Collective.
    ///
    /// # Errors
    /// If a PETSc call fails.
    pub fn add_tangent(
        &mut self,
        from: Option<&Vector>,
        u: &Vector,
        factor: f64,
        matrix: &mut MatrixView,
    ) -> petsc_wrap::Result<()> {
        let from = self.fetch_from(from)?;
        let Self { elements, gather, free, block, .. } = self;
        let u = gather.fetch(u)?;
        for (pad, place) in placed(elements) {
            let free = &free[place.clone()];
            block.resize(free.len() * free.len(), 0.0);
            pad.element.tangent(part(&from, place.clone()), &u[place], block);
            for (row, i) in block.chunks_exact_mut(free.len()).zip(free) {
                row.iter_mut().zip(free).for_each(|(value, j)| *value *= factor * i * j);
            }
            matrix.set_values(&pad.unknowns, &pad.unknowns, block, Insert::Add)?;
        }
        Ok(())
    }

    /// Adds the pads as springs that act in both directions: their stiffness to a matrix, which must be assembled
    /// afterwards, and ∫ k ū·v dS to a vector. Returns ½ ∫ k ū·ū dS, J, equal on all ranks. Collective.
    ///
    /// # Errors
    /// If a PETSc call fails.
    pub fn add_springs(&self, matrix: &mut MatrixView, load: &mut VectorView) -> petsc_wrap::Result<f64> {
        let (mut square, mut vector, mut offset) = (Vec::new(), Vec::new(), 0.0);
        for PadOnSurface { unknowns, element, .. } in &self.elements {
            square.resize(unknowns.len().pow(2), 0.0);
            vector.resize(unknowns.len(), 0.0);
            element.pressed_tangent(&mut square);
            element.load(|point| point.offset, &mut vector);
            matrix.set_values(unknowns, unknowns, &square, Insert::Add)?;
            load.set_values(unknowns, &vector, Insert::Add)?;
            offset += element.points().iter().map(|point| 0.5 * point.weight * point.offset.powi(2)).sum::<f64>();
        }
        load.assemble()?;
        Ok(self.sum(offset))
    }

    /// Returns ∫ k s·v dS over each surface region with pads. Collective.
    ///
    /// # Errors
    /// If a PETSc call fails.
    pub fn loads(&self, like: &Vector) -> petsc_wrap::Result<Vec<Vector>> {
        let mut places: Vec<u64> =
            self.comm.all_gather(&self.elements.iter().map(|pad| pad.place as u64).collect::<Vec<_>>());
        places.sort_unstable();
        places.dedup();
        let mut block = Vec::new();
        let of_place = |place: u64| {
            let mut load = like.duplicate()?;
            for pad in self.elements.iter().filter(|pad| pad.place as u64 == place) {
                block.resize(pad.unknowns.len(), 0.0);
                pad.element.load(|_| 1.0, &mut block);
                load.set_values(&pad.unknowns, &block, Insert::Add)?;
            }
            load.assemble()?;
            Ok(load)
        };
        places.into_iter().map(of_place).collect()
    }

    /// Returns Σ s φ_a u_a at all points, m, in the order of [`Self::points`]. Collective.
    ///
    /// # Errors
    /// If a PETSc call fails.
    pub fn moved(&mut self, u: &Vector) -> petsc_wrap::Result<Vec<f64>> {
        let u = self.gather.fetch(u)?;
        let here: Vec<f64> = placed(&self.elements).flat_map(|(pad, place)| pad.element.moved(&u[place])).collect();
        Ok(self.comm.all_gather(&here))
    }

    /// Returns the free unknowns that a pad can push, as ascending global numbers, equal on all ranks. Collective.
    pub fn pushed(&self) -> Vec<Int> {
        let mut here: Vec<Int> = Vec::new();
        for (pad, place) in placed(&self.elements) {
            let free = &self.free[place];
            let pushed = pad.element.points().iter().flat_map(|point| &point.unknowns);
            here.extend(pushed.filter(|&&i| free[i] != 0.0).map(|&i| pad.unknowns[i]));
        }
        distinct(&mut here);
        let mut all = self.comm.all_gather(&here);
        distinct(&mut all);
        all
    }

    /// Returns the points of the pads of all ranks, on every rank. Collective.
    pub fn points(&self) -> PadPoints {
        let (mut points, mut free) = (PadPoints::default(), Vec::new());
        for (pad, place) in placed(&self.elements) {
            let of_element = &self.free[place];
            for point in pad.element.points() {
                points.places.push(pad.place);
                points.weights.push(point.weight);
                points.offsets.push(point.offset);
                points.counts.push(point.unknowns.len());
                points.unknowns.extend(point.unknowns.iter().map(|&i| pad.unknowns[i]));
                points.values.extend(&point.values);
                free.extend(point.unknowns.iter().map(|&i| u8::from(of_element[i] != 0.0)));
            }
        }
        PadPoints {
            weights: self.comm.all_gather(&points.weights),
            offsets: self.comm.all_gather(&points.offsets),
            places: self.comm.all_gather(&points.places),
            counts: self.comm.all_gather(&points.counts),
            unknowns: self.comm.all_gather(&points.unknowns),
            values: self.comm.all_gather(&points.values),
            free: self.comm.all_gather(&free).into_iter().map(|free| free != 0).collect(),
        }
    }

    fn fetch_from(&mut self, from: Option<&Vector>) -> petsc_wrap::Result<Option<Vec<f64>>> {
        from.map(|from| Ok(self.gather.fetch(from)?.to_vec())).transpose()
    }

    /// Returns the potential ∫ ½ k ⟨·⟩² dS of all pads, J, equal on all ranks. Collective.
    ///
    /// # Errors
    /// If a PETSc call fails.
    pub fn potential(&mut self, u: &Vector) -> petsc_wrap::Result<f64> {
        let u = self.gather.fetch(u)?;
        let here: f64 = placed(&self.elements).map(|(pad, place)| pad.element.potential(&u[place])).sum();
        drop(u);
        Ok(self.sum(here))
    }

    fn sum(&self, here: f64) -> f64 {
        let mut all = 0.0;
        self.comm.mpi().all_reduce_into(&here, &mut all, SystemOperation::sum());
        all
    }
}

/// Iterates over the elements, each with the range of its values in the gathered vector.
fn placed(elements: &[PadOnSurface]) -> impl Iterator<Item = (&PadOnSurface, Range<usize>)> {
    elements.iter().scan(0, |end, pad| {
        let start = std::mem::replace(end, *end + pad.unknowns.len());
        Some((pad, start..*end))
    })
}

fn distinct(list: &mut Vec<Int>) {
    list.sort_unstable();
    list.dedup();
}

/// Returns the values in a range, if there are values.
fn part(all: &Option<Vec<f64>>, place: Range<usize>) -> Option<&[f64]> {
    all.as_ref().map(|all| &all[place])
}
