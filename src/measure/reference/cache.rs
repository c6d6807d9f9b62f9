//! References on disk, so that a scene's truth is computed once.
//!
//! A file is named by a hash of everything that its values depend on, and says so inside as well;
//! what has changed has another name, so nothing can be stale. A file ends with a hash of itself;
//! one that is damaged or cut off is as good as none.

use std::fs::{self, File};
use std::io::{self, Write as _};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU32, Ordering};

use glam::DVec3;
use sha2::{Digest, Sha256};

use super::key::{HASH, Key, MAGIC};
use super::run::ReferenceRun;
use super::sums::{State, Sums};

/// Bytes of a point's sums: a count and six numbers.
const RECORD: usize = 4 + 6 * 8;

/// A folder of references.
#[derive(Clone, Debug)]
pub struct Cache(PathBuf);

impl Cache {
    /// The cache in this folder, which is made when something is stored.
    pub fn new(folder: &Path) -> Self {
        Self(folder.to_owned())
    }

    /// The person's own cache: `selflink` in `$XDG_CACHE_HOME` or else in `~/.cache`; `None` where
    /// there is neither.
    pub fn of_user() -> Option<Self> {
        let folder = |name: &str| std::env::var_os(name).map(PathBuf::from).filter(|path| path.is_absolute());
        let base = folder("XDG_CACHE_HOME").or_else(|| Some(folder("HOME")?.join(".cache")))?;
        Some(Self(base.join("selflink")))
    }

    /// Where the reference with this key lies.
    pub fn path(&self, key: &Key) -> PathBuf {
        self.0.join(format!("{}.reference", key.name()))
    }

    /// Gives a run what is stored of it, if that is more than it has; false if not.
    pub fn load(&self, run: &mut ReferenceRun) -> bool {
        let Ok(bytes) = fs::read(self.path(run.key())) else { return false };
        match decode(&bytes, run.key(), run.points().len()) {
            Some(state) if state.passes > run.passes() => {
                run.restore(state);
                true
            }
            _ => false,
        }
    }

    /// Stores what a run knows, unless more is there already. The file changes at once or not at
    /// all.
    ///
    /// # Errors
    /// The folder cannot be made or written.
    pub fn store(&self, run: &ReferenceRun) -> io::Result<()> {
        static COUNTER: AtomicU32 = AtomicU32::new(0);
        let path = self.path(run.key());
        let stored = fs::read(&path).ok().and_then(|bytes| decode(&bytes, run.key(), run.points().len()));
        if stored.is_some_and(|state| state.passes >= run.passes()) {
            return Ok(());
        }
        fs::create_dir_all(&self.0)?;
        let number = COUNTER.fetch_add(1, Ordering::Relaxed);
        let beside = path.with_extension(format!("{}-{number}.new", std::process::id()));
        let written = File::create(&beside).and_then(|mut file| {
            file.write_all(&encode(run))?;
            file.sync_all()
        });
        let renamed = written.and_then(|()| fs::rename(&beside, &path));
        if renamed.is_err() {
            // Nothing more can be done about a file that cannot be removed either.
            let _ = fs::remove_file(&beside);
        }
        renamed
    }
}

fn encode(run: &ReferenceRun) -> Vec<u8> {
    let state = run.state();
    let mut bytes = Vec::with_capacity(MAGIC.len() + 2 * HASH + 12 + 2 * RECORD * state.pilot.len());
    bytes.extend(MAGIC);
    bytes.extend(run.key().0);
    bytes.extend(state.passes.to_le_bytes());
    bytes.extend((state.pilot.len() as u64).to_le_bytes());
    for sums in state.pilot.iter().chain(&state.counted) {
        bytes.extend(sums.count.to_le_bytes());
        for value in sums.mean.to_array().into_iter().chain(sums.square.to_array()) {
            bytes.extend(value.to_le_bytes());
        }
    }
    let hash: [u8; HASH] = Sha256::digest(&bytes).into();
    bytes.extend(hash);
    bytes
}

/// The state in a whole and fitting file.
fn decode(bytes: &[u8], key: &Key, points: usize) -> Option<State> {
    let (content, hash) = bytes.split_at_checked(bytes.len().checked_sub(HASH)?)?;
    if <[u8; HASH]>::from(Sha256::digest(content)) != hash {
        return None;
    }
    let content = content.strip_prefix(MAGIC)?.strip_prefix(&key.0)?;
    let (passes, content) = content.split_first_chunk::<4>()?;
    let (count, records) = content.split_first_chunk::<8>()?;
    if u64::from_le_bytes(*count) != points as u64 || records.len() != 2 * RECORD * points {
        return None;
    }
    let sums = records.as_chunks::<RECORD>().0.iter().map(|record| {
        let (count, numbers) = record.split_first_chunk::<4>()?;
        let numbers = numbers.as_chunks::<8>().0;
        let vector = |first: usize| DVec3::from_array([0, 1, 2].map(|axis| f64::from_le_bytes(numbers[first + axis])));
        Some(Sums { count: u32::from_le_bytes(*count), mean: vector(0), square: vector(3) })
    });
    let mut pilot: Vec<Sums> = sums.collect::<Option<_>>()?;
    let counted = pilot.split_off(points);
    Some(State { passes: u32::from_le_bytes(*passes), pilot, counted })
}
