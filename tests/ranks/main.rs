//! Tests of the library's computations on one to three ranks: each test runs in this program under `mpirun`.
//!
//! A module states the numbers of ranks of its tests: more than one if the tested computation is distributed.

#[path = "../common/bricks.rs"]
mod bricks;
#[path = "../common/field.rs"]
mod field;
#[path = "../common/glass.rs"]
mod glass;
#[path = "../common/laminated.rs"]
mod laminated;
#[path = "../common/modelled.rs"]
mod modelled;
#[path = "../common/parts.rs"]
mod parts;
#[path = "../common/patches.rs"]
mod patches;
#[path = "../common/start.rs"]
mod start;

mod mesh {
    pub mod groups;
    pub mod meshes;
    pub mod symmetry;
}
mod contact {
    pub mod area;
    pub mod laws;
    pub mod localisation;
    pub mod patch;
    pub mod patch_radius;
    pub mod zener;
}
mod body {
    pub mod cantilever;
    pub mod convergence;
    pub mod diagonal_symmetry;
    pub mod evaluate;
    pub mod krylov;
    pub mod layers;
    pub mod layerwise;
    pub mod lumped;
    pub mod mass_products;
    pub mod regions;
    pub mod spectrum;
    pub mod spline;
}
mod impact {
    pub mod conservation;
    pub mod controlled;
    pub mod equilibrium;
    pub mod extremes;
    pub mod hits;
    pub mod modal;
    pub mod newton;
    pub mod pads_condensed;
    pub mod reference;
    pub mod relaxing;
    pub mod relaxing_modes;
    pub mod schemes;
    pub mod time_order;
    pub mod unilateral;
}
mod model {
    pub mod agreement;
    pub mod beside_hit;
    pub mod converged;
    pub mod deflection;
    pub mod estimates;
    pub mod independent;
    pub mod reduction;
    pub mod select_theory;
    pub mod stress;
    pub mod supports;
    pub mod theories;
    pub mod theory_error;
    pub mod tolerances;
}
mod stability {
    pub mod chatter;
    pub mod choice;
    pub mod contact;
    pub mod iterative;
    pub mod localisation;
    pub mod locking;
    pub mod newton;
    pub mod order;
    pub mod steps;
}

use std::process::ExitCode;

use mpi_test::Suite;
use petsc_wrap::Session;

fn session() -> Session {
    Session::start(&[]).expect("the first session").expect("PETSc starts")
}

/// Adds the tests of modules, with the modules' names.
macro_rules! with {
    ($suite:expr, $($theme:ident::$module:ident),* $(,)?) => {
        $suite$(.group(concat!(stringify!($theme), "::", stringify!($module)), $theme::$module::RANKS, $theme::$module::TESTS))*
    };
}

fn main() -> ExitCode {
    // Objects that a test has dropped are destroyed before the next test.
    let suite = Suite::new(session).between(|session| session.world().collect_garbage().expect("PETSc destroys"));
    with!(
        suite,
        mesh::groups,
        mesh::meshes,
        mesh::symmetry,
        contact::area,
        contact::laws,
        contact::localisation,
        contact::patch,
        contact::patch_radius,
        contact::zener,
        body::spline,
        body::cantilever,
        body::convergence,
        body::evaluate,
        body::diagonal_symmetry,
        body::krylov,
        body::layers,
        body::lumped,
        body::mass_products,
        body::regions,
        body::spectrum,
        impact::conservation,
        impact::controlled,
        impact::equilibrium,
        impact::extremes,
        impact::hits,
        impact::modal,
        impact::newton,
        impact::pads_condensed,
        impact::reference,
        impact::relaxing,
        impact::relaxing_modes,
        impact::schemes,
        impact::time_order,
        impact::unilateral,
        model::agreement,
        model::beside_hit,
        model::select_theory,
        model::converged,
        model::deflection,
        model::estimates,
        model::independent,
        model::reduction,
        model::stress,
        model::supports,
        model::theories,
        model::theory_error,
        model::tolerances,
        stability::chatter,
        stability::choice,
        stability::contact,
        stability::iterative,
        stability::localisation,
        stability::locking,
        stability::newton,
        stability::order,
        stability::steps,
    )
    .group("contact::localisation", &[2], contact::localisation::ON_SEVERAL)
    .group("body::lumped", &[1], body::lumped::ALONE)
    .group("body::layers", &[1], body::layers::ALONE)
    .group("body::layerwise", &[1], body::layerwise::ALONE)
    // Three ranks on fewer cores wait for each other most of the time. In everyday runs, meshes and the paper's plates
    // on three ranks are enough; the tests below are long.
    .long_group("mesh::symmetry", &[3], mesh::symmetry::TESTS)
    .long_group("contact::laws", &[3], contact::laws::TESTS)
    .long_group("contact::localisation", &[3], contact::localisation::TESTS)
    .long_group("contact::localisation", &[3], contact::localisation::ON_SEVERAL)
    .long_group("contact::patch", &[3], contact::patch::TESTS)
    .long_group("contact::patch_radius", &[3], contact::patch_radius::TESTS)
    .long_group("body::convergence", &[3], body::convergence::TESTS)
    .long_group("body::evaluate", &[3], body::evaluate::TESTS)
    .long_group("body::lumped", &[3], body::lumped::TESTS)
    .long_group("body::spectrum", &[3], body::spectrum::TESTS)
    .long_group("impact::equilibrium", &[3], impact::equilibrium::TESTS)
    .long_group("impact::conservation", &[3], impact::conservation::TESTS)
    .long_group("impact::newton", &[2, 3], impact::newton::TESTS)
    .long_group("impact::pads_condensed", &[3], impact::pads_condensed::TESTS)
    .long_group("stability::newton", &[2, 3], stability::newton::TESTS)
    .long_group("body::spline", &[1], body::spline::LONG)
    .long_group("body::layerwise", &[1], body::layerwise::LONG)
    .long_group("impact::reference", &[2, 3], impact::reference::LONG)
    .long_group("impact::relaxing", &[1], impact::relaxing::LONG)
    .long_group("impact::relaxing", &[2], impact::relaxing::TESTS)
    .long_group("impact::relaxing_modes", &[1], impact::relaxing_modes::LONG)
    .long_group("model::converged", &[1], model::converged::LONG)
    .long_group("model::reduction", &[1], model::reduction::LONG)
    .long_group("model::stress", &[1], model::stress::LONG)
    .long_group("model::theory_error", &[1], model::theory_error::LONG)
    .long_group("model::tolerances", &[1], model::tolerances::LONG)
    .run()
}
