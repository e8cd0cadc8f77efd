//! Hertz's law of contact, F = k0 ⟨α⟩^{3/2}, and the impact on a half-space that follows from it.

/// Contact stiffness k0 of (15), N/m^1.5, from the radius (m) and the pairs (Young's modulus in Pa, Poisson's ratio)
/// of body and impactor.
pub fn stiffness(
    radius: f64,
    (young1, poisson1): (f64, f64),
    (young2, poisson2): (f64, f64),
) -> f64 {
    let compliance = (1.0 - poisson1 * poisson1) / young1 + (1.0 - poisson2 * poisson2) / young2;
    4.0 / 3.0 * radius.sqrt() / compliance
}

/// Contact time on a half-space, s: 3.21807 (m²/(k0² v))^{1/5} (Hertz 1882).
pub fn contact_time(stiffness: f64, mass: f64, speed: f64) -> f64 {
    3.21807 * ((mass / stiffness).powi(2) / speed).powf(0.2)
}

/// Peak force on a half-space, N: 1.14326 k0^{2/5} m^{3/5} v^{6/5} (Hertz 1882).
pub fn peak_force(stiffness: f64, mass: f64, speed: f64) -> f64 {
    1.14326 * stiffness.powf(0.4) * mass.powf(0.6) * speed.powf(1.2)
}
