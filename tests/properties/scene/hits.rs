//! Speed of the hit, duration of contacts, and the error of Hertz's law on one layer.

use ricochet::scene::{Impactor, Scene};

/// A free pane of 0.125 kg, with keys of the impactor and other tables.
fn impactor(keys: &str, rest: &str) -> Result<Impactor, String> {
    let text = format!(
        "[body]\nyoung = 70e9\npoisson = 0.23\ndensity = 2500.0\nsize = [0.1, 0.1, 0.005]\n[time]\nend = 1.0\n{rest}\n\
         [impactor]\nmass = 0.1\nradius = 0.05\nyoung = 210e9\npoisson = 0.3\n{keys}\n"
    );
    Scene::parse("test", &text, &[]).map(|(scene, _)| scene.impactor).map_err(|error| error.to_string())
}

const GRAVITY: f64 = 9.80665;
const SIDES: &str = "[[support]]\nsurface = \"side\"\nkind = \"elastic\"\nstiffness = 1e9\n";

/// v² + 2 g h with every sign: down, from rest, after a free fall, and up.
#[test]
fn the_weight_changes_the_speed_up_to_the_hit() {
    let (gap, up) = (0.3, "direction = [0, 0, 1]");
    for (keys, square) in [
        ("speed = 0.5".to_owned(), 0.25),
        ("speed = 0.5\ngravity = true".to_owned(), 0.25 + 2.0 * GRAVITY * gap),
        ("speed = 0\ngravity = true".to_owned(), 2.0 * GRAVITY * gap),
        ("drop_height = 0.2\ngravity = true".to_owned(), 2.0 * GRAVITY * (0.2 + gap)),
        (format!("speed = 3\ngravity = true\n{up}"), 9.0 - 2.0 * GRAVITY * gap),
    ] {
        let found = impactor(&format!("{keys}\ngap = {gap}"), SIDES).unwrap();
        // Rounding.
        assert!((found.hit_speed() / f64::sqrt(square) - 1.0).abs() < 1e-14, "{keys}: {}", found.hit_speed());
        let time = found.flight_time();
        let way = time * (found.speed + 0.5 * found.gravity * time);
        assert!((way / gap - 1.0).abs() < 1e-14, "{keys}: {way}");
        // The contact is that of an impactor that hits at this speed, but for the small work of the weight in it.
        let direct = impactor(&format!("speed = {}", f64::sqrt(square)), SIDES).unwrap();
        assert!((found.contact_time() / direct.contact_time() - 1.0).abs() < 1e-4);
        assert!((found.peak_force() / direct.peak_force() - 1.0).abs() < 2e-3);
    }
    let turns_back = impactor(&format!("speed = 1\ngravity = true\ngap = {gap}\n{up}"), SIDES).unwrap();
    assert_eq!((turns_back.flight_time(), turns_back.hit_speed()), (f64::INFINITY, 1.0));
}

/// From rest, something must drive the impactor to the surface.
#[test]
fn an_impactor_at_rest_needs_its_weight_and_a_gap() {
    for keys in ["", "gap = 0.1", "gravity = true", "gravity = true\ngap = 0.1\ndirection = [0, 0, 1]"] {
        let refused = impactor(&format!("speed = 0\n{keys}"), SIDES).unwrap_err();
        assert!(refused.contains("must be positive"), "{keys}: {refused}");
    }
}

/// A free body that falls with the impactor is hit at the speed at t = 0; on supports it does not fall.
#[test]
fn a_free_body_falls_with_the_impactor() {
    let keys = "speed = 0.5\ngap = 0.1\ngravity = true";
    let load = format!("[load]\ngravity = [0, 0, -{GRAVITY}]\n");
    let [free, held] = [load.clone(), load + SIDES].map(|rest| impactor(keys, &rest).unwrap().hit_speed());
    assert!((free - 0.5).abs() < 1e-15 && held > 1.4, "{free} {held}");
}

/// The weight of an impactor that is laid on a half-space: the force oscillates up to (n + 1) times the weight with F ∝ αⁿ,
/// from ∫ F dα = m g α.
#[test]
fn the_weight_does_work_in_the_contact() {
    let found = impactor("speed = 1e-9\ngravity = true", SIDES).unwrap();
    assert!((found.peak_force() / (2.5 * 0.1 * GRAVITY) - 1.0).abs() < 1e-6, "{}", found.peak_force());
}

