//! Free motions of a body whose modes are coupled by dampers or relaxation, in first-order coordinates.
//!
//! In the real coordinates x of the lower modes of a body, where M = 1,
//!
//! ẍ + C ẋ + K x + Σ G_i D w_i = φF + f,  ẇ_i = ẋ − w_i/τ_i,
//!
//! with the stretches w = x − z of the springs. With D = Σ_j d_j u_j u_jᵀ, the variables e_ij = √(G_i d_j) u_jᵀ w_i
//! have the spring energies ½ e², and
//!
//! (s x)˙ = s v,  v̇ = −K x − C v − Σ √(G_i d_j) u_j e_ij + φF + f,  ė_ij = √(G_i d_j) u_jᵀ v − e_ij/τ_i
//!
//! with s = ω of the modes. The matrix is antisymmetric except for C, 1/τ and the difference between K and diag(s²), so
//! that its eigenvectors are well conditioned. For one Prony series without dampers, [`Secular`] computes them at less
//! cost. The oscillating pairs are the vibrations, each with its damping. The real eigenvalues are the creep motions.
//! The modes that are left out respond as springs, with the modulus that the modes were computed with.

use nalgebra::{Complex, DMatrix, DVector};

use super::block_matrix::real_times_complex;
use super::eigen::GeneralEigen;
use super::modal_relaxation::ModalRelaxation;
use super::secular_eigen::{Pair, Secular};
use super::{BlockMatrix, Mode};
use crate::error::{Error, Result};

/// Largest norm of the inverse of the unit eigenvectors for which they count as independent.
const CONDITION: f64 = 1e9;

/// Quadratic forms of the energy of a viscoelastic body.
#[derive(Debug, Clone, PartialEq)]
pub struct RelaxingForms {
    /// K after all relaxation in modal coordinates, one block for each class of coupled modes.
    pub elastic: Vec<ElasticBlock>,
    /// Matrix E of the spring variables e = Re(E z), one row for each spring. The energy of a spring is ½ e².
    pub stretches: BlockMatrix,
}

/// Stiffness of some of the modes.
#[derive(Debug, Clone, PartialEq)]
pub struct ElasticBlock {
    /// Numbers of the modes.
    pub modes: Vec<usize>,
    /// Stiffness in these modes, 1/s².
    pub stiffness: DMatrix<f64>,
}

/// Modal components of forces, and of the displacement at the impact point.
#[derive(Debug, Clone, Copy)]
pub struct Forces<'a> {
    /// Components of the contact force.
    pub input: &'a DVector<f64>,
    /// Components of the loads.
    pub load: &'a DVector<f64>,
    /// Displacement of the impact point for unit amplitudes. It is equal to `input`, unless short waves are treated
    /// separately.
    pub output: &'a DVector<f64>,
}

impl<'a> Forces<'a> {
    /// Components for a reciprocal body: the output is equal to the input.
    #[cfg(test)]
    pub fn reciprocal(input: &'a DVector<f64>, load: &'a DVector<f64>) -> Self {
        Self { input, load, output: input }
    }
}

/// Free motions of one class of coupled modes.
pub struct FreeMotions {
    /// Rates λ of the coordinates z, 1/s.
    pub rates: Vec<Complex<f64>>,
    /// Matrices of x and v from the coordinates, Re(X z) and Re(V z).
    pub shapes: [DMatrix<Complex<f64>>; 2],
    /// Inputs b of forces on x.
    pub inputs: DMatrix<Complex<f64>>,
    /// K after all relaxation, 1/s².
    pub elastic: DMatrix<f64>,
    /// Matrix E of the spring variables e = Re(E z).
    pub stretches: DMatrix<Complex<f64>>,
}

/// First-order coordinates z of the coupled modes of a body.
pub struct CoupledModes {
    /// Coordinates z.
    pub modes: Vec<Mode>,
    /// Matrices of x and v from the coordinates, Re(X z) and Re(V z).
    pub shapes: [BlockMatrix; 2],
    /// Inputs b of forces on x.
    pub inputs: BlockMatrix,
    /// Quadratic forms of the energy.
    pub forms: RelaxingForms,
}

