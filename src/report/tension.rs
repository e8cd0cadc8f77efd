//! Section of a report with the largest tension on the faces of the body, compared with the strength.

use crate::error::Result;
use crate::figure::Sheet;
use crate::figure::face::draw_inline;
use crate::record::stress::{Face, Largest, Passed, StrengthVerdict, Stresses};

use super::data::Data;
use super::faces::face_figure;
use super::figures::Curves;
use super::model::stress_error;
use super::number::{STRESS, TIME, computed, digits, given, percent, place, unit_for};
use super::page::{Block, Column, Figure, Section, Table};

/// Largest number of drawn faces; the faces with the largest tension are drawn.
const DRAWN: usize = 6;

/// Makes the section.
///
/// # Errors
/// If a figure cannot be drawn.
pub fn section(data: &Data) -> Result<Section> {
    let mut parts = Vec::new();
    match &data.stresses {
        Some(stresses) if !stresses.faces.is_empty() => {
            parts.push(Block::Table(table(data, stresses)));
            parts.push(Block::Text(judgement(data, stresses)));
            parts.push(figure(data, stresses)?);
            parts.extend(maps(data, stresses)?);
        }
        _ => parts.push(Block::Text(
            "This result holds no stresses on the faces of the body. Probes, where the scene has any, read the stress at single points."
                .to_owned(),
        )),
    }
    parts.extend(data.stresses.as_ref().and_then(ring).map(Block::Text));
    Ok(Section { id: "tension", title: "Largest tension", parts })
}

/// Size of a map for wide pages, and below it the size for narrow screens.
const WIDE: Sheet = Sheet { width: 1600, height: 900 };
const NARROW: Sheet = Sheet { width: 620, height: 640 };

/// Draws the maps of the largest tension over time on the faces.
fn maps(data: &Data, stresses: &Stresses) -> Result<Vec<Block>> {
    let Some(maps) = &data.stress_maps else { return Ok(Vec::new()) };
    let is_drawn = drawn(stresses);
    let mut parts = Vec::new();
    for map in maps.faces.iter().filter(|map| is_drawn.iter().any(|face| face.name == map.name)) {
        let Some(figure) = face_figure((maps, map), Some(stresses), String::new()) else { continue };
        let name = face_name(&map.name);
        let caption = format!(
            "{}{}: the largest principal stress over the whole run at each place. The cross marks the largest of all.{}",
            name[..1].to_uppercase(),
            &name[1..],
            if map.tension.iter().any(|tension| tension.is_nan()) {
                " Within the dashed circle, 1.25 thicknesses about the hit, stresses are read at the hit alone: colours there are \
                 interpolated, and a larger value would not be seen."
            } else {
                ""
            }
        );
        let [wide, narrow] =
            [WIDE, NARROW].map(|sheet| draw_inline(&figure, sheet, &format!("tension on {}", map.name)));
        parts.push(Block::Figure(Figure { wide: wide?, narrow: narrow?, caption }));
    }
    Ok(parts)
}

/// Readable name of a face.
pub fn face_name(name: &str) -> String {
    match name {
        "upper" => "upper face (hit)".to_owned(),
        "lower" => "lower face (opposite)".to_owned(),
        other => format!("face {other}"),
    }
}

/// Largest tension on a face, and the strength of the face.
pub struct Use {
    /// Largest tension on the face.
    pub largest: Largest,
    /// Strength of the face, Pa.
    pub strength: f64,
}

impl Use {
    /// Largest tension divided by the strength.
    pub fn part(&self) -> f64 {
        self.largest.value / self.strength
    }

    /// Estimated error of the tension, divided by its value. It is known for the largest tension on all faces only;
    /// otherwise NaN.
    pub fn error(&self, stresses: &Stresses) -> f64 {
        let is_largest = stresses.largest.as_ref().is_some_and(|largest| largest.face == self.largest.face);
        if is_largest { stresses.error_estimate } else { f64::NAN }
    }

    /// Verdict on the strength.
    pub fn verdict(&self, stresses: &Stresses) -> StrengthVerdict {
        StrengthVerdict::of(self.largest.value, self.strength, self.error(stresses))
    }
}

/// The face with the largest ratio of tension to strength; `None` if no face has a strength.
pub fn most_used(data: &Data) -> Option<Use> {
    let stresses = data.stresses.as_ref()?;
    let of_rows = stresses.faces.iter().filter_map(|face| face.peak(&stresses.time));
    // The attributes cover all steps, but the rows only the recorded ones.
    let all = of_rows.chain(stresses.largest.clone());
    let used = all.filter_map(|largest| Some(Use { strength: data.strength.of(&largest.face)?, largest }));
    used.max_by(|one, other| one.part().total_cmp(&other.part()))
}

