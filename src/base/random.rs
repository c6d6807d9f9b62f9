//! Random numbers that are the same on every run, a hash of what they are for, and directions made
//! of them.

use glam::Vec3;

/// The increment of SplitMix64.
pub const GOLDEN: u64 = 0x9e37_79b9_7f4a_7c15;

/// A well-mixed 64-bit hash of two numbers (the finaliser of SplitMix64).
pub fn hash64(a: u64, b: u64) -> u64 {
    finalised(a.wrapping_mul(GOLDEN).wrapping_add(b).wrapping_add(GOLDEN))
}

/// A stream of random numbers \[SplitMix64, Steele et al. 2014\] from its seed.
pub struct Stream(pub u64);

impl Stream {
    /// The next 64 bits.
    pub fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(GOLDEN);
        finalised(self.0)
    }

    /// The next number in 0..1, of 24 bits.
    pub fn unit(&mut self) -> f32 {
        (self.bits() >> 40) as f32 / (1_u64 << 24) as f32
    }

    /// The next number in 0..1, of 53 bits.
    pub fn unit_f64(&mut self) -> f64 {
        (self.bits() >> 11) as f64 / (1_u64 << 53) as f64
    }
}

fn finalised(mut z: u64) -> u64 {
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

/// The 24 upper bits of a number as a fraction in 0..1, never 1.
#[inline]
pub fn fraction(bits: u32) -> f32 {
    (bits >> 8) as f32 * (1.0 / 16_777_216.0)
}

/// Steps of the two-dimensional sequence of the plastic number \[Roberts 2018\], as 32-bit
/// fractions.
const STEPS: [u32; 2] = [3_242_174_889, 2_447_445_414];

/// Point number `index` of a sequence that fills the unit square evenly, from a start that the seed
/// tells.
#[inline]
pub fn r2_sequence(seed: u64, index: u32) -> [f32; 2] {
    let start = [seed as u32, (seed >> 32) as u32];
    [0, 1].map(|axis: usize| fraction(start[axis].wrapping_add(STEPS[axis].wrapping_mul(index))))
}

/// A direction about a normal with density cosθ/π.
pub fn cosine_direction(normal: Vec3, u: f32, v: f32) -> Vec3 {
    let (tangent, bitangent) = normal.any_orthonormal_pair();
    let (sine, cosine) = (std::f32::consts::TAU * v).sin_cos();
    let radius = u.sqrt();
    (radius * (cosine * tangent + sine * bitangent) + (1.0 - u).max(0.0).sqrt() * normal).normalize()
}
