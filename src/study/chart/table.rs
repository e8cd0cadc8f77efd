//! Writes a chart as tables: the complete results as CSV, and a summary as text.

use super::front::{LEVELS, best, front};
use super::{Errors, Point, Reference};
use crate::impact::estimated;
use crate::study::history::Difference;

/// A line of the CSV. Errors are relative to the reference's values; times are in s.
#[derive(serde::Serialize)]
struct Line<'a> {
    method: &'a str,
    setting: &'a str,
    body: &'a str,
    solves: usize,
    build_s: f64,
    run_s: f64,
    total_s: f64,
    error_first: f64,
    error_whole: f64,
    error_peak: f64,
    error_impulse: f64,
    error_contact: f64,
    error_tension: f64,
    estimate: Option<f64>,
    is_resolved: Option<bool>,
    is_front: bool,
}

/// One line per point, in the order of the methods. `floor` is the smallest error that the reference resolves.
pub fn csv(points: &[Point], floor: Difference) -> String {
    let front = front(points, |point| point.errors.history.first);
    let mut table = csv::Writer::from_writer(Vec::new());
    for (n, point) in points.iter().enumerate() {
        let Errors { history, peak, impulse, contact } = point.errors;
        let line = Line {
            method: &point.method,
            setting: &point.setting,
            body: &point.body,
            solves: point.solves,
            build_s: point.seconds[0],
            run_s: point.seconds[1],
            total_s: point.total(),
            error_first: history.first,
            error_whole: history.whole,
            error_peak: peak,
            error_impulse: impulse,
            error_contact: contact,
            error_tension: history.tension,
            estimate: point.estimate,
            is_resolved: floor.first.is_finite().then_some(history.first >= floor.first),
            is_front: front.contains(&n),
        };
        // Writing plain fields to memory cannot fail.
        table.serialize(line).expect("a line of a table");
    }
    String::from_utf8(table.into_inner().expect("a table in memory")).expect("fields are UTF-8")
}

/// Summary: the fastest method at each level of error and its margin, the results of `auto`, and the runs that were
/// left out.
pub fn summary(title: &str, points: &[Point], reference: &Reference, left_out: &[String]) -> String {
    let floor = reference.floor();
    let mut text = format!("# Speed against accuracy: {title}\n\n");
    text += "Errors are largest differences of the acceleration from the reference's over its peak, in the first contact; times are wall times\n\
             of building the model and of its steps, medians of a few runs in one process.\n\n";
    text += &table(
        &["error", "quickest", "setting", "time", "its error", "next method", "times slower", "`auto`", "best peer"],
        &LEVELS.map(|level| row(points, level, floor.first)),
    );
    let agreement = reference.agreement;
    text += &format!("\nReference: {}", reference.setting);
    if agreement.first.is_finite() {
        text += &format!(
            "; the one before it differs by {:.1e} in the first contact and {:.1e} over all,\nso that errors below {:.0e} and {:.0e} are not resolved",
            agreement.first, agreement.whole, floor.first, floor.whole
        );
    }
    text += ".\n";
    if !left_out.is_empty() {
        text += "\nLeft out:\n\n";
        left_out.iter().for_each(|line| text += &format!("- {line}\n"));
    }
    text
}

/// Row of the summary for one level of error; empty cells if the reference does not resolve the level.
fn row(points: &[Point], level: f64, floor: f64) -> Vec<String> {
    let none = || "–".to_owned();
    let best = best(points, level);
    let Some(first) = best.first().filter(|_| floor.is_nan() || level >= floor) else {
        return [per_cent(level)].into_iter().chain((0..8).map(|_| none())).collect();
    };
    let slower = |seconds: f64| format!("{:.1}", seconds / first.total());
    // The next method excludes `auto`, which is another name of one of the others, and peers, which have their own
    // column.
    let next = best.iter().skip(1).find(|point| !point.is_foreign && point.auto.is_none());
    let auto = points.iter().find(|point| point.auto.is_some_and(|tolerance| (tolerance / level - 1.0).abs() < 1e-6));
    let peer = best.iter().find(|point| point.is_foreign);
    vec![
        per_cent(level),
        first.method.clone(),
        first.setting.clone(),
        seconds(first.total()),
        estimated(first.errors.history.first),
        next.map_or_else(none, |next| next.method.clone()),
        next.map_or_else(none, |next| slower(next.total())),
        auto.map_or_else(none, |auto| {
            let missed = if auto.errors.history.first > level { ", missed" } else { "" };
            format!("{}, error {}{missed}", seconds(auto.total()), estimated(auto.errors.history.first))
        }),
        peer.map_or_else(none, |peer| {
            let time = format!("{}: {}", peer.method, seconds(peer.total()));
            if first.is_foreign { time } else { format!("{time}, {} times slower", slower(peer.total())) }
        }),
    ]
}

