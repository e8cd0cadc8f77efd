//! The fields of a run, on the way into their own file.

use std::path::{Path, PathBuf};

use crate::error::Result;
use crate::impact::Reading;
use crate::impact::step::Step;
use crate::record::fields::FieldWriter;
use crate::record::series::SeriesWriter;
use crate::space::evaluate::FieldSampler;

/// What makes fields of readings, and the file of these. Rank 0 has it.
pub struct Recording {
    sampler: FieldSampler,
    output: PathBuf,
    fields: Option<FieldWriter>,
    /// Number of frames, where it is known.
    planned: Option<usize>,
}

impl Recording {
    /// Of a run with fields after every so many of so many steps, as far as these are known, that writes the result `output`.
    pub fn new(sampler: FieldSampler, output: &Path, every: Option<usize>, steps: Option<usize>) -> Self {
        let planned = every.zip(steps).map(|(every, steps)| steps / every + 1);
        Self { sampler, output: output.to_owned(), fields: None, planned }
    }

    /// Goes on with the fields of the result `from` behind a time, s; a result that has no frame of its own has these.
    ///
    /// # Errors
    /// [`crate::Error::Io`] where they cannot be read, or written.
    pub fn behind(self, from: &Path, end: f64, writer: &SeriesWriter) -> Result<Self> {
        writer.link_fields()?;
        let fields = FieldWriter::continued(&self.output, self.sampler.grid(), (from, end))?;
        Ok(Self { fields: Some(fields), ..self })
    }

    /// Writes the step's fields where it has any.
    ///
    /// # Errors
    /// [`crate::Error::Io`] when writing fails.
    pub fn step(&mut self, step: &Step, reading: &Reading, writer: &SeriesWriter) -> Result<()> {
        let Some([u, v]) = &reading.coordinates else { return Ok(()) };
        let fields = match &mut self.fields {
            Some(fields) => fields,
            none => {
                writer.link_fields()?;
                none.insert(FieldWriter::create(&self.output, self.sampler.grid(), self.planned)?)
            }
        };
        let contact = self.sampler.contact.now(step.contact.force, step.contact.indentation);
        fields.push(step.time, &self.sampler.fields([u, v], &contact))
    }

    /// Brings all fields to the system.
    ///
    /// # Errors
    /// [`crate::Error::Io`] when writing fails.
    pub fn flush(&mut self) -> Result<()> {
        self.fields.as_mut().map_or(Ok(()), FieldWriter::flush)
    }

    /// Brings all fields to the disk.
    ///
    /// # Errors
    /// [`crate::Error::Io`] when writing fails.
    pub fn sync(&mut self) -> Result<()> {
        self.fields.as_mut().map_or(Ok(()), FieldWriter::sync)
    }
}
