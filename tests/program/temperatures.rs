//! Tests of sweeps over the temperature of a laminate, or over the modulus of its interlayer.

use mpi_test::{PlainTest, tests};

use crate::results::{column, folder, good, number, open};
use crate::sweeps::members;

pub const TESTS: &[PlainTest] = tests![
    temperatures_have_the_relaxation_of_their_own,
    temperatures_beyond_the_shift_are_noted,
    temperatures_on_a_shared_basis_are_within_their_estimates,
    many_temperatures_are_within_their_estimates,
    stiff_terms_that_relax_at_once_hold_nothing,
    sweeps_name_the_member_that_needs_the_solid,
];

/// Sweeps over so many temperatures that other members would share one merged basis. The peak force, the deflection and the
/// largest tension of some are compared with a run with a tenth of the tolerance. No difference exceeds the estimate. Two ranks
/// give the same results.
fn many_temperatures_are_within_their_estimates() {
    let folder = folder(&pane(&[6.9e6, 3.9e6, 2.3e6]));
    good(&folder, 0, "sweep scene.toml --vary body.temperature=0..46:24 -o s.h5");
    let sweep = folder.path().join("s.h5");
    let of_sweep = |name: &str, member: usize| members(&sweep, name)[member];
    for member in [2, 13, 22] {
        let set = format!("--set body.temperature={} --set accuracy.tolerance=2e-3", 2 * member);
        good(&folder, 0, &format!("run scene.toml {set} -o run.h5 --force"));
        let run = folder.path().join("run.h5");
        let largest = |name: &str| column(&run, name).into_iter().map(f64::abs).fold(0.0, f64::max);
        let own = [
            ("peak_force", "first_contact_error", largest("contact/force")),
            ("largest_deflection", "deflection_error_estimate", largest("contact/surface_displacement")),
            ("largest_stress", "stress_error_estimate", number::<f64>(&open(run.clone()), "largest_stress")),
        ];
        for (name, estimate, own) in own {
            let (error, estimate) = ((of_sweep(name, member) / own - 1.0).abs(), of_sweep(estimate, member));
            assert!(error <= estimate && estimate < 4e-2, "{member}, {name}: {error:e} {estimate:e}");
        }
    }
    good(&folder, 2, "sweep scene.toml --vary body.temperature=0..46:24 -o two.h5");
    assert_eq!(members(&folder.path().join("two.h5"), "peak_force"), members(&sweep, "peak_force"));
}

/// The series of an interlayer falls from 290 MPa to 0.3 MPa. In the warm, most of it relaxes within microseconds, and the
/// slow terms of 1 MPa determine the force. It agrees with a run with a tenth of the tolerance, within the estimate. (When
/// the loss of each term was relative to the largest one alone, slow terms did not relax, and the force was 9% too large.)
fn stiff_terms_that_relax_at_once_hold_nothing() {
    let moduli = [120e6, 90e6, 50e6, 20e6, 8e6, 3e6, 1e6, 0.4e6];
    let scene = pane(&moduli).replace("shear = 3e6", "shear = 3e5").replace("end = 6e-4", "end = 4e-3");
    let folder = folder(&scene);
    let run = |tolerance: &str| {
        let set = format!("--set impactor.mass=10.0 --set body.temperature=50 --set accuracy.tolerance={tolerance}");
        good(&folder, 0, &format!("run scene.toml {set} -o run.h5 --force"));
        let path = folder.path().join("run.h5");
        let peak = column(&path, "contact/force").into_iter().fold(0.0, f64::max);
        (peak, number::<f64>(&open(path), "error_estimate"))
    };
    let ((peak, estimate), (exact, _)) = (run("2e-2"), run("2e-3"));
    let error = (peak / exact - 1.0).abs();
    assert!(error <= estimate && estimate < 3e-2, "{error:e} {estimate:e}");
}

/// The plies of the first member slide on each other, and the layerwise plate is not accurate enough for it. All members are
/// computed as solids.
fn sweeps_name_the_member_that_needs_the_solid() {
    let small = pane(&[1e3]).replace("[0.3, 0.3]", "[0.12, 0.12]").replace("mass = 2.0", "mass = 0.3");
    let folder = folder(&small.replace("model = \"layerwise\"\n", "").replace("end = 6e-4", "end = 1e-4"));
    let line = "sweep scene.toml --set accuracy.tolerance=2e-2 --vary material.interlayer.shear=1e5,1e9 -o s.h5";
    let said = good(&folder, 0, line).stderr;
    let [needs, suffices] = ["member 0: material.interlayer.shear=", "member 1: material.interlayer.shear="];
    assert!(said.contains(&format!("solid for all members, because {needs}")), "{said}");
    assert!(said.contains(&format!("layerwise suffices for {suffices}")), "{said}");
    assert!(said.contains("--set body.model=layerwise"), "{said}");
}

