//! Section of a report with a table of the contacts.

use crate::record::episodes::Episode;

use super::data::Data;
use super::number::{FORCE, IMPULSE, TIME, Units, computed, digits, unit_for};
use super::page::{Block, Column, Section, Table};

/// Largest number of contacts that the table lists.
const LISTED: usize = 40;

/// Makes the section.
pub fn section(data: &Data) -> Section {
    let all = &data.contacts.episodes;
    let parts = if all.is_empty() {
        vec![Block::Text("The impactor has not touched the body.".to_owned())]
    } else {
        let mut parts = vec![Block::Table(table(all))];
        let impulse = all.iter().map(|contact| contact.impulse).sum();
        let mut text = format!("The contacts transfer an impulse of {} in all.", computed(impulse, IMPULSE));
        if all.len() > LISTED {
            text = format!("The first {LISTED} of {} contacts are listed; the result holds all. {text}", all.len());
        }
        if data.contacts.is_open {
            text += " The last contact goes on at the end of the history.";
        }
        parts.push(Block::Text(text));
        parts
    };
    Section { id: "contacts", title: "Contacts", parts }
}

fn table(all: &[Episode]) -> Table {
    let unit = |of: fn(&Episode) -> f64, units: Units| unit_for(all.iter().map(of).fold(0.0, f64::max), units);
    let time = unit(|contact| contact.end, TIME);
    let force = unit(|contact| contact.peak_force, FORCE);
    let row = |contact: &Episode| {
        let times = [contact.start, contact.end, contact.end - contact.start].map(|t| digits(t / time.size, 4));
        let [force, at] =
            [contact.peak_force / force.size, contact.peak_time / time.size].map(|value| digits(value, 4));
        times.into_iter().chain([force, at, digits(contact.impulse, 4)]).collect()
    };
    Table {
        caption: "Contacts in the order of time".to_owned(),
        columns: vec![
            Column::number("Start", time.name),
            Column::number("End", time.name),
            Column::number("Length", time.name),
            Column::number("Peak force", force.name),
            Column::number("at", time.name),
            Column::number("Impulse", "N s"),
        ],
        rows: all.iter().take(LISTED).map(row).collect(),
    }
}
