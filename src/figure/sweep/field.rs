//! Draws a sweep over two keys: a quantity as a heat map.

use super::{BOTTOM, Field, LEFT, MARGIN, TITLE, TOP, ascending};
use crate::figure::canvas::{Anchor, Canvas, Drawing, Drawn, HEIGHT, WIDTH};
use crate::figure::frame::{Frame, LETTERS, SMALL, titled};
use crate::figure::scale::{Scale, cells};
use crate::figure::shade::{MISSING, draw_bar, shade};
use plotters::backend::DrawingBackend;

const RIGHT: f64 = WIDTH - 246.0;

impl Drawing for Field {
    fn draw<DB: DrawingBackend>(&self, canvas: &Canvas<DB>) -> Drawn {
        let axis = |n: usize| {
            let values = ascending(self.members.iter().map(|(values, _)| values[n]));
            let cells = cells(&values, self.keys[n].is_log);
            let scale = Scale::new(cells[0].0, cells[cells.len() - 1].1, self.keys[n].is_log);
            (values, cells, scale)
        };
        let ((across, columns, x), (up, rows, y)) = (axis(0), axis(1));
        let frame = Frame { left: LEFT + canvas.widest(&y, LETTERS), right: RIGHT, top: TOP, bottom: BOTTOM, x, y };
        let numbers = || self.members.iter().map(|member| member.1).filter(|peak| peak.is_finite());
        let colours = match &self.quantity.names[..] {
            [] => Scale::of_colours(numbers(), false),
            names => Scale::named(names),
        };

        canvas.text(&self.title, (0.5 * (frame.left + RIGHT), TITLE), LETTERS, Anchor::Centre)?;
        for ([value_x, value_y], peak) in &self.members {
            let place = |values: &[f64], value: &f64| values.partition_point(|other| other < value);
            let (column, row) = (columns[place(&across, value_x)], rows[place(&up, value_y)]);
            let colour = if peak.is_finite() { shade(colours.place(*peak)) } else { MISSING };
            let corners = ((frame.at_x(column.0), frame.at_y(row.1)), (frame.at_x(column.1), frame.at_y(row.0)));
            canvas.rectangle(corners.0, corners.1, colour)?;
        }
        frame.draw_axes(canvas, true)?;
        let title = titled(&self.quantity.label, &colours.unit(&self.quantity.unit));
        draw_bar(canvas, (RIGHT + 40.0, TOP, BOTTOM), &colours, shade, &title)?;
        if numbers().count() < self.members.len() {
            let y = HEIGHT - 36.0;
            canvas.rectangle((RIGHT + 40.0, y - 12.0), (RIGHT + 68.0, y + 12.0), MISSING)?;
            canvas.text("no result", (RIGHT + 80.0, y), SMALL, Anchor::Left)?;
        }
        let [across, up] =
            [0, 1].map(|n| titled(&self.keys[n].label, &[&frame.x, &frame.y][n].unit(&self.keys[n].unit)));
        canvas.text(&across, (0.5 * (frame.left + RIGHT), HEIGHT - 36.0), LETTERS, Anchor::Centre)?;
        canvas.text(&up, (MARGIN, 0.5 * (TOP + BOTTOM)), LETTERS, Anchor::Upwards)
    }
}