/// Sweeps over temperatures so close that one basis serves for both. Each peak is compared with the peak of a separate
/// run with a quarter of the tolerance. No difference exceeds the estimate.
fn temperatures_on_a_shared_basis_are_within_their_estimates() {
    let folder = folder(&pane(&[6.9e6, 3.9e6, 2.3e6]));
    good(&folder, 0, "sweep scene.toml --vary body.temperature=20,20.1 -o s.h5");
    let sweep = folder.path().join("s.h5");
    let estimates = members(&sweep, "error_estimate");
    for (n, peak) in members(&sweep, "peak_force").into_iter().enumerate() {
        let temperature = 20.0 + 0.1 * n as f64;
        good(
            &folder,
            0,
            &format!(
                "run scene.toml --set body.temperature={temperature} --set accuracy.tolerance=5e-3 -o run.h5 --force"
            ),
        );
        let own = column(&folder.path().join("run.h5"), "contact/force").into_iter().fold(0.0, f64::max);
        let error = (peak / own - 1.0).abs();
        assert!(error <= estimates[n] && estimates[n] < 3e-2, "{temperature} °C: {error:e} {estimates:?}");
    }
}

/// A layerwise pane whose interlayer has Prony terms with these moduli (Pa); the relaxation times begin at 10 µs and
/// are a decade apart.
fn pane(moduli: &[f64]) -> String {
    let glass = "[[body.layer]]\nthickness = 0.005\nmaterial = \"glass\"\n";
    let term = |(n, modulus): (usize, &f64)| format!("{{ modulus = {modulus:e}, time = 1e{} }}", n as i32 - 5);
    let terms: Vec<String> = moduli.iter().enumerate().map(term).collect();
    format!(
        "title = \"Laminate\"\n[body]\nsize = [0.3, 0.3]\nmodel = \"layerwise\"\ntemperature = 20.0\n{glass}\
         [[body.layer]]\nthickness = 0.00076\nmaterial = \"interlayer\"\n{glass}\
         [material.glass]\nyoung = 70e9\npoisson = 0.23\ndensity = 2500.0\n\
         [material.interlayer]\nbulk = 2e9\ndensity = 1100.0\nshear = 3e6\nprony = [{}]\n\
         wlf = {{ c1 = 20.7, c2 = 91.1, reference = 20.0 }}\n\
         [impactor]\nmass = 2.0\nradius = 0.05\nyoung = 210e9\npoisson = 0.3\nspeed = 1.0\n\
         [time]\nend = 6e-4\n[accuracy]\ntolerance = 2e-2\n",
        terms.join(", ")
    )
}

/// Far from the glass transition the time–temperature shift is extrapolated, which is noted.
fn temperatures_beyond_the_shift_are_noted() {
    let scene = concat!(env!("CARGO_MANIFEST_DIR"), "/scenes/laminate.toml");
    let folder = folder(&std::fs::read_to_string(scene).unwrap());
    for (temperature, is_told) in [(200.0, true), (-60.0, true), (20.0, false), (60.0, false)] {
        let said = good(&folder, 0, &format!("check scene.toml --set body.temperature={temperature}")).stdout;
        let told = said.lines().any(|line| line.starts_with("note ") && line.contains("WLF's formula usually holds"));
        assert_eq!(told, is_told, "{temperature}: {said}");
        // A room temperature in kelvin would be 200 °C or more.
        assert_eq!(said.contains("body.temperature is in °C"), temperature >= 200.0, "{temperature}: {said}");
        assert!(!said.contains("body.temperature is not given"), "{temperature}: {said}");
    }
    let said = good(&folder, 0, "check scene.toml --set body.temperature=").stdout;
    assert!(
        said.contains(
            "body.temperature is not given: relaxation times are those at the reference temperature of wlf, 20 °C"
        ),
        "{said}"
    );
}

/// Each temperature of a laminate uses its own relaxation times, also at a temperature where no term of the Prony
/// series has to be followed in time. Each member's force agrees with its own run within the tolerances of both.
fn temperatures_have_the_relaxation_of_their_own() {
    let laminate = r#"
        title = "Laminate"
        [body]
        size = [0.3, 0.3]
        model = "layerwise"
        temperature = 20.0
        [[body.layer]]
        thickness = 0.005
        material = "glass"
        [[body.layer]]
        thickness = 0.00152
        material = "interlayer"
        [[body.layer]]
        thickness = 0.005
        material = "glass"
        [material.glass]
        young = 70e9
        poisson = 0.23
        density = 2500.0
        [material.interlayer]
        bulk = 2e9
        density = 1100.0
        shear = 1e6
        prony = [{ modulus = 300e6, time = 1e-3 }]
        wlf = { c1 = 20.0, c2 = 90.0, reference = 20.0 }
        [impactor]
        mass = 2.0
        radius = 0.05
        young = 210e9
        poisson = 0.3
        speed = 1.0
        [time]
        end = 1e-3
    "#;
    let folder = folder(laminate);
    good(&folder, 0, "sweep scene.toml --vary body.temperature=-10,20,35,40 -o s.h5");
    let peaks = members(&folder.path().join("s.h5"), "peak_force");
    for (temperature, peak) in ["-10", "20", "35", "40"].into_iter().zip(&peaks) {
        good(&folder, 0, &format!("run scene.toml --set body.temperature={temperature} -o run.h5"));
        let own = column(&folder.path().join("run.h5"), "contact/force").into_iter().fold(0.0, f64::max);
        assert!((peak / own - 1.0).abs() < 2e-2, "{temperature} °C: {peak} {own}");
    }
    assert!(peaks[0] > 1.1 * peaks[3], "a cold interlayer is stiffer: {peaks:?}");
}
