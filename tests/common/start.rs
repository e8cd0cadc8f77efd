//! Makes an impact that is ready to run from the text of a scene.

use std::ops::ControlFlow;

use petsc_wrap::Comm;
use ricochet::body::Body;
use ricochet::impact::SteppedImpact;
use ricochet::impact::step::Step;
use ricochet::mesh::Mesh;
use ricochet::scene::Scene;

/// Makes the impact of a scene. Collective.
pub fn start(comm: &Comm, text: &str) -> (Mesh, SteppedImpact) {
    let (scene, _) = Scene::parse("test", text, &[]).unwrap_or_else(|error| panic!("{}", error));
    let mesh = Mesh::new(comm, &scene.body).unwrap();
    let body = Body::solid(&scene, &mesh).unwrap();
    let impact = SteppedImpact::new(&scene, body).unwrap();
    (mesh, impact)
}

/// Runs to the end of the scene. Collective.
#[allow(dead_code, reason = "not every test that shares this module runs to the end")]
pub fn run(impact: &mut SteppedImpact) -> Vec<Step> {
    let mut steps = Vec::new();
    let flow = impact.run(|step| {
        steps.push(*step);
        Ok(ControlFlow::Continue(()))
    });
    assert!(flow.unwrap_or_else(|error| panic!("{error}")).is_continue());
    steps
}
