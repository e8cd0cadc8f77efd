//! Free motions of a body whose coupled modes split into classes that do not couple with each other, such as symmetry
//! classes. Each class is solved separately.

use nalgebra::{Complex, DMatrix, DVector};

use super::Mode;
use super::block_matrix::{Block, BlockMatrix};
use super::coupled_modes::{CoupledModes, ElasticBlock, Forces, FreeMotions, RelaxingForms, free_motions};
use super::eigen::coupled;
use super::modal_relaxation::ModalRelaxation;
use crate::error::Result;

/// Computes the coordinates of all modes with the given ω², dampers and viscoelastic parts. The classes follow from the
/// coupling by dampers and relaxation. Four classes of a quarter of the modes take a sixteenth of the time.
///
/// # Errors
/// Same as [`free_motions`].
pub fn coupled_modes(
    squares: &DVector<f64>,
    damping: Option<&DMatrix<f64>>,
    relaxations: &[ModalRelaxation],
    forces: Forces,
) -> Result<CoupledModes> {
    let none = DMatrix::zeros(squares.len(), squares.len());
    let coupling = damping.into_iter().chain(relaxations.iter().map(|part| &part.distortion));
    let classes = coupled(&coupling.fold(none, |sum, matrix| sum + matrix.abs()));
    let motions = |class: Vec<usize>| {
        let damping = damping.map(|damping| damping.select_rows(&class).select_columns(&class));
        let relaxations: Vec<_> = relaxations.iter().filter_map(|part| part.of_class(&class)).collect();
        let motions = free_motions(&squares.select_rows(&class), damping.as_ref(), &relaxations)?;
        Ok((class, motions))
    };
    Ok(coordinates(classes.into_iter().map(motions).collect::<Result<_>>()?, forces))
}

/// Returns the coordinates of all classes under forces, one class after the other. Each class has its modes and its
/// motions.
pub fn coordinates(classes: Vec<(Vec<usize>, FreeMotions)>, forces: Forces) -> CoupledModes {
    let (count, mut springs, mut modes) = (forces.input.len(), 0, Vec::new());
    let [mut places, mut speeds, mut inputs, mut stretches] = [const { Vec::new() }; 4];
    let mut elastic = Vec::new();
    for (class, motions) in classes {
        let own: Vec<usize> = (modes.len()..modes.len() + motions.rates.len()).collect();
        let own_springs: Vec<usize> = (springs..springs + motions.stretches.nrows()).collect();
        springs += own_springs.len();
        let of_class = |v: &DVector<f64>| v.select_rows(&class).map(|entry| Complex::new(entry, 0.0));
        let [input, load] = [forces.input, forces.load].map(|v| &motions.inputs * of_class(v));
        let output = motions.shapes[0].tr_mul(&of_class(forces.output));
        let mode = |(c, rate)| Mode { rate, input: input[c], load: load[c], output: output[c] };
        modes.extend(motions.rates.into_iter().enumerate().map(mode));
        places.push(Block::new(class.clone(), own.clone(), &motions.shapes[0]));
        speeds.push(Block::new(class.clone(), own.clone(), &motions.shapes[1]));
        inputs.push(Block::new(own.clone(), class.clone(), &motions.inputs));
        stretches.push(Block::new(own_springs, own, &motions.stretches));
        elastic.push(ElasticBlock { modes: class, stiffness: motions.elastic });
    }
    let shapes = [places, speeds].map(|blocks| BlockMatrix::new([count, modes.len()], blocks));
    let inputs = BlockMatrix::new([modes.len(), count], inputs);
    let stretches = BlockMatrix::new([springs, modes.len()], stretches);
    CoupledModes { modes, shapes, inputs, forms: RelaxingForms { elastic, stretches } }
}

#[cfg(test)]
mod tests {
    use super::super::relaxing_directions::Directions;
    use super::*;
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
            assert_eq!(one.forms.stretches.dense().nrows(), 6);
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
