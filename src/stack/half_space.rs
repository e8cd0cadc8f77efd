//! Hertz's field: a half-space under p = p₀ √(1 − r²/a²) over a disc, p₀ = 3F/(2πa²), for F = 1.

use std::f64::consts::PI;

use super::Cylindrical;

/// Largest distance of a point from the contact, in contact radii. For a farther point the contact radius is increased.
/// The field is the same to 1e-6, and the formulas would lose digits with the small radius.
const FAR_FIELD_RADII: f64 = 1e3;

/// Stresses at a radius and a depth (m) under Hertz's pressure over a contact radius (m), for 1 N.
///
/// M. T. Huber, Ann. Phys. 14, 1904; K. L. Johnson, *Contact Mechanics*, 1985, ch. 3. The formulas are written in the
/// oblate spheroidal coordinates c and u, r² = (a² + u)(1 − c²), z² = u c². So they are also valid on the axis, on the
/// surface and at the edge of the contact. If both the contact radius and the distance are zero, no stress is defined
/// and zero is returned.
pub fn hertz(poisson: f64, radius: f64, depth: f64, contact_radius: f64) -> Cylindrical {
    let (rr, zz) = (radius * radius, depth * depth);
    let a = contact_radius.max((rr + zz).sqrt() / FAR_FIELD_RADII);
    let square = a * a;
    if square <= 0.0 {
        return Cylindrical::default();
    }
    // u − v = d and uv = a²z², with v = a²c².
    let d = rr + zz - square;
    let s = (d * d + 4.0 * square * zz).sqrt();
    let larger = 0.5 * (d.abs() + s);
    let smaller = if larger > 0.0 { square * zz / larger } else { 0.0 };
    let (u, v) = if d > 0.0 { (larger, smaller) } else { (smaller, larger) };
    let (root, c) = (u.sqrt(), v.sqrt() / a);
    // At the edge c³/s and c² √u/s tend to zero.
    let over_s = if s > 0.0 { square / s } else { 0.0 };
    let stretch = (1.0 - poisson) * u / (square + u);
    let angle = (1.0 + poisson) * root / a * a.atan2(root);
    let ring = (1.0 - 2.0 * poisson) / 3.0 * square * (1.0 + c + c * c) / ((1.0 + c) * (square + u));
    let along = c * c * c * over_s;
    let p0 = 1.5 / (PI * square);
    Cylindrical {
        rr: p0 * (ring + along + c * (stretch + angle - 2.0)),
        tt: -p0 * (ring + c * (2.0 * poisson + stretch - angle)),
        zz: -p0 * along,
        rz: -p0 * radius * c * c * root / (square + u) * over_s,
    }
}

/// Largest tension on the loaded face for 1 N, Pa: σ_rr = (1 − 2ν) p₀/3 = (1 − 2ν)/(2πa²) at the edge of the contact
/// (Johnson, (3.49)).
///
/// Outside the contact it decreases as (a/r)². It initiates Hertzian cone cracks. Because of its steep gradient it must
/// not be compared with the bending strength of a plate. The bending stress of the body at the edge is not included.
pub fn ring_tension(poisson: f64, contact_radius: f64) -> f64 {
    (1.0 - 2.0 * poisson) / (2.0 * PI * contact_radius * contact_radius)
}
