//! Content of a report, from which the templates in the folder `page` make HTML.

use askama::Template;

/// The whole page.
#[derive(Template)]
#[template(path = "report.html")]
pub struct Page {
    /// Title of the scene.
    pub title: String,
    /// Name of the result file.
    pub file: String,
    /// Date at which the result was last written; `None` if unknown.
    pub date: Option<String>,
    /// Version of the program that made the report.
    pub version: &'static str,
    /// The summary at the top of the page.
    pub summary: Summary,
    /// The sections below the summary.
    pub sections: Vec<Section>,
}

/// The summary of a report.
#[derive(Debug, Default)]
pub struct Summary {
    /// The impact in one sentence.
    pub sentence: String,
    /// Conclusions from the results, and their limitations.
    pub verdicts: Vec<Verdict>,
    /// The key figures.
    pub facts: Vec<Fact>,
}

/// A conclusion in the summary.
#[derive(Debug)]
pub struct Verdict {
    /// Rating of the result.
    pub grade: Grade,
    /// Title of a few words.
    pub title: String,
    /// Explanation in a sentence or two.
    pub text: String,
}

/// Rating of a conclusion.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Grade {
    /// The requirement is met.
    Good,
    /// Not certain.
    Open,
    /// The requirement is not met.
    Bad,
}

impl Grade {
    /// Class in the style sheet.
    pub fn class(self) -> &'static str {
        match self {
            Self::Good => "good",
            Self::Open => "open",
            Self::Bad => "bad",
        }
    }

    /// Sign that conveys the rating without colour.
    pub fn sign(self) -> &'static str {
        match self {
            Self::Good => "✓",
            Self::Open => "!",
            Self::Bad => "✗",
        }
    }
}

/// A section of the report.
#[derive(Debug)]
pub struct Section {
    /// Identifier for links.
    pub id: &'static str,
    /// Heading of the section.
    pub title: &'static str,
    /// Content from top to bottom.
    pub parts: Vec<Block>,
}

/// An element of a section.
#[derive(Debug)]
pub enum Block {
    /// A paragraph.
    Text(String),
    /// A table of names and values.
    Facts {
        /// Caption of the table.
        caption: &'static str,
        /// The rows.
        rows: Vec<Fact>,
    },
    /// A table of numbers.
    Table(Table),
    /// A figure.
    Figure(Figure),
    /// A text that is hidden until the reader opens it; it is always visible in print.
    Fold {
        /// Title, which is always visible.
        title: &'static str,
        /// The text; its line breaks are kept.
        text: String,
    },
}

/// A fact about a scene or a result.
#[derive(Debug)]
pub struct Fact {
    /// Name of the quantity or property.
    pub name: String,
    /// Value in words, or a number with its unit.
    pub value: String,
    /// Time, place or scope of the value; may be empty.
    pub note: String,
}

impl Fact {
    /// Makes a fact from a name and a value.
    pub fn new(name: impl Into<String>, value: impl Into<String>) -> Self {
        Self { name: name.into(), value: value.into(), note: String::new() }
    }

    /// The fact with a note.
    #[must_use]
    pub fn noted(self, note: impl Into<String>) -> Self {
        Self { note: note.into(), ..self }
    }

    /// Value and note.
    pub fn text(&self) -> String {
        format!("{} {}", self.value, self.note).trim_end().to_owned()
    }
}

/// A table; the first cell of each row is its heading.
#[derive(Debug)]
pub struct Table {
    /// Caption of the table.
    pub caption: String,
    /// The columns.
    pub columns: Vec<Column>,
    /// The rows, each with a cell for every column.
    pub rows: Vec<Vec<String>>,
}

impl Table {
    /// Whether the table is short enough to be kept on one page in print (at most 12 rows).
    pub fn is_short(&self) -> bool {
        self.rows.len() <= 12
    }
}

/// A column of a table.
#[derive(Debug)]
pub struct Column {
    /// Heading of the column.
    pub name: String,
    /// Unit of the numbers; may be empty.
    pub unit: &'static str,
    /// Whether the column contains text, which is left-aligned.
    pub is_text: bool,
}

impl Column {
    /// Makes a column of text.
    pub fn text(name: &str) -> Self {
        Self { name: name.to_owned(), unit: "", is_text: true }
    }

    /// Makes a column of numbers with a unit.
    pub fn number(name: &str, unit: &'static str) -> Self {
        Self { name: name.to_owned(), unit, is_text: false }
    }
}

/// A figure in two sizes; the page shows the one that fits its width.
#[derive(Debug)]
pub struct Figure {
    /// Text of an `svg` element for wide pages and paper.
    pub wide: String,
    /// Text of an `svg` element for narrow screens.
    pub narrow: String,
    /// Caption of the figure.
    pub caption: String,
}
