//! The one door for long work.
//!
//! Releases the GIL, runs the cases on a pool of `jobs` threads, and meanwhile attends to Python on the
//! calling thread: progress and finished cases go to callbacks, Ctrl-C is polled. An exception there, from a
//! callback or from a signal, raises the flag that the step loops read; it leaves only after every worker
//! has come home. A panic in a case is that case's failure and nobody else's.

use std::any::Any;
use std::num::NonZeroUsize;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError, SyncSender, channel, sync_channel};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use pyo3::prelude::*;
use railsim::run::Control;
use railsim::{Error, Result};
use rayon::ThreadPoolBuilder;

use crate::errors::{Failure, InternalError};

/// Time between two looks at signals and progress. Ctrl-C is to stop a run within a second; a terminal shows
/// no more than ten changes a second anyway.
const POLL: Duration = Duration::from_millis(100);

/// How far a case has come.
#[derive(Debug, Clone, Copy)]
pub struct Progress {
    /// Share of the case that is done, 0 to 1.
    pub fraction: f64,
    /// Distance of the vehicle, m.
    pub distance: f64,
    /// Simulated seconds for each second that passed since the case began.
    pub real_time_factor: f64,
}

/// A case that has ended, in its own slot.
pub struct Finished<T> {
    /// Its place in the list of cases.
    pub index: usize,
    /// What it gave.
    pub result: std::result::Result<T, Failure>,
    /// Time from begin to end, s.
    pub wall_s: f64,
}

/// What the calling thread does while the workers work; a failure of either function stops everything.
pub trait Listener: Send {
    /// What a case gives.
    type Output: Send;
    /// A case has moved on.
    fn progress(&mut self, py: Python<'_>, index: usize, progress: Progress) -> PyResult<()>;
    /// A case has ended.
    fn done(&mut self, py: Python<'_>, finished: Finished<Self::Output>) -> PyResult<()>;
}

/// Runs `work(index, control)` for every index below `count` on `jobs` threads.
///
/// # Errors
/// Whatever the listener raised, `KeyboardInterrupt` from a signal, or `InternalError` when no threads could
/// be made. Failures of single cases go to the listener.
pub fn enter<L, W>(
    py: Python<'_>,
    count: usize,
    jobs: NonZeroUsize,
    work: W,
    listener: &mut L,
) -> PyResult<()>
where
    L: Listener,
    W: Fn(usize, &dyn Control) -> Result<L::Output> + Sync,
{
    let stop = AtomicBool::new(false);
    let slots: Vec<Slot> = (0..count).map(|_| Slot { stop: &stop, state: Mutex::default() }).collect();
    py.detach(|| {
        let pool = ThreadPoolBuilder::new()
            .num_threads(jobs.get().min(count.max(1)))
            .thread_name(|i| format!("railsim-{i}"))
            .build()
            .map_err(|e| InternalError::new_err(format!("no worker threads: {e}")))?;
        let (sender, receiver) = channel::<Handed<L::Output>>();
        // The scope joins every worker before it returns, whatever happened in it.
        pool.in_place_scope_fifo(|scope| {
            for (index, slot) in slots.iter().enumerate() {
                let (sender, work) = (sender.clone(), &work);
                scope.spawn_fifo(move |_| {
                    let finished = slot.run(index, work);
                    let (taken, wait) = sync_channel::<()>(0);
                    // Nobody listens any more after an exception; the result is not wanted then.
                    if sender.send((finished, taken)).is_ok() {
                        // Until the listener has dealt with it and lets go of `taken`: no more than `jobs` results
                        // wait in memory, and `jobs` threads are all that works.
                        let _ = wait.recv();
                    }
                });
            }
            drop(sender);
            attend(receiver, &slots, listener).inspect_err(|_| stop.store(true, Ordering::Relaxed))
        })
    })
}

/// A finished case, and what its worker waits on: dropped when the case has been dealt with.
type Handed<T> = (Finished<T>, SyncSender<()>);

/// Serves the listener until every worker has hung up. Takes the receiver along when it leaves: workers that wait for their
/// result to be dealt with are let go.
fn attend<L: Listener>(
    receiver: Receiver<Handed<L::Output>>,
    slots: &[Slot<'_>],
    listener: &mut L,
) -> PyResult<()> {
    let mut next = Instant::now() + POLL;
    loop {
        match receiver.recv_timeout(next.saturating_duration_since(Instant::now())) {
            Ok((finished, taken)) => {
                Python::attach(|py| listener.done(py, finished))?;
                drop(taken);
            }
            Err(RecvTimeoutError::Timeout) => {}
            Err(RecvTimeoutError::Disconnected) => return Ok(()),
        }
        if Instant::now() >= next {
            Python::attach(|py| {
                py.check_signals()?;
                for (index, slot) in slots.iter().enumerate() {
                    if let Some(progress) = slot.news() {
                        listener.progress(py, index, progress)?;
                    }
                }
                Ok::<(), PyErr>(())
            })?;
            next = Instant::now() + POLL;
        }
    }
}

/// Where a worker leaves word of how far its case is.
struct Slot<'a> {
    stop: &'a AtomicBool,
    state: Mutex<State>,
}

#[derive(Default)]
struct State {
    begun: Option<Instant>,
    ended: bool,
    news: bool,
    t: f64,
    s: f64,
    fraction: f64,
}

impl Slot<'_> {
    fn state(&self) -> MutexGuard<'_, State> {
        // Plain numbers: they are whole even where a holder of the lock has panicked.
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn run<T>(&self, index: usize, work: &(impl Fn(usize, &dyn Control) -> Result<T> + Sync)) -> Finished<T> {
        let begun = Instant::now();
        self.state().begun = Some(begun);
        let result = if self.stop() {
            Err(Error::Interrupted.into())
        } else {
            match catch_unwind(AssertUnwindSafe(|| work(index, self))) {
                Ok(result) => result.map_err(Failure::from),
                Err(payload) => Err(Failure::Panic(message(payload.as_ref()))),
            }
        };
        self.state().ended = true;
        Finished { index, result, wall_s: begun.elapsed().as_secs_f64() }
    }

    /// How far the case is, when it has moved since the last question and is still on its way.
    fn news(&self) -> Option<Progress> {
        let mut state = self.state();
        let begun = state.begun?;
        if !state.news || state.ended {
            return None;
        }
        state.news = false;
        let elapsed = begun.elapsed().as_secs_f64();
        let real_time_factor = if elapsed > 0.0 { state.t / elapsed } else { 0.0 };
        Some(Progress { fraction: state.fraction, distance: state.s, real_time_factor })
    }
}

impl Control for Slot<'_> {
    fn progress(&self, t: f64, s: f64, fraction: f64) {
        let mut state = self.state();
        (state.t, state.s, state.fraction, state.news) = (t, s, fraction, true);
    }

    fn stop(&self) -> bool {
        self.stop.load(Ordering::Relaxed)
    }
}

/// The words of a panic.
fn message(payload: &(dyn Any + Send)) -> String {
    let text = payload.downcast_ref::<&str>().map(ToString::to_string);
    text.or_else(|| payload.downcast_ref::<String>().cloned()).unwrap_or_else(|| "panic".to_owned())
}
