//! Diagonal (lumped) matrices in place of consistent ones, so that an explicit time step needs no solution of a system.

/// Computes the diagonal that replaces a consistent mass or damping matrix of one cell or facet.
///
/// `matrix` is the row-major block of (3n)² values of the forms, which does not couple different components; `out`
/// takes 3n values. The sum over each component is preserved, and so is the mass of the cell. No value is negative.
///
/// The values are the row sums, which keep the full order of convergence of the frequencies if they are positive. On
/// parallelepipeds of order 2 they are Simpson's rule. The row sums at the vertices are negative on tetrahedra of order
/// 2 and zero on triangles of order 2. Therefore another lumping is used if any row sum is below half of its value: the
/// diagonal, scaled to the mass of the cell (E. Hinton, T. Rock & O. C. Zienkiewicz, A note on mass lumping and related
/// processes in the finite element method, Earthq. Eng. Struct. Dyn. 4, 1976). On tetrahedra of order 2 this reduces
/// the order of convergence of the frequencies from four to two.
pub fn lump(matrix: &[f64], out: &mut [f64]) {
    let size = out.len();
    for (sum, row) in out.iter_mut().zip(matrix.chunks_exact(size)) {
        *sum = row.iter().sum();
    }
    for component in 0..3 {
        let unknowns = || (component..size).step_by(3);
        let diagonal = |i: usize| matrix[i * size + i];
        let trace: f64 = unknowns().map(diagonal).sum();
        // A damper may leave a component undamped; its trace is then zero.
        let scale = if trace > 0. { unknowns().map(|i| out[i]).sum::<f64>() / trace } else { 0. };
        if unknowns().any(|i| out[i] < 0.5 * scale * diagonal(i)) {
            unknowns().for_each(|i| out[i] = scale * diagonal(i));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::description::Extent;
    use crate::element::{Element, Shape};
    use crate::form::{Material, SolidForms};
    use crate::space::finite_element::FacetRule;

    const DENSITY: f64 = 3.;

    /// Lumped masses of a cell, and the row sums of the consistent matrix.
    fn masses(shape: Shape, order: usize, x: &[[f64; 3]]) -> (Vec<f64>, Vec<f64>) {
        let mut forms = SolidForms::new(shape, order, Material { young: 1., poisson: 0., density: DENSITY });
        let size = 3 * forms.nodes();
        let (mut block, mut lumped) = (vec![0.; size * size], vec![0.; size]);
        forms.mass(x, &mut block).unwrap();
        lump(&block, &mut lumped);
        (lumped, block.chunks_exact(size).map(|row| row.iter().sum()).collect())
    }

    /// Reference vertices with a shift each, so that only the map of the tetrahedron is affine.
    fn distorted(shape: Shape) -> Vec<[f64; 3]> {
        let shift = |v: usize, c: usize| 0.15 * ((7 * v + 3 * c) as f64).sin();
        let vertices = shape.reference_vertices().iter().enumerate();
        vertices.map(|(v, x)| [0, 1, 2].map(|c| x[c] + shift(v, c))).collect()
    }

    #[test]
    fn masses_are_positive_and_sum_to_that_of_the_cell() {
        for shape in [Shape::Tetrahedron, Shape::Hexahedron] {
            for order in [1, 2] {
                let (lumped, rows) = masses(shape, order, &distorted(shape));
                assert!(lumped.iter().all(|mass| *mass > 0.), "{shape:?} {order}: {lumped:?}");
                for component in 0..3 {
                    let sum = |of: &[f64]| of.iter().skip(component).step_by(3).sum::<f64>();
                    // Rounding of at most 27² terms.
                    assert!((sum(&lumped) / sum(&rows) - 1.).abs() < 1e-13, "{shape:?} {order}");
                }
            }
        }
    }

    /// Fractions of the cell's mass: 1/36 at a vertex and 4/27 at an edge, from the integrals V/70 and 8V/105 of φ².
    /// The row sums are −1/20 and 1/5.
    #[test]
    fn quadratic_tetrahedron_has_masses_of_its_known_fractions() {
        let (lumped, rows) = masses(Shape::Tetrahedron, 2, Shape::Tetrahedron.reference_vertices());
        let mass = DENSITY / 6.;
        for i in 0..30 {
            let vertex = i < 12;
            let [expected, row] = if vertex { [1. / 36., -1. / 20.] } else { [4. / 27., 1. / 5.] };
            assert!((lumped[i] / mass - expected).abs() < 1e-14, "{i}: {}", lumped[i] / mass);
            assert!((rows[i] / mass - row).abs() < 1e-14, "{i}: {}", rows[i] / mass);
        }
    }

    /// On a parallelepiped the masses are Simpson's rule, 1/6, 4/6, 1/6 along each edge. The scaled diagonal would be
    /// the same.
    #[test]
    fn quadratic_parallelepiped_has_masses_of_simpsons_rule() {
        let x: Vec<[f64; 3]> = Shape::Hexahedron
            .reference_vertices()
            .iter()
            .map(|[x, y, z]| [x + 0.3 * y, *y, 2. * z - 0.5 * x])
            .collect();
        let (lumped, _) = masses(Shape::Hexahedron, 2, &x);
        let element = Element::new(Shape::Hexahedron, 2);
        for (node, masses) in element.reference_nodes().iter().zip(lumped.chunks_exact(3)) {
            let weight: f64 = node.iter().map(|x| if *x == 0. { 4. / 6. } else { 1. / 6. }).product();
            for mass in masses {
                assert!((mass / (16. * DENSITY) - weight).abs() < 1e-14);
            }
        }
    }

    /// If a vertex has almost no volume, its row sum alone would require a very small explicit time step. The scaled
    /// diagonal is used.
    #[test]
    fn a_vertex_almost_flattened_keeps_some_mass() {
        let mut x = Shape::Hexahedron.reference_vertices().to_vec();
        // The vertex is nearly in the plane of its neighbours, where its coordinates would be 1/3.
        x[6] = [0.34; 3];
        let (lumped, rows) = masses(Shape::Hexahedron, 2, &x);
        let least = |of: &[f64]| of.iter().copied().fold(f64::INFINITY, f64::min);
        assert!(least(&lumped) > 10. * least(&rows), "{} {}", least(&lumped), least(&rows));
    }

    /// The lumped damper keeps c times the area in each component, and zero in an undamped component.
    #[test]
    fn dampers_keep_their_sum() {
        for shape in [Shape::Triangle, Shape::Quadrilateral] {
            for order in [1, 2] {
                let x = distorted(shape);
                let facet = FacetRule::new(shape, order).element(&x, &Extent::All);
                let size = facet.unknowns;
                let (mut block, mut lumped) = (vec![0.; size * size], vec![f64::NAN; size]);
                let c = [2., 0., 5.];
                facet.spring(c, &mut block);
                lump(&block, &mut lumped);
                for (component, c) in c.into_iter().enumerate() {
                    let values = || lumped.iter().skip(component).step_by(3);
                    assert!(values().all(|value| if c == 0. { *value == 0. } else { *value > 0. }));
                    assert!((values().sum::<f64>() - c * facet.area()).abs() < 1e-13 * facet.area());
                }
            }
        }
    }
}
