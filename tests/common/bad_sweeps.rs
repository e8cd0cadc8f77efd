//! Command lines of sweeps that must be refused before anything is computed.

/// The command line, and its expected outcome.
pub struct BadSweep {
    /// Description of the fault.
    pub name: &'static str,
    /// The arguments, after the scene `box.toml`; the output is out.h5.
    pub line: &'static str,
    /// Texts that the whole message must contain.
    pub fragments: &'static [&'static str],
    /// Whether the test also runs on several ranks.
    pub on_ranks: bool,
}

const fn bad(name: &'static str, line: &'static str, fragments: &'static [&'static str], on_ranks: bool) -> BadSweep {
    BadSweep { name, line, fragments, on_ranks }
}

/// All faulty sweeps; each ends with status 2.
#[rustfmt::skip]
pub const TABLE: [BadSweep; 24] = [
    bad("nothing is varied", "-o out.h5", &["--vary"], false),
    bad("no output", "--vary impactor.speed=1,2", &["--output"], false),
    bad("no values", "--vary impactor.speed -o out.h5", &["--vary impactor.speed: ", "KEY=A..B:N or KEY=A,B,C"], true),
    bad("no number of values", "--vary impactor.speed=1..2 -o out.h5", &["--vary impactor.speed=1..2: ", "A..B:N"], false),
    bad("one value", "--vary impactor.speed=1..2:1 -o out.h5", &["\"1\" is no number of values"], false),
    bad("an end that is no number", "--vary impactor.speed=slow..2:3 -o out.h5", &["\"slow\" is no end of a range"], false),
    bad("a logarithm of zero", "--vary impactor.gap=0..1e-3:3 --log -o out.h5", &["(--log) has positive ends, and 0 is not"], true),
    bad("a logarithm of less", "--vary impactor.point.0=-1..1:3 --log -o out.h5", &["(--log) has positive ends, and -1 is not"], false),
    bad("a gap in a list", "--vary impactor.speed=1,,2 -o out.h5", &["a value of the list is empty"], false),
    bad("a value twice", "--vary impactor.speed=1,2,1.0 -o out.h5", &["--vary impactor.speed=1,2,1.0: the list has the value 1.0 twice"], false),
    bad("a dash between the ends of a range", "--vary impactor.gap=0-46:3 -o out.h5", &["a range has two dots between its ends: impactor.gap=0..46:3"], false),
    bad("a colon there, and an end below zero", "--vary impactor.point.0=-1:1e-3:3 -o out.h5", &["a range has two dots between its ends: impactor.point.0=-1..1e-3:3"], false),
    bad("a key twice", "--vary impactor.speed=1,2 --vary impactor.speed=3,4 -o out.h5", &["impactor.speed is varied twice"], false),
    bad("too many", "--vary impactor.speed=1..2:10000 --vary impactor.mass=1..2:10000 -o out.h5", &["at most 1000000 members"], false),
    bad("an unknown key", "--vary impactor.sped=1,2 -o out.h5", &["box.toml", "impactor.sped: unknown key (set by --vary impactor.sped)", "did you mean `speed`?"], true),
    bad("no key", "--vary impactor..speed=1,2 -o out.h5", &["--vary impactor..speed=1", "not a path"], false),
    bad("one member of six", "--vary impactor.mass=1,2 --vary impactor.speed=1,-2,3 -o out.h5",
        &["impactor.speed: must be positive, but is -2", "(member 1: impactor.mass=1, impactor.speed=-2)"], true),
    bad("members that only together are wrong", "--vary time.end=1e-3,1e-5 --vary time.step=1e-5,2e-5 -o out.h5",
        &["time.step: ", "(member 3: time.end=1e-5, time.step=2e-5)"], false),
    bad("a broken number", "--vary output.every=1..2:3 -o out.h5", &["output.every: ", "whole number", "member 1: output.every=1.5"], false),
    bad("shard 0", "--vary impactor.speed=1,2 --shard 0/2 -o out.h5", &["'0/2'", "1 ≤ i ≤ n"], false),
    bad("shard beyond", "--vary impactor.speed=1,2 --shard 3/2 -o out.h5", &["'3/2'", "1 ≤ i ≤ n"], false),
    bad("a malformed override", "--vary impactor.speed=1,2 --set time.step -o out.h5", &["--set time.step", "no `=`"], false),
    bad("a fault of the scene itself", "--vary impactor.speed=1,2 --set body.young=-1 -o out.h5",
        &["body.young: must be positive, but is -1 (set by --set body.young=-1) (in the scene itself, before --vary)"], false),
    bad("unknown type", "--vary impactor.speed=1,2 -o out.h5 -- -ksp_type nonsense", &["a PETSc option is wrong", "KSP type nonsense"], true),
];
