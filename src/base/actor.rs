//! A thread that answers questions: asks go in, of which several may be taken up at once, and a
//! small report comes out.

use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, TryRecvError, channel};
use std::sync::{Arc, Mutex};
use std::thread::Builder;
use std::time::Duration;

use rayon::ThreadPool;

use super::cancel::CancelToken;
use super::threads::{half_pool, lock, within};

/// The owner's end of such a thread, which never makes its owner wait; dropping it cancels what the
/// thread is about and ends it.
pub struct Actor<Ask, Report> {
    inbox: Option<Sender<Ask>>,
    report: Arc<Mutex<Report>>,
    cancel: CancelToken,
}

/// The thread's end: its inbox, its report, and half of the machine's threads to work on.
pub struct Desk<Ask, Report> {
    inbox: Receiver<Ask>,
    /// Asks that came, and are not taken up yet.
    waiting: Vec<Ask>,
    has_owner: bool,
    report: Arc<Mutex<Report>>,
    wake: Box<dyn Fn() + Send>,
    pool: Option<ThreadPool>,
    /// Cancelled by the owner where the present work is not wanted any more.
    pub cancel: CancelToken,
}

impl<Ask: Send + 'static, Report: Clone + Default + Send + 'static> Actor<Ask, Report> {
    /// Starts the thread. `wake` is called on it whenever the report changes; it must not block.
    ///
    /// # Errors
    /// The system gives no further thread.
    pub fn spawn(
        name: &'static str,
        wake: Box<dyn Fn() + Send>,
        run: impl FnOnce(Desk<Ask, Report>) + Send + 'static,
    ) -> std::io::Result<Self> {
        let (sender, inbox) = channel();
        let (report, cancel) = (Arc::new(Mutex::new(Report::default())), CancelToken::new());
        let (of_desk, token) = (report.clone(), cancel.clone());
        let work = move || {
            let pool = half_pool(name);
            run(Desk { inbox, waiting: Vec::new(), has_owner: true, report: of_desk, wake, pool, cancel: token });
        };
        Builder::new().name(name.into()).spawn(work)?;
        Ok(Self { inbox: Some(sender), report, cancel })
    }

    /// Asks something; returns at once.
    pub fn ask(&self, ask: Ask) {
        // Only a panic ends the thread before its owner; the report then stays as it is.
        let _ = self.inbox.as_ref().map(|inbox| inbox.send(ask));
    }

    /// Asks something in place of what the thread is about.
    pub fn ask_instead(&self, ask: Ask) {
        self.ask(ask);
        self.cancel.cancel();
    }

    /// The thread's report as it is now.
    pub fn report(&self) -> Report {
        lock(&self.report).clone()
    }
}

impl<Ask, Report> Drop for Actor<Ask, Report> {
    fn drop(&mut self) {
        self.inbox = None;
        self.cancel.cancel();
    }
}

impl<Ask, Report> Desk<Ask, Report> {
    /// All asks that wait; where there are none, waits for one so long, or without a time as long
    /// as it takes. `None` once the owner is gone.
    pub fn take(&mut self, patience: Option<Duration>) -> Option<Vec<Ask>> {
        if self.waiting.is_empty() {
            let first = match patience {
                Some(patience) => self.inbox.recv_timeout(patience),
                None => self.inbox.recv().map_err(|_| RecvTimeoutError::Disconnected),
            };
            match first {
                Ok(ask) => self.waiting.push(ask),
                Err(RecvTimeoutError::Timeout) => {}
                Err(RecvTimeoutError::Disconnected) => return None,
            }
        }
        self.cancel.reset();
        self.collect();
        self.has_owner.then(|| std::mem::take(&mut self.waiting))
    }

    /// The asks that wait, to be looked through or taken in the middle of work, and whether there
    /// is an owner still.
    pub fn waiting(&mut self) -> (&mut Vec<Ask>, bool) {
        self.collect();
        (&mut self.waiting, self.has_owner)
    }

    fn collect(&mut self) {
        loop {
            match self.inbox.try_recv() {
                Ok(ask) => self.waiting.push(ask),
                Err(TryRecvError::Empty) => return,
                Err(TryRecvError::Disconnected) => {
                    self.has_owner = false;
                    return;
                }
            }
        }
    }

    /// Changes the report and wakes the owner.
    pub fn tell(&self, change: impl FnOnce(&mut Report)) {
        change(&mut lock(&self.report));
        (self.wake)();
    }

    /// Works on the thread's pool.
    pub fn work<T: Send>(&self, work: impl FnOnce() -> T + Send) -> T {
        within(self.pool.as_ref(), work)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Truth: the order of what was asked; asks that come during work wait, and an owner who goes
    /// ends the thread, which hears the token.
    #[test]
    fn asks_are_taken_up_in_order_until_the_owner_goes() {
        let (done, heard) = channel();
        let actor: Actor<u32, Vec<u32>> =
            Actor::spawn("test", Box::new(|| {}), move |mut desk: Desk<u32, Vec<u32>>| {
                let mut ends_by_token = false;
                while let Some(asks) = desk.take(None) {
                    for ask in asks {
                        desk.tell(|report| report.push(ask));
                        while ask == 3 && !desk.cancel.is_cancelled() {
                            std::thread::yield_now();
                        }
                        ends_by_token = desk.cancel.is_cancelled();
                    }
                }
                let _ = done.send(ends_by_token);
            })
            .expect("a thread");
        for ask in [1, 2, 3] {
            actor.ask(ask);
        }
        while actor.report().len() < 3 {
            std::thread::yield_now();
        }
        assert_eq!(actor.report(), [1, 2, 3]);
        actor.ask(4);
        drop(actor);
        assert_eq!(heard.recv(), Ok(true), "the token ended the work on 3, and 4 was not begun");
    }

    #[test]
    fn asks_can_be_looked_through_while_others_wait() {
        let (sender, inbox) = channel();
        let report = Arc::new(Mutex::new(()));
        let cancel = CancelToken::new();
        let mut desk =
            Desk { inbox, waiting: Vec::new(), has_owner: true, report, wake: Box::new(|| {}), pool: None, cancel };
        assert_eq!(desk.take(Some(Duration::ZERO)), Some(vec![]));
        (0..3).for_each(|ask| sender.send(ask).expect("the desk is there"));
        let (waiting, has_owner) = desk.waiting();
        assert_eq!((&waiting[..], has_owner), (&[0, 1, 2][..], true));
        waiting.remove(1);
        assert_eq!(desk.take(None), Some(vec![0, 2]));
        drop(sender);
        assert_eq!(desk.take(None), None);
    }
}
