//! Linear isotropic materials, elastic in volume, elastic or viscoelastic in shear.
//!
//! Viscoelastic shear is a generalised Maxwell chain ([`Maxwell`]): a spring in parallel with terms that are a spring
//! in series with a dashpot. Temperature multiplies all relaxation times by the same factor ([`Wlf`]). [`Decay`] is the
//! exact time step of the chain, and [`Pruned`] is the shorter chain that suffices for an impact.
//!
//! This module does not depend on a mesh.

mod decay;
mod maxwell;
mod prune;
mod wlf;

pub use decay::Decay;
pub use maxwell::{Maxwell, Term};
pub use prune::{Pruned, Window};
pub use wlf::Wlf;

use crate::form;

/// Linear isotropic material.
#[derive(Debug, Clone, PartialEq)]
pub struct Material {
    /// Elastic constants for t → 0, and the density. For an elastic material they hold at all times.
    pub instantaneous: form::Material,
    /// Shear relaxation modulus G(t) at the temperature of the body; `None` for an elastic material.
    pub shear: Option<Maxwell>,
    /// Temperature dependence of the relaxation times in `shear`, if given. It is already applied to them.
    pub shift: Option<Wlf>,
}

impl Material {
    /// Material that is elastic at all times.
    pub fn elastic(constants: form::Material) -> Self {
        Self { instantaneous: constants, shear: None, shift: None }
    }

    /// Material that is elastic in volume, with the bulk modulus K (Pa), and has G(t) in shear; density in kg/m³.
    ///
    /// E = 9KG/(3K + G) and ν = (3K − 2G)/(6K + 2G) are computed with the instantaneous G. A chain without terms yields
    /// an elastic material.
    pub fn of_moduli(bulk: f64, shear: Maxwell, density: f64) -> Self {
        let instantaneous = constants([bulk, shear.instantaneous()], density);
        Self { instantaneous, shear: Some(shear).filter(|shear| !shear.terms.is_empty()), shift: None }
    }

    /// Elastic constants with the secant shear modulus at a time (s) ([`Maxwell::secant`]); those at t = 0 are the
    /// instantaneous ones.
    pub fn secant(&self, time: f64) -> form::Material {
        let density = self.instantaneous.density;
        self.shear.as_ref().map_or(self.instantaneous, |shear| constants([self.bulk(), shear.secant(time)], density))
    }

    /// Bulk modulus K, Pa.
    pub fn bulk(&self) -> f64 {
        self.instantaneous.bulk()
    }

    /// Lamé's constants after all relaxation, with G∞; for an elastic material its constants.
    pub fn relaxed(&self) -> form::Lame {
        match &self.shear {
            None => self.instantaneous.lame(),
            Some(shear) => form::Lame::of_moduli(self.bulk(), shear.equilibrium),
        }
    }
}

/// Elastic constants E = 9KG/(3K + G) and ν = (3K − 2G)/(6K + 2G).
fn constants([bulk, shear]: [f64; 2], density: f64) -> form::Material {
    form::Material {
        young: 9.0 * bulk * shear / (3.0 * bulk + shear),
        poisson: (3.0 * bulk - 2.0 * shear) / (6.0 * bulk + 2.0 * shear),
        density,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn moduli_of_a_chain() {
        let shear = Maxwell { equilibrium: 3e6, terms: vec![Term { modulus: 7e6, time: 1e-3 }] };
        let material = Material::of_moduli(2e9, shear, 1100.0);
        // Rounding of some operations; ν is near ½, where K = E/(3(1 − 2ν)) loses two digits.
        assert!((material.bulk() / 2e9 - 1.0).abs() < 1e-12);
        let form::Lame { lambda, mu } = material.instantaneous.lame();
        assert!((mu / 10e6 - 1.0).abs() < 1e-12 && ((lambda + 2.0 * mu / 3.0) / 2e9 - 1.0).abs() < 1e-12);
        let form::Lame { lambda, mu } = material.relaxed();
        assert!(mu == 3e6 && ((lambda + 2e6) / 2e9 - 1.0).abs() < 1e-12);
        // A chain without terms is elastic.
        let alone = Material::of_moduli(2e9, Maxwell { equilibrium: 3e6, terms: Vec::new() }, 1100.0);
        assert_eq!(alone.shear, None);
    }
}
