//! Values of a scene that are allowed but implausible.

use crate::bad_scenes::SMALL;
use crate::bad_scenes::layers::LAMINATE;
use ricochet::cli::notes::of_values;
use ricochet::scene::Scene;

/// The doubts about the small scene with overrides, one line each.
fn doubted(overrides: &[&str]) -> Vec<String> {
    doubted_of(SMALL, overrides)
}

/// Same as [`doubted`], for any scene.
fn doubted_of(text: &str, overrides: &[&str]) -> Vec<String> {
    let overrides: Vec<String> = overrides.iter().map(|&given| given.into()).collect();
    let (scene, source) = Scene::parse("scene.toml", text, &overrides).unwrap();
    let all = of_values(&scene, &source);
    assert!(all.iter().all(|doubt| doubt.size > 1.0));
    all.into_iter().map(|doubt| doubt.text).collect()
}

#[test]
fn values_in_other_units_are_told_with_their_key_and_a_remedy() {
    for (overrides, parts) in [
        // Given in GPa and in MPa; the first is refused at higher speeds.
        (&["body.young=210", "impactor.speed=0.1"][..], [":2: body.young: 210 Pa", "70 GPa are 70e9"]),
        (&["body.young=70000"], [":2: body.young: 70000 Pa is softer", "(set by --set body.young=70000)"]),
        (&["body.young=1e15"], ["body.young: ", "stiffer than diamond"]),
        (&["impactor.young=210"], ["impactor.young: 210 Pa is softer", "in Pa"]),
        (&["body.density=2.5"], ["body.density: 2.5 kg/m3 is lighter than foam", "2.5 g/cm3 are 2500"]),
        (&["body.density=2.5e6"], ["body.density: ", "heavier than any metal"]),
        (&["strength.tension=45"], ["strength.tension: 45 Pa is weaker than foam", "45 MPa are 4.5e7"]),
        (&["strength.face.lower=45"], ["strength.face.lower: 45 Pa is weaker than foam", "in Pa"]),
        (&["strength.tension=45e9"], ["strength.tension: 4.5e10 Pa is stronger than any steel", "45 MPa are 45e6"]),
        (&["strength.face.lower=45e9"], ["strength.face.lower: 4.5e10 Pa is stronger", "in Pa"]),
        // Given in N/mm3.
        (
            &["support=[{surface=\"side\",kind=\"elastic\",stiffness=5}]"],
            ["support.0.stiffness: 5 N/m3 is softer than a mattress", "1 N/mm3 is 1e9"],
        ),
        (
            &["support=[{surface=\"side\",kind=\"elastic\",stiffness=[0,0,5]}]"],
            ["support.0.stiffness: 5 N/m3 is softer", "in N/m3"],
        ),
        (&["impactor.radius=50"], ["impactor.radius: a ball of 50 m and 52 kg", "50 mm are 0.05"]),
        (&["load.body_force=[0,0,-1e12]"], ["load.body_force: the loads accelerate the body by 4.0e8 m/s2", "in N/m3"]),
        (
            &["load.traction=[{surface=\"top\",value=[0,0,-1e30]}]"],
            ["load.traction.0.value: a traction of 1.4e19", "in Pa"],
        ),
        (&["time.end=500"], ["time.end: a run of 500 s", "500 ms are 0.5"]),
        (&["time.step=5e-3"], ["time.step: a step of 0.005 s is longer than a contact", "at most"]),
    ] {
        let said = doubted(overrides);
        assert_eq!(said.len(), 1, "{overrides:?}: {said:?}");
        assert!(parts.iter().all(|part| said[0].contains(part)), "{parts:?}: {said:?}");
    }
}

/// Shear and bulk moduli are checked as Young's modulus is; the shear modulus of a viscoelastic material at t = 0.
#[test]
fn shear_and_bulk_moduli_in_other_units_are_told() {
    for (overrides, parts) in [
        // In MPa: the shear modulus after relaxation, and all terms.
        (
            &["material.interlayer.shear=3", "material.interlayer.prony=[{modulus=7,time=1e-5},{modulus=4,time=1e-4}]"]
                [..],
            [
                "material.interlayer.shear: the shear modulus of 1.400e1 Pa at t = 0",
                "softer than rubber",
                "2 GPa are 2e9",
            ],
        ),
        (&["material.interlayer.bulk=2000"], ["material.interlayer.bulk: 2000 Pa is softer", "rubber", "in Pa"]),
        (&["material.interlayer.bulk=2e15"], ["material.interlayer.bulk: 2", "stiffer than diamond", "in Pa"]),
    ] {
        let said = doubted_of(LAMINATE, overrides);
        assert_eq!(said.len(), 1, "{overrides:?}: {said:?}");
        assert!(parts.iter().all(|part| said[0].contains(part)), "{parts:?}: {said:?}");
    }
    // An elastic layer given by its shear modulus.
    let elastic = LAMINATE.replace("young = 70e9", "shear = 28");
    let said = doubted_of(&elastic, &["impactor.speed=0.001"]);
    assert!(
        matches!(&said[..], [one] if one.contains("material.glass.shear: 28 Pa is softer than rubber")),
        "{said:?}"
    );
    // A material that relaxes to a shear modulus of zero is allowed, and plausible.
    assert_eq!(doubted_of(LAMINATE, &["material.interlayer.shear=0"]), Vec::<String>::new());
}