impl RelaxingForms {
    /// Returns the energy of all springs, J, for several x, one column for each, and z.
    pub fn energies(&self, x: &DMatrix<f64>, z: &[&[Complex<f64>]]) -> Vec<f64> {
        let springs = self.stretches.real_parts_of(z);
        let mut energies: Vec<f64> = springs.column_iter().map(|of_springs| 0.5 * of_springs.norm_squared()).collect();
        for ElasticBlock { modes, stiffness } in &self.elastic {
            let own = x.select_rows(modes);
            let forces = stiffness * &own;
            let columns = own.column_iter().zip(forces.column_iter());
            energies.iter_mut().zip(columns).for_each(|(energy, (x, force))| *energy += 0.5 * x.dot(&force));
        }
        energies
    }
}

/// Returns K after all relaxation, 1/s², for modes with the given ω².
fn relaxed(squares: &DVector<f64>, relaxations: &[ModalRelaxation]) -> DMatrix<f64> {
    let all = DMatrix::from_diagonal(squares);
    relaxations.iter().fold(all, |sum, part| sum - &part.distortion * part.modulus())
}

/// Returns the equilibrium of all modes under loads after all relaxation, minus the equilibrium of the moving modes
/// alone. Also returns the difference of the two energies, J.
///
/// # Errors
/// [`Error::Solve`] if the loads make the body creep without end.
pub fn at_rest_beyond(
    squares: &DVector<f64>,
    relaxations: &[ModalRelaxation],
    loads: &DVector<f64>,
    moving: &[usize],
) -> Result<(DVector<f64>, f64)> {
    let all = relaxed(squares, relaxations);
    let mut rest = DVector::zeros(loads.len());
    let mut energy = 0.0;
    // Free motions come first and have no equilibrium.
    let left_out = moving.last().map_or(0, |last| last + 1)..loads.len();
    let held: Vec<usize> = moving.iter().copied().chain(left_out).collect();
    for (sign, of) in [(1.0, &held[..]), (-1.0, moving)] {
        let load = loads.select_rows(of);
        let factor = all.select_rows(of).select_columns(of).cholesky();
        let creeps = || Error::Solve("the loads make the body creep without end".into());
        let moved = factor.ok_or_else(creeps)?.solve(&load);
        energy += 0.5 * sign * load.dot(&moved);
        of.iter().zip(moved.iter()).for_each(|(&i, x)| rest[i] += sign * x);
    }
    Ok((rest, energy))
}

/// A spring in series with a dashpot: one direction of D for one term of the Prony series.
struct Spring {
    /// Coupling vector √(G d) u.
    coupling: DVector<f64>,
    /// Relaxation rate 1/τ, 1/s.
    rate: f64,
}

/// Returns all springs of the viscoelastic parts.
fn springs(relaxations: &[ModalRelaxation]) -> Vec<Spring> {
    let mut springs = Vec::new();
    for part in relaxations {
        let factor = part.factor();
        for term in &part.chain.terms {
            let spring = |b| Spring { coupling: b * term.modulus.sqrt(), rate: 1.0 / term.time };
            springs.extend(factor.column_iter().map(spring));
        }
    }
    springs
}

/// Computes the free motions of modes with the given ω², dampers and viscoelastic parts.
///
/// # Errors
/// [`Error::Solve`] if the body has no independent coordinates.
pub fn free_motions(
    squares: &DVector<f64>,
    damping: Option<&DMatrix<f64>>,
    relaxations: &[ModalRelaxation],
) -> Result<FreeMotions> {
    if let (None, [part]) = (damping, relaxations)
        && part.is_quicker_by_pairs()
        && let elastic = relaxed(squares, relaxations)
        && let Some(pairs) = pairs(squares, part, &elastic)
    {
        return Ok(of_pairs(&pairs, elastic, &springs(relaxations)));
    }
    let parts: Vec<_> = relaxations.iter().flat_map(ModalRelaxation::parts).collect();
    of_first_order(squares, damping, relaxed(squares, &parts), &springs(&parts))
}

