//! Tests of `ricochet sweep`: its output, on any number of ranks, whole or in parts.

use crate::results;
use mpi_test::{PlainTest, tests};
use std::path::Path;
use tempfile::TempDir;

use crate::program::{ricochet, run};
use crate::results::{column, folder, good, number, pane, text, words};
use crate::sweeps::{content, members, messages, numbers, supported};

pub const TESTS: &[PlainTest] = tests![
    members_are_the_runs_of_their_scenes,
    probes_are_kept_with_series,
    probes_do_not_count_without_series,
    any_number_of_ranks_writes_the_same,
    a_family_answers_as_its_members,
    a_family_has_the_deflections_of_a_light_ball,
    families_are_of_one_property,
    layers_that_relax_alike_are_those_of_the_member,
    members_with_controlled_steps,
    a_member_has_the_estimate_of_its_run,
    shards_put_together_are_the_whole,
    a_member_that_fails_is_a_result,
    a_member_whose_scene_is_wrong_on_its_mesh_is_named,
    one_key_is_drawn_as_a_curve_and_two_as_a_map,
    a_map_over_decades_has_logarithmic_colours,
    what_no_figure_shows_is_said
];

/// A grid of six members.
const GRID: &str = "--vary support.0.stiffness=1e7..1e11:3 --vary time.scheme=newmark,energy --log";

/// Probes are kept with the series, in modal coordinates and in time steps: in a whole sweep, on two ranks, and
/// combined from parts.
fn probes_are_kept_with_series() {
    let probes = "[output]\nprobes = [{ name = \"below\", point = [0.1, 0, -0.01] }, { name = \"above\", point = [0.1, 0, 0.01] }]\n";
    let folder = folder(&(supported() + probes));
    let line = "sweep scene.toml --vary time.scheme=modal,newmark --series";
    good(&folder, 0, &format!("{line} -o alone.h5"));
    good(&folder, 2, &format!("{line} -o two.h5"));
    for part in ["1/2", "2/2"] {
        good(&folder, 0, &format!("{line} --shard {part} -o parts.h5"));
    }
    good(&folder, 0, &format!("{line} -o parts.h5"));
    for (n, scheme) in ["modal", "newmark"].into_iter().enumerate() {
        good(&folder, 0, &format!("run scene.toml --set time.scheme={scheme} -o run.h5"));
        for name in ["time", "probe/below/displacement", "probe/above/velocity", "probe/above/principal_stress"] {
            let single = column(&file(&folder, "run.h5"), name);
            assert!(single.iter().any(|value| *value != 0.0), "{name}");
            for sweep in ["alone.h5", "two.h5", "parts.h5"] {
                // The same program on one rank: the same numbers.
                assert_eq!(
                    numbers(&file(&folder, sweep), &format!("series/{n}/{name}")),
                    single,
                    "{sweep}: {n} {name}"
                );
            }
        }
    }
}

/// Without series a sweep keeps no probes, so one on the face of the given plate does not limit the thicknesses. A hit
/// off the centre with a point of two numbers stays on the face.
fn probes_do_not_count_without_series() {
    let folder = folder(&(supported() + "[output]\nprobes = [{ name = \"below\", point = [0.05, 0, -0.01] }]\n"));
    let line = "sweep scene.toml --set impactor.point=[0.1,0.05] --vary body.size.2=0.01,0.02";
    good(&folder, 0, &format!("{line} -o sweep.h5"));
    let forces = numbers(&file(&folder, "sweep.h5"), "members/peak_force");
    assert!(forces.len() == 2 && forces.iter().all(|force| *force > 0.0), "{forces:?}");
    let outcome = run(ricochet(folder.path(), 0).args(words(&format!("{line} --series -o series.h5"))));
    assert_eq!(outcome.status, Some(2), "{outcome:?}");
    assert!(outcome.stderr.contains("output.probes.0.point"), "{outcome:?}");
}

fn file(folder: &tempfile::TempDir, name: &str) -> std::path::PathBuf {
    folder.path().join(name)
}

