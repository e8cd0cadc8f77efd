//! Boxes in pure bending, with half of the functions across the thickness.

use std::ops::Range;

use petsc_wrap::Session;
use ricochet::impact::Errors;

use crate::glass;

use super::{block, body, parse, trace};

pub(super) fn bending_is_all_but_a_constant(session: &Session) {
    check_bending(session, 1..3);
    // A contact as short as waves across the thickness; and one with a pull along the plate.
    for (impactor, rest) in [("mass = 0.004\nspeed = 10.0", ""), ("mass = 5.0\nspeed = 1.0", PULL)] {
        let scene = parse(&glass::scene("size = [0.3, 0.3, 0.03]", impactor, "end = 1e-3", rest));
        let free = parse(&glass::scene("size = [0.3, 0.3, 0.03]", "mass = 5.0\nspeed = 1.0", "end = 1e-3", ""));
        assert!(10 * block(&free, 1.0).system.terms.load.len() < 7 * block(&scene, 1.0).system.terms.load.len());
    }
}

pub(super) fn bending_on_more_supports(session: &Session) {
    check_bending(session, 0..5);
}

/// A negligible load along a side, which forces the use of all functions across the thickness.
const PULL: &str = "[[load.traction]]\nsurface = \"x-max\"\nvalue = [1e-30, 0, 0]\n";

/// Plates in bending with half of the functions agree with the same plates with all of them.
fn check_bending(session: &Session, chosen: Range<usize>) {
    let uneven =
        "[[support]]\nsurface = \"side\"\nkind = \"elastic\"\nstiffness = [3e9, 1e9, 2e8]\ndamping = [1e5, 0, 2e5]\n";
    let two = "[[support]]\nsurface = \"x-min\"\nkind = \"clamped\"\n[[support]]\nsurface = \"y-max\"\nkind = \"clamped\"\ncomponents = [\"z\"]\n";
    let weight = "[load]\nbody_force = [0, 0, -25e3]\n";
    let cases = [
        ("", String::new()),
        ("", glass::sides(1e9, 1e5)),
        ("point = [0.06, -0.04, 0.015]", uneven.into()),
        ("", two.into()),
        ("", weight.into()),
    ];
    for (point, rest) in &cases[chosen] {
        let scene = |more: &str| {
            let impactor = format!("mass = 5.0\nspeed = 1.0\n{point}");
            let rest = format!("[accuracy]\ntolerance = 1e-3\n{rest}{more}");
            let body = "model = \"solid\"\nsize = [0.3, 0.3, 0.03]\nsymmetry = \"none\"";
            parse(&glass::scene(body, &impactor, "end = 2e-3\nscheme = \"modal\"", &rest))
        };
        let [half, whole] = ["", PULL].map(scene);
        let [bent, full] = [&half, &whole].map(|scene| body(session, scene, 1.0));
        assert!(10 * bent.unknowns() < 7 * full.unknowns(), "{} {}", bent.unknowns(), full.unknowns());
        let Errors { first_contact: first, .. } = trace(&half, &bent).difference(&trace(&whole, &full));
        println!("{first:.1e} in the first contact");
        // The difference comes from different cells across the thickness, a part in a thousand in either, and from
        // dynamic squeezing.
        assert!(first < 1.5e-3, "{point} {rest}: {first:e}");
        session.world().collect_garbage().unwrap();
    }
}
