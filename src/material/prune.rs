//! Reduction of a generalised Maxwell chain to the terms that relax noticeably during an impact.
//!
//! The stress of a term due to a strain e(t) is G_i ∫ exp(−(t − s)/τ_i) ė ds. For a run of the length T, with |ė| ≤ ω
//! |e|:
//!
//! - If the term is replaced by a spring, its stress is G_i e. The difference is G_i/τ_i ∫ exp(−(t − s)/τ_i) e ds, at
//!   most **G_i (1 − exp(−T/τ_i)) |e|**.
//! - If the term is omitted, the missing stress is at most **G_i ω τ_i/(1 + ωτ_i) |e|**, from the bounds by the
//!   integral of the exponential and by G_i.
//!
//! The stress of the whole layer is G(T) |e| or more. So a set of terms whose bounds sum to ε G(T) changes the
//! stiffness of the body by at most the fraction ε; the elastic stiffness K_e, which does not contain the chain, only
//! reduces this fraction. A vibration frequency changes by at most ε/2. If the difference acts as a force on an
//! oscillator, its displacement changes by at most ε ωT (2/π) of its maximum.

use std::fmt;

use super::{Maxwell, Term};

/// Time scales of an impact, and the tolerated error of the stiffness.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Window {
    /// Length T of the run, s.
    pub end: f64,
    /// Highest relevant angular frequency ω of the strain, 1/s.
    pub frequency: f64,
    /// Tolerated fraction ε of the stiffness.
    pub tolerance: f64,
    /// Whether all terms have relaxed before the run. Terms that do not relax within the run then become one term, with the mean of
    /// their rates, since a spring would carry a part of the load.
    pub begins_relaxed: bool,
}

/// Longest time of the one term that replaces slow ones, over the length of the run.
const LONGEST: f64 = 1e8;

/// Chain with only the terms that are computed over time.
#[derive(Debug, Clone, PartialEq)]
pub struct Pruned {
    /// Reduced chain, with the springs included in G∞.
    pub chain: Maxwell,
    /// Number of terms that do not relax within the run and are not computed over time.
    pub springs: usize,
    /// Number of terms that relax before the contact force changes.
    pub relaxed: usize,
    /// Sum of the bounds divided by G(T): bound of the relative error of the stiffness.
    pub bound: f64,
}

impl Pruned {
    /// Keeps as few terms as possible: half of ε is allowed for springs, half for relaxed terms.
    pub fn new(chain: &Maxwell, window: &Window) -> Self {
        let Window { end, frequency, tolerance, begins_relaxed } = *window;
        let allowed = 0.5 * tolerance * chain.at(end);
        let as_spring = |term: &Term| -(-end / term.time).exp_m1() * term.modulus;
        let left_out = |term: &Term| term.modulus / (1.0 + 1.0 / (frequency * term.time));
        let mut followed = chain.terms.clone();
        let (springs, of_springs) = take(&mut followed, allowed, as_spring);
        let (relaxed, of_relaxed) = take(&mut followed, allowed, left_out);
        let of_rates: f64 = springs.iter().map(|term| term.modulus / term.time).sum();
        let mut stiff: f64 = springs.iter().map(|term| term.modulus).sum();
        let mut springs = springs.len();
        if begins_relaxed && stiff > 0.0 {
            // The relative change in the run remains far below any tolerance, for whatever longer times.
            let time = (stiff / of_rates).min(LONGEST * end);
            followed.push(Term { modulus: std::mem::take(&mut stiff), time });
            springs -= 1;
        }
        let bound = (of_springs + of_relaxed) / chain.at(end);
        Self {
            chain: Maxwell { equilibrium: chain.equilibrium + stiff, terms: followed },
            springs,
            relaxed: relaxed.len(),
            // A chain with G(T) = 0 (a fluid) is not reduced.
            bound: if bound.is_finite() { bound } else { 0.0 },
        }
    }
}

/// Removes the terms with the smallest bounds while the bounds sum to at most `allowed`; returns the terms and the sum.
fn take(terms: &mut Vec<Term>, allowed: f64, bound: impl Fn(&Term) -> f64) -> (Vec<Term>, f64) {
    let mut order: Vec<usize> = (0..terms.len()).collect();
    order.sort_by(|a, b| bound(&terms[*a]).total_cmp(&bound(&terms[*b])));
    let mut sum = 0.0;
    let count = order.iter().take_while(|i| {
        let with = sum + bound(&terms[**i]);
        let fits = with <= allowed;
        if fits {
            sum = with;
        }
        fits
    });
    let mut taken: Vec<usize> = count.copied().collect();
    taken.sort_unstable();
    let out = taken.iter().map(|i| terms[*i]).collect();
    for i in taken.iter().rev() {
        terms.remove(*i);
    }
    (out, sum)
}

