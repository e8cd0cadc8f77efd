//! One-sided elastic supports (12): the part of a body that is not linear.

use mpi::collective::SystemOperation;
use mpi::traits::CommunicatorCollectives;
use petsc_wrap::{Comm, Gather, Insert, Int, Matrix, Vector};

use crate::error::Result;
use crate::form::PadForms;
use crate::mesh::Mesh;
use crate::scene::{Support, SupportKind};

use super::Clamps;
use super::assembly::unknowns;

/// All pads of a scene, on this rank's facets.
pub struct Pads {
    comm: Comm,
    pads: Vec<Pad>,
    /// Displacements of all facets of all pads, one after the other.
    gather: Gather,
    /// 1 for a free unknown of those, 0 for a clamped one.
    free: Vec<f64>,
    /// Unknowns of a facet.
    each: usize,
    block: Vec<f64>,
}

/// One pad: the facets that lie on it.
struct Pad {
    forms: PadForms,
    facets: Vec<(Vec<[f64; 3]>, Vec<Int>)>,
}

impl Pads {
    /// The pads among the supports; `None` where the scene has none. Collective.
    ///
    /// # Errors
    /// PETSc's.
    pub fn new(mesh: &Mesh, supports: &[Support], clamps: &Clamps) -> Result<Option<Self>> {
        let elements = &mesh.facets;
        let mut pads = Vec::new();
        for support in supports {
            let SupportKind::Pad { stiffness, normal } = support.kind else { continue };
            let forms = PadForms::new(elements.shape, elements.order, stiffness, normal, support.displacement);
            let facet = |&i: &usize| {
                let mut indices = Vec::new();
                unknowns(elements.nodes(i), &mut indices);
                (elements.x(i).to_vec(), indices)
            };
            pads.push(Pad { forms, facets: mesh.surfaces[&support.surface].iter().map(facet).collect() });
        }
        if pads.is_empty() {
            return Ok(None);
        }
        let all = pads.iter().flat_map(|pad| &pad.facets).flat_map(|(_, indices)| indices.iter().copied());
        let indices: Vec<Int> = all.collect();
        let mut gather = Gather::new(&clamps.free, &indices)?;
        let free = gather.fetch(&clamps.free)?.to_vec();
        let each = 3 * elements.nodes_each();
        let comm = mesh.comm.clone();
        Ok(Some(Self { comm, pads, gather, free, each, block: vec![0.0; each * each] }))
    }

    /// Adds the free part of p(u), N, to `f`, which may be longer than u. Collective; assembles `f`.
    ///
    /// # Errors
    /// PETSc's.
    pub fn add_force(&mut self, u: &Vector, f: &mut Vector) -> petsc_wrap::Result<()> {
        self.add(u, f, PadForms::residual)
    }

    /// As [`Pads::add_force`], the largest tangent times u: that of pads pressed everywhere ([`PadForms::pressed`]).
    ///
    /// # Errors
    /// PETSc's.
    pub fn add_pressed(&mut self, u: &Vector, f: &mut Vector) -> petsc_wrap::Result<()> {
        self.add(u, f, PadForms::pressed)
    }

    fn add(
        &mut self,
        u: &Vector,
        f: &mut Vector,
        kernel: impl Fn(&PadForms, &[[f64; 3]], &[f64], &mut [f64]),
    ) -> petsc_wrap::Result<()> {
        let block = &mut self.block[..self.each];
        let u = self.gather.fetch(u)?;
        let mut parts = u.chunks_exact(self.each).zip(self.free.chunks_exact(self.each));
        for pad in &self.pads {
            for ((x, indices), (u, free)) in pad.facets.iter().zip(&mut parts) {
                kernel(&pad.forms, x, u, block);
                block.iter_mut().zip(free).for_each(|(value, free)| *value *= free);
                f.set_values(indices, block, Insert::Add)?;
            }
        }
        f.assemble()
    }

    /// Adds the free part of ∂p/∂u (semi-smooth), N/m, to a matrix, which must be assembled afterwards. Collective.
    ///
    /// # Errors
    /// PETSc's.
    pub fn add_tangent(&mut self, u: &Vector, matrix: &mut Matrix) -> petsc_wrap::Result<()> {
        let u = self.gather.fetch(u)?;
        let mut parts = u.chunks_exact(self.each).zip(self.free.chunks_exact(self.each));
        for pad in &mut self.pads {
            for ((x, indices), (u, free)) in pad.facets.iter().zip(&mut parts) {
                pad.forms.tangent(x, u, &mut self.block);
                for (row, i) in self.block.chunks_exact_mut(self.each).zip(free) {
                    row.iter_mut().zip(free).for_each(|(value, j)| *value *= i * j);
                }
                matrix.set_values(indices, indices, &self.block, Insert::Add)?;
            }
        }
        Ok(())
    }

    /// ∫ ½ k ⟨·⟩² dS over all pads, J, the same on all ranks. Collective.
    ///
    /// # Errors
    /// PETSc's.
    pub fn potential(&mut self, u: &Vector) -> petsc_wrap::Result<f64> {
        let u = self.gather.fetch(u)?;
        let mut parts = u.chunks_exact(self.each);
        let mut here = 0.0;
        for pad in &self.pads {
            for ((x, _), u) in pad.facets.iter().zip(&mut parts) {
                here += pad.forms.potential(x, u);
            }
        }
        let mut all = 0.0;
        self.comm.mpi().all_reduce_into(&here, &mut all, SystemOperation::sum());
        Ok(all)
    }
}
