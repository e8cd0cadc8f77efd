//! One-sided elastic supports (12): the part of a body that is not linear.

use std::ops::Range;

use mpi::collective::SystemOperation;
use mpi::traits::CommunicatorCollectives;
use petsc_wrap::{Comm, Gather, Insert, Int, MatrixView, Vector, VectorView};

use crate::error::Result;
use crate::form::PadElement;

use super::Clamps;

/// All pads of a scene, on this rank's part of the surface.
pub struct Pads {
    comm: Comm,
    elements: Vec<PadOnSurface>,
    /// Displacements of all elements, one after the other.
    gather: Gather,
    /// 1 for a free unknown of those, 0 for a clamped one.
    free: Vec<f64>,
    block: Vec<f64>,
}

/// A pad under an element of the surface.
#[derive(Debug, Clone)]
pub struct PadOnSurface {
    /// Global numbers of the element's unknowns.
    pub unknowns: Vec<Int>,
    /// What pushes back.
    pub element: PadElement,
    /// The number of its place among those of all pads.
    pub place: usize,
}

/// Pads as their quadrature points, component by component: a point pushes back with w ⟨g⟩ on each of its unknowns times s φ_a,
/// g = Σ s φ_a u_a − s ū.
#[derive(Debug, Clone, Default)]
pub struct PadPoints {
    /// w, N/m, by point.
    pub weights: Vec<f64>,
    /// s ū, m, by point.
    pub offsets: Vec<f64>,
    /// How many unknowns each point has.
    pub counts: Vec<usize>,
    /// Global numbers of the unknowns, point by point.
    pub unknowns: Vec<Int>,
    /// s φ_a, likewise.
    pub values: Vec<f64>,
    /// Whether the unknown is free, likewise.
    pub free: Vec<bool>,
}

impl Pads {
    /// Of this rank's elements. Collective.
    ///
    /// # Errors
    /// PETSc's.
    pub fn new(comm: &Comm, elements: Vec<PadOnSurface>, clamps: &Clamps) -> Result<Self> {
        let indices: Vec<Int> = elements.iter().flat_map(|pad| pad.unknowns.iter().copied()).collect();
        let mut gather = Gather::new(&clamps.free, &indices)?;
        let free = gather.fetch(&clamps.free)?.to_vec();
        Ok(Self { comm: comm.clone(), elements, gather, free, block: Vec::new() })
    }

    /// Adds the free part of p, N, to `f`, which may be longer than u: p(u), or, with a displacement `from`, the discrete
    /// gradient of the potential between the two. Collective; assembles `f`.
    ///
    /// # Errors
    /// PETSc's.
    pub fn add_force(&mut self, from: Option<&Vector>, u: &Vector, f: &mut VectorView) -> petsc_wrap::Result<()> {
        let from = self.fetch_from(from)?;
        self.add(u, f, |element, place, u, block| element.residual(part(&from, place), u, block))
    }

    /// As [`Pads::add_force`], the largest tangent times u: that of pads pressed everywhere ([`PadElement::pressed`]).
    ///
    /// # Errors
    /// PETSc's.
    pub fn add_pressed(&mut self, u: &Vector, f: &mut VectorView) -> petsc_wrap::Result<()> {
        self.add(u, f, |element, _, u, block| element.pressed(u, block))
    }

    /// Adds a kernel's part of each element; it gets the place of the element's values among those of all.
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

    /// Adds the free part of `factor` ∂p/∂u (semi-smooth), N/m, to a matrix, which must be assembled afterwards; p as in
    /// [`Self::add_force`]. Collective.
    ///
    /// # Errors
    /// PETSc's.
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

    /// The pads as springs in both directions: adds their K to a matrix, which must be assembled afterwards, and ∫ k ū·v dS to a vector;
    /// returns ½ ∫ k ū·ū dS, J, the same on all ranks. Collective.
    ///
    /// # Errors
    /// PETSc's.
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

    /// ∫ k s·v dS over each place with pads. Collective.
    ///
    /// # Errors
    /// PETSc's.
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

    /// Σ s φ_a u_a at all points, m, in the order of [`Self::points`]. Collective.
    ///
    /// # Errors
    /// PETSc's.
    pub fn moved(&mut self, u: &Vector) -> petsc_wrap::Result<Vec<f64>> {
        let u = self.gather.fetch(u)?;
        let here: Vec<f64> = placed(&self.elements).flat_map(|(pad, place)| pad.element.moved(&u[place])).collect();
        Ok(self.comm.all_gather(&here))
    }

    /// The free unknowns that a pad can push, by global number, in order; the same on all ranks. Collective.
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

    /// The points of all pads, of all ranks on every rank. Collective.
    pub fn points(&self) -> PadPoints {
        let (mut points, mut free) = (PadPoints::default(), Vec::new());
        for (pad, place) in placed(&self.elements) {
            let of_element = &self.free[place];
            for point in pad.element.points() {
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
            counts: self.comm.all_gather(&points.counts),
            unknowns: self.comm.all_gather(&points.unknowns),
            values: self.comm.all_gather(&points.values),
            free: self.comm.all_gather(&free).into_iter().map(|free| free != 0).collect(),
        }
    }

    fn fetch_from(&mut self, from: Option<&Vector>) -> petsc_wrap::Result<Option<Vec<f64>>> {
        from.map(|from| Ok(self.gather.fetch(from)?.to_vec())).transpose()
    }

    /// ∫ ½ k ⟨·⟩² dS over all pads, J, the same on all ranks. Collective.
    ///
    /// # Errors
    /// PETSc's.
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

/// The elements, each with the place of its values among those of all.
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

/// The values at a place, where there are any.
fn part(all: &Option<Vec<f64>>, place: Range<usize>) -> Option<&[f64]> {
    all.as_ref().map(|all| &all[place])
}