impl fmt::Display for Pruned {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let followed = self.chain.terms.len();
        let given = self.springs + self.relaxed + followed;
        let plural = if given == 1 { "" } else { "s" };
        write!(f, "Maxwell chain of {given} term{plural}: {followed} computed over time")?;
        if self.springs > 0 {
            write!(f, ", {} too slow to relax in this run (kept as elastic stiffness)", self.springs)?;
        }
        if self.relaxed > 0 {
            write!(f, ", {} relaxed before the contact can feel it (left out)", self.relaxed)?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::material::Decay;

    /// Two terms per decade from 1e-9 s to 3e1 s, with unequal moduli, similar to the series of a laminate's
    /// interlayer.
    fn series() -> Maxwell {
        let term =
            |i: i32| Term { modulus: 1e6 * (2.0 + f64::from(i * i % 7)), time: 10_f64.powf(-9.0 + 0.5 * f64::from(i)) };
        Maxwell { equilibrium: 2e6, terms: (0..22).map(term).collect() }
    }

    /// Displacements of a mass on a chain under a half-sine force, by average acceleration with the exact step of the
    /// chain.
    fn driven(chain: &Maxwell, mass: f64, (end, steps): (f64, usize), pulse: f64) -> Vec<f64> {
        let step = end / steps as f64;
        let decays: Vec<(f64, Decay)> =
            chain.terms.iter().map(|term| (term.modulus, Decay::new(step, term.time))).collect();
        let stiffness = chain.equilibrium + decays.iter().map(|(g, decay)| g * decay.taken).sum::<f64>();
        let (mut u, mut v, mut a, mut w) = (0.0, 0.0, 0.0, vec![0.0; decays.len()]);
        (1..=steps)
            .map(|n| {
                let time = n as f64 * step;
                let force = if time < pulse { (std::f64::consts::PI * time / pulse).sin() } else { 0.0 };
                let known: f64 = decays.iter().zip(&w).map(|((g, decay), w)| g * decay.left * w).sum();
                let inertia = mass * (4.0 / step * v + a);
                let increment =
                    (force - chain.equilibrium * u - known + inertia) / (stiffness + 4.0 * mass / (step * step));
                w.iter_mut().zip(&decays).for_each(|(w, (_, d))| *w = d.left * *w + d.taken * increment);
                u += increment;
                (v, a) = (2.0 * increment / step - v, 4.0 * increment / (step * step) - 4.0 * v / step - a);
                u
            })
            .collect()
    }

    /// A chain of 22 terms and the reduced one, as the only stiffness of an oscillator under a pulse: the bound holds
    /// and is not excessive.
    #[test]
    fn what_is_pruned_changes_no_more_than_the_bound() {
        let chain = series();
        for end in [1e-3, 2e-2] {
            let pulse = 0.2 * end;
            // Half a period with the modulus at this time is equal to the pulse length.
            let frequency = std::f64::consts::PI / pulse;
            let mass = chain.at(pulse) / (frequency * frequency);
            let run = (end, 4000);
            let full = driven(&chain, mass, run, pulse);
            let largest = full.iter().fold(0.0_f64, |m, u| m.max(u.abs()));
            let mut followed = usize::MAX;
            for tolerance in [1e-4, 1e-3, 1e-2, 1e-1] {
                let pruned = Pruned::new(&chain, &Window { end, frequency, tolerance, begins_relaxed: false });
                let part = driven(&pruned.chain, mass, run, pulse);
                let change = full.iter().zip(&part).fold(0.0_f64, |m, (a, b)| m.max((a - b).abs())) / largest;
                let bound = pruned.bound * frequency * end * std::f64::consts::FRAC_2_PI;
                assert!(pruned.bound <= tolerance && change <= bound, "{end} {tolerance}: {change:e} {bound:e}");
                assert!(change > 1e-3 * bound, "an idle bound: {end} {tolerance}: {change:e} {bound:e}");
                assert!(pruned.chain.terms.len() <= followed, "a larger tolerance follows no more terms");
                followed = pruned.chain.terms.len();
                assert_eq!(pruned.springs + pruned.relaxed + followed, 22);
                let stays = pruned.chain.at(end) / chain.at(end) - 1.0;
                assert!(stays.abs() <= tolerance, "G(T) changes by no more than ε");
            }
            assert!(followed <= 10, "{end}: {followed} terms for a tenth");
        }
    }

    #[test]
    fn words() {
        let pruned =
            Pruned::new(&series(), &Window { end: 1e-3, frequency: 1e4, tolerance: 1e-2, begins_relaxed: false });
        let text = pruned.to_string();
        assert!(text.starts_with("Maxwell chain of 22 terms: ") && text.ends_with(" (left out)"), "{text}");
        let one = Maxwell { equilibrium: 1e6, terms: vec![Term { modulus: 1e6, time: 1e9 }] };
        let pruned = Pruned::new(&one, &Window { end: 1e-3, frequency: 1e4, tolerance: 1e-2, begins_relaxed: false });
        assert_eq!(
            pruned.to_string(),
            "Maxwell chain of 1 term: 0 computed over time, 1 too slow to relax in this run (kept as elastic stiffness)"
        );
        assert_eq!(pruned.chain, Maxwell { equilibrium: 2e6, terms: Vec::new() });
    }

    /// A chain that relaxes to zero within the run keeps all its terms, since no other stiffness remains.
    #[test]
    fn a_fluid_keeps_its_terms() {
        let terms = [1e-6, 1e-3].map(|time| Term { modulus: 1e6, time });
        let chain = Maxwell { equilibrium: 0.0, terms: terms.to_vec() };
        let pruned = Pruned::new(&chain, &Window { end: 10.0, frequency: 1e3, tolerance: 1e-2, begins_relaxed: false });
        assert_eq!((pruned.chain, pruned.bound), (chain, 0.0));
    }
}