fn members_are_the_runs_of_their_scenes() {
    let folder = folder(&supported());
    let said =
        good(&folder, 0, &format!("sweep scene.toml {GRID} --series --set time.end=4e-3 --set output.every=3 -o s.h5"));
    assert!(said.stdout.contains("s.h5: 6 of 6 members, ") && said.stdout.contains("peak acceleration "), "{said:?}");
    let sweep = file(&folder, "s.h5");
    let (peak, force) = (members(&sweep, "peak_acceleration"), members(&sweep, "peak_force"));
    let (owner, start) = (numbers(&sweep, "contacts/member"), numbers(&sweep, "contacts/start"));
    let (count, mut several) = (members(&sweep, "contacts"), 0);
    for n in 0..6 {
        let (k, scheme) = (["1e7", "1e9", "1e11"][n / 2], ["newmark", "energy"][n % 2]);
        let set = format!(
            "--set support.0.stiffness={k} --set time.scheme={scheme} --set time.end=4e-3 --set output.every=3"
        );
        good(&folder, 0, &format!("run scene.toml {set} -o run.h5"));
        let single = file(&folder, "run.h5");
        for name in ["time", "impactor/acceleration", "contact/force", "energy/total"] {
            // The same program on one rank: the same numbers.
            assert_eq!(numbers(&sweep, &format!("series/{n}/{name}")), column(&single, name), "{n} {name}");
        }
        let single_start = numbers(&single, "contacts/start");
        let own: Vec<f64> =
            owner.iter().zip(&start).filter(|(owner, _)| **owner == n as f64).map(|pair| *pair.1).collect();
        assert_eq!(own, single_start);
        assert_eq!(count[n], single_start.len() as f64);
        several += usize::from(count[n] > 1.0);
        let single_force = numbers(&single, "contacts/peak_force").into_iter().fold(0.0, f64::max);
        assert_eq!(force[n], single_force);
        assert!((peak[n] - force[n] / 52.0).abs() < 1e-12 * peak[n]);
        let impulse: f64 = numbers(&single, "contacts/impulse").iter().sum();
        let velocity = column(&single, "impactor/velocity");
        // The last step is a recorded one only every third time. With Newmark's γ = 1/2 the impulse equals the momentum
        // transferred.
        assert!((members(&sweep, "impulse")[n] - impulse).abs() < 1e-12 * impulse);
        if scheme == "newmark" {
            let momentum = 52.0 * (velocity[0] - members(&sweep, "rebound_speed")[n]);
            assert!((impulse - momentum).abs() < 1e-9 * momentum, "{impulse} {momentum}");
        }
    }
    assert!(several > 0);
    let opened = results::open(&sweep);
    assert_eq!((text(&opened, "kind"), text(&opened, "title")), ("sweep".into(), "Small plate".into()));
    assert!(text(&opened, "scene").contains("every = 3") && number::<bool>(&opened, "complete"));
    assert_eq!(members(&sweep, "vary/support.0.stiffness"), [1e7, 1e7, 1e9, 1e9, 1e11, 1e11]);
    assert_eq!(members(&sweep, "status"), [1.0; 6]);
}

fn any_number_of_ranks_writes_the_same() {
    let folder = folder(&supported());
    let line = "sweep scene.toml --vary support.0.stiffness=1e7..1e9:24 --log --series";
    good(&folder, 0, &format!("{line} -o 0.h5"));
    let alone = content(&file(&folder, "0.h5"));
    assert_eq!(alone["/members/status"].len(), 24);
    assert!(alone.contains_key("/series/23/contact/force"));
    for ranks in 1..=3 {
        good(&folder, ranks, &format!("{line} -o {ranks}.h5"));
        assert_eq!(content(&file(&folder, &format!("{ranks}.h5"))), alone, "{ranks} ranks");
    }
    // Fewer members than ranks.
    good(&folder, 3, "sweep scene.toml --vary impactor.speed=1,2 -o few.h5");
    assert_eq!(members(&file(&folder, "few.h5"), "status"), [1.0, 1.0]);
}

