//! Work on a pool of threads whose panics become sentences.

use std::panic::{AssertUnwindSafe, catch_unwind};

use rayon::ThreadPool;

use super::loader::panic_message;
use crate::base::threads::{pool, within};

/// Runs work on the pool; a panic becomes a sentence, so that the thread lives on.
pub(super) fn guarded<T: Send>(
    pool: Option<&ThreadPool>,
    work: impl FnOnce() -> Result<T, String> + Send,
) -> Result<T, String> {
    let result = catch_unwind(AssertUnwindSafe(|| within(pool, work)));
    result.unwrap_or_else(|panic| Err(panic_message(&*panic).to_owned()))
}

/// A pool of so many threads, 0 for every core; without one, rayon's own serves.
pub(super) fn pool_of(threads: u32) -> Option<ThreadPool> {
    pool("solver", threads as usize).ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_panic_on_the_pool_is_a_sentence_and_the_pool_lives_on() {
        let pool = pool_of(2);
        let broken: Result<(), String> = guarded(pool.as_ref(), || panic!("wave {} is empty", 7));
        assert_eq!(broken, Err("wave 7 is empty".to_owned()));
        assert_eq!(guarded(pool.as_ref(), || Ok(rayon::current_num_threads())), Ok(2));
    }
}
