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
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, SyncSender, channel, sync_channel};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use pyo3::prelude::*;
use railsim::Result;
use railsim::run::Control;
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

/// Runs `work(case, control)` for every case on `jobs` threads. A case is taken from `cases` when a thread is free for it, on
/// that thread and by one thread at a time; its index counts from 0.
///
/// # Errors
/// What `cases` or the listener raised, `KeyboardInterrupt` from a signal, or `InternalError` when no threads could
/// be made. Failures of single cases go to the listener.
pub fn enter<C, I, L, W>(
    py: Python<'_>,
    cases: I,
    jobs: NonZeroUsize,
    work: W,
    listener: &mut L,
) -> PyResult<()>
where
    C: Send,
    I: Iterator<Item = PyResult<C>> + Send,
    L: Listener,
    W: Fn(C, &dyn Control) -> Result<L::Output> + Sync,
{
    let stop = AtomicBool::new(false);
    let slots: Vec<Slot> = (0..jobs.get()).map(|_| Slot { stop: &stop, state: Mutex::default() }).collect();
    let queue = Mutex::new(cases.enumerate().fuse());
    py.detach(|| {
        let pool = ThreadPoolBuilder::new()
            .num_threads(jobs.get())
            .thread_name(|i| format!("railsim-{i}"))
            .build()
            .map_err(|e| InternalError::new_err(format!("no worker threads: {e}")))?;
        let (sender, receiver) = channel();
        // The scope joins every worker before it returns, whatever happened in it.
        pool.in_place_scope_fifo(|scope| {
            for slot in &slots {
                let (sender, work, queue) = (sender.clone(), &work, &queue);
                scope.spawn_fifo(move |_| slot.serve(queue, work, &sender));
            }
            drop(sender);
            attend(receiver, &slots, listener).inspect_err(|_| stop.store(true, Ordering::Relaxed))
        })
    })
}

/// A finished case, or why there is no next one, and what its worker waits on: dropped when that has been dealt with.
type Handed<T> = (PyResult<Finished<T>>, SyncSender<()>);

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
                Python::attach(|py| listener.done(py, finished?))?;
                drop(taken);
            }
            Err(RecvTimeoutError::Timeout) => {}
            Err(RecvTimeoutError::Disconnected) => return Ok(()),
        }
        if Instant::now() >= next {
            Python::attach(|py| {
                py.check_signals()?;
                for (index, progress) in slots.iter().filter_map(Slot::news) {
                    listener.progress(py, index, progress)?;
                }
                Ok::<(), PyErr>(())
            })?;
            next = Instant::now() + POLL;
        }
    }
}

/// Where a worker leaves word of its case and how far that is.
struct Slot<'a> {
    stop: &'a AtomicBool,
    state: Mutex<State>,
}

#[derive(Default)]
struct State {
    running: Option<(usize, Instant)>,
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

    /// Takes cases, one after another, until there are no more or nobody listens.
    fn serve<C, T>(
        &self,
        queue: &Mutex<impl Iterator<Item = (usize, PyResult<C>)>>,
        work: &impl Fn(C, &dyn Control) -> Result<T>,
        sender: &Sender<Handed<T>>,
    ) {
        while !self.stop() {
            // Let go of before the case runs; an iterator that has panicked is not asked again.
            let Ok(taken) = queue.lock().map(|mut queue| queue.next()) else { return };
            let Some((index, case)) = taken else { return };
            let finished = case.map(|case| self.run(index, || work(case, self)));
            let (dealt, wait) = sync_channel::<()>(0);
            if sender.send((finished, dealt)).is_err() {
                return; // an exception: the result is not wanted any more
            }
            // Until the listener has dealt with it and lets go of `dealt`: no more than `jobs` results wait in memory, and
            // `jobs` threads are all that works.
            let _ = wait.recv();
        }
    }

    fn run<T>(&self, index: usize, work: impl FnOnce() -> Result<T>) -> Finished<T> {
        let begun = Instant::now();
        *self.state() = State { running: Some((index, begun)), ..State::default() };
        let result = match catch_unwind(AssertUnwindSafe(work)) {
            Ok(result) => result.map_err(Failure::from),
            Err(payload) => Err(Failure::Panic(message(payload.as_ref()))),
        };
        self.state().running = None;
        Finished { index, result, wall_s: begun.elapsed().as_secs_f64() }
    }

    /// Which case is on its way and how far it is, when it has moved since the last question.
    fn news(&self) -> Option<(usize, Progress)> {
        let mut state = self.state();
        let (index, begun) = state.running?;
        if !std::mem::take(&mut state.news) {
            return None;
        }
        let elapsed = begun.elapsed().as_secs_f64();
        let real_time_factor = if elapsed > 0.0 { state.t / elapsed } else { 0.0 };
        Some((index, Progress { fraction: state.fraction, distance: state.s, real_time_factor }))
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
