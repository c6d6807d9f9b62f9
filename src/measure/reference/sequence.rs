//! Random numbers that cover the unit square evenly: Owen-scrambled (0,2)-sequences, a fresh one
//! for each batch of paths.
//!
//! Every pair of dimensions is the two-dimensional Sobol sequence with its order and its digits
//! scrambled by a hash \[Burley, *Practical hash-based Owen scrambling*, JCGT 9(4), 2020\], with
//! the hash of pbrt-v4's `FastOwenScrambler`. Each number alone is uniform, so a batch is unbiased;
//! batches are independent, so their spread tells the error.

/// The numbers of one path.
#[derive(Clone, Copy)]
pub struct Sequence {
    /// Seed of the batch.
    seed: u64,
    /// Which path of the batch.
    index: u32,
    /// Paths of a batch less 1; their number is a power of two.
    mask: u32,
}

impl Sequence {
    /// The numbers of path `index` of a batch of `length` paths, a power of two.
    pub fn new(seed: u64, index: u32, length: u32) -> Self {
        debug_assert!(length.is_power_of_two() && index < length, "a batch is a power of two");
        Self { seed, index, mask: length - 1 }
    }

    /// The pair of numbers number `dimension`, in 0..1, stratified over the batch.
    #[inline]
    pub fn even(&self, dimension: u32) -> [f32; 2] {
        let seed = hash64(self.seed, u64::from(dimension));
        let [order, other] = [seed as u32, (seed >> 32) as u32];
        let index = scramble(self.index, order) & self.mask;
        let first = scramble(index.reverse_bits(), other.wrapping_mul(0x9e37_79b9) ^ order);
        let second = scramble(sobol_second(index), other);
        [unit(first), unit(second)]
    }

    /// A pair of numbers, in 0..1, that takes no heed of the other paths.
    #[inline]
    pub fn plain(&self, dimension: u32) -> [f32; 2] {
        let bits = hash64(hash64(self.seed, u64::from(dimension)), u64::from(self.index));
        [unit(bits as u32), unit((bits >> 32) as u32)]
    }
}

/// Owen's scrambling of the binary digits of a number below 1 (the highest bit counts ½).
#[inline]
fn scramble(digits: u32, seed: u32) -> u32 {
    let mut x = digits.reverse_bits();
    x ^= x.wrapping_mul(0x3d20_adea);
    x = x.wrapping_add(seed);
    x = x.wrapping_mul((seed >> 16) | 1);
    x ^= x.wrapping_mul(0x0552_6c56);
    x ^= x.wrapping_mul(0x53a2_2864);
    x.reverse_bits()
}

/// The second dimension of the Sobol sequence.
#[inline]
fn sobol_second(mut index: u32) -> u32 {
    let (mut direction, mut digits) = (1_u32 << 31, 0);
    while index > 0 {
        if index & 1 == 1 {
            digits ^= direction;
        }
        index >>= 1;
        direction ^= direction >> 1;
    }
    digits
}

#[inline]
fn unit(bits: u32) -> f32 {
    (bits >> 8) as f32 / 16_777_216.0
}

/// Hashes two numbers (the finaliser of SplitMix64, Steele et al. 2014).
#[inline]
pub fn hash64(a: u64, b: u64) -> u64 {
    let mut z = a ^ b.wrapping_add(1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Truth: the definition of a (0,2)-sequence; 64 points have one in every elementary interval
    /// of area 1/64.
    #[test]
    fn points_are_stratified_in_every_elementary_interval() {
        for seed in 0..20 {
            let points: Vec<[f32; 2]> = (0..64).map(|index| Sequence::new(seed, index, 64).even(3)).collect();
            for bits in 0..=6 {
                let (columns, rows) = (1_usize << bits, 64_usize >> bits);
                let mut count = vec![0; 64];
                for [u, v] in &points {
                    count[(u * columns as f32) as usize * rows + (v * rows as f32) as usize] += 1;
                }
                assert!(count.iter().all(|&count| count == 1), "seed {seed}, {columns} × {rows}: {count:?}");
            }
        }
    }

    /// Truth: the moments of uniform numbers, ½ and ⅓, and no correlation between two pairs: over
    /// 4,096 batches within four standard errors of plain sampling.
    #[test]
    fn numbers_are_uniform_over_batches() {
        let batches = 4096_u32;
        for index in [0, 5] {
            let (mut sum, mut squares, mut product) = (0.0, 0.0, 0.0);
            for batch in 0..batches {
                let sequence = Sequence::new(hash64(99, u64::from(batch)), index, 16);
                let ([a, b], [c, _]) = (sequence.even(0), sequence.even(1));
                sum += f64::from(a);
                squares += f64::from(b * b);
                product += f64::from((a - 0.5) * (c - 0.5));
            }
            let n = f64::from(batches);
            let error = |deviation: f64| 4.0 * deviation / n.sqrt();
            assert!((sum / n - 0.5).abs() < error(0.289), "mean {}", sum / n);
            assert!((squares / n - 1.0 / 3.0).abs() < error(0.299), "square {}", squares / n);
            assert!((product / n).abs() < error(1.0 / 12.0), "correlation {}", product / n);
        }
    }
}
