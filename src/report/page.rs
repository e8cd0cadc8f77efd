//! What a report consists of, before it is HTML. The templates are in the folder `page`.

use askama::Template;

/// The whole page.
#[derive(Template)]
#[template(path = "report.html")]
pub struct Page {
    /// Of the scene.
    pub title: String,
    /// Name of the result's file.
    pub file: String,
    /// When it was last written.
    pub date: Option<String>,
    /// Of the program that has made the report.
    pub version: &'static str,
    /// What a reader must know.
    pub summary: Summary,
    /// The rest.
    pub sections: Vec<Section>,
}

/// What a reader must know.
#[derive(Debug, Default)]
pub struct Summary {
    /// What was hit by what.
    pub sentence: String,
    /// What follows from the results, and what restricts them.
    pub verdicts: Vec<Verdict>,
    /// The key figures.
    pub facts: Vec<KeyFigure>,
}

/// A conclusion.
#[derive(Debug)]
pub struct Verdict {
    /// How good it is.
    pub grade: Grade,
    /// In a few words.
    pub title: String,
    /// In a sentence.
    pub text: String,
}

/// How good a conclusion is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Grade {
    /// As wanted.
    Good,
    /// Not certain.
    Open,
    /// Not as wanted.
    Bad,
}

impl Grade {
    /// Its class in the style sheet.
    pub fn class(self) -> &'static str {
        match self {
            Self::Good => "good",
            Self::Open => "open",
            Self::Bad => "bad",
        }
    }

    /// A sign that is read without colour.
    pub fn sign(self) -> &'static str {
        match self {
            Self::Good => "✓",
            Self::Open => "!",
            Self::Bad => "✗",
        }
    }
}

/// A number of the summary.
#[derive(Debug)]
pub struct KeyFigure {
    /// What it is.
    pub name: &'static str,
    /// With its unit.
    pub value: String,
    /// When, where; may be empty.
    pub note: String,
}

/// A section.
#[derive(Debug)]
pub struct Section {
    /// Its name in links.
    pub id: &'static str,
    /// Its heading.
    pub title: &'static str,
    /// What it has, from top to bottom.
    pub parts: Vec<Part>,
}

/// A part of a section.
#[derive(Debug)]
pub enum Part {
    /// A paragraph.
    Text(String),
    /// Names and values.
    Facts(Facts),
    /// Rows of numbers.
    Table(Table),
    /// A figure.
    Figure(Figure),
    /// A text that is unfolded on demand, and in print.
    Fold(Fold),
}

/// A table of names and values.
#[derive(Debug)]
pub struct Facts {
    /// What they are about.
    pub caption: String,
    /// The rows.
    pub rows: Vec<Fact>,
}

/// A name and a value.
#[derive(Debug)]
pub struct Fact {
    /// What it is.
    pub name: String,
    /// In words, or with its unit.
    pub value: String,
}

impl Fact {
    /// A name and a value.
    pub fn new(name: impl Into<String>, value: impl Into<String>) -> Self {
        Self { name: name.into(), value: value.into() }
    }
}

/// A table; the first cell of each row is its heading.
#[derive(Debug)]
pub struct Table {
    /// What it shows.
    pub caption: String,
    /// The columns.
    pub columns: Vec<Column>,
    /// A cell for each column.
    pub rows: Vec<Vec<String>>,
}

impl Table {
    /// Whether it stays on one sheet of paper.
    pub fn is_short(&self) -> bool {
        self.rows.len() <= 12
    }
}

/// A column of a table.
#[derive(Debug)]
pub struct Column {
    /// Its heading.
    pub name: String,
    /// The unit of its numbers; may be empty.
    pub unit: &'static str,
    /// Whether it holds words, which begin at the left.
    pub is_text: bool,
}

impl Column {
    /// A column of words.
    pub fn text(name: &str) -> Self {
        Self { name: name.to_owned(), unit: "", is_text: true }
    }

    /// A column of numbers in a unit.
    pub fn number(name: &str, unit: &'static str) -> Self {
        Self { name: name.to_owned(), unit, is_text: false }
    }
}

/// A figure in two shapes, of which a page shows the one that fits.
#[derive(Debug)]
pub struct Figure {
    /// An element `svg` for wide pages and paper.
    pub wide: String,
    /// One for narrow screens.
    pub narrow: String,
    /// What it shows.
    pub caption: String,
}

/// A text that is unfolded on demand.
#[derive(Debug)]
pub struct Fold {
    /// What it is.
    pub title: String,
    /// As it is, line by line.
    pub text: String,
}
