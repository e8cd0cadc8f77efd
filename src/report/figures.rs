//! Figures for a page: the program's own, in a shape for wide pages and one for narrow screens.

use crate::error::Result;
use crate::figure::Sheet;
use crate::figure::history::{Curve, History, Run, draw_inline};

use super::number::{Units, unit_for};
use super::page::Figure;

/// For wide pages and paper.
const WIDE: Sheet = Sheet { width: 1600, height: 660 };
/// For narrow screens, with the same letters.
const NARROW: Sheet = Sheet { width: 700, height: 600 };

/// What a line of the legend takes of the height.
const LEGEND_LINE: u32 = 40;
/// About as many names stand beside each other in a legend.
const BESIDE: [u32; 2] = [4, 1];

/// Curves over time.
pub struct Curves<'a> {
    /// What the vertical axis shows.
    pub quantity: &'a str,
    /// Its units.
    pub units: Units,
    /// s.
    pub time: &'a [f64],
    /// Names, empty for a single curve, and values in SI units.
    pub curves: Vec<(String, &'a [f64])>,
    /// Limits that the values are held against, with their names.
    pub limits: Vec<(String, f64)>,
    /// Start and end of each contact, s.
    pub contacts: Vec<(f64, f64)>,
    /// Below the figure.
    pub caption: String,
}

impl Curves<'_> {
    /// Draws them.
    ///
    /// # Errors
    /// As [`draw_inline`].
    pub fn draw(self) -> Result<Figure> {
        let values = self.curves.iter().flat_map(|(_, values)| values.iter().copied());
        let largest = values.chain(self.limits.iter().map(|(_, limit)| *limit));
        let unit = unit_for(
            largest.filter(|value| value.is_finite()).fold(0.0, |most, value| most.max(value.abs())),
            self.units,
        );
        let curve = |(label, values): (String, &[f64])| Curve {
            label,
            values: values.iter().map(|value| value / unit.size).collect(),
            is_limit: false,
        };
        let limits = self.limits.into_iter().map(|(label, value)| Curve {
            label,
            values: vec![value / unit.size; self.time.len()],
            is_limit: true,
        });
        let history = History {
            title: String::new(),
            quantity: self.quantity.to_owned(),
            unit: unit.name.to_owned(),
            runs: vec![Run {
                time: self.time.to_vec(),
                curves: self.curves.into_iter().map(curve).chain(limits).collect(),
                contacts: self.contacts,
            }],
        };
        let name = format!("{} over time", self.quantity);
        // Legends take nothing from the plot.
        let names = history.runs[0].curves.iter().filter(|curve| !curve.label.is_empty()).count() as u32;
        let draw = |sheet: Sheet, beside: u32| {
            let height = sheet.height + LEGEND_LINE * names.div_ceil(beside);
            draw_inline(&history, Sheet { height, ..sheet }, &name)
        };
        let [wide, narrow] = [(WIDE, BESIDE[0]), (NARROW, BESIDE[1])].map(|(sheet, beside)| draw(sheet, beside));
        Ok(Figure { wide: wide?, narrow: narrow?, caption: self.caption })
    }
}
