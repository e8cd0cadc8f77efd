//! Makes a report on a run: a single HTML page without external files.
//!
//! Flow of the data: result file → `data` → sections of text, tables and figures (one file each) → `page` → HTML.

mod contacts;
mod data;
mod energy;
mod faces;
mod figures;
mod history;
mod model;
mod number;
mod origin;
mod page;
mod probes;
mod relaxation;
pub mod scene;
mod summary;
mod tension;

use std::path::Path;

use askama::Template;

use crate::error::{Error, Result};

use data::Data;
pub use faces::face_figure;
pub use page::Fact;
use page::{Page, Section};

/// Makes the report on the result `path`. Returns the text of an HTML file.
///
/// # Errors
/// Same as [`crate::record::read::history`]; [`Error::Output`] if a figure or the page cannot be made.
pub fn report(path: &Path) -> Result<String> {
    let data = Data::read(path)?;
    let page = Page {
        title: data.title(),
        file: data.file.clone(),
        date: data.written.map(number::date),
        version: env!("CARGO_PKG_VERSION"),
        summary: summary::summary(&data),
        sections: sections(&data)?,
    };
    page.render().map_err(|error| Error::Output(format!("the report cannot be made: {error}")))
}

/// The sections in the order of a reader's questions: the computed scene, the model, the results, and their origin.
fn sections(data: &Data) -> Result<Vec<Section>> {
    Ok(vec![
        scene::section(data),
        model::section(data),
        history::section(data)?,
        contacts::section(data),
        tension::section(data)?,
        probes::section(data)?,
        energy::section(data)?,
        origin::section(data),
    ])
}
