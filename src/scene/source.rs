//! The text of a scene after its overrides, and errors that point into it.

use std::borrow::Cow;
use std::ops::Range;
use std::path::{Path, PathBuf};

use miette::{LabeledSpan, NamedSource};
use serde::{Deserialize, Serialize};
use toml_edit::{Array, Document, DocumentMut, InlineTable, Item, Value, value};

use super::error::{Excerpt, SceneError};
use super::grammar::hint;
use super::locate::{self, locate};
use super::overrides::Override;

/// Text of a scene after its overrides: all that is needed to repeat the run.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Source {
    name: String,
    /// Folder for relative paths of files named in the scene.
    folder: PathBuf,
    text: String,
    overrides: Vec<Override>,
    /// Command-line option that gave the overrides, for messages.
    option: Cow<'static, str>,
}

/// Command-line option that varies keys.
const VARIED: &str = "--vary";

/// Part of the text that an error underlines.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum Mark {
    Key,
    Value,
}

impl Source {
    /// Checks that `text` is valid TOML, and applies the overrides of `--set`.
    pub(super) fn new(name: &str, text: &str, overrides: &[String]) -> Result<Self, SceneError> {
        Self::with(name, text, overrides, "--set")
    }

    /// This scene with the values of one member of a sweep.
    pub(super) fn varied(&self, values: &[String]) -> Result<Self, SceneError> {
        Ok(Self::with(&self.name, &self.text, values, VARIED)?.of_folder(&self.folder))
    }

    fn with(name: &str, text: &str, overrides: &[String], option: &'static str) -> Result<Self, SceneError> {
        let (name, text) = (name.to_owned(), text.to_owned());
        let mut source = Self { name, folder: PathBuf::new(), text, overrides: Vec::new(), option: option.into() };
        let mut document = Document::parse(source.text.as_str())
            .map_err(|error| source.syntax(error.message(), error.span()))?
            .into_mut();
        for given in overrides {
            let entry = Override::new(given)
                .and_then(|entry| entry.apply(&mut document).map(|()| entry))
                .map_err(|message| on_command_line(option, given, message))?;
            source.overrides.push(entry);
        }
        if !overrides.is_empty() {
            source.text = written(&document, option, overrides)?;
        }
        Ok(source)
    }

    /// The same source, with the folder for relative paths of files.
    pub(super) fn of_folder(self, folder: &Path) -> Self {
        Self { folder: folder.to_owned(), ..self }
    }

    /// The source with `contact.table` replaced by points of indentation (m) and force (N), if it names a file.
    pub(super) fn with_table(self, points: &[[f64; 2]]) -> Self {
        let points = value(points.iter().map(|point| Array::from_iter(*point)).collect::<Array>());
        self.with_value(&["contact", "table"], points)
    }

    /// The source with the relaxation terms of a material, pairs of time (s) and modulus (Pa), in place of their file.
    pub(super) fn with_terms(self, material: &str, pairs: &[[f64; 2]]) -> Self {
        let term = |[time, modulus]: &[f64; 2]| {
            InlineTable::from_iter([("modulus", Value::from(*modulus)), ("time", Value::from(*time))])
        };
        self.with_value(&["material", material, "prony"], value(pairs.iter().map(term).collect::<Array>()))
    }

    /// The source with another value in place of the name of a file.
    fn with_value(mut self, path: &[&str], value: Item) -> Self {
        if let Ok(mut document) = Document::parse(self.text.as_str()).map(Document::into_mut)
            && let Some(found) = path.iter().try_fold(document.as_item_mut(), |item, key| item.get_mut(key))
            && found.is_str()
        {
            *found = value;
            self.text = document.to_string();
        }
        self
    }

    /// Folder for relative paths; empty for the current folder.
    pub fn folder(&self) -> &Path {
        &self.folder
    }

    /// Name of the scene in messages: its file.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// The full text after overrides: a valid TOML document.
    pub fn text(&self) -> &str {
        &self.text
    }

    /// Number at a dotted path through tables, as the text has it; `None` if there is none.
    pub fn number(&self, path: &str) -> Option<f64> {
        let document = Document::parse(self.text.as_str()).ok()?;
        let item = path.split('.').try_fold(document.as_item(), |item, name| item.get(name))?;
        item.as_float().or(item.as_integer().map(|whole| whole as f64))
    }

    /// An error at the key of a dotted path, for example `support.0.surface`; if the key is missing, at its table.
    /// `message` describes the error, `help` how to correct it.
    pub fn error(&self, path: &str, message: impl Into<String>, help: impl Into<String>) -> SceneError {
        let segments: Vec<&str> = path.split('.').collect();
        self.error_at(&segments, Mark::Value, message.into(), help.into())
    }

    /// An error for a required key that is missing.
    pub(super) fn missing(&self, path: &str, help: String) -> SceneError {
        let segments: Vec<&str> = path.split('.').collect();
        self.error_at(&segments, Mark::Key, "this key is required".into(), help)
    }