/// Relative terms, as other programs have them, are told; small ones in Pa beside a small modulus are not.
#[test]
fn relative_relaxation_is_told() {
    let terms = "material.interlayer.prony=[{modulus=0.6,time=1e-4},{modulus=0.35,time=1e-2}]";
    let said = doubted_of(LAMINATE, &["material.interlayer.shear=1e6", terms]);
    assert!(
        matches!(&said[..], [one] if one.contains("material.interlayer.prony: the terms add up to 0.95 Pa")
            && one.contains("multiply each relative one by the modulus at t = 0")),
        "{said:?}"
    );
    let large = "material.interlayer.prony=[{modulus=0.6e6,time=1e-4},{modulus=0.35e6,time=1e-2}]";
    assert_eq!(doubted_of(LAMINATE, &["material.interlayer.shear=1e6", large]), Vec::<String>::new());
}

/// A layer's thickness in millimetres is told: one layer, and all of them.
#[test]
fn a_thickness_in_millimetres_is_told() {
    let said = doubted_of(LAMINATE, &["body.layer.1.thickness=0.76"]);
    assert!(
        matches!(&said[..], [one] if one.contains("body.layer.1.thickness: a layer of 0.76 m is thick beside edges of 0.5 and 0.5 m")
            && one.contains("0.76 mm are 7.6e-4")),
        "{said:?}"
    );
    let all = ["body.layer.0.thickness=8", "body.layer.1.thickness=1.52", "body.layer.2.thickness=8"];
    let said = doubted_of(LAMINATE, &all);
    assert!(said.len() == 2 && said.iter().all(|one| one.contains("8 mm are 0.008")), "{said:?}");
    // A thick concrete slab with a thin topping, a sandwich with a thick core, a layered bar.
    for size_and_layers in [["[3,3]", "0.3", "0.005"], ["[0.5,0.5]", "0.09", "0.001"], ["[0.02,0.02]", "0.5", "0.02"]] {
        let [size, thick, thin] = size_and_layers;
        let overrides = [
            format!("body.size={size}"),
            format!("body.layer.0.thickness={thin}"),
            format!("body.layer.1.thickness={thick}"),
            format!("body.layer.2.thickness={thin}"),
        ];
        let overrides: Vec<&str> = overrides.iter().map(String::as_str).collect();
        assert_eq!(doubted_of(LAMINATE, &overrides), Vec::<String>::new());
    }
}

/// A temperature in kelvin is told, for a material whose relaxation depends on it.
#[test]
fn a_temperature_in_kelvin_is_told() {
    let scene = "[body]\nsize = [0.6, 0.4]\ntemperature = 293\n\
         [[body.layer]]\nthickness = 0.01\nmaterial = \"glass\"\n[[body.layer]]\nthickness = 0.002\nmaterial = \"soft\"\n\
         [material.glass]\nyoung = 70e9\npoisson = 0.23\ndensity = 2500.0\n\
         [material.soft]\ndensity = 1100.0\nbulk = 2e9\nshear = 1e6\nprony = [{ modulus = 4e7, time = 1e-4 }]\n\
         wlf = { reference = 20.0, c1 = 12.6, c2 = 74.46 }\n\
         [impactor]\nmass = 1.0\nradius = 0.05\nstiffness = 1e10\nspeed = 1.0\n[time]\nend = 1e-3\n";
    let overrides = ["body.temperature=20", "material.soft.wlf.reference=293.15"].map(str::to_owned);
    let error = Scene::parse("scene.toml", scene, &overrides).expect_err("below the pole");
    assert!(error.to_string().contains("wlf") && error.advice().contains("293.15 K are 20 °C"), "{error}");
    let cold = doubted_of(scene, &["body.temperature=200.15"]);
    assert!(matches!(&cold[..], [one] if one.contains("200.15 K are -73 °C")), "{cold:?}");
    let hot = doubted_of(scene, &[]);
    assert!(matches!(&hot[..], [one] if one.contains("293 °C is hotter") && one.contains("293 K are 19.8")), "{hot:?}");
}

/// Unusual but plausible values are not doubted: rubber, aluminium foam, a flat hammer, a rigid impactor, many bounces,
/// few steps.
#[test]
fn unusual_values_are_not_doubted() {
    for overrides in [
        &[][..],
        &["body.young=2e6", "body.density=1100", "impactor.speed=0.5"],
        &["body.density=200", "body.young=1e9"],
        &["impactor.radius=0.9"],
        &["impactor.young=1e15"],
        &["strength.tension=3.5e9"],
        &["support=[{surface=\"side\",kind=\"elastic\",stiffness=5e4}]"],
        &["support=[{surface=\"side\",kind=\"elastic\",stiffness=[0,0,1e9]}]"],
        &["time.end=1"],
        &["time.step=5e-4"],
    ] {
        assert_eq!(doubted(overrides), Vec::<String>::new(), "{overrides:?}");
    }
}
