//! Writes the fields of a run to a separate file.

use std::path::{Path, PathBuf};

use crate::error::Result;
use crate::impact::Reading;
use crate::impact::step::Step;
use crate::record::fields::FieldWriter;
use crate::record::series::SeriesWriter;
use crate::space::evaluate::FieldSampler;

/// Computes fields from readings and writes them. Exists on rank 0 only.
pub struct Recording {
    sampler: FieldSampler,
    output: PathBuf,
    fields: Option<FieldWriter>,
    /// Number of frames, if it is known.
    planned: Option<usize>,
}

impl Recording {
    /// Prepares the fields of a run with the result `output`. `every` is the interval of frames in steps, `steps` the
    /// number of steps; both if known.
    pub fn new(sampler: FieldSampler, output: &Path, every: Option<usize>, steps: Option<usize>) -> Self {
        let planned = every.zip(steps).map(|(every, steps)| steps / every + 1);
        Self { sampler, output: output.to_owned(), fields: None, planned }
    }

    /// Continues the fields of the result `from`. Its frames up to the time `end` (s) are kept in the file of the new
    /// result.
    ///
    /// # Errors
    /// [`crate::Error::Io`] if fields cannot be read or written.
    pub fn behind(self, from: &Path, end: f64, writer: &SeriesWriter) -> Result<Self> {
        writer.link_fields()?;
        let fields = FieldWriter::continued(&self.output, self.sampler.grid(), (from, end))?;
        Ok(Self { fields: Some(fields), ..self })
    }

    /// Writes the fields of a step, if it has any.
    ///
    /// # Errors
    /// [`crate::Error::Io`] if writing fails.
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

    /// Writes all fields to the file system.
    ///
    /// # Errors
    /// [`crate::Error::Io`] if writing fails.
    pub fn flush(&mut self) -> Result<()> {
        self.fields.as_mut().map_or(Ok(()), FieldWriter::flush)
    }

    /// Writes all fields to the disk (fsync).
    ///
    /// # Errors
    /// [`crate::Error::Io`] if writing fails.
    pub fn sync(&mut self) -> Result<()> {
        self.fields.as_mut().map_or(Ok(()), FieldWriter::sync)
    }
}
