//! Anderson's mixing: the fixed point of x ↦ g(x) in fewer steps than by repetition [Anderson,
//! *Iterative procedures for nonlinear integral equations*, 1965; for a linear g it is much like
//! GMRES: Walker, Ni, *Anderson acceleration for fixed-point iterations*, 2011].
//!
//! Light that is reflected to and fro converges like a few geometric series. The last steps tell
//! their ratios: the next one starts at that combination of them whose changes cancel the most.

use std::collections::VecDeque;

use glam::{DVec3, Vec3};
use rayon::prelude::*;

/// Former steps that are mixed with the newest one.
const DEPTH: usize = 2;
/// Two changes are as good as one where the squared sine of the angle between them is less than
/// this.
const LEAST_ANGLE: f64 = 1e-6;
/// Entries that one task sums, a fixed number for sums to be the same for any number of threads.
const CHUNK: usize = 1 << 14;

/// The last steps of an iteration. Colours are mixed each on its own.
#[derive(Clone, Debug, Default)]
pub struct Mixing {
    /// Where former steps led to, and what they changed; the newest first.
    former: VecDeque<Former>,
}

#[derive(Clone, Debug)]
struct Former {
    to: Vec<Vec3>,
    change: Vec<Vec3>,
}

/// Products of the newest change f, and of its differences d₁, d₂ from the ones before it, over all
/// entries.
#[derive(Clone, Copy, Debug, Default)]
struct Products {
    d1_d1: DVec3,
    d1_d2: DVec3,
    d2_d2: DVec3,
    d1_f: DVec3,
    d2_f: DVec3,
}

impl Mixing {
    /// Where to start after a step that led from `from` to `to`. An entry's change counts by its
    /// weight.
    pub fn next(&mut self, weights: &[f32], from: &[Vec3], to: Vec<Vec3>) -> Vec<Vec3> {
        let change: Vec<Vec3> = to.par_iter().zip(from).map(|(to, from)| *to - *from).collect();
        let shares = self.shares(weights, &change).map(DVec3::as_vec3);
        let mix = |(index, to): (usize, &Vec3)| {
            let former = self.former.iter().zip(shares);
            let mixed = former.fold(*to, |mixed, (former, share)| mixed - share * (*to - former.to[index]));
            mixed.max(Vec3::ZERO)
        };
        let mixed = to.par_iter().enumerate().map(mix).collect();
        self.former.truncate(DEPTH - 1);
        self.former.push_front(Former { to, change });
        mixed
    }

    /// Shares of the former steps by which the changes cancel the most.
    fn shares(&self, weights: &[f32], change: &[Vec3]) -> [DVec3; DEPTH] {
        let none: &[Vec3] = &[];
        let [first, second] = [0, 1].map(|place| self.former.get(place).map_or(none, |former| &former.change));
        let of_chunk = |start: usize| {
            let mut sums = Products::default();
            for index in start..(start + CHUNK).min(change.len()) {
                let weight = f64::from(weights[index]);
                let f = change[index].as_dvec3();
                let from_former =
                    |former: &[Vec3]| former.get(index).map_or(DVec3::ZERO, |former| f - former.as_dvec3());
                let (d1, d2) = (from_former(first), from_former(second));
                sums.d1_d1 += weight * d1 * d1;
                sums.d1_d2 += weight * d1 * d2;
                sums.d2_d2 += weight * d2 * d2;
                sums.d1_f += weight * d1 * f;
                sums.d2_f += weight * d2 * f;
            }
            sums
        };
        let starts: Vec<usize> = (0..change.len()).step_by(CHUNK).collect();
        let chunks: Vec<Products> = starts.into_par_iter().map(of_chunk).collect();
        let sum = |of: fn(&Products) -> DVec3| chunks.iter().map(of).sum::<DVec3>().to_array();
        let (d1_d1, d1_d2, d2_d2) = (sum(|of| of.d1_d1), sum(|of| of.d1_d2), sum(|of| of.d2_d2));
        let (d1_f, d2_f) = (sum(|of| of.d1_f), sum(|of| of.d2_f));
        let mut shares = [DVec3::ZERO; DEPTH];
        for colour in 0..3 {
            let determinant = d1_d1[colour] * d2_d2[colour] - d1_d2[colour] * d1_d2[colour];
            if determinant > LEAST_ANGLE * d1_d1[colour] * d2_d2[colour] {
                shares[0][colour] = (d1_f[colour] * d2_d2[colour] - d2_f[colour] * d1_d2[colour]) / determinant;
                shares[1][colour] = (d2_f[colour] * d1_d1[colour] - d1_f[colour] * d1_d2[colour]) / determinant;
            } else if d1_d1[colour] > 0.0 {
                shares[0][colour] = d1_f[colour] / d1_d1[colour];
            }
        }
        shares
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Truth: the fixed point of a linear map of two geometric series, which three steps tell
    /// wholly; a third colour is dark.
    #[test]
    fn two_geometric_series_end_at_once() {
        let ratios = [Vec3::new(0.9, 0.5, 0.0), Vec3::new(0.4, 0.3, 0.0), Vec3::new(0.9, 0.5, 0.0)];
        let sent = [Vec3::new(1.0, 2.0, 0.0), Vec3::new(3.0, 1.0, 0.0), Vec3::new(5.0, 0.1, 0.0)];
        let step =
            |from: &[Vec3]| -> Vec<Vec3> { (0..3).map(|index| sent[index] + ratios[index] * from[index]).collect() };
        let (mut mixing, mut from) = (Mixing::default(), sent.to_vec());
        for _ in 0..3 {
            let to = step(&from);
            from = mixing.next(&[1.0, 2.0, 0.5], &from, to);
        }
        for index in 0..3 {
            let wanted = sent[index] / (Vec3::ONE - ratios[index]);
            assert!(
                (from[index] - wanted).abs().max_element() < 1e-3 * wanted.max_element(),
                "{} {wanted}",
                from[index]
            );
        }
    }

    /// A step that changes nothing is where the next one starts.
    #[test]
    fn a_fixed_point_stays() {
        let (mut mixing, light) = (Mixing::default(), vec![Vec3::ONE; 3]);
        for _ in 0..4 {
            assert_eq!(mixing.next(&[1.0; 3], &light, light.clone()), light);
        }
    }
}
