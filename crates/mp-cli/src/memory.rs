//! `--memory`: a budget that ends the work as Ctrl-C does, with what was found.

use memory_stats::memory_stats;
use mp_plan::{Cancel, Error};
use std::time::Duration;

/// How often the memory is looked at: reading it takes some microseconds.
const EVERY: Duration = Duration::from_millis(5);

/// Units, longest first, and their bytes.
const UNITS: [(&str, f64); 7] = [
    ("kib", 1024.0),
    ("mib", 1_048_576.0),
    ("gib", 1_073_741_824.0),
    ("kb", 1e3),
    ("mb", 1e6),
    ("gb", 1e9),
    ("b", 1.0),
];

/// Reads a size, such as `500MB` or `1.5GiB`: bytes.
pub(crate) fn size(text: &str) -> Result<u64, String> {
    let lower = text.trim().to_ascii_lowercase();
    let unit = UNITS.iter().find(|(unit, _)| lower.ends_with(unit));
    let bytes = unit.and_then(|(unit, bytes)| {
        let number: f64 = lower.strip_suffix(unit)?.trim_end().parse().ok()?;
        Some(number * bytes).filter(|n| (1.0..1e18).contains(n))
    });
    bytes.map(|n| n as u64).ok_or_else(|| "write a size, such as 500MB or 1.5GiB".to_owned())
}

/// Raises `cancel` when the process has more than `most` bytes in memory.
///
/// # Errors
/// When it has as many already, or the system does not say how many.
pub(crate) fn limit(cancel: &Cancel, most: u64) -> Result<(), Error> {
    let used = || memory_stats().map(|now| now.physical_mem as u64);
    match used() {
        None => return Err(Error::new("--memory: this system does not say how much memory a process takes")),
        Some(now) if now >= most => {
            let shown = |n: u64| format!("{:.1} MB", n as f64 / 1e6);
            let message = format!("--memory {}: the program itself takes {}", shown(most), shown(now));
            return Err(Error::new(message).help("give more memory"));
        }
        Some(_) => {}
    }
    let cancel = cancel.clone();
    // It ends with the program.
    std::thread::spawn(move || {
        while !cancel.is_raised() {
            if used().is_some_and(|now| now >= most) {
                cancel.out_of_memory();
            }
            std::thread::sleep(EVERY);
        }
    });
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_are_read() {
        for (text, bytes) in [
            ("500MB", 500_000_000),
            ("1.5GiB", 1_610_612_736),
            (" 2 gb", 2_000_000_000),
            ("64kib", 65_536),
            ("3kB", 3000),
            ("1B", 1),
        ] {
            assert_eq!(size(text), Ok(bytes), "{text}");
        }
        for text in ["", "MB", "500", "-1GB", "0MB", "nanMB", "infGB", "1e30GB", "2TB!", "1,5GB"] {
            assert!(size(text).unwrap_err().contains("500MB"), "{text}");
        }
    }
}
