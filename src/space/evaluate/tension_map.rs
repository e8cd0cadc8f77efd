//! Largest tension over time at each point of the faces.

/// Tensions at the points of all faces, face by face: of one step, or the largest of many steps.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct TensionMap {
    /// Tension, Pa; −∞ at a point that is left out. Single precision suffices for a map; values compared with a
    /// strength are kept in double precision.
    pub tension: Vec<f32>,
    /// Time of the tension, s: one for each point, or one for all.
    pub time: Vec<f64>,
}

impl TensionMap {
    /// Tensions (Pa) at one time, s.
    pub fn of_step(tension: Vec<f32>, time: f64) -> Self {
        Self { tension, time: vec![time] }
    }

    /// Largest tension of many steps at each point (Pa), with its time, s.
    ///
    /// # Panics
    /// If the numbers of times and tensions differ.
    pub fn of_steps(tension: Vec<f32>, time: Vec<f64>) -> Self {
        assert_eq!(tension.len(), time.len(), "each tension has a time");
        Self { tension, time }
    }

    /// Time at which the tension at a point was reached, s.
    pub fn time_at(&self, point: usize) -> f64 {
        if self.time.len() == 1 { self.time[0] } else { self.time[point] }
    }

    /// Includes later steps: larger tensions and their times replace the present ones.
    pub fn take(&mut self, later: &Self) {
        if later.tension.is_empty() {
            return;
        }
        if self.tension.is_empty() {
            *self = later.clone();
            return;
        }
        if self.time.len() < self.tension.len() {
            self.time = vec![self.time[0]; self.tension.len()];
        }
        for (point, tension) in later.tension.iter().enumerate() {
            if *tension > self.tension[point] {
                (self.tension[point], self.time[point]) = (*tension, later.time_at(point));
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::TensionMap;

    /// Step by step, the result is the same as for all steps together. Equal tensions keep the earlier time, and NaN is
    /// ignored.
    #[test]
    fn larger_tensions_replace_smaller_ones() {
        let mut map = TensionMap::default();
        map.take(&TensionMap::of_step(vec![1.0, -2.0, f32::NEG_INFINITY], 0.0));
        map.take(&TensionMap::default());
        map.take(&TensionMap::of_step(vec![1.0, 3.0, f32::NEG_INFINITY], 0.5));
        map.take(&TensionMap::of_step(vec![f32::NAN, 2.0, f32::NEG_INFINITY], 0.7));
        map.take(&TensionMap::of_steps(vec![4.0, 2.5, f32::NEG_INFINITY], vec![0.8, 0.9, 0.8]));
        assert_eq!(map.tension, [4.0, 3.0, f32::NEG_INFINITY]);
        assert_eq!([0, 1].map(|point| map.time_at(point)), [0.8, 0.5]);
    }
}
