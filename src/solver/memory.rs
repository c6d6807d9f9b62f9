//! Whether the links of plain hierarchical radiosity fit into memory.

use super::SolverError;
use super::link::Link;
use crate::hierarchy::ElementId;

/// Whether plain HR's links fit into memory, should every pair become one.
pub fn check_pairs_fit(patches: u64) -> Result<(), SolverError> {
    let pairs = patches * patches.saturating_sub(1);
    // A link and its receiver while it waits to be taken into the table.
    let needed = pairs * (size_of::<Link>() + size_of::<(ElementId, Link)>()) as u64;
    let available = available_memory().unwrap_or(u64::MAX);
    if needed <= available / 2 {
        return Ok(());
    }
    Err(SolverError::TooManyPairs { pairs, needed_mib: needed >> 20, available_mib: available >> 20 })
}

/// Memory that the system could give, bytes, where it tells.
fn available_memory() -> Option<u64> {
    let meminfo = std::fs::read_to_string("/proc/meminfo").ok()?;
    let line = meminfo.lines().find(|line| line.starts_with("MemAvailable:"))?;
    line.split_whitespace().nth(1)?.parse::<u64>().ok().map(|kib| kib << 10)
}
