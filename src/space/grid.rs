//! Spaces on a grid between the faces of a box: common code of splines in three dimensions and of plates.

use std::collections::BTreeMap;

use nalgebra_sparse::CsrMatrix;
use petsc_wrap::Int;

use super::clip::{AreaPoint, Clipped, clip};
use super::evaluate::Form;
use super::{Add, Space, Visit};
use crate::description::{Extent, Part, Place};
use crate::element::gauss_legendre;
use crate::error::Result;
use crate::form::{SurfaceElement, SurfacePoint};
use crate::scene::{Vec3, faces};

/// Polynomial degree of a displacement whose square is integrated exactly by the quadrature for rough integrands.
/// Higher terms of the splines are small within a cell, since cells resolve the waves.
const ROUGH_DEGREE: usize = 2;

/// A displacement that is smooth within the cells of a grid.
pub trait GridField {
    /// Ends of the cells of the modelled part along each axis, m.
    fn lines(&self) -> [&[f64]; 3];

    /// Polynomial degree of the displacement within a cell along each axis.
    fn degrees(&self) -> [usize; 3];

    /// Number of unknowns.
    fn unknowns(&self) -> usize;

    /// Displacement at a point (m) as linear forms: non-zero entries by ascending unknown.
    fn displacement(&self, x: Vec3) -> [Form; 3];

    /// Force vector of the body forces of the parts, N.
    fn body_force(&self, parts: &[Part]) -> Vec<f64>;
}

/// Number of cells between lines (m), some of which may be repeated.
pub fn count_cells(lines: &[f64]) -> usize {
    lines.windows(2).filter(|pair| pair[0] < pair[1]).count()
}

/// A field as a space. Every rank holds the whole field.
pub struct GridSpace<'a, F> {
    /// Discretised displacement.
    pub field: &'a F,
    /// Axes normal to planes of symmetry. The modelled part has no face at its lower end along these axes.
    pub mirrors: &'a [usize],
}

/// A face of the modelled part of a box.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Face {
    /// Axis normal to the face.
    pub axis: usize,
    /// Whether the face is the one at the larger coordinate.
    pub is_upper: bool,
}

impl Face {
    /// Faces of the modelled part that belong to a named surface of a box.
    pub fn of_surface<'a>(surface: &str, mirrors: &'a [usize]) -> impl Iterator<Item = Self> + 'a {
        let all = faces(surface).iter().map(|&(axis, is_upper)| Self { axis, is_upper });
        all.filter(|face| face.is_upper || !mirrors.contains(&face.axis))
    }
}

impl<F: GridField> GridSpace<'_, F> {
    /// Visits the cells on a face, cut by an extent of space. The quadrature suits products of two polynomials of these
    /// degrees along the axes.
    fn visit_face(&self, face: Face, extent: &Extent, degrees: [usize; 3], visit: &mut Visit) -> Result<()> {
        let lines = self.field.lines();
        let across = lines[face.axis];
        let height = if face.is_upper { across[across.len() - 1] } else { across[0] };
        let [first, second] = faces::along(face.axis);
        let at = |along: [f64; 2]| {
            let mut x = [height; 3];
            (x[first], x[second]) = (along[0], along[1]);
            x
        };
        let cells = |axis: usize| lines[axis].windows(2).filter(|ends| ends[0] < ends[1]);
        let rules = [first, second].map(|axis| gauss_legendre(degrees[axis] + 1));
        for (one, other) in cells(first).flat_map(|one| cells(second).map(move |other| (one, other))) {
            let corners = [[one[0], other[0]], [one[1], other[0]], [one[1], other[1]], [one[0], other[1]]].map(at);
            let points: Vec<AreaPoint> = match clip(&corners, extent, 2 * degrees[first].max(degrees[second])) {
                Clipped::Nothing => continue,
                Clipped::Points(points) => points,
                Clipped::Whole => {
                    let place = |ends: &[f64], t: f64| 0.5 * (ends[0] + ends[1]) + 0.5 * (ends[1] - ends[0]) * t;
                    let area = 0.25 * (one[1] - one[0]) * (other[1] - other[0]);
                    let of_first = |(s, of_s): &(f64, f64)| {
                        let (x, weight) = (place(one, *s), area * of_s);
                        let of_second = |(t, of_t): &(f64, f64)| AreaPoint {
                            position: at([x, place(other, *t)]),
                            area: weight * of_t,
                        };
                        rules[1].iter().map(of_second).collect::<Vec<_>>()
                    };
                    rules[0].iter().flat_map(of_first).collect()
                }
            };
            let (unknowns, element) = self.element(&points);
            visit(&unknowns, &element)?;
        }
        Ok(())
    }

    /// Element of the surface made of quadrature points, and the global numbers of its unknowns.
    fn element(&self, points: &[AreaPoint]) -> (Vec<Int>, SurfaceElement) {
        let moved: Vec<[Form; 3]> = points.iter().map(|point| self.field.displacement(point.position)).collect();
        let is_of = |form: &Form, unknowns: &[usize]| form.iter().map(|entry| &entry.0).eq(unknowns);
        let distinct = |mut unknowns: Vec<usize>| {
            unknowns.sort_unstable();
            unknowns.dedup();
            unknowns
        };
        // All points within a cell have the same unknowns, except where a function happens to be zero.
        let of_component = [0, 1, 2].map(|component| {
            let forms = || moved.iter().map(|forms| &forms[component]);
            let unknowns: Vec<usize> = forms().take(1).flatten().map(|entry| entry.0).collect();
            if forms().all(|form| is_of(form, &unknowns)) {
                return unknowns;
            }
            distinct(forms().flatten().map(|entry| entry.0).collect())
        });
        let all = distinct(of_component.concat());
        let shape = |forms: &[Form; 3]| {
            std::array::from_fn(|component| {
                let (form, unknowns) = (&forms[component], &of_component[component]);
                if is_of(form, unknowns) {
                    return form.iter().map(|entry| entry.1).collect();
                }
                let mut values = vec![0.0; unknowns.len()];
                for (unknown, value) in form {
                    values[unknowns.partition_point(|other| other < unknown)] = *value;
                }
                values
            })
        };
        let points = points.iter().zip(&moved);
        let points = points.map(|(point, forms)| SurfacePoint {
            position: point.position,
            area: point.area,
            shape: shape(forms),
        });
        let local = |unknown: &usize| all.partition_point(|other| other < unknown);
        let element = SurfaceElement {
            unknowns: all.len(),
            points: points.collect(),
            of_component: of_component.each_ref().map(|unknowns| unknowns.iter().map(local).collect()),
        };
        (all.iter().map(|unknown| *unknown as Int).collect(), element)
    }
}

