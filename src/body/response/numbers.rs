//! A response as plain numbers, for communication between ranks.

use nalgebra::{Complex, DMatrix, DVector};
use serde::{Deserialize, Serialize};

use super::Response;
use crate::body::modes::Free;
use crate::body::shapes::Shapes;
use crate::contact::Footprint;

/// Plain numbers of a [`Response`].
#[derive(Serialize, Deserialize)]
pub struct Numbers {
    end: f64,
    /// Real and imaginary parts of λ and of the output, for each coordinate.
    modes: Vec<[f64; 4]>,
    /// Real and imaginary parts of Y, by columns.
    places: Vec<[f64; 2]>,
    free: [f64; 3],
    residual: f64,
    /// Displacements that do not depend on z, as four vectors.
    others: [Vec<f64>; 4],
    /// Stress forms on the face opposite the impact point, by columns of three.
    hit_stress: Vec<f64>,
    local_stress_per_newton: [f64; 3],
    compliance: f64,
    multiplicity: f64,
    footprint: Footprint,
}

impl From<Response> for Numbers {
    fn from(response: Response) -> Self {
        let Response { end, modes, places, free, residual, others, hit_stress, compliance, multiplicity, footprint } =
            response;
        let Shapes { free: [way, of_load], residual: of_force, rest, .. } = others;
        Self {
            end,
            modes: modes.iter().map(|(rate, output)| [rate.re, rate.im, output.re, output.im]).collect(),
            places: places.iter().map(|entry| [entry.re, entry.im]).collect(),
            free: [free.mobility, free.load, free.square],
            residual,
            others: [way, of_load, of_force, rest].map(|vector| vector.as_slice().to_vec()),
            hit_stress: hit_stress.0.as_slice().to_vec(),
            local_stress_per_newton: hit_stress.1,
            compliance,
            multiplicity,
            footprint,
        }
    }
}

impl From<Numbers> for Response {
    fn from(numbers: Numbers) -> Self {
        let Numbers {
            end,
            modes,
            places,
            free,
            residual,
            others,
            hit_stress,
            local_stress_per_newton,
            compliance,
            multiplicity,
            footprint,
        } = numbers;
        let [way, of_load, of_force, rest] = others.map(DVector::from_vec);
        let vectors = way.len();
        let [mobility, load, square] = free;
        let rows = hit_stress.len() / vectors.max(1);
        Self {
            end,
            places: DMatrix::from_iterator(vectors, modes.len(), places.iter().map(|[re, im]| Complex::new(*re, *im))),
            modes: modes.iter().map(|[re, im, c, d]| (Complex::new(*re, *im), Complex::new(*c, *d))).collect(),
            free: Free { mobility, load, square },
            residual,
            others: Shapes { moving: DMatrix::zeros(vectors, 0), free: [way, of_load], residual: of_force, rest },
            hit_stress: (DMatrix::from_vec(rows, vectors, hit_stress), local_stress_per_newton),
            compliance,
            multiplicity,
            footprint,
        }
    }
}