fn table(data: &Data, stresses: &Stresses) -> Table {
    let time = unit_for(data.end(), TIME);
    let peaks: Vec<(&Face, Option<Largest>)> =
        stresses.faces.iter().map(|face| (face, stresses.peak_on(&face.name))).collect();
    let values = peaks.iter().filter_map(|(_, peak)| Some(peak.as_ref()?.value.abs()));
    let stress = unit_for(values.fold(0.0, f64::max), STRESS);
    let has_strength = data.strength.is_given();
    let row = |(face, peak): &(&Face, Option<Largest>)| {
        let mut row = vec![face_name(&face.name)];
        row.extend(match peak {
            Some(Largest { value, time: at, point, .. }) => {
                [digits(value / stress.size, 4), digits(at / time.size, 4), place(*point)]
            }
            None => ["–", "–", "–"].map(str::to_owned),
        });
        if has_strength {
            let strength = data.strength.of(&face.name);
            row.push(strength.map_or("–".to_owned(), |strength| digits(strength / stress.size, 4)));
            let used = peak.as_ref().zip(strength).map(|(peak, strength)| percent(peak.value / strength));
            row.push(used.unwrap_or("–".to_owned()));
        }
        row
    };
    let mut columns = vec![
        Column::text("Face"),
        Column::number("Tension", stress.name),
        Column::number("at", time.name),
        Column::text("Place"),
    ];
    if has_strength {
        columns.extend([Column::number("Strength", stress.name), Column::number("Used", "")]);
    }
    Table {
        caption: "Largest principal stress on each face".to_owned(),
        columns,
        rows: peaks.iter().map(row).collect(),
    }
}

/// Describes the estimated error of the stresses, and when the strength was exceeded.
fn judgement(data: &Data, stresses: &Stresses) -> String {
    let strength = match (!data.strength.is_given(), &stresses.strength_passed) {
        (true, _) => "The scene gives no strength.".to_owned(),
        (false, Some(Passed { time, face })) => {
            format!("The strength of the {} was first exceeded at {}.", face_name(face), computed(*time, TIME))
        }
        (false, None) => match most_used(data).map(|used| used.verdict(stresses)) {
            Some(StrengthVerdict::NotExceeded) => "The strength was not exceeded.".to_owned(),
            _ => "Whether the strength was exceeded is undecided.".to_owned(),
        },
    };
    let error = stress_error(stresses);
    format!("{strength} {}: {}.", error.name, error.text())
}

/// The faces to be drawn.
fn drawn(stresses: &Stresses) -> Vec<&Face> {
    let size = |face: &&Face| face.peak(&stresses.time).map_or(f64::NEG_INFINITY, |peak| peak.value);
    let mut drawn: Vec<&Face> = stresses.faces.iter().collect();
    if drawn.len() > DRAWN {
        drawn.sort_by(|one, other| size(other).total_cmp(&size(one)));
        drawn.truncate(DRAWN);
    }
    drawn
}

fn figure(data: &Data, stresses: &Stresses) -> Result<Block> {
    let drawn = drawn(stresses);
    let which = if drawn.len() < stresses.faces.len() { ", of the faces with the largest values" } else { "" };
    let curves = Curves {
        quantity: "largest principal stress",
        units: STRESS,
        time: &stresses.time,
        curves: drawn.iter().map(|face| (face_name(&face.name), face.largest.as_slice())).collect(),
        limits: limits(data, &drawn),
        caption: format!("Largest principal stress anywhere on a face{which}. Tension is positive."),
    };
    curves.draw(data).map(Block::Figure)
}

/// Strengths of the faces to be drawn as limits: one line if all are equal, otherwise one line for each face.
fn limits(data: &Data, faces: &[&Face]) -> Vec<(String, f64)> {
    let strengths = faces.iter().filter_map(|face| Some((face.name.as_str(), data.strength.of(&face.name)?)));
    let mut strengths: Vec<(&str, f64)> = strengths.collect();
    let is_common = strengths.windows(2).all(|pair| pair[0].1 == pair[1].1);
    strengths.truncate(if is_common { 1 } else { DRAWN });
    let named = |(face, strength): (&str, f64)| {
        let words = format!("strength {}", given(strength, STRESS));
        (if is_common { words } else { format!("{words} ({face})") }, strength)
    };
    strengths.into_iter().map(named).collect()
}

/// Describes the largest radial tension of Hertz's theory at the edge of the contact.
fn ring(stresses: &Stresses) -> Option<String> {
    let rows = stresses.ring.iter().zip(&stresses.time).filter(|(value, _)| value.is_finite());
    let (value, time) = rows.max_by(|one, other| one.0.total_cmp(other.0))?;
    Some(format!(
        "At the edge of the contact itself Hertz’s radial tension reaches {} at {}. It is steep, starts cone cracks under small impactors, \
         and is not held against the strength.",
        computed(*value, STRESS),
        computed(*time, TIME)
    ))
}