/// Members on one merged basis agree with the same members on separate bases.
fn a_family_answers_as_its_members() {
    let scene = supported().replace("step = 2e-5\n", "").replace("end = 1e-3", "end = 6e-3");
    let folder = folder(&scene.replace("cells = [4, 4, 1]\norder = 1\n", "").replace("localization = \"point\"\n", ""));
    let line = "sweep scene.toml --vary support.0.stiffness=3e8..3e9:24 --log --series -o family.h5";
    let said = run(ricochet(folder.path(), 0).env("RICOCHET_LOG", "info").args(words(line)));
    assert!(said.status == Some(0) && said.stderr.contains("merged basis tested"), "{said:?}");
    let family = file(&folder, "family.h5");
    let (values, estimate) = (members(&family, "vary/support.0.stiffness"), members(&family, "error_estimate"));
    let mut several = 0;
    for n in [0, 3, 8, 11, 17, 22, 23] {
        let set = format!("--set support.0.stiffness={:e} --set accuracy.tolerance=1e-3", values[n]);
        good(&folder, 0, &format!("run scene.toml {set} --set body.model=mindlin -o run.h5"));
        let single = file(&folder, "run.h5");
        let (times, exact) = (column(&single, "time"), column(&single, "impactor/acceleration"));
        let (end, peak) = (numbers(&single, "contacts/end")[0], exact.iter().copied().fold(0.0, f64::max));
        several += usize::from(numbers(&single, "contacts/end").len() > 1);
        let at = |time: f64| {
            let next = times.partition_point(|t| *t <= time).clamp(1, times.len() - 1);
            let part = ((time - times[next - 1]) / (times[next] - times[next - 1])).clamp(0.0, 1.0);
            exact[next - 1] + part * (exact[next] - exact[next - 1])
        };
        let of = |name: &str| numbers(&family, &format!("series/{n}/{name}"));
        let largest = column(&single, "contact/surface_displacement").into_iter().map(f64::abs).fold(0.0, f64::max);
        let [found, of_deflection] =
            ["largest_deflection", "deflection_error_estimate"].map(|name| members(&family, name)[n]);
        let off = (found / largest - 1.0).abs();
        assert!(off < of_deflection && of_deflection < 5e-2, "{n}: {off:e} {of_deflection:e}");
        let (mut first, mut all) = (0.0_f64, 0.0_f64);
        for (time, found) in of("time").into_iter().zip(of("impactor/acceleration")) {
            let off = (found - at(time)).abs() / peak;
            all = all.max(off);
            first = if time <= end { first.max(off) } else { first };
        }
        println!(
            "k = {:e}: {first:.1e} in the first contact, {all:.1e} over all, estimate {:.1e}",
            values[n], estimate[n]
        );
        assert!(first < 1e-2 && all < estimate[n], "{n}: {first:e} {all:e} {:e}", estimate[n]);
    }
    assert!(several > 0);
}

/// After a short contact, members on one merged basis deflect as a separate run within the sum of their estimates. (With
/// the basis for the force they were wrong by up to three times.)
fn a_family_has_the_deflections_of_a_light_ball() {
    let scene = pane().replace("[1.0, 1.5, 0.008]", "[0.3, 0.3, 0.008]").replace("end = 1e-3", "end = 3e-3");
    let folder = folder(&scene);
    let ball = "--set body.model=mindlin --set impactor.mass=5e-3 --set impactor.radius=5e-3 --set impactor.speed=3";
    good(&folder, 0, &format!("sweep scene.toml {ball} --vary support.0.stiffness=1e6..1e10:24 --log -o s.h5"));
    let sweep = file(&folder, "s.h5");
    info_prints_the_ranges_of(&folder, &sweep);
    good(&folder, 0, "plot s.h5 --quantity deflection -o deflection.svg");
    let figure = std::fs::read_to_string(file(&folder, "deflection.svg")).unwrap();
    assert!(figure.contains("largest deflection"), "{figure}");
    for n in [0, 23] {
        let stiffness = members(&sweep, "vary/support.0.stiffness")[n];
        let set = format!("{ball} --set support.0.stiffness={stiffness:e} --set accuracy.tolerance=3e-3");
        good(&folder, 0, &format!("run scene.toml {set} --set accuracy.quantity=deflection -o run.h5"));
        let deflection = column(&file(&folder, "run.h5"), "contact/surface_displacement");
        let largest = deflection.into_iter().map(f64::abs).fold(0.0, f64::max);
        let [found, estimate] =
            ["largest_deflection", "deflection_error_estimate"].map(|name| members(&sweep, name)[n]);
        println!("{stiffness:e}: {found:.3e} {largest:.3e}, estimate {estimate:.1e}");
        assert!((found / largest - 1.0).abs() < estimate + 3e-3 && estimate < 0.1, "{found} {largest} {estimate}");
    }
}

