//! Free vibrations of a steel strip under an elastomer (code_aster, case V2.02.151): frequencies and damping ratios of
//! the reduced body.

use mpi_test::{Test, tests};
use nalgebra::Complex;
use petsc_wrap::Session;
use ricochet::body::{Closed, DirectSum, ModalBody};
use ricochet::model::watch::Unwatched;
use ricochet::model::{Built, ModelContext, build};

use crate::modelled::parse;

pub const RANKS: &[usize] = &[1];
pub const TESTS: &[Test<Session>] =
    tests![frequencies_and_damping_of_a_strip, a_slender_strip_has_the_damping_of_a_beam];

/// Frequencies (Hz) and damping ratios of the case: its closed form of a composite beam, with the table's moduli at
/// real frequencies.
const EXPECTED: [(f64, f64); 3] = [(33.09, 0.01178), (211.36, 0.01814), (601.64, 0.01883)];

/// Young's modulus (Pa) and density (kg/m³) of the steel.
const STEEL: (f64, f64) = (210e9, 7800.0);

/// The elastomer's bulk modulus, Pa, and density, kg/m³.
const ELASTOMER: (f64, f64) = (8.333333e8, 1200.0);

/// Number of basis vectors. With 80, 160 and 360 vectors, the third damping ratio is 1.2%, 0.9% and 0.7% above that of the
/// case; the frequencies hardly change.
const VECTORS: usize = 120;

/// Dimensions of a strip, m.
#[derive(Clone, Copy)]
struct Strip {
    length: f64,
    width: f64,
    steel: f64,
    elastomer: f64,
}

/// The strip of the case. The whole section is clamped, including the end of the elastomer, and is free to contract.
/// The width is 2 mm; the width does not enter the frequencies of a beam. (With a width of 10 mm and a free end of the
/// elastomer, the ratios are 8% lower.)
const STRIP: Strip = Strip { length: 0.15, width: 0.002, steel: 0.001, elastomer: 0.002 };

/// A strip with the same frequencies, and half the ratio of thickness to wavelength.
const SLENDER: Strip = Strip { length: 0.075, width: 5e-4, steel: 2.5e-4, elastomer: 5e-4 };

/// Relaxation times (s) and shear moduli (Pa) of the Prony series, fitted by scripts/independent/fit_chain.py. With the
/// bulk modulus, E″ is within 1.1% of the table's at the three frequencies, and E′ within 8%, which changes the strip
/// by 3%. No causal material has both of the table's moduli.
fn chain() -> Vec<(f64, f64)> {
    let lines = include_str!("../../fixtures/laminated/cantilever.csv").lines().skip(1);
    lines.filter_map(|line| line.split_once(',')).map(|(a, b)| (a.parse().unwrap(), b.parse().unwrap())).collect()
}

/// Complex eigenvalues s of the three lowest bending vibrations of a beam with the same layers, 1/s: s² = −(D/μ)
/// (β/L)⁴. The bending stiffness D of the composite section (Euler–Bernoulli) is for E(s) at s itself, as for a freely
/// decaying vibration.
fn of_a_beam(strip: &Strip) -> [Complex<f64>; 3] {
    let (h, c) = (strip.steel, strip.elastomer);
    let mass = STEEL.1 * h + ELASTOMER.1 * c;
    let stiffness = |rate: Complex<f64>| {
        let shear: Complex<f64> =
            chain().iter().map(|(time, modulus)| rate * *time * *modulus / (rate * *time + 1.0)).sum();
        let soft = shear * 9.0 * ELASTOMER.0 / (shear + 3.0 * ELASTOMER.0);
        let centre = (soft * c * (h + c / 2.0) + STEEL.0 * h * h / 2.0) / (soft * c + STEEL.0 * h);
        let of_steel = (centre - h / 2.0).powi(2) * h + h.powi(3) / 12.0;
        let of_elastomer = (centre - h - c / 2.0).powi(2) * c + c.powi(3) / 12.0;
        of_steel * STEEL.0 + soft * of_elastomer
    };
    // Roots of cos β cosh β = −1.
    [1.875_104_07, 4.694_091_13, 7.854_757_44].map(|root: f64| {
        let mut rate = Complex::new(0.0, 600.0);
        // Damping changes E little: each iteration gains two digits or more.
        for _ in 0..50 {
            rate = Complex::<f64>::i() * (stiffness(rate) / mass).sqrt() * (root / strip.length).powi(2);
        }
        rate
    })
}

