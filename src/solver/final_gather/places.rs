//! Random places on the mesh, more where more may be wrong.

use crate::random::{even_point, mix};

/// The leaves of a mesh as a line along which places lie evenly, each leaf as long as its weight.
pub struct Places {
    /// Where each leaf ends on the line.
    ends: Vec<f64>,
    /// Number of places.
    count: usize,
}

/// One of the places.
#[derive(Clone, Copy, Debug)]
pub struct Place {
    /// Index into the mesh's leaves.
    pub leaf: usize,
    /// Where on the leaf, in 0..1.
    pub uv: [f32; 2],
    /// Mean number of places on this leaf: one of them stands for the leaf's area over that.
    pub density: f64,
}

impl Places {
    /// So many places on leaves of these weights.
    pub fn new(weights: impl IntoIterator<Item = f64>, count: usize) -> Self {
        let mut sum = 0.0;
        let ends = weights.into_iter().map(|weight| {
            sum += weight.max(0.0);
            sum
        });
        Self { ends: ends.collect(), count }
    }

    /// A place by its number: one in each of as many equal parts of the line, so places of one leaf follow one another. `None` where
    /// nothing has a weight.
    pub fn at(&self, index: usize, seed: u64) -> Option<Place> {
        let total = self.ends.last().copied().filter(|total| *total > 0.0)?;
        let within = (mix(mix(seed, 1), index as u64) >> 11) as f64 / (1_u64 << 53) as f64;
        let wanted = (index as f64 + within) / self.count as f64 * total;
        let leaf = self.ends.partition_point(|end| *end <= wanted);
        // Rounding may lead past the last leaf that has a weight.
        let leaf = if leaf < self.ends.len() { leaf } else { self.ends.partition_point(|end| *end < total) };
        let start = if leaf > 0 { self.ends[leaf - 1] } else { 0.0 };
        let density = (self.ends[leaf] - start) / total * self.count as f64;
        Some(Place { leaf, uv: even_point(mix(seed, 2), index as u32), density })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn leaves_get_places_in_proportion_to_their_weights_and_none_without() {
        let weights = [0.0, 3.0, 0.0, 1.0, 4.0, 0.0];
        let places = Places::new(weights, 800);
        let mut counts = [0; 6];
        for index in 0..800 {
            let place = places.at(index, 7).expect("there are weights");
            assert!((place.density - 100.0 * weights[place.leaf]).abs() < 1e-9);
            assert!(place.uv.iter().all(|number| (0.0..1.0).contains(number)));
            counts[place.leaf] += 1;
        }
        assert_eq!(counts, [0, 300, 0, 100, 400, 0]);
        assert!(Places::new([0.0; 3], 10).at(0, 7).is_none());
        assert!(Places::new([], 10).at(0, 7).is_none());
    }
}
