//! What the fuzzers found worth keeping: inputs that once broke, hung or took a way of their own
//! through the loaders.

use std::fs;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use crate::inputs;

/// The inputs for one fuzzer.
fn of(fuzzer: &str) -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/bad_input/finds").join(fuzzer);
    let entries = fs::read_dir(&folder).unwrap_or_else(|error| panic!("{}: {error}", folder.display()));
    let mut paths: Vec<PathBuf> = entries.map(|entry| entry.expect("a readable folder").path()).collect();
    paths.sort();
    assert!(!paths.is_empty(), "{} is empty", folder.display());
    paths
}

/// Pictures of 16 megapixels take seconds without optimisation; what takes longer than this hangs,
/// on any machine.
const HANG: Duration = Duration::from_secs(60);

/// Truth: what `inputs` asserts of every scene and every error.
fn replay(fuzzer: &str, try_it: fn(&[u8])) {
    for path in of(fuzzer) {
        let data = fs::read(&path).expect("a readable file");
        let begun = Instant::now();
        let outcome = std::panic::catch_unwind(|| try_it(&data));
        assert!(outcome.is_ok(), "{} breaks it", path.display());
        assert!(begun.elapsed() < HANG, "{} takes {:?}", path.display(), begun.elapsed());
    }
}

#[test]
fn obj() {
    replay("obj", inputs::obj);
}

#[test]
fn glb() {
    replay("glb", inputs::glb);
}

#[test]
fn sidecar() {
    replay("sidecar", inputs::sidecar);
}

#[test]
fn ply() {
    replay("ply", inputs::ply);
}

#[test]
fn stl() {
    replay("stl", inputs::stl);
}

#[test]
fn texture() {
    replay("texture", inputs::texture);
}

#[test]
fn compressed() {
    replay("compressed", inputs::compressed);
}

/// Each input, changed in a few bytes, cut, or with a part of it twice, in so many ways.
fn mutate(fuzzer: &str, ways: u64, try_it: fn(&[u8])) {
    for (number, path) in of(fuzzer).into_iter().enumerate() {
        let data = fs::read(&path).expect("a readable file");
        for way in 0..ways {
            let seed = 1 + way + 1_000_003 * number as u64;
            let mut dice = Dice(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15));
            let changed = dice.changed(&data);
            let begun = Instant::now();
            let outcome = std::panic::catch_unwind(|| try_it(&changed));
            assert!(outcome.is_ok(), "{} changed in way {way} breaks it", path.display());
            let took = begun.elapsed();
            assert!(took < HANG, "{} changed in way {way} takes {took:?}", path.display());
        }
    }
}

/// The generator xorshift64.
struct Dice(u64);

impl Dice {
    fn below(&mut self, limit: usize) -> usize {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        ((self.0 >> 11) % limit.max(1) as u64) as usize
    }

    fn changed(&mut self, data: &[u8]) -> Vec<u8> {
        let mut data = data.to_vec();
        for _ in 0..=self.below(4) {
            let (at, length) = (self.below(data.len()), 1 + self.below(8));
            let end = (at + length).min(data.len());
            match self.below(6) {
                0 | 1 => data[at..end].iter_mut().for_each(|byte| *byte ^= 1 << self.below(8)),
                2 => data[at..end].iter_mut().for_each(|byte| *byte = [0, 1, 127, 128, 255, b'9'][self.below(6)]),
                3 => data.truncate(at.max(1)),
                4 => data.extend_from_within(at..end),
                _ => drop(data.splice(at..at, vec![self.below(256) as u8; length])),
            }
        }
        data
    }
}

/// What a fuzzer does with bytes.
type Try = fn(&[u8]);

const ALL: [(&str, Try); 7] = [
    ("obj", inputs::obj),
    ("glb", inputs::glb),
    ("sidecar", inputs::sidecar),
    ("ply", inputs::ply),
    ("stl", inputs::stl),
    ("texture", inputs::texture),
    ("compressed", inputs::compressed),
];

/// Truth: what `inputs` asserts of every scene and every error.
#[test]
fn all_of_it_changed() {
    for (fuzzer, try_it) in ALL {
        mutate(fuzzer, 12, try_it);
    }
}

#[test]
#[ignore = "slow: some minutes without optimisation"]
fn slow_all_of_it_changed_in_thousands_of_ways() {
    let ways = std::env::var("SELFLINK_WAYS").ok().and_then(|ways| ways.parse().ok()).unwrap_or(2000);
    for (fuzzer, try_it) in ALL {
        mutate(fuzzer, ways, try_it);
    }
}
