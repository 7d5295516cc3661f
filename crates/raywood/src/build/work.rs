//! How far a build is, and the wish to stop it: what every stage of a build is handed beside its options.

use std::ops::{ControlFlow, Range};
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering::Relaxed};

use crate::{BuildError, parallel};

/// The units of work of a whole build. Shares are rounded down to units, so many that nobody sees it.
const WHOLE: u64 = 1 << 40;

/// How many simple steps a stretch has: some milliseconds on one thread, and enough for many.
const STRETCH: usize = 1 << 18;

/// A share of a build's work, and whom to report to, if anybody.
///
/// Who does the work divides its share among its parts, says of each that it is [`done`](Self::done), and [`ask`](Self::ask)s in the midst of long ones, at least
/// every few milliseconds. Once either answers that the build is cancelled, whatever was made is thrown away: it need not make sense, only be made quickly.
/// Without a watcher all of this is a test for `None` a piece of work.
#[derive(Clone, Copy)]
pub(crate) struct Work<'a> {
    watch: Option<&'a Watch<'a>>,
    units: u64,
}

/// The watcher asked to stop, or panicked.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Cancelled;

impl From<Cancelled> for BuildError {
    fn from(_: Cancelled) -> Self {
        Self::Cancelled
    }
}

/// What all threads share of a build that is watched.
struct Watch<'a> {
    /// Tells the watcher how much is done, unless another thread is just doing so.
    tell: &'a (dyn Fn(&AtomicU64) -> ControlFlow<()> + Sync),
    /// How many units are done.
    done: AtomicU64,
    is_stopped: AtomicBool,
}

/// Runs a build that is watched: `watcher` is told the share that is done, from 0 to 1 and never falling, by one thread at a time.
pub(crate) fn watched<T>(
    mut watcher: impl FnMut(f64) -> ControlFlow<()> + Send,
    build: impl FnOnce(Work<'_>) -> Result<T, BuildError>,
) -> Result<T, BuildError> {
    let mut answer = ControlFlow::Continue(());
    let watcher = Mutex::new(move |share: f64| {
        // Never again after it said to stop.
        if answer.is_continue() {
            answer = watcher(share);
        }
        answer
    });
    let tell = |done: &AtomicU64| match watcher.try_lock() {
        // Read under the lock, so that it never falls.
        Ok(mut watcher) => watcher(done.load(Relaxed).min(WHOLE) as f64 / WHOLE as f64),
        Err(_) => ControlFlow::Continue(()),
    };
    let watch = Watch { tell: &tell, done: AtomicU64::new(0), is_stopped: AtomicBool::new(false) };
    let work = Work { watch: Some(&watch), units: WHOLE };
    work.ask()?;
    let built = build(work)?;
    watch.done.store(WHOLE, Relaxed);
    work.ask()?;
    Ok(built)
}

impl Work<'_> {
    /// Of a build that nobody watches.
    pub(crate) const UNWATCHED: Self = Self { watch: None, units: 0 };

    /// Whether anybody watches.
    pub(crate) fn is_watched(self) -> bool {
        self.watch.is_some()
    }

    /// Divides it by weights, which are not negative.
    pub(crate) fn shares<const N: usize>(self, weights: [f64; N]) -> [Self; N] {
        if self.watch.is_none() {
            return [self; N];
        }
        let sum: f64 = weights.iter().sum();
        // No weight at all makes no number, which counts as none.
        weights.map(|weight| Self { units: (self.units as f64 * (weight / sum)) as u64, ..self })
    }

    /// The share of so many among all.
    pub(crate) fn part(self, some: usize, all: usize) -> Self {
        let [part, _] = self.shares([some as f64, all.saturating_sub(some) as f64]);
        part
    }

    /// The same, but nothing more is done by it.
    pub(crate) fn without_progress(self) -> Self {
        Self { units: 0, ..self }
    }

    /// Says that this share is done, and asks whether to go on.
    #[inline]
    pub(crate) fn done(self) -> Result<(), Cancelled> {
        if let Some(watch) = self.watch {
            watch.done.fetch_add(self.units, Relaxed);
        }
        self.ask()
    }

    /// Asks whether to go on. Takes as long as the watcher does.
    #[inline]
    pub(crate) fn ask(self) -> Result<(), Cancelled> {
        match self.watch {
            None => Ok(()),
            Some(watch) => watch.ask(),
        }
    }

    /// Whether to go on, as far as is known already.
    #[inline]
    pub(crate) fn check(self) -> Result<(), Cancelled> {
        match self.watch {
            Some(watch) if watch.is_stopped.load(Relaxed) => Err(Cancelled),
            _ => Ok(()),
        }
    }

    /// Has `f` do the steps from 0 to `n-1` in stretches, one after the other, which it reports; all at once if nobody watches.
    pub(crate) fn in_stretches(
        self,
        n: usize,
        f: impl FnMut(Range<usize>),
    ) -> Result<(), Cancelled> {
        self.in_stretches_of(STRETCH, n, f)
    }

    /// The same for steps that take longer, of which a stretch should have only so many.
    pub(crate) fn in_stretches_of(
        self,
        length: usize,
        n: usize,
        mut f: impl FnMut(Range<usize>),
    ) -> Result<(), Cancelled> {
        if self.watch.is_none() {
            f(0..n);
            return Ok(());
        }
        for start in (0..n).step_by(length) {
            let stretch = start..n.min(start + length);
            let part = self.part(stretch.len(), n);
            f(stretch);
            part.done()?;
        }
        Ok(())
    }

    /// So many copies of a value: of large lists it takes a while until all pages are there.
    pub(crate) fn copies<T: Copy + Send + Sync>(
        self,
        value: T,
        n: usize,
    ) -> Result<Vec<T>, Cancelled> {
        parallel::map_watched(n, self, |_| value)
    }
}

