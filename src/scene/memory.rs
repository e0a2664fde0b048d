//! How much memory a scene may take: what `settings.memory` says, or what the machine has free.

use crate::linear::estimate::GIGABYTE;
use std::fs;
use std::sync::OnceLock;

/// What may be taken where nothing tells what is free, in bytes.
const UNTOLD: f64 = 4.0 * GIGABYTE;

/// Bytes that a scene may take; `setting` is in GB.
pub fn budget(setting: Option<f64>) -> f64 {
    setting.map_or_else(free, |gigabytes| gigabytes * GIGABYTE)
}

/// Bytes that are free: of the machine, and of the group of processes that this one is confined to, if it is.
///
/// It is read once, so that all solvers of a process choose the same.
pub fn free() -> f64 {
    static FREE: OnceLock<f64> = OnceLock::new();
    *FREE.get_or_init(read_free)
}

fn read_free() -> f64 {
    let machine = fs::read_to_string("/proc/meminfo").ok();
    let machine = machine.as_deref().and_then(available);
    let number = |file: &str| {
        let text = fs::read_to_string(format!("/sys/fs/cgroup/{file}")).ok()?;
        text.trim().parse::<f64>().ok()
    };
    let group = number("memory.max").zip(number("memory.current"));
    let group = group.map_or(f64::INFINITY, |(most, now)| (most - now).max(0.0));
    machine.unwrap_or(UNTOLD).min(group)
}

/// What `/proc/meminfo` says is available.
fn available(text: &str) -> Option<f64> {
    let line = text.lines().find_map(|l| l.strip_prefix("MemAvailable:"))?;
    let kilobytes: f64 = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
    Some(kilobytes * 1024.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::linear::estimate::bytes;

    #[test]
    fn the_kernels_table_is_read() {
        let table = "MemTotal:  24 kB\nMemFree: 1 kB\nMemAvailable:   22 kB\n";
        assert_eq!(available(table), Some(22.0 * 1024.0));
        assert_eq!(available("MemTotal: 24 kB\n"), None);
        assert!(free() > 0.0);
    }

    #[test]
    fn what_is_set_counts_and_not_what_is_free() {
        assert_eq!(budget(Some(2.0)), 2e9);
        assert_eq!(
            [bytes(2e3), bytes(3.2e7), bytes(2.34e9), bytes(6.4e10)],
            ["1 MB", "32 MB", "2.3 GB", "64 GB"]
        );
    }
}
