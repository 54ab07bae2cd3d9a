//! Ends of what would take too long, by the clock.

use std::process;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{RecvTimeoutError, Sender, channel};
use std::thread;
use std::time::Duration;

/// Does some work, and sets a flag when that takes longer than this.
pub fn flagged<T>(limit: Duration, flag: &AtomicBool, work: impl FnOnce() -> T) -> T {
    let (done, wait) = channel::<()>();
    thread::scope(|scope| {
        scope.spawn(move || {
            if wait.recv_timeout(limit) == Err(RecvTimeoutError::Timeout) {
                flag.store(true, Ordering::Relaxed);
            }
        });
        let result = work();
        drop(done);
        result
    })
}

/// The end of the process with this code, after the last words, unless what is given back is dropped before. For commands that
/// write no files.
pub fn or_end(limit: Duration, code: u8, last_words: impl FnOnce() + Send + 'static) -> Sender<()> {
    let (done, wait) = channel::<()>();
    thread::spawn(move || {
        if wait.recv_timeout(limit) == Err(RecvTimeoutError::Timeout) {
            last_words();
            process::exit(code.into());
        }
    });
    done
}

#[cfg(test)]
mod tests {
    use std::time::Instant;

    use super::*;

    #[test]
    fn a_flag_is_set_when_time_is_over_and_not_before() {
        let flag = AtomicBool::new(false);
        assert_eq!(flagged(Duration::from_secs(60), &flag, || 7), 7);
        assert!(!flag.load(Ordering::Relaxed));
        let start = Instant::now();
        let turns = flagged(Duration::from_millis(20), &flag, || {
            (0u64..).find(|_| flag.load(Ordering::Relaxed) || start.elapsed().as_secs() > 30)
        });
        assert!(turns.is_some() && flag.load(Ordering::Relaxed));
        assert!(start.elapsed() >= Duration::from_millis(20));
    }
}
