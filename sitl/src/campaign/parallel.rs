//! The same work on many items, on a few threads, results in the order of the items.

use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError, mpsc};

/// Runs `work` on every item on `jobs` threads; `each` is called with every result as it ends.
pub fn map<T: Sync, R: Send>(
    items: &[T],
    jobs: usize,
    work: impl Fn(&T) -> R + Sync,
    mut each: impl FnMut(&R),
) -> Vec<R> {
    let slots: Vec<Mutex<Option<R>>> = items.iter().map(|_| Mutex::new(None)).collect();
    let fill = |index: usize| {
        if let (Some(item), Some(slot)) = (items.get(index), slots.get(index)) {
            let result = work(item);
            *open(slot) = Some(result);
        }
    };
    run(items.len(), jobs, &fill, &mut |index| {
        if let Some(result) = slots.get(index).map(open).as_deref().and_then(Option::as_ref) {
            each(result);
        }
    });
    let results = slots.into_iter().map(Mutex::into_inner);
    results.filter_map(|slot| slot.unwrap_or_else(PoisonError::into_inner)).collect()
}

fn open<T>(slot: &Mutex<T>) -> MutexGuard<'_, T> {
    slot.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Threads and the channel between them, by index: compiled once, not for every type of result.
fn run(count: usize, jobs: usize, work: &(dyn Fn(usize) + Sync), ended: &mut dyn FnMut(usize)) {
    let next = AtomicUsize::new(0);
    let (send, receive) = mpsc::channel();
    std::thread::scope(|scope| {
        for _ in 0..jobs.max(1) {
            let (send, next) = (send.clone(), &next);
            scope.spawn(move || {
                loop {
                    let index = next.fetch_add(1, Ordering::Relaxed);
                    if index >= count {
                        break;
                    }
                    work(index);
                    if send.send(index).is_err() {
                        break;
                    }
                }
            });
        }
        drop(send);
        receive.iter().for_each(ended);
    });
}

/// As many threads as this machine has cores.
#[must_use]
pub fn cores() -> usize {
    std::thread::available_parallelism().map_or(1, usize::from)
}
