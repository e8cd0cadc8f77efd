//! Tests of the figures that the Python package draws.

use crate::results::{folder, good};
use crate::sweeps::{numbers, supported};

use super::{bits, python};

pub(super) fn sweeps_are_drawn_as_curves_and_maps() {
    let folder = folder(&supported());
    good(&folder, 0, "sweep scene.toml --vary support.0.stiffness=1e7..1e11:3 --log -o k.h5");
    good(
        &folder,
        0,
        "sweep scene.toml --vary impactor.speed=0.5,1 --vary support.0.stiffness=1e7..1e11:3 --log -o both.h5",
    );
    let told = python(
        folder.path(),
        "axes = ricochet.Sweep('k.h5').plot()\n\
         print(axes.get_xscale(), '|', axes.get_xlabel(), '|', axes.get_ylabel(), '|', bits(axes.lines[0].get_ydata()))\n\
         axes = ricochet.Sweep('both.h5').plot('peak_force', plt.figure().gca())\n\
         print(axes.get_xlabel(), '|', axes.get_ylabel(), '|', bits(axes.collections[0].get_array().ravel()))\n\
         print(np.allclose(axes.get_xlim(), (1e6, 1e12)), np.allclose(axes.get_ylim(), (0.5 / 2**0.5, 2**0.5)))",
    );
    let read = |file: &str, name: &str| bits(&numbers(&folder.path().join(file), &format!("members/{name}")));
    assert_eq!(
        told.unwrap(),
        [
            format!(
                "log | support.0.stiffness (N/m3) | peak acceleration (m/s2) | {}",
                read("k.h5", "peak_acceleration")
            ),
            format!("support.0.stiffness (N/m3) | impactor.speed (m/s) | {}", read("both.h5", "peak_force")),
            // Cells extend half a step beyond the values, on both logarithmic axes.
            "True True".to_owned(),
        ]
    );
}

/// Text values become names of ticks, in the given order; numbers are drawn in ascending order.
pub(super) fn sweeps_over_texts_are_drawn_with_names() {
    let folder = folder(&supported());
    let schemes = "--vary time.scheme=newmark,energy,modal --set time.end=4e-4";
    good(&folder, 0, &format!("sweep scene.toml {schemes} -o schemes.h5"));
    good(&folder, 0, &format!("sweep scene.toml {schemes} --vary support.0.stiffness=1e9,1e7 --log -o both.h5"));
    let told = python(
        folder.path(),
        "sweep, both = ricochet.Sweep('schemes.h5'), ricochet.Sweep('both.h5')\n\
         def names(axis): return *(label.get_text() for label in axis.get_ticklabels()),\n\
         axes = sweep.plot('peak_force')\n\
         axes.figure.canvas.draw()\n\
         print(*names(axes.xaxis), bits(axes.lines[0].get_ydata()), bits(sweep.grid('peak_force')))\n\
         axes = both.plot('peak_force')\n\
         axes.figure.canvas.draw()\n\
         print(*names(axes.yaxis), axes.get_xscale(), axes.get_yscale(), axes.get_xlabel(), axes.get_ylabel())\n\
         print(bits(axes.collections[0].get_array().ravel()))\n\
         print(bits(both.grid('peak_force')), *both.values('time.scheme'), *both.values('support.0.stiffness'))",
    );
    let told = told.unwrap();
    let peaks = |file: &str| numbers(&folder.path().join(file), "members/peak_force");
    let of_schemes = bits(&peaks("schemes.h5"));
    assert_eq!(told[0], format!("newmark energy modal {of_schemes} {of_schemes}"));
    assert_eq!(told[1], "newmark energy modal log linear support.0.stiffness (N/m3) time.scheme");
    let of_both = peaks("both.h5");
    let ascending: Vec<f64> = of_both.chunks(2).flat_map(|pair| [pair[1], pair[0]]).collect();
    assert_eq!(told[2], bits(&ascending));
    assert_eq!(told[3], format!("{} newmark energy modal 1000000000.0 10000000.0", bits(&of_both)));
}

/// Each plot makes a new figure. If axes are given, nothing is drawn elsewhere.
pub(super) fn plots_have_axes_of_their_own() {
    let folder = folder(&supported());
    good(&folder, 0, "run scene.toml -o run.h5");
    good(&folder, 0, "sweep scene.toml --vary support.0.stiffness=1e8,1e9 -o sweep.h5");
    let told = python(
        folder.path(),
        "run, sweep = ricochet.Run('run.h5'), ricochet.Sweep('sweep.h5')\n\
         force, acceleration, peaks, forces = run.plot('contact/force'), run.plot(), sweep.plot(), sweep.plot('peak_force')\n\
         print(len(plt.get_fignums()), len({axes.figure.number for axes in (force, acceleration, peaks, forces)}))\n\
         print(run.plot('contact/force', force) is force, sweep.plot(axes=peaks) is peaks, len(plt.get_fignums()))\n\
         print(*(len(axes.lines) for axes in (force, acceleration, peaks, forces)), force.get_ylabel(), acceleration.get_ylabel())",
    );
    assert_eq!(
        told.unwrap(),
        ["4 4", "True True 4", "2 1 2 1 contact force (N) impactor acceleration (m/s2)"].map(str::to_owned)
    );
}
