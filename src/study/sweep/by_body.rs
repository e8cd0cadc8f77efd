//! Tells which members of a sweep have the same body.

use crate::body::rates;
use crate::description::Description;
use crate::form;
use crate::material::Maxwell;
use crate::model::shift;
use crate::scene::{self, Scene};

/// Description of a scene's body: the text of all properties that the body depends on.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub struct BodyOf(String);

/// Tolerance of a basis shared by members with different chains, relative to their tolerance. Error estimates were
/// measured to differ by a factor of two from 0 to 50 °C. Chains that share a local field hardly differ.
const SHARED_BASIS_TOLERANCE: f64 = 0.6;

/// The scene for which a family's shared basis is made: with a margin on the tolerance if the members differ in their
/// relaxation.
pub(super) fn shared(scene: Scene) -> Scene {
    let differ = scene.body.composition.is_viscoelastic() && !has_local_field(&scene);
    let margin = if differ { SHARED_BASIS_TOLERANCE } else { 1.0 };
    Scene { tolerance: margin * scene.tolerance, ..scene }
}

/// The Maxwell chains of a member's viscoelastic parts, in their order.
pub(super) fn chains(scene: &Scene) -> Vec<Maxwell> {
    if !scene.body.composition.is_viscoelastic() {
        return Vec::new();
    }
    Description::new(scene).relaxations().into_iter().map(|(chain, _)| chain.clone()).collect()
}

/// Largest relative difference, over the tolerance, of the moduli of bodies that share local constants. The local
/// constants changed a laminate's peak force by some 30% when the modulus fell to a thirtieth: 0.1 per unit of the
/// modulus' logarithm. Rounding leaves half of the difference.
const LARGEST_MODULUS_DIFFERENCE: f64 = 4.0;

impl BodyOf {
    /// The description of a scene's body. The chains of viscoelastic materials and the temperature are left out, except
    /// for the moduli of the local contact field: each member gives the body its chains
    /// ([`ModalBody::with_chains`](crate::body::ModalBody::with_chains)).
    pub fn new(scene: &Scene) -> Self {
        let time = scene.impactor.moduli_time();
        let materials = scene.body.composition.materials().into_iter().filter(|_| has_local_field(scene));
        // Rounded, because the influence of the local contact field is small.
        let moduli =
            materials.filter_map(|material| Some(rounded(material.shear.as_ref()?.secant(time), scene.tolerance)));
        Self::of(scene, &moduli.collect::<Vec<_>>(), &rates_of(scene))
    }

    /// The description for bodies that differ in the chains of viscoelastic materials and are tested for each of them.
    pub fn of_relaxations(scene: &Scene) -> Self {
        let time = scene.body.composition.is_viscoelastic().then(|| scene.impactor.contact_time());
        let local: Vec<String> = time.map(|time| rounded(time, scene.tolerance)).into_iter().collect();
        Self::of(scene, &local, &[])
    }

    /// The description without relaxation, and with the given constants of the local contact field and rates.
    fn of(scene: &Scene, local: &[String], rates: &[u32]) -> Self {
        let Scene { mut body, supports, impactor, contact, load, time, output, measure, cell_factor, .. } =
            scene.clone();
        // The disc under layers with their own contact law.
        let disc_of_law = impactor.layered_contact().map(|layered| layered.disc);
        // `alike` has for each viscoelastic material the index of the first one with the same chain. Materials with one
        // chain share one matrix D.
        let (mut bulk, mut chains, mut alike) = (Vec::new(), Vec::new(), Vec::new());
        for material in body.composition.materials_mut() {
            if let Some(chain) = material.shear.take() {
                alike.push(chains.iter().position(|other| *other == chain).unwrap_or(chains.len()));
                chains.push(chain);
                // Rounded, because the bulk modulus is computed from constants that depend on the shear modulus.
                bulk.push(format!("{:.8e}", material.bulk()));
                material.instantaneous = form::Material { young: 0.0, poisson: 0.0, ..material.instantaneous };
            }
        }
        body.temperature = None;
        let place = (impactor.point, impactor.direction, contact, disc_of_law);
        let settings = (time.initial, measure, cell_factor, output.stress);
        Self(format!("{:?}", (body, supports, load, place, settings, (bulk, alike, local), rates)))
    }
}

