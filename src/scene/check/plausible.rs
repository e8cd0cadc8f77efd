//! Refuses values that are valid numbers but cannot describe an impact. The error names the key to blame.

use super::super::{Body, Geometry, Impactor, SceneError, Source};
use super::numbers::show;
use crate::contact::{ForceLaw, Hertz, hertz};

/// Longest allowed run, in contact times on a half-space.
const LONGEST: f64 = 1e8;

/// Shortest allowed run, in contact times on a half-space. In a shorter one the force is only rounding.
const SHORTEST: f64 = 1e-4;

/// Wave speed below which the material is to blame, m/s. Waves in the softest foams are faster.
const SLOWEST: f64 = 10.0;

/// Largest allowed radius of the contact on a half-space over the longest edge of the body. Soft contacts of small
/// bodies reach some hundred. Larger values are wrong by powers of ten.
const LARGEST: f64 = 1e3;

/// Radius of the impactor over the longest edge of the body above which the size of the body is to blame.
const SPECK: f64 = 1e4;

/// Radius above which the impactor is to blame, m. No impactor is so flat.
const FLAT: f64 = 1e4;

/// Density below which the density is to blame, kg/m³. No solid is lighter.
const LIGHTEST: f64 = 1e-2;
/// Density above which the density is to blame, kg/m³. No solid is heavier.
const HEAVIEST: f64 = 1e6;

/// Speed of light, m/s.
const LIGHT: f64 = 3e8;

/// Ratio of a given contact stiffness to the stiffness for two bodies of the plate's material, or its inverse, from
/// which the given stiffness is to blame.
const STRANGE: f64 = 1e6;

/// Keys that determine the contact on a half-space. If one of them was overridden, the error message says so.
const CONTACT_KEYS: [&str; 9] = [
    "impactor.stiffness",
    "impactor.mass",
    "impactor.speed",
    "impactor.radius",
    "impactor.young",
    "body.young",
    "contact.stiffness",
    "contact.exponent",
    "contact.table",
];

/// Keys of the stiffness and the density of the impacted material.
#[derive(Clone, Copy)]
pub(super) struct Keys<'a> {
    pub stiffness: &'a str,
    pub density: &'a str,
}

/// Checks that the speed, the extent of the contact and the end of the run are possible. `is_stiffness_given` says
/// whether the scene gives the contact stiffness of the impactor.
///
/// # Errors
/// - If waves in the body are faster than light.
/// - If the impactor is faster than waves in the body.
/// - If the contact is more than [`LARGEST`] times as large as the body.
/// - If the run is very many contacts long, or a very small part of one.
pub(super) fn check(
    source: &Source,
    (body, keys): (&Body, Keys),
    (impactor, is_stiffness_given): (&Impactor, bool),
    end: f64,
) -> Result<(), SceneError> {
    let struck = body.struck();
    let wave = (struck.young / struck.density).sqrt();
    if wave > LIGHT {
        let message = format!("waves in the body would be faster than light, {wave:.1e} m/s");
        let help = "Young's modulus in Pa, as 70e9, and the density in kg/m3, as 2500";
        let key = if struck.density < LIGHTEST { keys.density } else { keys.stiffness };
        return Err(source.error_with(key, &[keys.stiffness, keys.density], message, help));
    }
    let hit = impactor.hit_speed();
    if hit > wave {
        let message = format!("the impactor's {hit:.3e} m/s are faster than waves in the body, {wave:.3e} m/s");
        // No solid has waves as slow as `SLOWEST`.
        let (key, help) = match wave < SLOWEST {
            true if struck.density > HEAVIEST => (keys.density, "the density in kg/m3, as 2500 for glass"),
            true => (keys.stiffness, "Young's modulus in Pa, so that 70 GPa are 70e9, and the density in kg/m3"),
            false => {
                ("impactor.speed", "a speed in m/s well below that: the body takes part in the impact by its waves")
            }
        };
        return Err(source.error_with(key, &[keys.density, "impactor.speed", "impactor.drop_height"], message, help));
    }
    let of_material = (struck.young, struck.poisson);
    let natural = impactor.radius.map_or(f64::NAN, |radius| hertz::stiffness(radius, of_material, of_material));
    let is_strange = is_stiffness_given
        && Ball::of(impactor).is_some_and(|ball| !(natural / STRANGE..natural * STRANGE).contains(&ball.stiffness));
    let error = |key: &str, message: String, help: &str| match is_strange {
        true => {
            let help = format!("in N/m^1.5: two bodies of the plate's material would have {natural:.1e}");
            source.error_with("impactor.stiffness", &["impactor.radius"], message, help)
        }
        false => source.error_with(key, &CONTACT_KEYS, message, help),
    };
    if let (Geometry::Box { size, .. }, Some(ball)) = (&body.geometry, Ball::of(impactor)) {
        let edge = size.iter().copied().fold(0.0, f64::max);
        if ball.contact() > LARGEST * edge {
            let key = culprit(body, &ball, edge, size.iter().product::<f64>());
            let message = format!(
                "on a half-space the contact would have a radius of {:.3e} m, and the longest edge of the body is {} m",
                ball.contact(),
                show(edge)
            );
            return Err(error(key, message, "values in SI units: kg, m, m/s, Pa"));
        }
    }
    let contact = impactor.contact_time();
    if end > LONGEST * contact {
        let message = format!(
            "a run of {} s is {:.1e} times as long as a contact on a half-space, {contact:.3e} s",
            show(end),
            end / contact
        );
        return Err(error("time.end", message, "the end of the run in s, some contacts later"));
    }
    if impactor.gap == 0.0 && end < SHORTEST * contact {
        let message =
            format!("a run of {} s is {:.1e} of a contact on a half-space, {contact:.3e} s", show(end), end / contact);
        return Err(error("time.end", message, "the end of the run in s, at least a contact long"));
    }
    Ok(())
}

/// An impactor whose contact obeys Hertz's law.
#[derive(Clone, Copy)]
struct Ball {
    /// Mass, kg.
    mass: f64,
    /// Radius of the rounded end, m.
    radius: f64,
    /// Contact stiffness k0, N/m^1.5.
    stiffness: f64,
    /// Impact speed, m/s.
    speed: f64,
}

impl Ball {
    /// `None` if the contact has another law.
    fn of(impactor: &Impactor) -> Option<Self> {
        let Impactor { mass, radius, force_law: ForceLaw::Hertz(Hertz { stiffness }), .. } = *impactor else {
            return None;
        };
        Some(Self { mass, radius: radius?, stiffness, speed: impactor.contact_speed() })
    }

    /// Hertz's contact radius at the peak of an impact on a half-space, m.
    fn contact(&self) -> f64 {
        (self.radius * hertz::peak_indentation(self.stiffness, self.mass, self.speed)).sqrt()
    }
}

/// Key to blame for a contact far larger than the body: with an ordinary value of it, the contact is small enough.
fn culprit(body: &Body, ball: &Ball, edge: f64, volume: f64) -> &'static str {
    if SPECK * edge < ball.radius && ball.radius < FLAT {
        return "body.size";
    }
    let heavy = Ball { mass: ball.mass.min(body.struck().density * volume), ..*ball };
    if heavy.contact() <= LARGEST * edge {
        return "impactor.mass";
    }
    // k0 is proportional to √R.
    let small = edge.min(ball.radius);
    let blunt = Ball { radius: small, stiffness: ball.stiffness * (small / ball.radius).sqrt(), ..*ball };
    if blunt.contact() <= LARGEST * edge { "impactor.radius" } else { "body.size" }
}