fn table(head: &[&str], rows: &[Vec<String>]) -> String {
    let line = |cells: Vec<&str>| format!("| {} |\n", cells.join(" | "));
    let mut text = line(head.to_vec()) + &line(vec!["---"; head.len()]);
    rows.iter().for_each(|row| text += &line(row.iter().map(String::as_str).collect()));
    text
}

fn per_cent(level: f64) -> String {
    format!("{}%", (1e6 * level).round() / 1e4)
}

fn seconds(value: f64) -> String {
    match value {
        v if v < 0.1 => format!("{:.1} ms", 1e3 * v),
        v if v < 1.0 => format!("{:.0} ms", 1e3 * v),
        v => format!("{v:.1} s"),
    }
}

#[cfg(test)]
mod tests {
    use super::super::front::tests::point;
    use super::*;
    use crate::study::history::History;

    fn reference() -> Reference {
        let agreement = Difference { first: 1e-5, whole: 2e-5, tension: f64::NAN };
        Reference { setting: "finest".into(), history: History::default(), agreement }
    }

    /// The fastest point may also be `auto` or another program.
    #[test]
    fn nobody_is_quicker_than_the_quickest() {
        let mut auto = point("auto", 0.01, 5e-3);
        auto.auto = Some(1e-1);
        let own = [auto, point("mindlin", 0.02, 4e-3)];
        let text = summary("plate", &own, &reference(), &[]);
        assert!(
            text.contains("| 1% | auto | t=0.01 | 10.0 ms | 5.0e-3 | mindlin | 2.0 | \u{2013} | \u{2013} |"),
            "{text}"
        );
        let with_peer = [own[0].clone(), own[1].clone(), point("peer", 0.005, 9e-3)];
        let text = summary("plate", &with_peer, &reference(), &[]);
        assert!(
            text.contains("| 1% | peer | t=0.005 | 5.0 ms | 9.0e-3 | mindlin | 4.0 | \u{2013} | peer: 5.0 ms |"),
            "{text}"
        );
    }

    #[test]
    fn the_gist_says_who_wins_and_by_how_much() {
        let mut auto = point("auto", 0.03, 5e-3);
        auto.auto = Some(1e-2);
        let points = [auto, point("mindlin", 0.02, 4e-3), point("solid", 0.5, 2e-4), point("peer", 4.0, 9e-3)];
        let reference = reference();
        let text = summary("plate", &points, &reference, &["dear: too long".into()]);
        assert!(text.contains("| 1% | mindlin | t=0.02 | 20.0 ms | 4.0e-3 | solid | 25.0 | 30.0 ms, error 5.0e-3 | peer: 4.0 s, 200.0 times slower |"), "{text}");
        assert!(text.contains("| 0.1% | solid | t=0.5 | 500 ms | 2.0e-4 | – | – | – | – |"), "{text}");
        assert!(
            text.contains("| 0.01% | – |") && text.contains("below 1e-4 and 2e-4") && text.contains("- dear"),
            "{text}"
        );
        let table = csv(&points, reference.floor());
        assert_eq!(table.lines().count(), 5);
        assert!(
            table.lines().nth(3).unwrap().starts_with("solid,t=0.5,mindlin,10,0.125,0.375,0.5,0.0002,0.0004,NaN"),
            "{table}"
        );
        assert!(
            table.lines().nth(2).unwrap().ends_with(",true,true")
                && table.lines().nth(4).unwrap().ends_with(",true,false")
        );
    }
}
