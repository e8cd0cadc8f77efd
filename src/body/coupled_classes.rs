//! Free motions of a body whose coupled modes split into classes that do not couple with each other, such as symmetry
//! classes. Each class is solved separately.

use nalgebra::{DMatrix, DVector};

use super::BlockMatrix;
use super::coupled_modes::{CoupledModes, Forces, RelaxingForms, of_class};
use super::eigen::coupled;
use super::modal_relaxation::ModalRelaxation;
use crate::error::Result;

/// Same as [`of_class`] for all modes. The classes follow from the coupling by dampers and relaxation. Four classes of
/// a quarter of the modes take a sixteenth of the time.
///
/// # Errors
/// Same as [`of_class`].
pub fn coupled_modes(
    squares: &DVector<f64>,
    damping: Option<&DMatrix<f64>>,
    relaxations: &[ModalRelaxation],
    forces: Forces,
) -> Result<CoupledModes> {
    let none = DMatrix::zeros(squares.len(), squares.len());
    let coupling = damping.into_iter().chain(relaxations.iter().map(|part| &part.distortion));
    let classes = coupled(&coupling.fold(none, |sum, matrix| sum + matrix.abs()));
    if classes.len() == 1 {
        return of_class(squares, damping, relaxations, forces);
    }
    let part = |class: &Vec<usize>| {
        let rows = |v: &DVector<f64>| v.select_rows(class);
        let damping = damping.map(|damping| damping.select_rows(class).select_columns(class));
        let relaxations: Vec<_> = relaxations.iter().filter_map(|part| part.of_class(class)).collect();
        let [input, load, output] = [forces.input, forces.load, forces.output].map(rows);
        let forces = Forces { input: &input, load: &load, output: &output };
        of_class(&rows(squares), damping.as_ref(), &relaxations, forces)
    };
    let parts = classes.iter().map(part).collect::<Result<Vec<_>>>()?;
    Ok(joined(&classes, parts, squares.len()))
}

/// Joins the coordinates of all classes, one class after the other.
fn joined(classes: &[Vec<usize>], parts: Vec<CoupledModes>, count: usize) -> CoupledModes {
    let coordinates = parts.iter().map(|part| part.modes.len()).sum();
    let springs = parts.iter().map(|part| part.forms.stretches.rows()).sum();
    let mut modes = Vec::with_capacity(coordinates);
    let [mut places, mut speeds, mut inputs, mut stretches] = [const { Vec::new() }; 4];
    let mut elastic = Vec::new();
    let mut spring = 0;
    for (class, part) in classes.iter().zip(parts) {
        let own: Vec<usize> = (modes.len()..modes.len() + part.modes.len()).collect();
        let own_springs: Vec<usize> = (spring..spring + part.forms.stretches.rows()).collect();
        spring += own_springs.len();
        modes.extend(part.modes);
        let [of_places, of_speeds] = part.shapes;
        places.extend(of_places.into_blocks_of(class, &own));
        speeds.extend(of_speeds.into_blocks_of(class, &own));
        inputs.extend(part.inputs.into_blocks_of(&own, class));
        stretches.extend(part.forms.stretches.into_blocks_of(&own_springs, &own));
        elastic.extend(part.forms.elastic.into_iter().map(|block| block.of_class(class)));
    }
    let shapes = [places, speeds].map(|blocks| BlockMatrix::new([count, coordinates], blocks));
    let inputs = BlockMatrix::new([coordinates, count], inputs);
    let stretches = BlockMatrix::new([springs, coordinates], stretches);
    CoupledModes { modes, shapes, inputs, forms: RelaxingForms { elastic, stretches } }
}

#[cfg(test)]
mod tests {
    use super::super::relaxing_directions::Directions;
    use nalgebra::Complex;

    use super::*;
    use crate::body::Mode;
    use crate::material::{Maxwell, Term};

    /// Two interlaced classes and a single mode move like the same modes with a coupling by a damper of the size of
    /// rounding.
    #[test]
    fn classes_move_as_all_modes_together() {
        let squares = DVector::from_row_slice(&[4.0, 9.0, 13.0, 16.0, 30.0]);
        // The last mode is a class without other modes.
        let class = |i: usize| if i == 4 { 2 } else { i % 2 };
        let same = |i: usize, j: usize| if class(i) == class(j) { 1.0 } else { 0.0 };
        let factor =
            DMatrix::from_fn(5, 3, |i, j| if class(i) == j % 2 { ((2 * i + 3 * j + 1) as f64).sin() } else { 0.0 });
        let terms = [(1.0, 0.05), (0.6, 0.7)].map(|(modulus, time)| Term { modulus, time });
        let part = ModalRelaxation {
            distortion: &factor * factor.transpose(),
            directions: Some(Directions { factor, counts: vec![3, 3] }),
            chain: Maxwell { equilibrium: 0.0, terms: terms.to_vec() },
            rate: 2.0,
        };
        let [force, load] =
            [[1.0, -0.5, 0.7, 0.2, 0.4], [0.3, 0.1, -0.2, 0.4, 0.0]].map(|v| DVector::from_row_slice(&v));
        let damping = DMatrix::from_fn(5, 5, |i, j| if i == j { 0.1 } else { 1e-3 * same(i, j) });
        let everywhere = damping.map(|entry: f64| if entry == 0.0 { 1e-17 } else { entry });
        let of = |damping: Option<&DMatrix<f64>>| {
            coupled_modes(&squares, damping, std::slice::from_ref(&part), Forces::reciprocal(&force, &load)).unwrap()
        };
        // The response at a rate is a sum over the coordinates, in any order.
        let answer = |of: &CoupledModes, rate: f64| {
            let one = |mode: &Mode| (mode.output * (mode.input + mode.load) / (Complex::new(rate, 0.0) - mode.rate)).re;
            of.modes.iter().map(one).sum::<f64>()
        };
        for (one, other) in
            [(of(Some(&damping)), of(Some(&everywhere))), (of(None), of(Some(&(damping.clone() * 1e-17))))]
        {
            // Three springs for each of two terms: two springs in one class and one in the other.
            assert_eq!(one.forms.stretches.rows(), 6);
            assert_eq!(one.modes.len(), other.modes.len());
            for rate in [0.1, 1.0, 10.0] {
                let [x, y] = [&one, &other].map(|of| answer(of, rate));
                assert!((x - y).abs() < 1e-13, "{rate}: {x} {y}");
            }
            let [x, y] = [&one, &other].map(|CoupledModes { modes, shapes, forms, .. }| {
                let z: Vec<_> =
                    modes.iter().map(|mode| (mode.input + mode.load) / (Complex::new(1.0, 0.0) - mode.rate)).collect();
                let x = shapes[0].real_parts(&z);
                let x = DMatrix::from_column_slice(x.len(), 1, x.as_slice());
                forms.energies(&x, &[&z])[0] + shapes[1].real_parts(&z).norm_squared()
            });
            assert!((x - y).abs() < 1e-13, "{x} {y}");
        }
    }
}
