//! Errors in a scene, with the key, the line, and a hint how to correct it.

use miette::{Diagnostic, LabeledSpan, NamedSource, SourceCode};

/// An error in a scene or in an override. Its text is `name:line: key: message`. As a [`Diagnostic`] it also has the
/// source with the place marked, and a hint how to correct it.
#[derive(Debug, thiserror::Error)]
#[error("{}:{line}: {key}: {message}", excerpt.source.name())]
pub struct SceneError {
    key: String,
    line: usize,
    message: String,
    excerpt: Box<Excerpt>,
}

/// The source, the marked place, and the hint.
#[derive(Debug)]
pub(super) struct Excerpt {
    pub source: NamedSource<String>,
    pub mark: LabeledSpan,
    pub help: String,
}

impl Excerpt {
    /// Whether the lines around the mark are short enough to be shown. Longer ones do not fit in a terminal, and miette
    /// counts columns in 16 bits.
    fn is_short(&self) -> bool {
        const LONGEST: usize = 2000;
        let text = self.source.inner();
        let at = self.mark.offset().min(text.len());
        let mut before = text.as_bytes()[..at].rsplitn(3, |byte| *byte == b'\n');
        let mut after = text.as_bytes()[at..].splitn(3, |byte| *byte == b'\n');
        let own = before.next().map_or(0, <[u8]>::len) + after.next().map_or(0, <[u8]>::len);
        let next = [before.next(), after.next()].into_iter().flatten().map(<[u8]>::len);
        next.chain([own]).all(|length| length <= LONGEST)
    }
}

impl SceneError {
    pub(super) fn new(key: String, line: usize, message: String, excerpt: Excerpt) -> Self {
        Self { key, line, message, excerpt: Box::new(excerpt) }
    }

    /// Dotted path of the wrong or missing key, for example `support.0.stiffness`.
    pub fn key(&self) -> &str {
        &self.key
    }

    /// Line of the key, counted from 1. For a missing key: the line of the table where it belongs.
    pub fn line(&self) -> usize {
        self.line
    }

    /// Adds a remark in brackets to the message.
    pub fn remarked(self, remark: &str) -> Self {
        Self { message: format!("{} ({remark})", self.message), ..self }
    }

    /// Description of the error, without its place.
    pub fn message(&self) -> &str {
        &self.message
    }

    /// Hint how to correct the error.
    pub fn advice(&self) -> &str {
        &self.excerpt.help
    }
}

impl Diagnostic for SceneError {
    fn help<'a>(&'a self) -> Option<Box<dyn std::fmt::Display + 'a>> {
        Some(Box::new(&self.excerpt.help))
    }

    fn source_code(&self) -> Option<&dyn SourceCode> {
        self.excerpt.is_short().then_some(&self.excerpt.source as &dyn SourceCode)
    }

    fn labels(&self) -> Option<Box<dyn Iterator<Item = LabeledSpan> + '_>> {
        self.excerpt.is_short().then(|| Box::new(std::iter::once(self.excerpt.mark.clone())) as _)
    }
}