/// Returns the eigenpairs of a body with one viscoelastic part, of which all terms relax in all directions of the part;
/// `None` if some are not found.
fn pairs(squares: &DVector<f64>, part: &ModalRelaxation, elastic: &DMatrix<f64>) -> Option<Vec<Pair>> {
    Secular::new(squares, &part.factor(), &part.chain, part.modulus()).pairs(elastic)
}

/// Returns the motions in coordinates z with x = Re Σ φ z, summed over all pairs.
fn of_pairs(pairs: &[Pair], elastic: DMatrix<f64>, springs: &[Spring]) -> FreeMotions {
    let n = elastic.nrows();
    let shapes = |factor: &dyn Fn(&Pair) -> Complex<f64>| {
        DMatrix::from_fn(n, pairs.len(), |i, c| pairs[c].shape[i] * factor(&pairs[c]) * pairs[c].count())
    };
    let (places, speeds) = (shapes(&|_| Complex::new(1.0, 0.0)), shapes(&|pair| pair.rate));
    let inputs = DMatrix::from_fn(pairs.len(), n, |c, i| pairs[c].shape[i] / pairs[c].slope);
    // ẇ = ẋ − w/τ.
    let couplings = DMatrix::from_fn(springs.len(), n, |k, i| springs[k].coupling[i]);
    let mut stretches = real_times_complex(&couplings, &places);
    for (mut column, pair) in stretches.column_iter_mut().zip(pairs) {
        let rows = column.iter_mut().zip(springs);
        rows.for_each(|(entry, spring)| *entry *= pair.rate / (pair.rate + spring.rate));
    }
    let rates = pairs.iter().map(|pair| pair.rate).collect();
    FreeMotions { rates, shapes: [places, speeds], inputs, elastic, stretches }
}

/// Computes the same motions from the eigenvectors of the first-order system.
fn of_first_order(
    squares: &DVector<f64>,
    damping: Option<&DMatrix<f64>>,
    elastic: DMatrix<f64>,
    springs: &[Spring],
) -> Result<FreeMotions> {
    let n = squares.len();
    let of_damping = |i: usize| damping.map_or(0.0, |damping| damping[(i, i)]);
    let scales = DVector::from_fn(n, |i, _| squares[i].sqrt().max(of_damping(i)).max(f64::MIN_POSITIVE));
    let size = 2 * n + springs.len();
    tracing::debug!(size, "coupled modes by the first-order system");
    let mut matrix = DMatrix::zeros(size, size);
    for i in 0..n {
        matrix[(i, n + i)] = scales[i];
        for j in 0..n {
            matrix[(n + i, j)] = -elastic[(i, j)] / scales[j];
        }
    }
    if let Some(damping) = damping {
        matrix.view_mut((n, n), (n, n)).copy_from(&-damping);
    }
    for (row, Spring { coupling, rate }) in (2 * n..).zip(springs) {
        matrix.view_mut((n, row), (n, 1)).copy_from(&-coupling);
        matrix.view_mut((row, n), (1, n)).copy_from(&coupling.transpose());
        matrix[(row, row)] = -rate;
    }
    let dependent = || {
        let message = match springs.is_empty() {
            true => {
                "the dampers leave the body without independent modes (critical damping): try another damping, or another time.scheme"
            }
            false => {
                "the body's relaxation leaves it without independent modes: try another time.scheme, or another temperature"
            }
        };
        Error::Solve(message.into())
    };
    let eigen = GeneralEigen::new(&matrix).ok_or_else(dependent)?;
    // Of each conjugate pair, one is kept and counted twice; real ones are counted once.
    let chosen: Vec<(usize, f64)> = (0..size)
        .filter_map(|k| match eigen.value(k).im {
            0.0 => Some((k, 1.0)),
            im if im > 0.0 => Some((k, 2.0)),
            _ => None,
        })
        .collect();
    // Inputs of forces on v to each coordinate.
    let inputs = eigen.coordinates(&DMatrix::from_fn(size, n, |i, j| if i == n + j { 1.0 } else { 0.0 }));
    let inputs = inputs.filter(|inputs| inputs.norm() < CONDITION).ok_or_else(dependent)?;
    let inputs = DMatrix::from_fn(chosen.len(), n, |c, i| inputs[(chosen[c].0, i)]);
    let rows = |begin: usize, count: usize| {
        DMatrix::from_fn(count, chosen.len(), |i, c| eigen.entry(begin + i, chosen[c].0) * chosen[c].1)
    };
    let (mut places, speeds, stretches) = (rows(0, n), rows(n, n), rows(2 * n, springs.len()));
    places.row_iter_mut().zip(scales.iter()).for_each(|(mut row, scale)| row.unscale_mut(*scale));
    let rates = chosen.iter().map(|&(k, _)| eigen.value(k)).collect();
    Ok(FreeMotions { rates, shapes: [places, speeds], inputs, elastic, stretches })
}