impl Watch<'_> {
    fn ask(&self) -> Result<(), Cancelled> {
        if self.is_stopped.load(Relaxed) {
            return Err(Cancelled);
        }
        // If the watcher panics, the other threads stop, and the panic goes its way.
        let on_panic = Stop(&self.is_stopped);
        let answer = (self.tell)(&self.done);
        std::mem::forget(on_panic);
        match answer {
            ControlFlow::Continue(()) => Ok(()),
            ControlFlow::Break(()) => {
                self.is_stopped.store(true, Relaxed);
                Err(Cancelled)
            }
        }
    }
}

/// Stops the build when it is dropped.
struct Stop<'a>(&'a AtomicBool);

impl Drop for Stop<'_> {
    fn drop(&mut self) {
        self.0.store(true, Relaxed);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shares_add_up_and_never_fall() {
        let mut told = Vec::new();
        let built = watched(
            |share| {
                told.push(share);
                ControlFlow::Continue(())
            },
            |work| {
                let [a, b, nothing] = work.shares([1.0, 3.0, 0.0]);
                a.done()?;
                nothing.done()?;
                let mut steps = 0;
                b.in_stretches_of(10, 25, |stretch| steps += stretch.len())?;
                assert_eq!(steps, 25);
                let [none] = b.shares([0.0]);
                none.done()?;
                Ok(7)
            },
        );
        assert_eq!(built, Ok(7));
        let expected = [0.0, 0.25, 0.25, 0.55, 0.85, 1.0, 1.0, 1.0];
        assert_eq!(told.len(), expected.len());
        for (told, expected) in told.iter().zip(expected) {
            assert!((told - expected).abs() < 1e-9, "{told} is not {expected}");
        }
        assert_eq!(told.last(), Some(&1.0));
    }

    #[test]
    fn nobody_is_asked_again_after_stopping() {
        let mut asked = 0;
        let built: Result<(), _> = watched(
            |_| {
                asked += 1;
                if asked == 2 { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
            },
            |work| {
                assert_eq!(work.check(), Ok(()));
                assert_eq!(work.ask(), Err(Cancelled));
                assert_eq!((work.check(), work.ask()), (Err(Cancelled), Err(Cancelled)));
                assert_eq!(work.copies(1, 3), Err(Cancelled));
                Ok(work.done()?)
            },
        );
        assert_eq!((built, asked), (Err(BuildError::Cancelled), 2));
    }

    #[test]
    fn without_a_watcher_all_is_done_at_once() {
        let work = Work::UNWATCHED;
        let mut stretches = Vec::new();
        work.in_stretches_of(1, 5, |stretch| stretches.push((stretch.start, stretch.end)))
            .expect("nobody stops it");
        assert_eq!(stretches, [(0, 5)]);
        assert_eq!(work.copies(2, 3), Ok(vec![2, 2, 2]));
    }
}