/// The ranges and the largest estimates that `info` prints are those of the members.
fn info_prints_the_ranges_of(folder: &TempDir, sweep: &Path) {
    let facts = good(folder, 0, "info s.h5 --json").stdout;
    let facts: serde_json::Value = serde_json::from_str(&facts).expect("facts");
    // The text has all digits of a number; its reader may change the last one.
    let is = |value: &serde_json::Value, wanted: f64| (value.as_f64().unwrap() / wanted - 1.0).abs() < 1e-15;
    let largest = |name: &str| members(sweep, name).into_iter().fold(0.0, f64::max);
    let smallest = |name: &str| members(sweep, name).into_iter().fold(f64::MAX, f64::min);
    for name in ["peak_acceleration", "largest_deflection", "largest_stress"] {
        let [low, high] = [&facts[name][0], &facts[name][1]];
        assert!(is(low, smallest(name)) && is(high, largest(name)), "{name}: {facts}");
    }
    let errors = &facts["error_estimates"];
    for (name, estimate) in [("acceleration", "error_estimate"), ("deflection", "deflection_error_estimate")] {
        assert!(is(&errors[name]["largest"], largest(estimate)), "{name}: {facts}");
        let without = members(sweep, estimate).into_iter().filter(|estimate| estimate.is_nan()).count();
        assert_eq!(errors[name]["without"], without, "{name}: {facts}");
    }
    let text = good(folder, 0, "info s.h5").stdout;
    assert!(["peaks ", "deflection ", "tension ", "errors "].iter().all(|name| text.contains(name)), "{text}");
}

/// A family varies one property only: it does not cover other changes of the support, nor a theory without supports.
fn families_are_of_one_property() {
    let scene = supported().replace("step = 2e-5\n", "").replace("cells = [4, 4, 1]\norder = 1\n", "");
    let folder = folder(&scene.replace("localization = \"point\"\n", ""));
    let both = "--vary support.0.stiffness=5e8..6e8:20 --vary support.0.damping=0,1e6";
    good(&folder, 0, &format!("sweep scene.toml {both} --set body.model=mindlin -o s.h5"));
    let peaks = members(&file(&folder, "s.h5"), "peak_acceleration");
    for (n, damping) in [(38, "0"), (39, "1e6")] {
        let set = format!("--set body.model=mindlin --set support.0.stiffness=6e8 --set support.0.damping={damping}");
        good(&folder, 0, &format!("run scene.toml {set} -o run.h5"));
        let own = column(&file(&folder, "run.h5"), "impactor/acceleration").into_iter().fold(0.0, f64::max);
        // The tolerance of both runs.
        assert!((peaks[n] / own - 1.0).abs() < 2e-2, "{n}: {} {own}", peaks[n]);
    }
    assert!((peaks[38] / peaks[39] - 1.0).abs() > 2e-2, "{peaks:?}");
    good(&folder, 0, "sweep scene.toml --vary support.0.stiffness=5e8..6e8:20 --set body.model=half-space -o h.h5");
    assert_eq!(members(&file(&folder, "h.h5"), "status"), [1.0; 20]);
}

/// Each member is reduced with its own pairing of layers of equal relaxation: a with b, or a with c. Each member agrees
/// with its own run within a part of the tolerance.
fn layers_that_relax_alike_are_those_of_the_member() {
    let relaxing = |name: &str, shear: &str| {
        format!(
            "[material.{name}]\nbulk = 2e9\ndensity = 1100.0\nshear = {shear}\nprony = [{{ modulus = 1e5, time = 1e-4 }}]\n"
        )
    };
    let glass = "[[body.layer]]\nthickness = 0.006\nmaterial = \"glass\"\n";
    let layer = |name: &str| format!("{glass}[[body.layer]]\nthickness = 0.00152\nmaterial = \"{name}\"\n");
    let laminate = format!(
        "title = \"Three interlayers\"\n[body]\nsize = [0.3, 0.3]\nmodel = \"layerwise\"\nreduction = 40\n{}{}{}{glass}\
         [material.glass]\nyoung = 70e9\npoisson = 0.23\ndensity = 2500.0\n{}{}{}\
         [impactor]\nmass = 2.0\nradius = 0.05\nyoung = 210e9\npoisson = 0.3\nspeed = 1.0\n\
         [time]\nend = 3e-4\n[output]\nstress = false\n[accuracy]\ntolerance = 5e-2\n",
        layer("a"),
        layer("b"),
        layer("c"),
        relaxing("a", "1e5"),
        relaxing("b", "1e5"),
        relaxing("c", "3e7"),
    );
    let folder = folder(&laminate);
    good(&folder, 0, "sweep scene.toml --vary material.a.shear=1e5,3e7 -o s.h5");
    let peaks = members(&file(&folder, "s.h5"), "peak_force");
    for (shear, peak) in ["1e5", "3e7"].into_iter().zip(&peaks) {
        good(&folder, 0, &format!("run scene.toml --set material.a.shear={shear} -o run.h5"));
        let own = column(&file(&folder, "run.h5"), "contact/force").into_iter().fold(0.0, f64::max);
        // A fifth of the tolerance, because cells and basis vectors differ. With another member's pairing of layers the
        // difference was 8% and more.
        assert!((peak / own - 1.0).abs() < 1e-2, "{shear} Pa: {peak} {own}");
    }
}

