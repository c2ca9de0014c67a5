//! A limit on the memory that one input may take.

use std::alloc::{GlobalAlloc, Layout, System};
use std::io::Write;
use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};

/// More than this in use at a time, for an input of some kilobytes, is an error. Images are allowed to expand: a
/// kilobyte of a PNG may be a megabyte of pixels.
const LIMIT: usize = 64 << 20;

/// Bytes in use.
static USED: AtomicUsize = AtomicUsize::new(0);

/// Bytes in use when the present input came, and the limit.
static MOST: AtomicUsize = AtomicUsize::new(usize::MAX);

/// The memory of the system, counted.
pub struct Bounded;

/// A new input.
pub fn begin() {
    MOST.store(USED.load(Relaxed) + LIMIT, Relaxed);
}

fn take(bytes: usize) {
    if USED.fetch_add(bytes, Relaxed) + bytes > MOST.load(Relaxed) {
        // The message takes memory too.
        MOST.store(usize::MAX, Relaxed);
        let _ = writeln!(std::io::stderr(), "error: one input takes more than {LIMIT} bytes of memory");
        // Not a panic: an allocator must not unwind.
        std::process::abort();
    }
}

// SAFETY: all calls are passed to the allocator of the system as they are.
unsafe impl GlobalAlloc for Bounded {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        take(layout.size());
        // SAFETY: as above.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, memory: *mut u8, layout: Layout) {
        USED.fetch_sub(layout.size(), Relaxed);
        // SAFETY: as above.
        unsafe { System.dealloc(memory, layout) }
    }

    unsafe fn alloc_zeroed(&self, layout: Layout) -> *mut u8 {
        take(layout.size());
        // SAFETY: as above.
        unsafe { System.alloc_zeroed(layout) }
    }

    unsafe fn realloc(&self, memory: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        take(size);
        USED.fetch_sub(layout.size(), Relaxed);
        // SAFETY: as above.
        unsafe { System.realloc(memory, layout, size) }
    }
}
