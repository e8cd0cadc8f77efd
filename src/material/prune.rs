//! The terms of a chain that an impact can tell from springs and from nothing.
//!
//! A term answers a strain e(t) with the stress G_i ∫ exp(−(t − s)/τ_i) ė ds. Over a run of the length T, with |ė| ≤ ω |e| at most:
//!
//! - As a spring it would have G_i e. The difference is G_i/τ_i ∫ exp(−(t − s)/τ_i) e ds, at most **G_i (1 − exp(−T/τ_i)) |e|**.
//! - Left out, what is missing is at most **G_i ω τ_i/(1 + ωτ_i) |e|**: the integral of the exponential, and G_i itself.
//!
//! Beside it the layer has the stress G(T) |e| or more. So a set of terms whose bounds add up to ε G(T) changes no stiffness of the body by
//! more than the part ε: K_e, which the chain is not in, only makes the part smaller. A vibration's frequency changes by ε/2. With the
//! response of an oscillator to the difference as a force, its displacement changes by ε ωT (2/π) of its largest at most.

use std::fmt;

use super::{Maxwell, Term};

/// What can be told apart: times, and the part of the stiffness that may be wrong.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Window {
    /// T, s: the length of the run.
    pub end: f64,
    /// ω, 1/s: the highest angular frequency of the strain that matters.
    pub frequency: f64,
    /// ε.
    pub tolerance: f64,
}

/// A chain of which only those terms are left that a run follows.
#[derive(Debug, Clone, PartialEq)]
pub struct Pruned {
    /// The chain, with the springs in G∞.
    pub chain: Maxwell,
    /// Terms that do not relax within the run.
    pub springs: usize,
    /// Terms that have relaxed before anything happens.
    pub relaxed: usize,
    /// The sum of the bounds over G(T): what part of a stiffness may be wrong.
    pub bound: f64,
}

impl Pruned {
    /// As few terms as a window allows: half of ε is for springs, half for what has relaxed.
    pub fn new(chain: &Maxwell, window: &Window) -> Self {
        let Window { end, frequency, tolerance } = *window;
        let allowed = 0.5 * tolerance * chain.at(end);
        let as_spring = |term: &Term| -(-end / term.time).exp_m1() * term.modulus;
        let left_out = |term: &Term| term.modulus / (1.0 + 1.0 / (frequency * term.time));
        let mut followed = chain.terms.clone();
        let (springs, of_springs) = take(&mut followed, allowed, as_spring);
        let (relaxed, of_relaxed) = take(&mut followed, allowed, left_out);
        let stiff: f64 = springs.iter().map(|term| term.modulus).sum();
        let bound = (of_springs + of_relaxed) / chain.at(end);
        Self {
            chain: Maxwell { equilibrium: chain.equilibrium + stiff, terms: followed },
            springs: springs.len(),
            relaxed: relaxed.len(),
            // Nothing is pruned of a chain that ends as a fluid.
            bound: if bound.is_finite() { bound } else { 0.0 },
        }
    }
}

/// Takes the terms with the least bounds out, as long as these add up to what is allowed: the terms, and the sum.
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

    /// Two terms a decade from 1e-9 s to 3e1 s, of unequal moduli, as a laminate's series has them.
    fn series() -> Maxwell {
        let term =
            |i: i32| Term { modulus: 1e6 * (2.0 + f64::from(i * i % 7)), time: 10_f64.powf(-9.0 + 0.5 * f64::from(i)) };
        Maxwell { equilibrium: 2e6, terms: (0..22).map(term).collect() }
    }

    /// A mass on a chain under half a sine of a force, by average acceleration with the chain's exact step: the displacements.
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

    /// A chain of 22 terms and the pruned one, as the only stiffness of an oscillator that a pulse drives: the bound holds, and is not
    /// idle.
    #[test]
    fn what_is_pruned_changes_no_more_than_the_bound() {
        let chain = series();
        for end in [1e-3, 2e-2] {
            let pulse = 0.2 * end;
            // Half a period as long as the pulse with the modulus of that time.
            let frequency = std::f64::consts::PI / pulse;
            let mass = chain.at(pulse) / (frequency * frequency);
            let run = (end, 4000);
            let full = driven(&chain, mass, run, pulse);
            let largest = full.iter().fold(0.0_f64, |m, u| m.max(u.abs()));
            let mut followed = usize::MAX;
            for tolerance in [1e-4, 1e-3, 1e-2, 1e-1] {
                let pruned = Pruned::new(&chain, &Window { end, frequency, tolerance });
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
        let pruned = Pruned::new(&series(), &Window { end: 1e-3, frequency: 1e4, tolerance: 1e-2 });
        let text = pruned.to_string();
        assert!(text.starts_with("Maxwell chain of 22 terms: ") && text.ends_with(" (left out)"), "{text}");
        let one = Maxwell { equilibrium: 1e6, terms: vec![Term { modulus: 1e6, time: 1e9 }] };
        let pruned = Pruned::new(&one, &Window { end: 1e-3, frequency: 1e4, tolerance: 1e-2 });
        assert_eq!(
            pruned.to_string(),
            "Maxwell chain of 1 term: 0 computed over time, 1 too slow to relax in this run (kept as elastic stiffness)"
        );
        assert_eq!(pruned.chain, Maxwell { equilibrium: 2e6, terms: Vec::new() });
    }

    /// A chain that relaxes to nothing within the run keeps all its terms, since nothing else is left beside them.
    #[test]
    fn a_fluid_keeps_its_terms() {
        let terms = [1e-6, 1e-3].map(|time| Term { modulus: 1e6, time });
        let chain = Maxwell { equilibrium: 0.0, terms: terms.to_vec() };
        let pruned = Pruned::new(&chain, &Window { end: 10.0, frequency: 1e3, tolerance: 1e-2 });
        assert_eq!((pruned.chain, pruned.bound), (chain, 0.0));
    }
}
