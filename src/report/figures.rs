//! Draws the program's figures for a page, in one size for wide pages and one for narrow screens.

use crate::error::Result;
use crate::figure::Sheet;
use crate::figure::history::{Curve, History, Role, RunCurves, draw_inline};

use super::data::Data;
use super::number::{Units, unit_for};
use super::page::Figure;

/// Size for wide pages and paper.
const WIDE: Sheet = Sheet { width: 1600, height: 660 };
/// Size for narrow screens, with letters of the same size.
const NARROW: Sheet = Sheet { width: 700, height: 600 };

/// Height of a line of the legend.
const LEGEND_LINE: u32 = 40;
/// Approximate number of names in a line of the legend, for wide and narrow figures.
const NAMES_PER_LEGEND_LINE: [u32; 2] = [4, 1];

/// Name of a curve that is the sum of the others.
pub const TOTAL: &str = "total";

/// Data of a figure with curves over time.
pub struct Curves<'a> {
    /// Title of the vertical axis.
    pub quantity: &'a str,
    /// Units from which the unit of the vertical axis is chosen.
    pub units: Units,
    /// Times of the values, s.
    pub time: &'a [f64],
    /// Name and values (SI units) of each curve; the name of a single curve may be empty.
    pub curves: Vec<(String, &'a [f64])>,
    /// Name and value of limits, drawn as horizontal lines.
    pub limits: Vec<(String, f64)>,
    /// Caption below the figure.
    pub caption: String,
}

impl Curves<'_> {
    /// Draws the figure in both sizes, with the contacts below the curves.
    ///
    /// # Errors
    /// Same as [`draw_inline`].
    pub fn draw(self, data: &Data) -> Result<Figure> {
        let values = self.curves.iter().flat_map(|(_, values)| values.iter().copied());
        let largest = values.chain(self.limits.iter().map(|(_, limit)| *limit));
        let unit = unit_for(
            largest.filter(|value| value.is_finite()).fold(0.0, |most, value| most.max(value.abs())),
            self.units,
        );
        let curve = |(label, values): (String, &[f64])| Curve {
            role: if label == TOTAL { Role::Total } else { Role::Value },
            label,
            values: values.iter().map(|value| value / unit.size).collect(),
        };
        let limits = self.limits.into_iter().map(|(label, value)| Curve {
            label,
            values: vec![value / unit.size; self.time.len()],
            role: Role::Limit,
        });
        let history = History {
            title: String::new(),
            quantity: self.quantity.to_owned(),
            unit: unit.name.to_owned(),
            runs: vec![RunCurves {
                time: self.time.to_vec(),
                curves: self.curves.into_iter().map(curve).chain(limits).collect(),
                contacts: data.contacts.episodes.clone(),
            }],
        };
        let name = format!("{} over time", self.quantity);
        // The sheet is enlarged by the height of the legend, so that the plot keeps its size.
        let names = history.runs[0].curves.iter().filter(|curve| !curve.label.is_empty()).count() as u32;
        let draw = |sheet: Sheet, beside: u32| {
            let height = sheet.height + LEGEND_LINE * names.div_ceil(beside);
            draw_inline(&history, Sheet { height, ..sheet }, &name)
        };
        let [wide, narrow] = [(WIDE, NAMES_PER_LEGEND_LINE[0]), (NARROW, NAMES_PER_LEGEND_LINE[1])]
            .map(|(sheet, beside)| draw(sheet, beside));
        Ok(Figure { wide: wide?, narrow: narrow?, caption: self.caption })
    }
}