/// Eigenvalues with positive frequency and with more damping than vibrations of the steel alone, 1/s.
fn vibrations(session: &Session, strip: &Strip) -> Vec<Complex<f64>> {
    let terms: Vec<String> =
        chain().iter().map(|(time, modulus)| format!("{{ modulus = {modulus:e}, time = {time:e} }}")).collect();
    let text = format!(
        "[body]\nsize = [{}, {}]\nmodel = \"solid\"\n\
         [[body.layer]]\nthickness = {}\nmaterial = \"steel\"\n\
         [[body.layer]]\nthickness = {}\nmaterial = \"elastomer\"\n\
         [material.steel]\nyoung = {:e}\npoisson = 0.3\ndensity = {}\n\
         [material.elastomer]\nbulk = {:e}\nshear = 0.0\ndensity = {}\nprony = [{}]\n\
         [[support]]\nsurface = \"x-min\"\nkind = \"clamped\"\n\
         [impactor]\nmass = 0.01\nradius = 0.001\nyoung = 210e9\npoisson = 0.3\nspeed = 0.1\npoint = [{}, 0.0, {}]\n\
         [output]\nstress = false\n[accuracy]\ntolerance = 0.5\n[time]\nend = 1.0\n",
        strip.length,
        strip.width,
        strip.steel,
        strip.elastomer,
        STEEL.0,
        STEEL.1,
        ELASTOMER.0,
        ELASTOMER.1,
        terms.join(", "),
        0.4 * strip.length,
        (strip.steel + strip.elastomer) / 2.0
    );
    let scene = parse(&text);
    let comm = session.world();
    let Built::Operators(built) =
        build(&ModelContext::new(&comm, &Unwatched(&comm)), &scene, scene.body.model, 1.0).unwrap()
    else {
        panic!("a solid has operators")
    };
    assert_eq!(built.body.linear().chains()[0].terms.len(), 9, "all terms are followed");
    // Basis vectors for a shift at the frequency of the third vibration, and for lower shifts, where the elastomer has
    // other moduli.
    let mut krylov = DirectSum::new(built.body.linear(), 3800.0).unwrap();
    krylov.grow(built.body.linear(), VECTORS).unwrap();
    let body = ModalBody::of(&krylov.projection(built.body.linear()).unwrap());
    let closed = Closed { tangent: 1e6, compliance: 0.0, mass: 0.01, accuracy: 1e-9, end: 1.0 };
    let rates: Vec<_> = body.modes(1e12, &closed).unwrap().modes.iter().map(|mode| mode.rate).collect();
    rates.into_iter().filter(|rate| rate.im > 0.0 && -rate.re > 5e-3 * rate.norm()).collect()
}

/// The eigenvalue nearest in magnitude. Strips also vibrate sideways.
fn nearest(rates: &[Complex<f64>], wanted: f64) -> Complex<f64> {
    let off = |rate: &Complex<f64>| (rate.norm() - wanted).abs();
    *rates.iter().min_by(|a, b| off(a).total_cmp(&off(b))).expect("a vibration")
}

fn damping(rate: Complex<f64>) -> f64 {
    -rate.re / rate.norm()
}

/// Comparison with the case's numbers: frequencies within 0.5%, damping ratios within 3%. The third ratio differs by
/// 1.0%, that of a beam with the same Prony series by 2.0%: the series' E′ is below the table's there.
fn frequencies_and_damping_of_a_strip(session: &Session) {
    let rates = vibrations(session, &STRIP);
    let beam = of_a_beam(&STRIP);
    for ((frequency, ratio), same_material) in EXPECTED.into_iter().zip(beam) {
        let rate = nearest(&rates, std::f64::consts::TAU * frequency);
        let off_frequency = rate.norm() / std::f64::consts::TAU / frequency - 1.0;
        let off_ratio = damping(rate) / ratio - 1.0;
        let off_beam = damping(rate) / damping(same_material) - 1.0;
        println!("  {frequency} Hz {off_frequency:+.2e}, ratio {off_ratio:+.2e}; of the same material {off_beam:+.2e}");
        assert!(off_frequency.abs() < 5e-3, "{frequency}: {off_frequency}");
        assert!(off_ratio.abs() < 0.03, "{frequency}: {off_ratio}");
        // Effects neglected by a beam are proportional to (h k)², 0.02 for the third vibration.
        assert!(off_beam.abs() < 0.01, "{frequency}: {off_beam}");
    }
}

/// With half the ratio of thickness to wavelength, the effects neglected by a beam are a quarter: frequencies and
/// ratios are closer to the beam's.
fn a_slender_strip_has_the_damping_of_a_beam(session: &Session) {
    let rates = vibrations(session, &SLENDER);
    for beam in of_a_beam(&SLENDER) {
        let rate = nearest(&rates, beam.norm());
        let (off, off_ratio) = (rate.norm() / beam.norm() - 1.0, damping(rate) / damping(beam) - 1.0);
        println!("  {:.2} Hz {off:+.2e}, ratio {off_ratio:+.2e}", beam.norm() / std::f64::consts::TAU);
        assert!(off.abs() < 1e-3, "{off}");
        assert!(off_ratio.abs() < 0.01, "{off_ratio}");
    }
}
