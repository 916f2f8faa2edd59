//! Several threads at one cloth.
//!
//! A substep of a large cloth is a row of short phases (its rows, its columns, …), each of which can be done in parts of any size. Sharing
//! out every phase to a task pool would cost more than it gains, and waiting for all threads at a barrier would stand still whenever one of
//! them is busy elsewhere. So helpers are called once for a step and look for work by themselves: each thread that is free takes the next
//! part of the phase in progress. The leading thread takes parts as well, and goes on when the taken parts are done. A helper that comes
//! late, or never, is not waited for.

#![expect(
    unsafe_code,
    reason = "what a phase does borrows from the thread that leads, and helpers live longer"
)]

use std::{
    mem,
    ops::Range,
    sync::{
        Arc, Mutex, PoisonError,
        atomic::{AtomicBool, AtomicU32, AtomicU64, Ordering},
    },
    thread,
};

use bevy_tasks::ComputeTaskPool;

/// Number of parts of a phase for each thread, so that an interrupted thread does not keep the others waiting for long.
const PARTS_PER_THREAD: usize = 4;

/// Number of times that a thread looks for work before it lets others run.
const SPINS: u32 = 200;

/// Threads that work on a cloth.
#[derive(Clone, Copy, Debug)]
pub struct Workers<'a>(Option<&'a Arc<Queue>>);

/// Queue of the phases of a step.
#[derive(Debug)]
pub struct Queue {
    /// Phase in progress, in the upper half, and its next part to be taken, in the lower.
    ticket: AtomicU64,
    /// Number of parts of the phase that are done.
    done: AtomicU32,
    job: Mutex<Job>,
    open: AtomicBool,
    threads: usize,
}

/// A phase.
#[derive(Clone, Copy, Debug)]
struct Job {
    phase: u32,
    parts: u32,
    first: usize,
    last: usize,
    part: usize,
    work: Work,
}

/// Work of a phase on a part of its range.
#[derive(Clone, Copy, Debug)]
struct Work(Option<*const (dyn Fn(Range<usize>) + Sync)>);

// SAFETY: what it points to is `Sync`, and is called only as long as the leader keeps it: see `Queue::take`.
unsafe impl Send for Work {}

impl Workers<'_> {
    /// The current thread alone.
    pub const ALONE: Workers<'static> = Workers(None);

    /// Length of the parts of a range of this length, in [`Self::share`]: a multiple of 16 where there are several.
    pub fn part(self, len: usize) -> usize {
        const GRAIN: usize = 16;
        let parts = self.0.map_or(1, |queue| queue.threads * PARTS_PER_THREAD);
        len.div_ceil(parts).next_multiple_of(GRAIN).min(len)
    }

    /// Calls `work` for parts of the range that together are all of it, and returns when all are done.
    pub fn share(self, all: Range<usize>, work: impl Fn(Range<usize>) + Sync) {
        self.share_by(self.part(all.len()), all, work);
    }

    /// Shares as [`Self::share`], in parts of this length.
    pub fn share_by(self, part: usize, all: Range<usize>, work: impl Fn(Range<usize>) + Sync) {
        match self.0 {
            Some(queue) if all.len() > part => queue.run(all, part, &work),
            _ => work(all),
        }
    }

    /// Shares as [`Self::share`], and returns whether `work` returned true for any part.
    pub fn any(self, all: Range<usize>, work: impl Fn(Range<usize>) -> bool + Sync) -> bool {
        let found = AtomicBool::new(false);
        self.share(all, |range| {
            if work(range) {
                found.store(true, Ordering::Relaxed);
            }
        });
        found.into_inner()
    }
}

impl Queue {
    /// Calls as many helpers as the pool has threads, but for the one that leads, while `lead` runs with them as its workers.
    pub fn open(lead: impl FnOnce(Workers)) {
        let threads = ComputeTaskPool::try_get().map_or(1, |pool| pool.thread_num());
        Self::open_for(threads, lead);
    }

    fn open_for(threads: usize, lead: impl FnOnce(Workers)) {
        let Some(pool) = ComputeTaskPool::try_get().filter(|_| threads > 1) else {
            return lead(Workers::ALONE);
        };
        let queue = Arc::new(Queue {
            ticket: AtomicU64::new(0),
            done: AtomicU32::new(0),
            job: Mutex::new(Job {
                phase: 0,
                parts: 0,
                first: 0,
                last: 0,
                part: 0,
                work: Work(None),
            }),
            open: AtomicBool::new(true),
            threads,
        });
        let _closing = Closing(&queue);
        for _ in 1..threads {
            let queue = queue.clone();
            pool.spawn(async move { queue.help() }).detach();
        }
        lead(Workers(Some(&queue)));
    }

    /// Does parts of the phases until there are no more phases.
    fn help(&self) {
        let mut job = self.job();
        let mut idle = 0;
        while self.open.load(Ordering::Acquire) {
            let ticket = self.ticket.load(Ordering::Acquire);
            if phase_of(ticket) != job.phase {
                job = self.job();
            }
            if phase_of(ticket) == job.phase && self.take(job, ticket) {
                idle = 0;
                continue;
            }
            wait(&mut idle);
        }
    }

