//! Steps at which the largest tension of all may be, by a search of some of them.
//!
//! Steps follow the contact, whose force bends more sharply in time than the body does. So the tensions are first looked at in every few steps; then
//! in those between two of which one is near the highest.

use super::rows::StressRows;
use super::seen::{Seen, Wanted};
use super::{BLOCK, ContactNow, TensionSearch};

/// Every so manieth step is looked at.
const STRIDE: usize = 4;

/// By how much a tension is taken to be above the higher one of the steps about it at most. An estimate.
const BETWEEN: f64 = 1.2;

/// Steps from which on that is worth its while.
const MANY: usize = 64;

impl TensionSearch<'_> {
    /// The steps whose largest tension may be that of all, or at least a given one, Pa; `None` where all are as soon looked through.
    pub(super) fn screened(
        &self,
        rows: &StressRows,
        coordinates: &[f64],
        contacts: &[ContactNow],
        least: f64,
    ) -> Option<Vec<usize>> {
        if contacts.len() < MANY {
            return None;
        }
        let last = contacts.len() - 1;
        let looked_at: Vec<usize> = (0..last).step_by(STRIDE).chain([last]).collect();
        let of_step = |step: usize| &coordinates[step * rows.count..(step + 1) * rows.count];
        let (mut seen, mut tops) = (Seen::default(), Vec::with_capacity(looked_at.len()));
        for steps in looked_at.chunks(BLOCK) {
            let some: Vec<f64> = steps.iter().flat_map(|&step| of_step(step)).copied().collect();
            let (all, sizes) = rows.of_steps(&some);
            for ((&step, size), column) in steps.iter().zip(sizes).zip(all.column_iter()) {
                seen.take(column.as_slice());
                let faces = self.faces.faces.iter().zip(&self.local).map(|(face, local)| {
                    seen.look((face, local), (column.as_slice(), size), &contacts[step], Wanted::Largest);
                    f64::from(seen.top) * size
                });
                // (Without a size, as at rest, single precision tells nothing.)
                let top = faces.fold(f64::NEG_INFINITY, f64::max);
                tops.push(if size > f64::MIN_POSITIVE { top } else { 0.0 });
            }
        }
        if tops.iter().any(|top| !top.is_finite()) {
            return None;
        }
        let level = tops.iter().copied().fold(0.0, f64::max).min(least) / BETWEEN;
        let between = looked_at.windows(2).zip(tops.windows(2)).filter(|(_, tops)| tops[0].max(tops[1]) >= level);
        let mut high: Vec<usize> = between.flat_map(|(steps, _)| steps[0]..=steps[1]).collect();
        high.dedup();
        tracing::debug!(steps = contacts.len(), coordinates = rows.count, searched = high.len(), "tensions");
        Some(high)
    }
}
