//! Threads for planners that work in parallel.

use super::BuildError;
#[cfg(feature = "parallel")]
use rayon::prelude::*;
use std::sync::Arc;
#[cfg(feature = "parallel")]
use std::sync::Mutex;

#[cfg(feature = "parallel")]
type Pool = rayon::ThreadPool;
/// No pool can be made.
#[cfg(not(feature = "parallel"))]
type Pool = std::convert::Infallible;

/// A pool of worker threads; clones share it. No result depends on the number of threads. Without the
/// feature `parallel` only the caller's own thread works.
#[derive(Clone, Debug)]
pub struct Workers(Option<Arc<Pool>>);

impl Workers {
    /// The most threads a pool may have.
    pub const MOST: usize = 1024;

    /// Only the caller's own thread.
    #[must_use]
    pub fn single() -> Self {
        Self(None)
    }

    /// A pool of `threads` threads.
    ///
    /// # Errors
    /// When `threads` is zero or more than [`MOST`](Self::MOST), or the system refuses them.
    pub fn new(threads: usize) -> Result<Self, BuildError> {
        match Self::checked(threads)? {
            #[cfg(feature = "parallel")]
            2.. => match rayon::ThreadPoolBuilder::new().num_threads(threads).build() {
                Ok(pool) => Ok(Self(Some(Arc::new(pool)))),
                Err(error) => Err(Self::refused(threads, format!("fewer: {error}"))),
            },
            _ => Ok(Self::single()),
        }
    }

    /// `threads`, if a pool may have that many.
    ///
    /// # Errors
    /// When `threads` is zero or more than [`MOST`](Self::MOST).
    pub fn checked(threads: usize) -> Result<usize, BuildError> {
        match threads {
            1..=Self::MOST => Ok(threads),
            _ => Err(Self::refused(threads, format!("from 1 to {}", Self::MOST))),
        }
    }

    fn refused(threads: usize, range: String) -> BuildError {
        BuildError::OutOfRange { name: "threads", value: threads as f64, range }
    }

    /// Calls `work` on each item, on several in parallel where there are threads.
    pub fn each<T: Send>(&self, items: &mut [T], work: impl Fn(&mut T) + Send + Sync) {
        match &self.0 {
            None => items.iter_mut().for_each(work),
            #[cfg(feature = "parallel")]
            Some(pool) => {
                let items: Vec<_> = items.iter_mut().map(Mutex::new).collect();
                in_parallel(pool, items.len(), &|i| {
                    if let Ok(mut item) = items[i].lock() {
                        work(&mut item);
                    }
                });
            }
            #[cfg(not(feature = "parallel"))]
            Some(pool) => match **pool {},
        }
    }
}

/// Calls `work` with each number below `count`. Not generic: what rayon has of it is large, and compiled once.
#[cfg(feature = "parallel")]
fn in_parallel(pool: &Pool, count: usize, work: &(dyn Fn(usize) + Sync)) {
    pool.install(|| (0..count).into_par_iter().with_max_len(1).for_each(work));
}
