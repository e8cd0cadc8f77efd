//! A step of the paper's system without its Newton matrix: Newmark's average acceleration on a plate of solid elements.
//!
//! Body and impactor are linear but for Hertz's law (15), F = k0⟨δ⟩^{3/2}. Over a step, the increment of the body is
//! E = E* + w F with S E* = g, S w = a and S = K + c M, c = 4/h². With the contact vector a (14), the indentation is
//! δ = δ* − s F, s = aᵀw + 1/(c m0). One scalar equation remains, δ + s F(δ) = δ*. By the formula of Sherman and Morrison,
//! its solution is that of the paper's system with the block aF′aᵀ, which the program solves here for comparison.
//!
//!     mpirun -n 2 cargo run --release --example condensed_step

use std::error::Error;
use std::ops::ControlFlow;

use petsc_wrap::Session;
use ricochet::body::Body;
use ricochet::impact::SteppedImpact;
use ricochet::mesh::Mesh;
use ricochet::scene::Scene;

const SCENE: &str = include_str!("../scenes/plate20.toml");

fn main() -> Result<(), Box<dyn Error>> {
    let session = Session::start(&[]).ok_or("MPI has been started before")??;
    session.petsc()?;
    compare(&session)?;
    Ok(session.finish()?)
}

/// Computes the contact force both ways.
fn compare(session: &Session) -> Result<(), Box<dyn Error>> {
    let coarse = ["body.cells=[8, 8, 1]", "time.end=2e-3"].map(str::to_owned);
    let (scene, _) = Scene::parse("plate20.toml", SCENE, &coarse)?;
    let mesh = Mesh::new(&session.world(), &scene.body)?;
    let body = Body::solid(&scene, &mesh)?;
    let (step, mass, stiffness) = (2e-5, scene.impactor.mass, scene.impactor.stiffness);
    let c = 4.0 / (step * step);

    // S = K + c M, factorised once, with the springs of the supports (11) in K; and its answer w to a unit force.
    let mut solver = body.solver(&body.operator(0.0, c)?)?;
    let a = &body.terms.contact.force;
    let zero = || body.terms.load.duplicate();
    let (mut w, mut u, mut v, mut acceleration) = (zero()?, zero()?, zero()?, zero()?);
    let (mut momentum, mut product, mut known, mut increment) = (zero()?, zero()?, zero()?, zero()?);
    solver.solve(a, &mut w)?;
    let s = a.dot(&w)? + 1.0 / (c * mass);

    let (mut q, mut speed, mut pull) = (0.0, scene.impactor.speed, 0.0);
    let mut forces = vec![0.0];
    for _ in 0..100 {
        // g = M (4/h v + ü) − K u, without the force.
        momentum.set_combination(&[(4.0 / step, &v), (1.0, &acceleration)])?;
        body.mass.mult(&momentum, &mut known)?;
        body.terms.elastic.mult(&u, &mut product)?;
        known.axpy(-1.0, &product)?;
        body.terms.support.as_ref().ok_or("no springs")?.mult(&u, &mut product)?;
        known.axpy(-1.0, &product)?;
        solver.solve(&known, &mut increment)?;
        // δ* is the indentation at the end of a step without force. Newton's method converges from the right.
        let free = q + (4.0 / step * speed + pull) / c - a.dot(&u)? - a.dot(&increment)?;
        let mut indentation = free.max(0.0);
        for _ in 0..60 {
            let defect = indentation + s * stiffness * indentation.powf(1.5) - free;
            indentation = (indentation - defect / (1.0 + 1.5 * s * stiffness * indentation.sqrt())).max(0.0);
        }
        let force = stiffness * indentation.powf(1.5);
        increment.axpy(force, &w)?;
        // The state at the end of the step: ü = c E − 4/h v − ü_n, and v by the trapezoidal rule.
        let moved = (4.0 / step * speed + pull) / c - force / (c * mass);
        q += moved;
        speed -= 0.5 * step * force / mass - 0.5 * step * pull;
        pull = -force / mass;
        u.axpy(1.0, &increment)?;
        product.copy_from(&acceleration)?;
        acceleration.set_combination(&[(c, &increment), (-1.0, &momentum)])?;
        v.add_combination(&[(0.5 * step, &product), (0.5 * step, &acceleration)])?;
        forces.push(force);
    }

    let mut paper = Vec::new();
    let _ = SteppedImpact::new(&scene, Body::solid(&scene, &mesh)?)?.run(|step| {
        paper.push(step.contact.force);
        Ok(ControlFlow::Continue(()))
    })?;
    let peak = paper.iter().copied().fold(0.0, f64::max);
    let apart = forces.iter().zip(&paper).map(|(one, other)| (one - other).abs()).fold(0.0, f64::max);
    if session.world().rank() == 0 {
        println!("peak force {peak:.1} N; condensed and full steps differ by {:.1e} of it", apart / peak);
    }
    // Newton's method on all unknowns stops at residuals of 1e-10 of the peak.
    assert!(forces.len() == paper.len() && apart < 1e-8 * peak);
    Ok(())
}