impl<F: GridField> Space for GridSpace<'_, F> {
    type Matrix = CsrMatrix<f64>;
    type Vector = Vec<f64>;

    fn visit(&self, place: &Place, visit: &mut Visit) -> Result<()> {
        let degrees = self.field.degrees();
        let mut faces = Face::of_surface(&place.surface, self.mirrors);
        faces.try_for_each(|face| self.visit_face(face, &place.extent, degrees, visit))
    }

    fn visit_roughly(&self, place: &Place, visit: &mut Visit) -> Result<()> {
        let degrees = self.field.degrees().map(|degree| degree.min(ROUGH_DEGREE));
        let mut faces = Face::of_surface(&place.surface, self.mirrors);
        faces.try_for_each(|face| self.visit_face(face, &place.extent, degrees, visit))
    }

    fn body_force(&self, parts: &[Part], add: &mut Add) -> Result<()> {
        let all: Vec<Int> = (0..self.field.unknowns() as Int).collect();
        add(&all, &self.field.body_force(parts))
    }

    fn vector(&self, fill: impl FnOnce(&mut Add) -> Result<()>) -> Result<Vec<f64>> {
        let mut vector = vec![0.0; self.field.unknowns()];
        fill(&mut |unknowns, values| {
            unknowns.iter().zip(values).for_each(|(unknown, value)| vector[*unknown as usize] += value);
            Ok(())
        })?;
        Ok(vector)
    }

    fn matrix(&self, _: &[&Place], fill: impl FnOnce(&mut Add) -> Result<()>) -> Result<CsrMatrix<f64>> {
        // Entries are summed in the order in which the elements come, so that the matrix is exactly symmetric.
        let mut rows = vec![BTreeMap::new(); self.field.unknowns()];
        fill(&mut |unknowns, values| {
            for (row, values) in unknowns.iter().zip(values.chunks_exact(unknowns.len())) {
                for (column, value) in unknowns.iter().zip(values).filter(|(_, value)| **value != 0.0) {
                    *rows[*row as usize].entry(*column as usize).or_insert(0.0) += value;
                }
            }
            Ok(())
        })?;
        let (mut offsets, mut columns, mut values) = (vec![0], Vec::new(), Vec::new());
        for row in &rows {
            columns.extend(row.keys());
            values.extend(row.values());
            offsets.push(columns.len());
        }
        let matrix = CsrMatrix::try_from_csr_data(rows.len(), rows.len(), offsets, columns, values);
        Ok(matrix.expect("rows in order, columns ascending"))
    }

    fn sum(&self, here: f64) -> f64 {
        here
    }
}
