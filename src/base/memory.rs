//! Memory: what a person allows the solver, and what the machine has.

use std::fmt;
use std::str::FromStr;
use std::sync::OnceLock;

use serde::{Deserialize, Serialize};
use sysinfo::{MemoryRefreshKind, ProcessRefreshKind, ProcessesToUpdate, RefreshKind, System};

/// The share of the machine's memory that is used where nobody says anything: the rest is for the
/// graphics driver, for loading and for other programs.
const USUAL_SHARE: f64 = 0.6;

/// Memory that a machine is taken to have where the system does not tell, bytes.
const UNKNOWN_MACHINE: u64 = 4 << 30;

/// Least budget that can be asked for, bytes; the smallest scene needs some of it.
pub const LEAST_BYTES: u64 = 1 << 20;

/// Units that a size may be written in, and their bytes.
const UNITS: [(&str, u64); 8] = [
    ("TiB", 1 << 40),
    ("GiB", 1 << 30),
    ("MiB", 1 << 20),
    ("KiB", 1 << 10),
    ("TB", 1_000_000_000_000),
    ("GB", 1_000_000_000),
    ("MB", 1_000_000),
    ("KB", 1_000),
];

/// Memory that a solve may use: `60%` of what the machine has, or `4GiB`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "String", into = "String")]
pub enum MemoryBudget {
    /// A share of what the machine has, 0..=1.
    Share(f64),
    /// Bytes.
    Bytes(u64),
}

impl Default for MemoryBudget {
    fn default() -> Self {
        Self::Share(USUAL_SHARE)
    }
}

impl MemoryBudget {
    /// The budget in bytes on this machine.
    pub fn bytes(self) -> u64 {
        match self {
            Self::Share(share) => (share * machine_memory() as f64) as u64,
            Self::Bytes(bytes) => bytes,
        }
    }

    /// The budget as a share of what this machine has.
    pub fn share(self) -> f64 {
        match self {
            Self::Share(share) => share,
            Self::Bytes(bytes) => bytes as f64 / machine_memory() as f64,
        }
    }

    /// Whether it can be used: more than nothing, and as a share no more than all.
    pub fn is_usable(self) -> bool {
        match self {
            Self::Share(share) => share > 0.0 && share <= 1.0,
            Self::Bytes(bytes) => bytes >= LEAST_BYTES,
        }
    }
}

impl fmt::Display for MemoryBudget {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::Share(share) => write!(f, "{}%", 100.0 * share),
            Self::Bytes(bytes) => {
                let whole = UNITS[..4].iter().find(|(_, size)| bytes >= *size && bytes % size == 0);
                match whole {
                    Some((unit, size)) => write!(f, "{}{unit}", bytes / size),
                    None => write!(f, "{bytes}"),
                }
            }
        }
    }
}

impl From<MemoryBudget> for String {
    fn from(budget: MemoryBudget) -> Self {
        budget.to_string()
    }
}

impl TryFrom<String> for MemoryBudget {
    type Error = String;

    fn try_from(text: String) -> Result<Self, String> {
        text.parse()
    }
}

impl FromStr for MemoryBudget {
    type Err = String;

    /// Reads `60%`, `4GiB`, `1.5 GB` or a number of bytes.
    fn from_str(text: &str) -> Result<Self, String> {
        let text = text.trim();
        let wrong = || "it must be a size such as 4GiB or a share of the machine's memory such as 60%".to_owned();
        let number =
            |digits: &str| digits.trim().parse::<f64>().ok().filter(|value| value.is_finite() && *value >= 0.0);
        if let Some(percent) = text.strip_suffix('%') {
            return number(percent).map(|percent| Self::Share(percent / 100.0)).ok_or_else(wrong);
        }
        let lower = text.to_lowercase();
        for (unit, size) in UNITS {
            if let Some(digits) = lower.strip_suffix(&unit.to_lowercase()) {
                // The cast saturates; more than any machine has is as good as all.
                return number(digits).map(|value| Self::Bytes((value * size as f64) as u64)).ok_or_else(wrong);
            }
        }
        text.parse().map(Self::Bytes).map_err(|_| wrong())
    }
}

/// Memory that this machine has, or that the process may have of it where a control group limits
/// it, bytes; looked up once.
pub fn machine_memory() -> u64 {
    static MEMORY: OnceLock<u64> = OnceLock::new();
    *MEMORY.get_or_init(|| look_up().filter(|bytes| *bytes > 0).unwrap_or(UNKNOWN_MACHINE))
}

fn look_up() -> Option<u64> {
    let ram = RefreshKind::nothing().with_memory(MemoryRefreshKind::nothing().with_ram());
    let mut system = System::new_with_specifics(ram).ok()?;
    let total = system.total_memory();
    let id = sysinfo::get_current_pid().ok();
    let limit = id.and_then(|id| {
        system.refresh_processes_specifics(ProcessesToUpdate::Some(&[id]), false, ProcessRefreshKind::nothing());
        system.process(id)?.cgroup_limits().map(|limits| limits.total_memory)
    });
    let limit = limit.filter(|limit| *limit > 0).unwrap_or(u64::MAX);
    Some(if total > 0 { total.min(limit) } else { limit }).filter(|bytes| *bytes < u64::MAX)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Truth: what people write, and what is written is read again.
    #[test]
    fn budgets_are_read_and_written() {
        for (text, budget, again) in [
            ("60%", MemoryBudget::Share(0.6), "60%"),
            ("4GiB", MemoryBudget::Bytes(4 << 30), "4GiB"),
            ("1.5 gib", MemoryBudget::Bytes(3 << 29), "1536MiB"),
            ("2GB", MemoryBudget::Bytes(2_000_000_000), "1953125KiB"),
            ("1048577", MemoryBudget::Bytes(1_048_577), "1048577"),
        ] {
            assert_eq!(text.parse(), Ok(budget), "{text}");
            assert_eq!(budget.to_string(), again);
            assert_eq!(again.parse(), Ok(budget));
        }
        for text in ["", "%", "much", "-1GiB", "NaN%", "4 XiB", "1e99999GiB"] {
            assert!(text.parse::<MemoryBudget>().is_err(), "{text}");
        }
        for text in ["0%", "101%", "0", "1KiB"] {
            assert!(!text.parse::<MemoryBudget>().is_ok_and(MemoryBudget::is_usable), "{text}");
        }
    }

    /// Truth: what the system itself says of the machine; a group's limit can only be less.
    #[test]
    #[cfg(target_os = "linux")]
    fn the_machine_has_no_more_than_it_says() {
        let text = std::fs::read_to_string("/proc/meminfo").expect("the system tells");
        let line = text.lines().find(|line| line.starts_with("MemTotal:")).expect("a total");
        let total: u64 = line.split_whitespace().nth(1).and_then(|kib| kib.parse().ok()).expect("a number");
        let memory = machine_memory();
        assert!(memory > 64 << 20 && memory <= total << 10, "{memory} of {total} KiB");
        assert_eq!(MemoryBudget::Share(0.5).bytes(), memory / 2);
        assert!((MemoryBudget::Bytes(memory / 4).share() - 0.25).abs() < 1e-9);
    }
}