#[cfg(test)]
mod tests {
    use super::super::coupled_classes::{coordinates, coupled_modes};
    use super::*;
    use crate::body::eigen::semidefinite_factor;
    use crate::body::relaxing_directions::Directions;
    use crate::element::gauss_legendre;
    use crate::material::{Maxwell, Term};
    use crate::scheme::modal::phi;

    /// Four modes with two viscoelastic parts, with or without a damper.
    struct Sample {
        squares: DVector<f64>,
        damping: Option<DMatrix<f64>>,
        relaxations: Vec<ModalRelaxation>,
        force: DVector<f64>,
        load: DVector<f64>,
    }

    fn sample(damping: f64) -> Sample {
        let part = |seed: usize, terms: &[(f64, f64)]| {
            // Rank three.
            let rows = DMatrix::from_fn(3, 4, |i, j| ((seed + 3 * i + 5 * j) % 7) as f64 - 2.5);
            let terms = terms.iter().map(|&(modulus, time)| Term { modulus, time }).collect();
            let chain = Maxwell { equilibrium: 0.1, terms };
            ModalRelaxation { distortion: rows.tr_mul(&rows) * 0.02, directions: None, chain, rate: 2.0 }
        };
        Sample {
            squares: DVector::from_row_slice(&[4.0, 9.0, 16.0, 30.0]),
            damping: (damping > 0.0).then(|| DMatrix::from_fn(4, 4, |i, j| damping / (1.0 + (i + j) as f64))),
            relaxations: vec![part(1, &[(1.0, 0.05), (0.6, 0.7), (0.5, 20.0)]), part(4, &[(0.8, 0.3)])],
            force: DVector::from_row_slice(&[1.0, -0.5, 0.7, 0.2]),
            load: DVector::from_row_slice(&[0.3, 0.1, -0.2, 0.4]),
        }
    }

    /// Returns the energy of all springs at x and z.
    fn energy(forms: &RelaxingForms, x: &DVector<f64>, z: &[Complex<f64>]) -> f64 {
        forms.energies(&DMatrix::from_column_slice(x.len(), 1, x.as_slice()), &[z])[0]
    }

    /// Returns z at a time after a start from zero, under a constant force of 1 and the loads.
    fn pushed(modes: &[Mode], time: f64) -> Vec<Complex<f64>> {
        modes.iter().map(|mode| phi(mode.rate * time)[0] * time * (mode.input + mode.load)).collect()
    }

