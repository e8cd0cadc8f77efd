//! `ricochet info`: prints the contents and the origin of a result.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use serde::Serialize;

use crate::error::Result;
use crate::impact::estimated;
use crate::record::checkpoint::is_there;
use crate::record::episodes::Episode;
use crate::record::extremes::{Extreme, Extremes, extremes};
use crate::record::provenance::{Cost, Origin, Provenance};
use crate::record::read::{history, origin};
use crate::record::sweep::{Quantity, Status, Sweep, is_sweep};

use super::notes::counted;
use super::summary::{costs, lines};
use super::{Info, say, say_json, short};

/// Prints the facts of a run or of a sweep.
///
/// # Errors
/// [`crate::Error::Io`] if the file is not a readable result.
pub fn info(arguments: &Info) -> Result<()> {
    let path = &arguments.result;
    let sweep = if is_sweep(path)? { Some(Sweep::read(path)?) } else { None };
    if arguments.scene {
        let text = match &sweep {
            Some(sweep) => sweep.header.origin.scene.clone(),
            None => origin(path)?.0.origin.scene,
        };
        say(format_args!("{}", text.trim_end()));
        return Ok(());
    }
    match (sweep, arguments.json) {
        (Some(sweep), false) => SweepFacts::of(&sweep).print(),
        (Some(sweep), true) => say_json(&SweepFacts::of(&sweep)),
        (None, false) => RunFacts::read(path)?.print(),
        (None, true) => say_json(&RunFacts::read(path)?),
    }
    Ok(())
}

/// Facts of a run, in SI units; NaN is null in JSON.
#[derive(Serialize)]
struct RunFacts {
    #[serde(flatten)]
    provenance: Provenance,
    rows: usize,
    /// Time of the last row, s.
    end: f64,
    is_complete: bool,
    /// The result, if the run can be continued from its checkpoint.
    #[serde(skip_serializing_if = "Option::is_none")]
    restart: Option<PathBuf>,
    largest: Option<Extremes>,
    contacts: Vec<Episode>,
    /// Warnings and notes of the run.
    warnings: Vec<String>,
    #[serde(flatten)]
    cost: Cost,
}

impl RunFacts {
    fn read(path: &Path) -> Result<Self> {
        let (provenance, cost, is_complete) = origin(path)?;
        let history = history(path)?;
        let can_go_on = !is_complete && is_there(path, provenance.run_id);
        Ok(Self {
            warnings: provenance.warnings.lines().map(str::to_owned).collect(),
            rows: history.time.len(),
            end: history.time.last().copied().unwrap_or_default(),
            is_complete,
            restart: can_go_on.then(|| path.to_owned()),
            largest: extremes(path)?,
            contacts: history.contacts,
            provenance,
            cost,
        })
    }

    fn print(&self) {
        let Provenance { origin, model, unknowns, reduction, .. } = &self.provenance;
        print_origin(origin);
        say(format_args!("model      {model}, {unknowns} unknowns, reduction {reduction}"));
        let state = match &self.restart {
            _ if self.is_complete => "complete".to_owned(),
            Some(path) => format!("not complete; --restart {} continues it", path.display()),
            None => "not complete, without a checkpoint".to_owned(),
        };
        say(format_args!("series     {} rows to t = {} s, {state}", self.rows, short(self.end)));
        if let Some(largest) = &self.largest {
            let Extreme { value, time } = largest.acceleration;
            say(format_args!("largest    acceleration {} m/s² at {} ms", short(value), short(1e3 * time)));
            for line in lines(largest, self.cost.deflection_error_estimate) {
                say(format_args!("           {line}"));
            }
        }
        for Episode { start, end, impulse, .. } in &self.contacts {
            say(format_args!("contact    {} to {} ms, {} N s", short(1e3 * start), short(1e3 * end), short(*impulse)));
        }
        let Cost { error_estimate, total, .. } = self.cost;
        if !error_estimate.is_nan() {
            say(format_args!("error      estimated {} of the peak over the whole history", estimated(error_estimate)));
        }
        self.warnings.iter().for_each(|line| say(format_args!("remark     {line}")));
        if !total.is_nan() {
            say(format_args!("cost       {}", costs(&self.cost)));
        }
    }
}

/// Prints the title of a scene and the program.
fn print_origin(Origin { title, version, commit, petsc_version, petsc_options, ranks, .. }: &Origin) {
    let options = if petsc_options.is_empty() { "no options" } else { petsc_options };
    let ranks = counted(*ranks, "rank");
    say(format_args!("title      {title}"));
    say(format_args!("program    ricochet {version} ({commit}), PETSc {petsc_version} with {options}, {ranks}"));
}

