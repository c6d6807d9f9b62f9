//! Locks, pools of threads, and work on a thread of its own that answers once.

use std::sync::mpsc::{Receiver, TryRecvError, channel};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::task::Poll;
use std::thread::{self, Builder};

use rayon::{ThreadPool, ThreadPoolBuildError, ThreadPoolBuilder};
use thread_priority::{ThreadPriority, ThreadPriorityValue};

/// Priority of threads that give way, of 100; about half is usual.
const BACKGROUND: u8 = 25;

/// Locks; a thread that panicked while it held the lock left a whole value behind, since all of
/// ours only swap or set.
pub fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// A pool of so many threads, 0 for every core.
///
/// # Errors
/// The system gives no further threads.
pub fn pool(name: &'static str, threads: usize) -> Result<ThreadPool, ThreadPoolBuildError> {
    ThreadPoolBuilder::new().num_threads(threads).thread_name(move |index| format!("{name}-{index}")).build()
}

/// A pool of so many threads, 0 for every core, that give way to all others of the program: where
/// cores are short, frames and commands come first.
///
/// # Errors
/// The system gives no further threads.
pub fn background_pool(name: &'static str, threads: usize) -> Result<ThreadPool, ThreadPoolBuildError> {
    let give_way = |_| {
        // A system that does not let threads give way runs them alike.
        let _ = ThreadPriorityValue::try_from(BACKGROUND)
            .map(|value| ThreadPriority::Crossplatform(value).set_for_current());
    };
    ThreadPoolBuilder::new()
        .num_threads(threads)
        .thread_name(move |index| format!("{name}-{index}"))
        .start_handler(give_way)
        .build()
}

/// A pool of half of the machine's threads that gives way to the solver's, which has all of them.
/// Without one, rayon's own serves.
pub fn half_pool(name: &'static str) -> Option<ThreadPool> {
    background_pool(name, thread::available_parallelism().map_or(1, |count| count.get().div_ceil(2))).ok()
}

/// Works on a pool; without one, on rayon's own.
pub fn within<T: Send>(pool: Option<&ThreadPool>, work: impl FnOnce() -> T + Send) -> T {
    match pool {
        Some(pool) => pool.install(work),
        None => work(),
    }
}

/// Work on a thread of its own that answers once.
pub struct Background<T>(Receiver<T>);

impl<T: Send + 'static> Background<T> {
    /// Starts the work; `wake` is called on its thread once the answer is there.
    ///
    /// # Errors
    /// The system gives no further thread.
    pub fn start(
        name: &str,
        wake: impl FnOnce() + Send + 'static,
        work: impl FnOnce() -> T + Send + 'static,
    ) -> std::io::Result<Self> {
        let (answer, answers) = channel();
        let work = move || {
            // Nobody may wait any more.
            let _ = answer.send(work());
            wake();
        };
        Builder::new().name(name.into()).spawn(work)?;
        Ok(Self(answers))
    }

    /// The answer, once it is there; nothing where the work panicked. It comes once.
    pub fn poll(&self) -> Poll<Option<T>> {
        match self.0.try_recv() {
            Ok(answer) => Poll::Ready(Some(answer)),
            Err(TryRecvError::Empty) => Poll::Pending,
            Err(TryRecvError::Disconnected) => Poll::Ready(None),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Truth: what Linux says of the thread; 0 is usual, 19 the least.
    #[cfg(target_os = "linux")]
    #[test]
    fn threads_of_the_background_give_way() {
        let niceness = || {
            let stat = std::fs::read_to_string("/proc/thread-self/stat").expect("Linux tells");
            let after_name = stat.rsplit(')').next().expect("a name in brackets").to_owned();
            after_name.split_whitespace().nth(16).and_then(|field| field.parse::<i32>().ok()).expect("a number")
        };
        let usual = niceness();
        let found = background_pool("background", 1).expect("a thread").install(niceness);
        assert!(found > usual.min(18), "{found} instead of {usual}");
    }
}
