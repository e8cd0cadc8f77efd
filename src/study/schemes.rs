//! The time integration schemes that a study compares, and their names.

use crate::scene::Scheme;

/// The schemes to compare, unconditionally stable ones first. The scene's own scheme is appended if it is not among
/// them.
pub(super) fn compared(own: Scheme) -> Vec<Scheme> {
    let mut schemes = vec![
        Scheme::Newmark { beta: 0.25, gamma: 0.5 },
        Scheme::GeneralizedAlpha { rho_inf: 0.8 },
        Scheme::GeneralizedAlpha { rho_inf: 0.5 },
        Scheme::GeneralizedAlpha { rho_inf: 0.0 },
        Scheme::Energy,
        Scheme::Newmark { beta: 1.0 / 6.0, gamma: 0.5 },
        Scheme::CentralDifference { allow_unstable: true },
        Scheme::Newmark { beta: 0.25, gamma: 0.45 },
    ];
    if !is_explicit(own) && !schemes.contains(&own) {
        schemes.push(own);
    }
    schemes
}

/// Whether the scheme uses the lumped mass.
pub(super) fn is_explicit(scheme: Scheme) -> bool {
    matches!(scheme, Scheme::CentralDifference { .. })
}

/// The name and parameters of the scheme as written in a scene file.
pub fn name(scheme: Scheme) -> String {
    match scheme {
        Scheme::Newmark { beta, gamma } => format!("newmark beta={} gamma={}", short(beta), short(gamma)),
        Scheme::GeneralizedAlpha { rho_inf } => format!("generalized-alpha rho_inf={}", short(rho_inf)),
        Scheme::Energy => "energy".to_owned(),
        Scheme::CentralDifference { .. } => "central-difference".to_owned(),
    }
}

/// The common name of the scheme, for tables and charts.
pub fn label(scheme: Scheme) -> String {
    match scheme {
        Scheme::Newmark { beta: 0.25, gamma: 0.5 } => "average acceleration".to_owned(),
        Scheme::Newmark { beta, gamma: 0.5 } if beta == 1.0 / 6.0 => "linear acceleration".to_owned(),
        Scheme::Newmark { beta, gamma } => format!("Newmark β = {}, γ = {}", short(beta), short(gamma)),
        Scheme::GeneralizedAlpha { rho_inf } => format!("generalised-α, ρ∞ = {}", short(rho_inf)),
        Scheme::Energy => "energy-conserving".to_owned(),
        Scheme::CentralDifference { .. } => "central difference".to_owned(),
    }
}

/// Rounds to four decimals.
fn short(value: f64) -> f64 {
    (value * 1e4).round() / 1e4
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_scenes_own_scheme_is_there_once() {
        let count = compared(Scheme::Energy).len();
        assert_eq!(compared(Scheme::CentralDifference { allow_unstable: false }).len(), count);
        let own = Scheme::Newmark { beta: 0.3025, gamma: 0.6 };
        let all = compared(own);
        assert_eq!((all.len(), all.last()), (count + 1, Some(&own)));
        let names: std::collections::HashSet<_> = all.iter().map(|scheme| name(*scheme)).collect();
        assert_eq!(names.len(), all.len());
    }
}
