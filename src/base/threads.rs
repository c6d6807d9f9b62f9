//! What the threads beside the solver's have in common.

use std::sync::{Mutex, MutexGuard, PoisonError};
use std::thread;

use rayon::{ThreadPool, ThreadPoolBuilder};

/// Locks; a thread that panicked while it held the lock left a whole value behind, since all of ours only swap or set.
pub fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// A pool of half of the machine's threads: the solver has all of them, and the two share. Without one, rayon's own serves.
pub fn half_pool(name: &'static str) -> Option<ThreadPool> {
    let threads = thread::available_parallelism().map_or(1, |count| count.get().div_ceil(2));
    ThreadPoolBuilder::new().num_threads(threads).thread_name(move |index| format!("{name}-{index}")).build().ok()
}