/// Far above the mass of a body that is free or held softly, the mass of an impactor does not lengthen its contact. Of ordinary
/// impactors it does.
#[test]
fn a_light_body_bounds_the_contact_time() {
    let soft = "[[support]]\nsurface = \"side\"\nkind = \"elastic\"\nstiffness = 1e3\n";
    for rest in ["", soft] {
        let of_scene = |mass: f64| {
            let text = format!(
                "[body]\nyoung = 70e9\npoisson = 0.23\ndensity = 2500.0\nsize = [0.1, 0.1, 0.005]\n[time]\nend = 1.0\n{rest}\n\
                 [impactor]\nmass = {mass}\nradius = 0.05\nyoung = 210e9\npoisson = 0.3\nspeed = 0.2\n"
            );
            Scene::parse("test", &text, &[]).unwrap().0.impactor.contact_time()
        };
        assert_eq!(of_scene(1e3), of_scene(1e6));
        // T ∝ m^{2/5}.
        assert!((of_scene(10.0) / of_scene(0.1) - 100_f64.powf(0.4)).abs() < 1e-12);
    }
}

/// Estimate of Hertz's error on a bonded sheet against the error found by an integral equation for a bonded layer (pressure by
/// orthogonal polynomials, ν = 0.3), at contact radii of 0.41 to 1.05 times the thickness. It is an estimate by Ritz's method
/// without the rest of the body: not below the error, and at most twice as large.
#[test]
fn the_error_of_hertzs_law_on_a_thin_sheet_is_estimated() {
    let of_sheet = |ratio: f64, support: &str, size: &str| {
        let (young, radius, thickness) = (5e6, 0.05, 0.005);
        // Speed with which a half-space is hit for this contact radius.
        let indentation = (ratio * thickness).powi(2) / radius;
        let modulus = 1.0 / ((1.0 - 0.3 * 0.3) / young + (1.0 - 0.3 * 0.3) / 210e9);
        let stiffness = 4.0 / 3.0 * f64::sqrt(radius) * modulus;
        let speed = (0.8 * stiffness * f64::powf(indentation, 2.5) / 0.1).sqrt();
        let text = format!(
            "[body]\nyoung = {young:e}\npoisson = 0.3\ndensity = 1100.0\nsize = {size}\n{support}\n[time]\nend = 0.01\n\
             [impactor]\nmass = 0.1\nradius = {radius}\nyoung = 210e9\npoisson = 0.3\nspeed = {speed}\n"
        );
        Scene::parse("test", &text, &[]).unwrap().0.impactor.error_of_law()
    };
    let sheet = "[0.12, 0.12, 0.005]";
    for support in [
        "kind = \"clamped\"",
        "kind = \"elastic\"\nstiffness = 1e11",
        "kind = \"pad\"\nstiffness = 1e11\nnormal = [0, 0, -1]",
    ] {
        let support = format!("[[support]]\nsurface = \"bottom\"\n{support}\n");
        for (ratio, error) in [(0.41, 0.016), (0.77, 0.046), (1.05, 0.076)] {
            let estimate = of_sheet(ratio, &support, sheet);
            assert!(estimate > 0.9 * error && estimate < 2.0 * error, "{ratio}: {estimate} {error}");
        }
        assert_eq!(of_sheet(0.2, &support, sheet), 0.0);
    }
    // On its side the same sheet is a thick body.
    let side = "[[support]]\nsurface = \"bottom\"\nkind = \"clamped\"\n";
    assert_eq!(of_sheet(0.77, side, "[0.12, 0.12, 0.05]"), 0.0);
}

/// A direction within a degree of the face is no impact; two degrees are.
#[test]
fn an_impactor_does_not_slide_along_a_face() {
    for (slope, is_hit) in [(1e-6, false), (0.017, false), (0.035, true)] {
        let found = impactor(&format!("speed = 1\npoint = [0, 0, 0.0025]\ndirection = [1, 0, -{slope}]"), SIDES);
        assert_eq!(found.is_ok(), is_hit, "{slope}: {found:?}");
    }
}
