//! Supports and loads on the surface of a body, integrated on any space.

use super::Space;
use crate::body::PadOnSurface;
use crate::description::{Description, Part, Place, Region};
use crate::error::Result;
use crate::form::PadElement;
use crate::scene::Vec3;

/// Operators and loads of a description, without the mass and elasticity of the body.
pub struct SurfaceTerms<S: Space> {
    /// Stiffness K of the elastic supports, N/m; `None` if there are none.
    pub support: Option<S::Matrix>,
    /// Matrix C of the dampers, N s/m; `None` if there are none.
    pub damping: Option<S::Matrix>,
    /// Force vector of body forces and tractions, N.
    pub load: S::Vector,
    /// Vector ∫ k ū·v dS of the elastic supports, N.
    pub support_load: S::Vector,
    /// Energy ½ ∫ k ū·ū dS of the elastic supports of the modelled part, J.
    pub support_offset: f64,
    /// Unilateral supports (pads) on this rank.
    pub pads: Vec<PadOnSurface>,
}

impl<S: Space> SurfaceTerms<S> {
    /// Integrates a description. Collective.
    ///
    /// # Errors
    /// If a PETSc call fails, or if a cell is tangled (inverted).
    pub fn new(space: &S, description: &Description) -> Result<Self> {
        let Description { parts, springs, dampers, tractions, .. } = description;
        let tractions = tractions.iter().map(|term| (&term.region, term.value));
        let pulls = springs.iter().map(|term| {
            let traction = [0, 1, 2].map(|i| term.stiffness[i] * term.displacement[i]);
            (&term.region, traction)
        });
        Ok(Self {
            support: matrix(space, springs.iter().map(|term| (&term.region, term.stiffness)))?,
            damping: matrix(space, dampers.iter().map(|term| (&term.region, term.coefficient)))?,
            load: vector(space, parts, tractions)?,
            support_load: vector(space, &[], pulls)?,
            support_offset: support_offset(space, description)?,
            pads: pads(space, description)?,
        })
    }
}

/// Matrix ∫ k u·v dS summed over regions, each with its k by component; `None` if every k is zero.
fn matrix<'a, S: Space>(space: &S, terms: impl Iterator<Item = (&'a Region, Vec3)>) -> Result<Option<S::Matrix>> {
    let on_places = |(region, k): (&'a Region, Vec3)| region.iter().map(move |place| (place, k));
    let terms: Vec<(&Place, Vec3)> = terms.filter(|(_, k)| *k != [0.0; 3]).flat_map(on_places).collect();
    if terms.is_empty() {
        return Ok(None);
    }
    let places: Vec<&Place> = terms.iter().map(|(place, _)| *place).collect();
    let fill = |add: &mut super::Add| {
        let mut block = Vec::new();
        terms.iter().try_for_each(|(place, k)| {
            space.visit(place, &mut |unknowns, element| {
                block.resize(unknowns.len().pow(2), 0.0);
                element.spring(*k, &mut block);
                add(unknowns, &block)
            })
        })
    };
    space.matrix(&places, fill).map(Some)
}

/// Vector ∫ f·v dV of the body forces of the parts, plus ∫ f·v dS summed over regions, each with its f.
fn vector<'a, S: Space>(
    space: &S,
    parts: &[Part],
    terms: impl Iterator<Item = (&'a Region, Vec3)>,
) -> Result<S::Vector> {
    space.vector(|add| {
        if parts.iter().any(|part| part.force != [0.0; 3]) {
            space.body_force(parts, add)?;
        }
        let mut block = Vec::new();
        for (region, f) in terms.filter(|(_, f)| *f != [0.0; 3]) {
            for place in region {
                space.visit(place, &mut |unknowns, element| {
                    block.resize(unknowns.len(), 0.0);
                    element.traction(|_| f, &mut block);
                    add(unknowns, &block)
                })?;
            }
        }
        Ok(())
    })
}

fn support_offset<S: Space>(space: &S, description: &Description) -> Result<f64> {
    let mut offset = 0.0;
    for term in &description.springs {
        let density: f64 = (0..3).map(|i| 0.5 * term.stiffness[i] * term.displacement[i].powi(2)).sum();
        for place in term.region.iter().filter(|_| density != 0.0) {
            space.visit(place, &mut |_, element| {
                offset += density * element.area();
                Ok(())
            })?;
        }
    }
    Ok(space.sum(offset))
}

fn pads<S: Space>(space: &S, description: &Description) -> Result<Vec<PadOnSurface>> {
    let mut pads = Vec::new();
    let places = description.pads.iter().flat_map(|term| term.region.iter().map(move |place| (place, term)));
    for (number, (place, term)) in places.enumerate() {
        space.visit_roughly(place, &mut |unknowns, element| {
            let element = PadElement::new(element, &term.foundation);
            pads.push(PadOnSurface { unknowns: unknowns.to_vec(), element, place: number });
            Ok(())
        })?;
    }
    Ok(pads)
}