    /// The work of the forces equals the kinetic energy, the stored energy and the losses in dashpots and dampers. The
    /// balance holds to rounding, because the motion is exact.
    #[test]
    fn work_is_stored_or_lost() {
        for damping in [0.0, 0.4] {
            let Sample { squares, damping, relaxations, force, load } = sample(damping);
            let CoupledModes { modes, shapes, forms, .. } =
                coupled_modes(&squares, damping.as_ref(), &relaxations, Forces::reciprocal(&force, &load)).unwrap();
            let [places, speeds] = &shapes;
            let rates: Vec<f64> = springs(&relaxations).iter().map(|spring| spring.rate).collect();
            let power = |time: f64| {
                let z = pushed(&modes, time);
                let stretches = forms.stretches.real_parts(&z);
                let v = speeds.real_parts(&z);
                let of_dampers = damping.as_ref().map_or(0.0, |damping| v.dot(&(damping * &v)));
                stretches.iter().zip(&rates).map(|(e, rate)| e * e * rate).sum::<f64>() + of_dampers
            };
            let (rule, panel) = (gauss_legendre(12), 0.05);
            let mut lost = 0.0;
            for k in 1..=100 {
                let middle = (f64::from(k) - 0.5) * panel;
                lost += rule.iter().map(|(x, p)| 0.5 * panel * p * power(middle + 0.5 * panel * x)).sum::<f64>();
                let z = pushed(&modes, f64::from(k) * panel);
                let (x, v) = (places.real_parts(&z), speeds.real_parts(&z));
                let work = x.dot(&(&force + &load));
                let off = 0.5 * v.norm_squared() + energy(&forms, &x, &z) + lost - work;
                assert!(off.abs() < 1e-12, "{off:e} of {work} at {k}");
            }
            assert!(lost > 0.01, "{lost}");
        }
    }

    /// The response at a rate s equals the response of the nonlinear operator, φᵀ(s² + sC + K + Σ G_i sτ_i/(1 + sτ_i)
    /// D)⁻¹φ.
    #[test]
    fn coordinates_have_the_transform_of_the_chain() {
        for damping in [0.0, 0.4] {
            let Sample { squares, damping, relaxations, force, load } = sample(damping);
            let CoupledModes { modes, .. } =
                coupled_modes(&squares, damping.as_ref(), &relaxations, Forces::reciprocal(&force, &load)).unwrap();
            for s in [1e-3, 0.1, 3.0, 40.0, 1e4] {
                let mut operator = relaxed(&squares, &relaxations) + DMatrix::identity(4, 4) * (s * s);
                for part in &relaxations {
                    operator += &part.distortion * part.chain.transformed_terms(s);
                }
                if let Some(damping) = &damping {
                    operator += damping * s;
                }
                let exact = force.dot(&operator.cholesky().unwrap().solve(&force));
                let of = |mode: &Mode| (mode.output * mode.input / (Complex::new(s, 0.0) - mode.rate)).re;
                let found: f64 = modes.iter().map(of).sum();
                // At high rates, terms of order one cancel and leave s⁻².
                assert!((found - exact).abs() < 1e-13 + 1e-11 * exact.abs() / s.max(1.0), "{s}: {found} {exact}");
            }
        }
    }

    /// For terms that relax in one, two and three directions, the response at a rate equals the response of the
    /// operator with a separate D for each term.
    #[test]
    fn terms_relax_in_directions_of_their_own() {
        let Sample { squares, relaxations, force, load, .. } = sample(0.0);
        let mut part = relaxations[0].clone();
        let factor = semidefinite_factor(&part.distortion);
        let counts = vec![2, 3, 1];
        part.directions = Some(Directions { factor: factor.clone(), counts: counts.clone() });
        let CoupledModes { modes, forms, .. } =
            coupled_modes(&squares, None, &part.parts(), Forces::reciprocal(&force, &load)).unwrap();
        assert_eq!(forms.stretches.dense().nrows(), 6);
        for s in [1e-3, 0.1, 3.0, 40.0] {
            let mut operator = DMatrix::from_diagonal(&squares) + DMatrix::identity(4, 4) * (s * s);
            for (term, count) in part.chain.terms.iter().zip(&counts) {
                let columns = factor.columns(0, *count);
                let alone = Maxwell { equilibrium: 0.0, terms: vec![*term] };
                let beyond = alone.transformed_terms(s) - alone.transformed_terms(part.rate);
                operator += columns * columns.transpose() * beyond;
            }
            let exact = force.dot(&operator.cholesky().unwrap().solve(&force));
            let of = |mode: &Mode| (mode.output * mode.input / (Complex::new(s, 0.0) - mode.rate)).re;
            let found: f64 = modes.iter().map(of).sum();
            // At high rates, terms of order one cancel and leave s⁻².
            assert!((found - exact).abs() < 1e-13 + 1e-11 * exact.abs() / s.max(1.0), "{s}: {found} {exact}");
        }
    }

