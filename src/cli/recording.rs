//! What a run reads of its body, on the way into the result: probes into the series, fields into their own file.

use std::path::{Path, PathBuf};

use crate::error::Result;
use crate::impact::step::Step;
use crate::impact::{Probe, Tape};
use crate::model::Readings;
use crate::record::fields::FieldWriter;
use crate::record::series::SeriesWriter;
use crate::space::evaluate::FieldSampler;

/// The readings of a run, and the file of its fields. Rank 0 has it.
pub struct Recording {
    tape: Tape,
    sampler: Option<FieldSampler>,
    output: PathBuf,
    fields: Option<FieldWriter>,
    /// Number of frames, where it is known.
    planned: Option<usize>,
}

impl Recording {
    /// Of a run with fields after every so many of so many steps, as far as these are known, that writes the result `output`.
    pub fn new(readings: Readings, output: &Path, every: Option<usize>, steps: Option<usize>) -> Self {
        let Readings { tape, sampler } = readings;
        let planned = every.zip(steps).map(|(every, steps)| steps / every + 1);
        Self { tape, sampler, output: output.to_owned(), fields: None, planned }
    }

    /// Goes on with the fields of the result `from` behind a time, s; a result that has no frame of its own has these.
    ///
    /// # Errors
    /// [`crate::Error::Io`] where they cannot be read, or written.
    pub fn behind(self, from: &Path, end: f64, writer: &SeriesWriter) -> Result<Self> {
        let Some(sampler) = &self.sampler else { return Ok(self) };
        writer.link_fields()?;
        let fields = FieldWriter::continued(&self.output, sampler.grid(), (from, end))?;
        Ok(Self { fields: Some(fields), ..self })
    }

    /// Writes the step's fields where it has any; returns what the probes have read at it.
    ///
    /// # Errors
    /// [`crate::Error::Io`] when writing fails.
    pub fn step(&mut self, step: &Step, writer: &SeriesWriter) -> Result<Vec<Probe>> {
        // In modal coordinates all steps are there when the first is told.
        let waiting = if step.number == 0 { self.tape.fields() } else { 0 };
        let Some(reading) = self.tape.take(step.number) else { return Ok(Vec::new()) };
        if let (Some(sampler), Some([u, v])) = (&self.sampler, &reading.coordinates) {
            let fields = match &mut self.fields {
                Some(fields) => fields,
                none => {
                    writer.link_fields()?;
                    let planned = self.planned.or(Some(waiting).filter(|waiting| *waiting > 1));
                    none.insert(FieldWriter::create(&self.output, sampler.grid(), planned)?)
                }
            };
            fields.push(step.time, &sampler.fields([u, v]))?;
        }
        Ok(reading.probes)
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