/// Facts of a sweep.
#[derive(Serialize)]
struct SweepFacts {
    #[serde(flatten)]
    origin: Origin,
    varied: Vec<Varied>,
    done: usize,
    failed: usize,
    refused: usize,
    missing: usize,
    /// Shard i of n.
    #[serde(skip_serializing_if = "Option::is_none")]
    part: Option<[usize; 2]>,
    /// Smallest and largest peak acceleration of the members that are done, m/s².
    peak_acceleration: Option<[f64; 2]>,
    /// The same of the largest deflection under the impactor, m.
    largest_deflection: Option<[f64; 2]>,
    /// The same of the largest tension on all faces, Pa.
    largest_stress: Option<[f64; 2]>,
    /// Estimated errors of these members: of the acceleration over its peak, over the whole history; of the deflection under
    /// the impactor over its largest value; of the largest tension.
    error_estimates: BTreeMap<&'static str, MemberEstimates>,
}

/// Estimated errors of the members of a sweep that are done.
#[derive(Serialize)]
struct MemberEstimates {
    /// Largest estimate; `None` if no member has one. (In JSON, an infinite estimate is null as well.)
    largest: Option<f64>,
    /// Number of members without an estimate.
    without: usize,
}

/// A key that is varied.
#[derive(Serialize)]
struct Varied {
    key: String,
    units: String,
    values: usize,
}

impl SweepFacts {
    fn of(sweep: &Sweep) -> Self {
        let header = &sweep.header;
        let of = |quantity: Quantity| sweep.done(quantity).map(|(value, _)| value);
        let most = |quantity: Quantity| of(quantity).reduce(f64::max);
        let estimates = |quantity: Quantity| MemberEstimates {
            largest: most(quantity),
            without: sweep.count(Status::Done) - of(quantity).count(),
        };
        let range = |quantity: Quantity| Some([of(quantity).reduce(f64::min)?, most(quantity)?]);
        Self {
            origin: header.origin.clone(),
            varied: header
                .keys
                .iter()
                .map(|key| Varied { key: key.path.clone(), units: key.units.clone(), values: key.values.distinct() })
                .collect(),
            done: sweep.count(Status::Done),
            failed: sweep.count(Status::Failed),
            refused: sweep.count(Status::Refused),
            missing: sweep.count(Status::Missing),
            part: header.shard.map(|(i, n)| [i, n]),
            peak_acceleration: range(Quantity::PeakAcceleration),
            largest_deflection: range(Quantity::LargestDeflection),
            largest_stress: range(Quantity::LargestStress),
            error_estimates: BTreeMap::from([
                ("acceleration", estimates(Quantity::ErrorEstimate)),
                ("deflection", estimates(Quantity::DeflectionErrorEstimate)),
                ("stress", estimates(Quantity::StressErrorEstimate)),
            ]),
        }
    }

    fn print(&self) {
        print_origin(&self.origin);
        for Varied { key, units, values } in &self.varied {
            let units = if units == "1" { String::new() } else { format!(" [{units}]") };
            say(format_args!("varied     {key}{units}, {}", counted(*values, "value")));
        }
        say(format_args!(
            "members    {} done, {} failed, {} refused, {} missing{}",
            self.done,
            self.failed,
            self.refused,
            self.missing,
            self.part.map_or(String::new(), |[i, n]| format!("; part {i} of {n}"))
        ));
        let ranges = [
            ("peaks     ", self.peak_acceleration, 1.0, "m/s²"),
            ("deflection", self.largest_deflection, 1e3, "mm"),
            ("tension   ", self.largest_stress, 1e-6, "MPa"),
        ];
        for (name, range, factor, unit) in ranges {
            // Half-spaces have no deflection.
            if let Some([low, high]) = range.filter(|[_, high]| *high > 0.0) {
                say(format_args!("{name} {} to {} {unit}", short(factor * low), short(factor * high)));
            }
        }
        let known = self.error_estimates.iter().filter_map(|(what, MemberEstimates { largest, without })| {
            let without = match without {
                0 => String::new(),
                without => format!(" ({} without an estimate)", counted(*without, "member")),
            };
            let what = if *what == "stress" { "largest tension" } else { what };
            Some(format!("{} of the {what}{without}", estimated((*largest)?)))
        });
        let known: Vec<String> = known.collect();
        if !known.is_empty() {
            say(format_args!("errors     estimated at most: {}", known.join(", ")));
        }
    }
}