    /// For one Prony series without dampers, the eigenpairs computed one by one agree with the first-order system. The
    /// terms are as fast as the vibrations, much faster, or much slower.
    #[test]
    fn pairs_are_those_of_the_first_order_system() {
        let Sample { squares, relaxations, force, load, .. } = sample(0.0);
        let relaxations = &relaxations[..1];
        for (scale, is_factored) in
            [1e-3, 0.03, 1.0, 300.0].into_iter().flat_map(|scale| [(scale, false), (scale, true)])
        {
            let mut part = relaxations[0].clone();
            part.chain.terms.iter_mut().for_each(|term| term.time *= scale);
            let counts = vec![3; 3];
            let factor = || semidefinite_factor(&part.distortion);
            part.directions = is_factored.then(|| Directions { factor: factor(), counts });
            let parts = std::slice::from_ref(&part);
            let (elastic, springs) = (relaxed(&squares, parts), springs(parts));
            let pairs = pairs(&squares, &part, &elastic).expect("all pairs");
            // Four vibrations, and three directions for each of three terms.
            assert_eq!(pairs.len(), 4 + 9, "{scale}");
            let one = of_pairs(&pairs, elastic.clone(), &springs);
            let other = of_first_order(&squares, None, elastic, &springs).unwrap();
            let [one, other] = [one, other]
                .map(|motions| coordinates(vec![(vec![0, 1, 2, 3], motions)], Forces::reciprocal(&force, &load)));
            for time in [0.01, 0.3, 2.0, 20.0] {
                let [(x, v, e), (y, w, f)] = [&one, &other].map(|CoupledModes { modes, shapes, forms, .. }| {
                    let z = pushed(modes, time);
                    let [places, speeds] = &shapes;
                    (places.real_parts(&z), speeds.real_parts(&z), forms.stretches.real_parts(&z))
                });
                // Rounding of displacements and stretches of order one, and of the rates of the first-order system,
                // relative to the fastest rate.
                let off = 1e-11 + 1e-14 * time / (0.05 * scale);
                assert!((x - y).amax() < off && (v - w).amax() < off && (e - f).amax() < off, "{scale} {time}");
            }
        }
    }

    /// The equilibrium of all modes after all relaxation is the sum of the equilibrium of the moving modes and the part
    /// of the others.
    #[test]
    fn left_out_modes_share_the_equilibrium() {
        let Sample { squares, relaxations, load, .. } = sample(0.0);
        let whole = relaxed(&squares, &relaxations).cholesky().unwrap().solve(&load);
        let (beyond, energy) = at_rest_beyond(&squares, &relaxations, &load, &[0, 1]).unwrap();
        let moving: Vec<_> = relaxations.iter().map(|part| part.select(&[0, 1])).collect();
        let own = relaxed(&squares.rows(0, 2).into_owned(), &moving).cholesky().unwrap().solve(&load.rows(0, 2));
        let sum = &beyond + own.clone().resize_vertically(4, 0.0);
        assert!((sum - &whole).amax() < 1e-14);
        assert!((energy - 0.5 * (load.dot(&whole) - load.rows(0, 2).dot(&own))).abs() < 1e-14 && energy > 0.0);
    }
}