/// Members with error-controlled time steps, which report their steps late.
fn members_with_controlled_steps() {
    let scene = supported().replace("step = 2e-5\n", "");
    let folder = folder(&scene);
    good(&folder, 2, "sweep scene.toml --vary accuracy.tolerance=1e-1,1e-2 -o s.h5");
    let estimate = members(&file(&folder, "s.h5"), "error_estimate");
    assert!(estimate[0] < 0.5 && estimate[1] < estimate[0] && estimate[1] > 0.0, "{estimate:?}");
}

/// The estimate of a run may use more bases than that of members that share a body. For the member for which the body
/// was made it is the estimate of its run.
fn a_member_has_the_estimate_of_its_run() {
    let folder = folder(&pane().replace("[1.0, 1.5, 0.008]", "[0.5, 0.5, 0.02]").replace("end = 1e-3", "end = 5e-3"));
    let auto = "auto --set impactor.speed=1";
    for (models, out) in
        [("--vary body.model=kirchhoff,mindlin", "named.h5"), ("--vary impactor.speed=1,0.5", "auto.h5")]
    {
        good(&folder, 0, &format!("sweep scene.toml {models} -o {out}"));
    }
    // With `auto` the theory is selected for all members, and its error is one of the parts.
    for (model, sweep, member) in [("kirchhoff", "named.h5", 0), ("mindlin", "named.h5", 1), (auto, "auto.h5", 0)] {
        good(&folder, 0, &format!("run scene.toml --set body.model={model} -o run.h5"));
        let facts = good(&folder, 0, "info --json run.h5").stdout;
        let facts: serde_json::Value = serde_json::from_str(&facts).unwrap();
        let of = |name: &str| members(&file(&folder, sweep), name)[member];
        for name in ["error_estimate", "deflection_error_estimate"] {
            let own = facts[name].as_f64().unwrap();
            // The error of the time steps, a small part, is computed anew.
            assert!((of(name) / own - 1.0).abs() < 1e-3, "{model}: {name} {} {own}", of(name));
        }
        // Both have the same body and the same time steps.
        let own = facts["largest"]["deflection"]["value"].as_f64().unwrap().abs();
        assert!((of("largest_deflection") / own - 1.0).abs() < 1e-9, "{model}: {own}");
    }
}

fn shards_put_together_are_the_whole() {
    let folder = folder(&supported());
    let line = "sweep scene.toml --vary support.0.stiffness=1e6..1e12:7 --log --series";
    good(&folder, 0, &format!("{line} -o whole.h5"));
    for shard in ["1/3", "2/3", "3/3"] {
        good(&folder, 0, &format!("{line} -o s.h5 --shard {shard}"));
    }
    let part = file(&folder, "s.2-of-3.h5");
    assert_eq!(members(&part, "status"), [0.0, 1.0, 0.0, 0.0, 1.0, 0.0, 0.0]);
    assert_eq!(
        numbers(&part, "contacts/member").iter().map(|n| n % 3.0).sum::<f64>(),
        numbers(&part, "contacts/member").len() as f64
    );
    let said = good(&folder, 2, &format!("{line} -o s.h5"));
    assert!(said.stdout.contains("s.h5: 7 of 7 members, 7 of them were there"), "{said:?}");
    assert_eq!(said.stderr.matches("members taken over from s.").count(), 3, "{said:?}");
    assert_eq!(content(&file(&folder, "s.h5")), content(&file(&folder, "whole.h5")));
    // Two of three parts are there: the rest is computed. Then follows a part of another sweep.
    std::fs::remove_file(file(&folder, "s.h5")).unwrap();
    std::fs::remove_file(file(&folder, "s.3-of-3.h5")).unwrap();
    let said = good(&folder, 0, &format!("{line} -o s.h5"));
    assert!(said.stdout.contains("7 of 7 members, 5 of them were there"), "{said:?}");
    assert_eq!(content(&file(&folder, "s.h5")), content(&file(&folder, "whole.h5")));
    std::fs::remove_file(file(&folder, "s.h5")).unwrap();
    good(&folder, 0, "sweep scene.toml --vary support.0.stiffness=1e6,1e7 -o s.h5 --shard 1/1");
    let outcome = run(ricochet(folder.path(), 0).args(words(&format!("{line} -o s.h5"))));
    assert_eq!(outcome.status, Some(4));
    assert!(
        outcome.stderr.contains("s.1-of-1.h5: holds a sweep over other values of support.0.stiffness"),
        "{outcome:?}"
    );
    assert!(outcome.stderr.contains("it cannot be a part of s.h5"), "{outcome:?}");
}

