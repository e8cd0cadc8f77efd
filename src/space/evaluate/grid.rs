//! Grid on which fields are written: the mesh of a solid, or hexahedra between lines of a box.

use crate::element::{Element, Shape};
use crate::mesh::{Whole, add_image};
use crate::scene::Vec3;

/// Points and cells of the whole body.
#[derive(Debug, Clone, PartialEq)]
pub struct Grid {
    /// Shape of the cells.
    pub shape: Shape,
    /// Order of the elements.
    pub order: usize,
    /// Coordinates of the points, m.
    pub points: Vec<Vec3>,
    /// Point numbers of the cells, cell by cell, in VTK's order.
    pub cells: Vec<usize>,
    /// For each point, the number of its original in the modelled part, and the signs that map the displacement of the
    /// original to the point.
    pub(super) images: Vec<(usize, Vec3)>,
}

impl Grid {
    /// Grid of a mesh.
    pub(super) fn of_mesh(mesh: &Whole) -> Self {
        Self::new(mesh.shape, mesh.order, mesh.nodes.clone(), mesh.cells.clone())
    }

    /// Hexahedra between lines normal to all axes, m. Point numbers vary slowest along the first axis.
    pub(super) fn of_lines(lines: &[Vec<f64>; 3]) -> Self {
        let [nx, ny, nz] = lines.each_ref().map(Vec::len);
        let at = |i: usize, j: usize, k: usize| (i * ny + j) * nz + k;
        let mut points = Vec::with_capacity(nx * ny * nz);
        for x in &lines[0] {
            points.extend(lines[1].iter().flat_map(|y| lines[2].iter().map(move |z| [*x, *y, *z])));
        }
        let corners = Shape::Hexahedron.reference_vertices();
        let mut cells = Vec::new();
        for (i, j, k) in (1..nx).flat_map(|i| (1..ny).flat_map(move |j| (1..nz).map(move |k| (i, j, k)))) {
            cells.extend(corners.iter().map(|corner| {
                let [a, b, c] = corner.map(|x| usize::from(x < 0.0));
                at(i - a, j - b, k - c)
            }));
        }
        Self::new(Shape::Hexahedron, 1, points, cells)
    }

    fn new(shape: Shape, order: usize, points: Vec<Vec3>, cells: Vec<usize>) -> Self {
        let images = (0..points.len()).map(|point| (point, [1.0; 3])).collect();
        Self { shape, order, points, cells, images }
    }

    /// Number of points of each cell.
    pub fn points_each(&self) -> usize {
        Element::new(self.shape, self.order).nodes()
    }

    /// The grid and its mirror image across the plane where a coordinate is zero.
    pub(super) fn with_image(mut self, axis: usize) -> Self {
        for point in add_image((self.shape, self.order), &mut self.points, &mut self.cells, axis) {
            let (of, mut signs) = self.images[point];
            signs[axis] = -signs[axis];
            self.images.push((of, signs));
        }
        self
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::element::{Quadrature, Table};

    /// The cells of a quarter and its mirror images fill the box. No cell is inverted, and no point is duplicated.
    #[test]
    fn a_quarter_and_its_images_are_the_whole() {
        let lines = [vec![0.0, 0.2, 0.5], vec![0.0, 0.3], vec![-0.1, 0.0, 0.1]];
        let grid = Grid::of_lines(&lines).with_image(0).with_image(1);
        assert_eq!((grid.points.len(), grid.cells.len()), (5 * 3 * 3, 8 * 4 * 2 * 2));
        let table = Table::new(&Element::new(Shape::Hexahedron, 1), &Quadrature::exact(Shape::Hexahedron, 1));
        let mut volume = 0.0;
        for cell in grid.cells.chunks_exact(8) {
            let x: Vec<Vec3> = cell.iter().map(|&point| grid.points[point]).collect();
            let determinant = table.jacobian(0, &x).determinant();
            assert!(determinant > 0.0, "{x:?}");
            volume += 8.0 * determinant;
        }
        assert!((volume - 1.0 * 0.6 * 0.2).abs() < 1e-15, "{volume}");
        let mut sorted = grid.points.clone();
        sorted.sort_by(|a, b| a.partial_cmp(b).expect("numbers"));
        sorted.dedup();
        assert_eq!(sorted.len(), grid.points.len());
        for (x, (of, signs)) in grid.points.iter().zip(&grid.images) {
            let from = grid.points[*of];
            assert_eq!(*x, [0, 1, 2].map(|i| signs[i] * from[i]));
        }
    }
}
