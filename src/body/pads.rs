//! One-sided elastic supports (12): the part of a body that is not linear.

use mpi::collective::SystemOperation;
use mpi::traits::CommunicatorCollectives;
use petsc_wrap::{Comm, Gather, Insert, Int, MatrixView, Vector, VectorView};

use crate::error::Result;
use crate::form::{PadForms, PadPoint};
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

/// Pads as their quadrature points, component by component: a point pushes back with w ⟨g⟩ on each of its unknowns times s φ_a,
/// g = Σ s φ_a u_a − s ū.
#[derive(Debug, Clone, Default)]
pub struct PadPoints {
    /// Unknowns of a point.
    pub nodes: usize,
    /// w, N/m, by point.
    pub weights: Vec<f64>,
    /// s ū, m, by point.
    pub offsets: Vec<f64>,
    /// Global numbers of the unknowns, point by point.
    pub unknowns: Vec<Int>,
    /// s φ_a, likewise.
    pub values: Vec<f64>,
    /// Whether the unknown is free, likewise.
    pub free: Vec<bool>,
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

    /// Adds the free part of p, N, to `f`, which may be longer than u: p(u), or, with a displacement `from`, the discrete
    /// gradient of the potential between the two. Collective; assembles `f`.
    ///
    /// # Errors
    /// PETSc's.
    pub fn add_force(&mut self, from: Option<&Vector>, u: &Vector, f: &mut VectorView) -> petsc_wrap::Result<()> {
        let from = self.fetch_from(from)?;
        self.add(u, f, |forms, i, each, x, u, block| forms.residual(x, part(&from, i, each), u, block))
    }

    /// As [`Pads::add_force`], the largest tangent times u: that of pads pressed everywhere ([`PadForms::pressed`]).
    ///
    /// # Errors
    /// PETSc's.
    pub fn add_pressed(&mut self, u: &Vector, f: &mut VectorView) -> petsc_wrap::Result<()> {
        self.add(u, f, |forms, _, _, x, u, block| forms.pressed(x, u, block))
    }

    /// Adds a kernel's part of each facet; it gets the facet's number and its unknowns' number.
    fn add(
        &mut self,
        u: &Vector,
        f: &mut VectorView,
        kernel: impl Fn(&PadForms, usize, usize, &[[f64; 3]], &[f64], &mut [f64]),
    ) -> petsc_wrap::Result<()> {
        let each = self.each;
        let block = &mut self.block[..each];
        let u = self.gather.fetch(u)?;
        let mut parts = u.chunks_exact(each).zip(self.free.chunks_exact(each)).enumerate();
        for pad in &self.pads {
            for ((x, indices), (i, (u, free))) in pad.facets.iter().zip(&mut parts) {
                kernel(&pad.forms, i, each, x, u, block);
                block.iter_mut().zip(free).for_each(|(value, free)| *value *= free);
                f.set_values(indices, block, Insert::Add)?;
            }
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
        let u = self.gather.fetch(u)?;
        let mut parts = u.chunks_exact(self.each).zip(self.free.chunks_exact(self.each)).enumerate();
        for pad in &mut self.pads {
            for ((x, indices), (i, (u, free))) in pad.facets.iter().zip(&mut parts) {
                pad.forms.tangent(x, part(&from, i, self.each), u, &mut self.block);
                for (row, i) in self.block.chunks_exact_mut(self.each).zip(free) {
                    row.iter_mut().zip(free).for_each(|(value, j)| *value *= factor * i * j);
                }
                matrix.set_values(indices, indices, &self.block, Insert::Add)?;
            }
        }
        Ok(())
    }

    /// The free unknowns that a pad can push, by global number, in order; the same on all ranks. Collective.
    pub fn pushed(&self) -> Vec<Int> {
        let mut here: Vec<Int> = Vec::new();
        self.each_point(|_, entries| here.extend(entries.filter(|entry| entry.2).map(|entry| entry.0)));
        distinct(&mut here);
        let mut all = self.comm.all_gather(&here);
        distinct(&mut all);
        all
    }

    /// The points of all pads, of all ranks on every rank. Collective.
    pub fn points(&self) -> PadPoints {
        let mut points = PadPoints { nodes: self.each / 3, ..PadPoints::default() };
        let mut free = Vec::new();
        self.each_point(|point, entries| {
            points.weights.push(point.weight);
            points.offsets.push(point.offset);
            for (unknown, value, is_free) in entries {
                points.unknowns.push(unknown);
                points.values.push(value);
                free.push(u8::from(is_free));
            }
        });
        let all = |mine: &[f64]| self.comm.all_gather(mine);
        PadPoints {
            nodes: points.nodes,
            weights: all(&points.weights),
            offsets: all(&points.offsets),
            unknowns: self.comm.all_gather(&points.unknowns),
            values: all(&points.values),
            free: self.comm.all_gather(&free).into_iter().map(|free| free != 0).collect(),
        }
    }

    /// Visits this rank's points, each with (unknown, s φ_a, whether it is free) of the nodes of its facet.
    fn each_point(&self, mut visit: impl FnMut(&PadPoint, &mut dyn Iterator<Item = (Int, f64, bool)>)) {
        let mut free = self.free.chunks_exact(self.each);
        for pad in &self.pads {
            for ((x, indices), free) in pad.facets.iter().zip(&mut free) {
                for point in pad.forms.points(x) {
                    let unknowns = indices.iter().zip(free).skip(point.component).step_by(3);
                    let mut entries =
                        unknowns.zip(point.values).map(|((&i, &free), value)| (i, point.sign * value, free != 0.0));
                    visit(&point, &mut entries);
                }
            }
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

fn distinct(list: &mut Vec<Int>) {
    list.sort_unstable();
    list.dedup();
}

/// The values of facet `i`, with `each` of them a facet.
fn part(all: &Option<Vec<f64>>, i: usize, each: usize) -> Option<&[f64]> {
    all.as_ref().map(|all| &all[i * each..(i + 1) * each])
}
