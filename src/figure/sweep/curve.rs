//! Draws a sweep over one key: a quantity, and below it the times of contact.

use super::{BOTTOM, Curve, LEFT, MARGIN, Member, TITLE, TOP, ascending};
use crate::figure::canvas::{Anchor, Canvas, Drawing, Drawn, HEIGHT, WIDTH};
use crate::figure::frame::{Frame, LETTERS, SMALL, titled};
use crate::figure::scale::{Scale, cells};
use crate::figure::shade::{draw_bar, shade};
use crate::figure::stroke::stroke;
use crate::record::episodes::Episode;
use plotters::backend::DrawingBackend;
use plotters::style::RGBColor;

const MIDDLE: f64 = 500.0;
/// Distance between the panels, pixels.
const GAP: f64 = 34.0;
/// Right edge of the panels, pixels.
const RIGHT: f64 = WIDTH - 226.0;
/// Largest number of members for which each member gets a dot.
const DOTS: usize = 120;

impl Drawing for Curve {
    fn draw<DB: DrawingBackend>(&self, canvas: &Canvas<DB>) -> Drawn {
        let values = ascending(self.members.iter().map(|member| member.value));
        let cells = cells(&values, self.key.is_log);
        let numbers = || self.members.iter().map(|member| member.result);
        let (least, largest) = (numbers().fold(0.0, f64::min), numbers().fold(0.0, f64::max));
        let contacts = || self.members.iter().flat_map(|member| &member.contacts);
        let end = 1e3 * contacts().map(|contact| contact.end).fold(0.0, f64::max);
        let forces = Scale::of_colours(contacts().map(|contact| contact.peak_force), true);
        let times = Scale::spanning(0.0, end);
        let results = match &self.quantity.names[..] {
            [] => Scale::spanning(1.02 * least, 1.02 * largest),
            names => Scale::named(names),
        };
        let left = LEFT + canvas.widest(&results, LETTERS).max(canvas.widest(&times, LETTERS));
        let unit = results.unit(&self.quantity.unit);
        let x = || Scale::new(cells[0].0, cells[cells.len() - 1].1, self.key.is_log);
        let frame = |top: f64, bottom: f64, y: Scale| Frame { left, right: RIGHT, top, bottom, x: x(), y };
        let upper = frame(TOP, MIDDLE, results);
        let lower = frame(MIDDLE + GAP, BOTTOM, times);

        canvas.text(&self.title, (0.5 * (left + RIGHT), TITLE), LETTERS, Anchor::Centre)?;
        upper.draw_grid(canvas)?;
        lower.draw_grid(canvas)?;
        self.draw_results(canvas, &upper)?;
        for member in &self.members {
            if let Some(cell) = values.iter().position(|value| *value == member.value).map(|n| cells[n]) {
                member.draw_contacts(canvas, &lower, cell, &forces)?;
            }
        }
        upper.draw_axes(canvas, false)?;
        lower.draw_axes(canvas, true)?;
        let title = titled("peak force of the contact", &forces.unit("N"));
        draw_bar(canvas, (RIGHT + 34.0, MIDDLE + GAP, BOTTOM), &forces, colour, &title)?;
        let upwards = |title: String, frame: &Frame| {
            let at = (MARGIN, 0.5 * (frame.top + frame.bottom));
            canvas.text(&title, at, SMALL, Anchor::Upwards)
        };
        upwards(titled(&self.quantity.label, &unit), &upper)?;
        upwards(titled("in contact, time", &lower.y.unit("ms")), &lower)?;
        let title = titled(&self.key.label, &lower.x.unit(&self.key.unit));
        canvas.text(&title, (0.5 * (left + RIGHT), HEIGHT - 36.0), LETTERS, Anchor::Centre)
    }
}

impl Curve {
    fn draw_results<DB: DrawingBackend>(&self, canvas: &Canvas<DB>, frame: &Frame) -> Drawn {
        let mut points: Vec<(f64, f64)> = self.members.iter().map(|member| (member.value, member.result)).collect();
        points.retain(|point| point.1.is_finite());
        points.sort_by(|a, b| a.0.total_cmp(&b.0));
        let at = |point: &(f64, f64)| (frame.at_x(point.0), frame.at_y(point.1));
        let pixels: Vec<_> = points.iter().map(at).collect();
        let look = stroke(0, 1);
        canvas.line(&pixels.iter().map(|(x, y)| canvas.point(*x, *y)).collect::<Vec<_>>(), &look)?;
        if pixels.len() <= DOTS {
            pixels.iter().try_for_each(|pixel| canvas.dot(*pixel, 5.0, look.colour))?;
        }
        Ok(())
    }
}

impl Member {
    /// Draws a bar from the start to the end of each contact, with the width of the member's cell.
    fn draw_contacts<DB: DrawingBackend>(
        &self,
        canvas: &Canvas<DB>,
        frame: &Frame,
        cell: (f64, f64),
        forces: &Scale,
    ) -> Drawn {
        let [left, at, right] = [cell.0, self.value, cell.1].map(|x| frame.at_x(x));
        // Wide bars are separated by gaps and keep the value of their member inside; thin bars would disappear with
        // gaps.
        let part = if right - left > 6.0 { 0.76 } else { 1.0 };
        let (left, right) = (at - part * (at - left), at + part * (right - at));
        for Episode { start, end, peak_force, .. } in &self.contacts {
            let (bottom, top) = (frame.at_y(1e3 * start), frame.at_y(1e3 * end));
            let corners = ((left, top.min(bottom - 1.5)), (right.max(left + 1.0), bottom));
            canvas.rectangle(corners.0, corners.1, colour(forces.place(*peak_force)))?;
        }
        Ok(())
    }
}

/// Colour of a contact for the relative position of its force on the scale. The weakest force is still visible on
/// white.
fn colour(place: f64) -> RGBColor {
    shade(0.15 + 0.85 * place.clamp(0.0, 1.0))
}