    /// Same as [`error`](Self::error), for a key that conflicts with another key. The message names an override of
    /// either key.
    pub(super) fn conflict(&self, path: &str, with: &str, message: String, help: String) -> SceneError {
        self.error_with(path, &[with], message, help)
    }

    /// Same as [`error`](Self::error), for a value that is wrong together with the values of other keys. The message
    /// names an override of any of these keys.
    pub(super) fn error_with(
        &self,
        path: &str,
        others: &[&str],
        message: String,
        help: impl Into<String>,
    ) -> SceneError {
        let other = others.iter().find_map(|other| self.overridden(other));
        let message = match (self.overridden(path), other) {
            (None, Some(given)) => format!("{message} ({})", self.set_by(given)),
            _ => message,
        };
        self.error(path, message, help)
    }

    /// Words for the origin of a value: the override as given, or the name of a varied key.
    fn set_by(&self, given: &str) -> String {
        let given = if self.option == VARIED { left_of_equals(given) } else { given };
        format!("set by {} {given}", self.option)
    }

    /// The last override that concerns a key: an override of the key, of a part of it, or of a table that contains it.
    fn overridden(&self, path: &str) -> Option<&str> {
        let named =
            |entry: &&Override| entry.segments.iter().map(String::as_str).zip(path.split('.')).all(|(a, b)| a == b);
        self.overrides.iter().rev().find(named).map(|entry| entry.given.as_str())
    }

    /// Same as [`error`](Self::error), for a path in segments, which may contain dots. Underlines the key or the value.
    pub(super) fn error_at(&self, segments: &[&str], mark: Mark, message: String, help: String) -> SceneError {
        // The text was already parsed once. If parsing failed here, the error would point to the start of the text.
        let document = Document::parse(self.text.as_str()).unwrap_or_else(|_| Document::default());
        let place = locate(&document, segments);
        let line = locate::line(self.text.as_bytes(), place.key.start);
        let (span, label) = match segments.get(place.depth) {
            Some(missing) if place.depth > 0 => (place.key, Some(format!("`{missing}` belongs here"))),
            Some(_) => (place.key, None),
            None if mark == Mark::Key => (place.key, None),
            None => (place.value, None),
        };
        let key = segments.join(".");
        let message = match self.overridden(&key) {
            Some(given) => format!("{message} ({})", self.set_by(given)),
            None => message,
        };
        self.fault(key, line, span, label, (message, help))
    }

    fn fault(
        &self,
        key: String,
        line: usize,
        span: Range<usize>,
        label: Option<String>,
        (message, help): (String, String),
    ) -> SceneError {
        let name = if self.overrides.is_empty() {
            self.name.clone()
        } else {
            format!("{} (after {})", self.name, self.option)
        };
        let excerpt = Excerpt {
            source: NamedSource::new(name, self.text.clone()),
            mark: LabeledSpan::new_with_span(label, span),
            help,
        };
        SceneError::new(key, line, message, excerpt)
    }

    /// An error of the TOML syntax. The key is the text left of the `=` in the faulty line.
    fn syntax(&self, message: &str, span: Option<Range<usize>>) -> SceneError {
        let end = self.text.len();
        let span = span.map_or(end..end, |span| span.start.min(end)..span.end.min(end));
        let start = self.text[..span.start].rfind('\n').map_or(0, |at| at + 1);
        let line = self.text[start..].lines().next().unwrap_or_default();
        let key = left_of_equals(line).trim_matches(['[', ']']).to_owned();
        let number = locate::line(self.text.as_bytes(), span.start);
        let help = hint(line, message).to_owned();
        let message = format!("not valid TOML: {}", message.replace('\n', "; "));
        self.fault(key, number, span, None, (message, help))
    }
}

/// The document as text, checked to be valid TOML.
fn written(document: &DocumentMut, option: &str, overrides: &[String]) -> Result<String, SceneError> {
    let text = document.to_string();
    match Document::parse(text.as_str()) {
        Ok(_) => Ok(text),
        Err(error) => Err(on_command_line(
            option,
            &overrides.join(" "),
            format!("the scene does not stay valid TOML: {}", error.message()),
        )),
    }
}

/// Text before the `=` (or `:`) in a line that may not be an assignment; the whole line if that is empty.
fn left_of_equals(line: &str) -> &str {
    let end = if line.contains('=') { '=' } else { ':' };
    let key = line.split(end).next().unwrap_or_default().trim();
    if key.is_empty() { line.trim() } else { key }
}

/// An error in an override.
fn on_command_line(option: &str, given: &str, message: String) -> SceneError {
    let text = format!("{option} {given}");
    let key = left_of_equals(given);
    let excerpt = Excerpt {
        mark: LabeledSpan::new_with_span(None, option.len() + 1..text.len()),
        help: "write KEY=VALUE with the key's dotted path: time.step=1e-6, support.0.stiffness=1e9".into(),
        source: NamedSource::new("command line", text),
    };
    SceneError::new(key.to_owned(), 1, format!("{message} ({option} {given})"), excerpt)
}