/// A failed member is recorded as a result. In modal coordinates the force is a polynomial in each step and so not
/// exact in the contact: an energy gate of 1e-9 stops the run, a gate of 1 does not.
fn a_member_that_fails_is_a_result() {
    let folder = folder(&supported());
    let line = "sweep scene.toml --vary solver.energy_gate=1,1e-9,0.5 --series -o s.h5";
    for (ranks, there) in [(0, ""), (2, ", 3 of them were there")] {
        let outcome = run(ricochet(folder.path(), ranks).args(words(line)));
        assert_eq!(outcome.status, Some(3), "{outcome:?}");
        assert!(
            outcome.stdout.contains("failed: 1, the first of them member 1: solver.energy_gate=1e-9: step "),
            "{outcome:?}"
        );
        assert!(outcome.stdout.contains(&format!("s.h5: 3 of 3 members{there}, ")), "{outcome:?}");
    }
    let path = file(&folder, "s.h5");
    assert_eq!(members(&path, "status"), [1.0, 2.0, 1.0]);
    let (why, peak) = (messages(&path), members(&path, "peak_force"));
    assert!(why[1].contains("solver.energy_gate allows 1e-9") && why[0].is_empty(), "{why:?}");
    assert!(peak[1].is_nan() && peak[0] > 0.0 && peak[0] == peak[2]);
    assert!(!numbers(&path, "contacts/member").contains(&1.0));
    assert!(results::open(&path).group("series/1").is_err());
}

/// An unstable time step is detected only with the mesh.
fn a_member_whose_scene_is_wrong_on_its_mesh_is_named() {
    let folder = folder(&supported());
    let line = "sweep scene.toml --vary time.scheme=newmark,central-difference -o s.h5";
    let outcome = run(ricochet(folder.path(), 2).args(words(line)));
    assert_eq!(outcome.status, Some(2), "{outcome:?}");
    assert!(
        outcome.stdout.contains("member 1: time.scheme=central-difference: scene.toml (after --vary):"),
        "{outcome:?}"
    );
    assert_eq!(members(&file(&folder, "s.h5"), "status"), [1.0, 3.0]);
    assert!(messages(&file(&folder, "s.h5"))[1].contains("time.step: the central difference is stable up to"));
}

fn figure(folder: &Path, name: &str) -> image::RgbImage {
    image::load_from_memory(&std::fs::read(folder.join(name)).unwrap()).unwrap().into_rgb8()
}