    fn job(&self) -> Job {
        *self.job.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Leads a phase.
    fn run(&self, all: Range<usize>, part: usize, work: &(dyn Fn(Range<usize>) + Sync)) {
        // SAFETY: only the lifetime changes. The pointer is followed by `take` alone, for parts that this function
        // waits for, also where `work` panics: then by `Ending`.
        let work: *const (dyn Fn(Range<usize>) + Sync) =
            unsafe { mem::transmute::<&(dyn Fn(Range<usize>) + Sync), &'static _>(work) };
        let phase = phase_of(self.ticket.load(Ordering::Relaxed)).wrapping_add(1);
        let job = Job {
            phase,
            parts: all.len().div_ceil(part) as u32,
            first: all.start,
            last: all.end,
            part,
            work: Work(Some(work)),
        };
        *self.job.lock().unwrap_or_else(PoisonError::into_inner) = job;
        self.done.store(0, Ordering::Relaxed);
        self.ticket.store(u64::from(phase) << 32, Ordering::Release);
        let _ending = Ending { queue: self, job };
        while self.take(job, self.ticket.load(Ordering::Acquire)) {}
    }

    /// Takes the next part of a phase and does it. Returns whether to look again.
    fn take(&self, job: Job, ticket: u64) -> bool {
        let part = ticket as u32;
        if part >= job.parts {
            return false;
        }
        let next = ticket + 1;
        let taken = self
            .ticket
            .compare_exchange(ticket, next, Ordering::AcqRel, Ordering::Relaxed);
        if taken.is_err() {
            return true;
        }
        let start = job.first + part as usize * job.part;
        let _counted = Counted(&self.done);
        if let Work(Some(work)) = job.work {
            // SAFETY: the phase had this part left when it was taken, so that the leader waits for it before the
            // work goes out of scope.
            let work = unsafe { &*work };
            work(start..(start + job.part).min(job.last));
        }
        true
    }
}

fn phase_of(ticket: u64) -> u32 {
    (ticket >> 32) as u32
}

fn wait(idle: &mut u32) {
    *idle += 1;
    if *idle < SPINS {
        std::hint::spin_loop();
    } else {
        thread::yield_now();
    }
}

/// Counts a part as done, also where it panics.
struct Counted<'a>(&'a AtomicU32);

impl Drop for Counted<'_> {
    fn drop(&mut self) {
        self.0.fetch_add(1, Ordering::Release);
    }
}

/// Waits for the parts of a phase that others took.
struct Ending<'a> {
    queue: &'a Queue,
    job: Job,
}

impl Drop for Ending<'_> {
    fn drop(&mut self) {
        let all = u64::from(self.job.phase) << 32 | u64::from(self.job.parts);
        // Where the work panicked there are parts left, which nobody is to take any more.
        let taken = self.queue.ticket.swap(all, Ordering::AcqRel) as u32;
        let taken = taken.min(self.job.parts);
        let mut idle = 0;
        while self.queue.done.load(Ordering::Acquire) < taken {
            wait(&mut idle);
        }
    }
}

/// Sends the helpers home.
struct Closing<'a>(&'a Queue);

impl Drop for Closing<'_> {
    fn drop(&mut self) {
        self.0.open.store(false, Ordering::Release);
    }
}

#[cfg(test)]
mod tests {
    use std::{panic, sync::atomic::AtomicUsize};

    use bevy_tasks::TaskPool;

    use super::*;

    fn pool() {
        ComputeTaskPool::get_or_init(TaskPool::new);
    }

    #[test]
    fn every_element_is_done_once_in_every_phase() {
        pool();
        for threads in [1, 2, 3, 8] {
            for len in [0, 1, 15, 16, 17, 1000] {
                let counts: Vec<AtomicUsize> = (0..len).map(|_| AtomicUsize::new(0)).collect();
                Queue::open_for(threads, |workers| {
                    for phase in 1..=50 {
                        workers.share(0..len, |range| {
                            for count in &counts[range] {
                                count.fetch_add(1, Ordering::Relaxed);
                            }
                        });
                        let right = |count: &AtomicUsize| count.load(Ordering::Relaxed) == phase;
                        assert!(counts.iter().all(right), "{threads} threads, {len}");
                    }
                });
            }
        }
    }

    #[test]
    fn any_finds_the_one() {
        pool();
        Queue::open_for(4, |workers| {
            assert!(workers.any(3..500, |range| range.contains(&499)));
            assert!(!workers.any(3..500, |range| range.contains(&2)));
        });
    }

    #[test]
    fn a_panic_of_the_leader_does_not_leave_work_behind() {
        pool();
        let calls = AtomicUsize::new(0);
        let result = panic::catch_unwind(panic::AssertUnwindSafe(|| {
            Queue::open_for(4, |workers| {
                let leader = thread::current().id();
                workers.share(0..10_000, |_| {
                    calls.fetch_add(1, Ordering::Relaxed);
                    assert_ne!(thread::current().id(), leader, "as is wanted here");
                });
            });
        }));
        assert!(result.is_err());
        let after = calls.load(Ordering::Relaxed);
        thread::sleep(std::time::Duration::from_millis(20));
        assert_eq!(calls.load(Ordering::Relaxed), after);
    }
}
