//! What the fuzzers found worth keeping: inputs that once broke, hung or took a way of their own
//! through the loaders.

use std::fs;
use std::path::{Path, PathBuf};

use crate::dice::Dice;
use crate::inputs;
use crate::strict::ends;

/// What a fuzzer does with bytes.
type Try = fn(&[u8]);

/// The inputs for one fuzzer.
fn of(fuzzer: &str) -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/bad_input/finds").join(fuzzer);
    let entries = fs::read_dir(&folder).unwrap_or_else(|error| panic!("{}: {error}", folder.display()));
    let mut paths: Vec<PathBuf> = entries.map(|entry| entry.expect("a readable folder").path()).collect();
    paths.sort();
    assert!(!paths.is_empty(), "{} is empty", folder.display());
    paths
}

/// Each input, changed in a few bytes, cut, or with a part of it twice, in so many ways.
fn mutate(fuzzer: &str, ways: u64, try_it: Try) {
    for (number, path) in of(fuzzer).into_iter().enumerate() {
        let data = fs::read(&path).expect("a readable file");
        for way in 0..ways {
            let seed = 1 + way + 1_000_003 * number as u64;
            let changed = Dice(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15)).changed(&data);
            ends(&format!("{} changed in way {way}", path.display()), move || try_it(&changed));
        }
    }
}

impl Dice {
    fn below(&mut self, limit: usize) -> usize {
        self.roll(limit.max(1) as u64) as usize
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
fn all_of_it() {
    for (fuzzer, try_it) in ALL {
        for path in of(fuzzer) {
            let data = fs::read(&path).expect("a readable file");
            ends(&path.display().to_string(), move || try_it(&data));
        }
    }
}

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