fn one_key_is_drawn_as_a_curve_and_two_as_a_map() {
    let folder = folder(&supported());
    good(
        &folder,
        0,
        "sweep scene.toml --vary impactor.speed=0.5..2:4 --vary support.0.stiffness=1e6,1e12 --log -o two.h5",
    );
    good(&folder, 0, "sweep scene.toml --vary support.0.stiffness=1e6..1e12:7 --log --set time.end=4e-3 -o one.h5");
    // Each key has its own number of values, although it has one for each of the eight members.
    let facts = good(&folder, 0, "info two.h5").stdout;
    let count = |key: &str| facts.lines().find(|line| line.contains(key)).map(str::to_owned).unwrap_or_default();
    assert!(count("impactor.speed").ends_with(", 4 values"), "{facts}");
    assert!(count("support.0.stiffness").ends_with(", 2 values"), "{facts}");
    good(&folder, 0, "plot two.h5 -o two.png");
    good(&folder, 0, "plot one.h5 -o one.png");
    good(&folder, 0, "plot one.h5 -o one.svg");
    let svg = std::fs::read_to_string(file(&folder, "one.svg")).unwrap();
    for word in ["support.0.stiffness (N/m³)", "peak acceleration (m/s²)", "in contact", "10¹²", "Small plate"] {
        assert!(svg.contains(word), "{word}");
    }
    // The curve extends through its panel from the first to the last member.
    let one = figure(folder.path(), "one.png");
    let blue = (0..1600).filter(|x| (0..500).any(|y| one.get_pixel(*x, y).0 == [0, 114, 178])).count();
    assert!(blue > 800, "{blue}");
    // The map has eight cells: eight colours, the lightest and the darkest at opposite corners of the plot.
    let two = figure(folder.path(), "two.png");
    let grey = |p: [u8; 3]| p.iter().map(|c| i32::from(*c)).sum::<i32>();
    let at = |x: u32, y: u32| two.get_pixel(x, y).0;
    // Two columns for the fast key; four rows for the slow key, upwards.
    let cells: Vec<i32> = [400, 1100].into_iter().flat_map(|x| [180, 380, 580, 780].map(|y| grey(at(x, y)))).collect();
    let distinct: std::collections::BTreeSet<_> = cells.iter().collect();
    assert!(distinct.len() >= 6, "{cells:?}");
    assert_eq!(cells.iter().min(), [&cells[0], &cells[4]].into_iter().min());
    assert_eq!(cells.iter().max(), [&cells[3], &cells[7]].into_iter().max());
}

/// Peaks over three decades have logarithmic colours, so that the middle row is halfway; and a short logarithmic axis
/// has labels.
fn a_map_over_decades_has_logarithmic_colours() {
    let folder = folder(&supported());
    let half_space = "--set body.model=half-space --set contact.localization=patch --log";
    let vary = "--vary impactor.speed=1e-3..10:3 --vary impactor.mass=10..14:2";
    let cells = "--set body.cells= --set body.order=";
    good(&folder, 0, &format!("sweep scene.toml {half_space} {cells} --set time.step= {vary} -o two.h5"));
    let peaks = members(&file(&folder, "two.h5"), "peak_acceleration");
    assert!(peaks[4] > 1e3 * peaks[0], "{peaks:?}");
    good(&folder, 0, "plot two.h5 -o two.png");
    good(&folder, 0, "plot two.h5 -o two.svg");
    let two = figure(folder.path(), "two.png");
    let grey = |y: u32| two.get_pixel(400, y).0.iter().map(|c| i32::from(*c)).sum::<i32>();
    let (weak, middle, strong) = (grey(780), grey(480), grey(180));
    // On a linear scale the middle row would be as light as the weakest.
    assert!(weak - middle > 150 && middle - strong > 150, "{weak} {middle} {strong}");
    let svg = std::fs::read_to_string(file(&folder, "two.svg")).unwrap();
    for label in ["10\u{207b}\u{b2}", "10\u{2070}", "10", "12", "14"] {
        assert!(svg.split("</text>").any(|text| text.trim_end().ends_with(&format!("\n{label}"))), "{label}");
    }
}

fn what_no_figure_shows_is_said() {
    let folder = folder(&supported());
    good(&folder, 0, "sweep scene.toml --vary time.scheme=newmark,energy -o words.h5");
    good(
        &folder,
        0,
        "sweep scene.toml --vary impactor.speed=1,2 --vary impactor.mass=1,2 --vary impactor.gap=0,1e-5 -o three.h5",
    );
    for (line, why) in [
        ("plot words.h5 -o f.png", "over the numbers of one or two keys, not over time.scheme"),
        ("plot three.h5 -o f.png", "not over impactor.speed, impactor.mass, impactor.gap"),
        ("plot words.h5 three.h5 -o f.png", "words.h5: a sweep has a figure of its own"),
        (
            "plot three.h5 -o f.png --quantity velocity",
            "--quantity velocity: a sweep has acceleration, force, deflection, stress, peak_force",
        ),
    ] {
        let outcome = run(ricochet(folder.path(), 0).args(words(line)));
        assert_eq!(outcome.status, Some(2), "{outcome:?}");
        assert!(outcome.stderr.contains(why) && !file(&folder, "f.png").exists(), "{outcome:?}");
    }
}