/// Whether a body depends on the secant moduli at half the contact time. A solid of one material resolves the field
/// under the impactor itself, so it needs them for stresses only.
pub(super) fn has_local_field(scene: &Scene) -> bool {
    let is_layered = scene.body.composition.uniform().is_none();
    scene.body.model != scene::Model::Solid || is_layered || scene.output.stress
}

/// Shifts at which the basis vectors are made for the chains, in hundredths of the first shift; empty for an elastic body.
/// A basis with fewer shifts may lack shapes of the body. The larger basis would lack them too, so the error estimate would
/// not show it.
fn rates_of(scene: &Scene) -> Vec<u32> {
    let chains = chains(scene);
    if chains.is_empty() {
        return Vec::new();
    }
    let first = shift(&shared(scene.clone()), false);
    let all = rates(&chains.iter().collect::<Vec<_>>(), first, scene.time.end);
    all.into_iter().map(|rate| (100.0 * rate / first).round() as u32).collect()
}

/// A value rounded to a width of [`LARGEST_MODULUS_DIFFERENCE`] times the tolerance in its logarithm.
fn rounded(value: f64, tolerance: f64) -> String {
    let width = LARGEST_MODULUS_DIFFERENCE * tolerance;
    format!("{:.3e}", ((value.ln() / width).round() * width).exp())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A laminated pane as a solid, with a Prony series of its interlayer. Its members share a basis for any moduli.
    fn pane(prony: &str) -> Scene {
        varied(prony, "")
    }

    /// The pane with further text.
    fn varied(prony: &str, rest: &str) -> Scene {
        let glass = "[[body.layer]]\nthickness = 0.005\nmaterial = \"glass\"\n";
        let text = format!(
            "[body]\nsize = [0.3, 0.3]\nmodel = \"solid\"\n{glass}\
             [[body.layer]]\nthickness = 0.00076\nmaterial = \"interlayer\"\n{glass}\
             [material.glass]\nyoung = 70e9\npoisson = 0.23\ndensity = 2500.0\n\
             [material.interlayer]\nbulk = 2e9\ndensity = 1100.0\nshear = 3e6\nprony = [{prony}]\n\
             [impactor]\nmass = 2.0\nradius = 0.05\nyoung = 210e9\npoisson = 0.3\nspeed = 1.0\n\
             [time]\nend = 6e-4\n[output]\nstress = false\n{rest}"
        );
        Scene::parse("test", &text, &[]).expect("a scene").0
    }

    /// A basis made at one shift is not shared with a body whose modulus falls to a small part.
    #[test]
    fn bodies_of_other_rates_have_other_bases() {
        let little = pane("{ modulus = 1e6, time = 1e-4 }");
        assert_eq!(rates_of(&little), [100]);
        assert_eq!(BodyOf::new(&little), BodyOf::new(&pane("{ modulus = 1.1e6, time = 9e-5 }")));
        let much = pane("{ modulus = 1e9, time = 1e-4 }");
        assert!(rates_of(&much).len() > 1, "{:?}", rates_of(&much));
        assert_ne!(BodyOf::new(&little), BodyOf::new(&much));
    }

    /// Cells of another size are another body.
    #[test]
    fn other_cells_are_another_body() {
        let of = |factor: f64| {
            let factor = format!("[accuracy]\ncell_factor = {factor}\n");
            BodyOf::new(&varied("{ modulus = 1e6, time = 1e-4 }", &factor))
        };
        assert_eq!(of(1.0), of(1.0));
        assert_ne!(of(1.0), of(0.5));
    }
}
