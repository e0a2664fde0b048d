//! Memory limit of a scene: `settings.memory`, or the machine's free memory.

use std::fs;
use std::path::Path;
use std::sync::OnceLock;
use stickslip_core::linear::estimate::GIGABYTE;

/// Memory limit in bytes if the free memory is unknown.
const UNTOLD: f64 = 4.0 * GIGABYTE;

/// Memory limit in bytes; `setting` is in GB.
pub fn budget(setting: Option<f64>) -> f64 {
    setting.map_or_else(free, |gigabytes| gigabytes * GIGABYTE)
}

/// Free memory in bytes: of the machine, and of the control groups (cgroups, version 1 or 2) of this process, which containers
/// and batch schedulers use.
///
/// Read only once, so that all solvers of a process make the same choices.
pub fn free() -> f64 {
    static FREE: OnceLock<f64> = OnceLock::new();
    *FREE.get_or_init(read_free)
}

fn read_free() -> f64 {
    let machine = fs::read_to_string("/proc/meminfo")
        .ok()
        .as_deref()
        .and_then(available);
    let groups = fs::read_to_string("/proc/self/cgroup").unwrap_or_default();
    let group = confined(Path::new("/sys/fs/cgroup"), &groups);
    machine.unwrap_or(UNTOLD).min(group)
}

/// Bytes left by the control groups of a process; infinite without a limit. `mount` is the mount point of the groups, and `own`
/// the content of `/proc/self/cgroup`: lines `number:controllers:path`, without controllers in version 2.
fn confined(mount: &Path, own: &str) -> f64 {
    let mut least = f64::INFINITY;
    for line in own.lines() {
        let mut fields = line.splitn(3, ':').skip(1);
        let (Some(controllers), Some(path)) = (fields.next(), fields.next()) else {
            continue;
        };
        let path = Path::new(path.trim_start_matches('/'));
        // A limit also applies to all groups below. A container may only see the groups from its own downwards.
        for group in path.ancestors() {
            let left = match controllers {
                "" => left(&mount.join(group), ["memory.max", "memory.current"]).or_else(|| {
                    left(
                        &mount.join("unified").join(group),
                        ["memory.max", "memory.current"],
                    )
                }),
                _ if controllers.split(',').any(|own| own == "memory") => left(
                    &mount.join("memory").join(group),
                    ["memory.limit_in_bytes", "memory.usage_in_bytes"],
                ),
                _ => None,
            };
            least = left.map_or(least, |left| least.min(left));
        }
    }
    least
}

/// Bytes left in a group, given the names of its limit and usage files; `None` without a limit. Inactive file caches count as
/// free, because they are released when memory is short.
fn left(group: &Path, [most, used]: [&str; 2]) -> Option<f64> {
    let text = |file: &str| fs::read_to_string(group.join(file)).ok();
    let number = |file: &str| text(file)?.trim().parse::<f64>().ok();
    let (most, used) = (number(most)?, number(used)?);
    let stat = text("memory.stat").unwrap_or_default();
    let of = |name: &str| {
        let line = stat.lines().find_map(|line| line.strip_prefix(name))?;
        line.trim().parse::<f64>().ok()
    };
    let given_back = of("total_inactive_file ").or_else(|| of("inactive_file "));
    Some((most - (used - given_back.unwrap_or(0.0)).max(0.0)).max(0.0))
}

/// The available memory in `/proc/meminfo`.
fn available(text: &str) -> Option<f64> {
    let line = text.lines().find_map(|l| l.strip_prefix("MemAvailable:"))?;
    let kilobytes: f64 = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
    Some(kilobytes * 1024.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use stickslip_core::linear::estimate::bytes;

    #[test]
    fn proc_meminfo_is_read() {
        let table = "MemTotal:  24 kB\nMemFree: 1 kB\nMemAvailable:   22 kB\n";
        assert_eq!(available(table), Some(22.0 * 1024.0));
        assert_eq!(available("MemTotal: 24 kB\n"), None);
        assert!(free() > 0.0);
    }

    /// Makes the files of a group.
    fn group(at: &Path, files: &[(&str, &str)]) {
        fs::create_dir_all(at).unwrap();
        for (name, text) in files {
            fs::write(at.join(name), text).unwrap();
        }
    }

    #[test]
    fn the_tightest_control_group_applies() {
        let folder = tempfile::tempdir().unwrap();
        let mount = folder.path();
        let files = |most, used| [("memory.max", most), ("memory.current", used)];
        group(&mount.join("job"), &files("5000\n", "1000\n"));
        group(&mount.join("job/step"), &files("max\n", "600\n"));
        assert_eq!(confined(mount, "0::/job/step\n"), 4000.0);
        group(&mount.join("job/step"), &files("3000\n", "600\n"));
        assert_eq!(confined(mount, "0::/job/step\n"), 2400.0);
        // Inactive file caches do not count as used.
        group(
            &mount.join("job/step"),
            &[("memory.stat", "anon 500\ninactive_file 100\n")],
        );
        assert_eq!(confined(mount, "0::/job/step\n"), 2500.0);
        assert_eq!(confined(mount, "0::/other\n"), f64::INFINITY);
    }

    #[test]
    fn version_1_control_groups_apply_too() {
        let folder = tempfile::tempdir().unwrap();
        let mount = folder.path();
        let files = |most, used| {
            [
                ("memory.limit_in_bytes", most),
                ("memory.usage_in_bytes", used),
            ]
        };
        group(
            &mount.join("memory"),
            &files("9223372036854771712\n", "7\n"),
        );
        group(
            &mount.join("memory/slurm/job_3"),
            &files("5000\n", "2000\n"),
        );
        let own = "9:cpu,cpuacct:/slurm/job_3\n4:memory:/slurm/job_3\n0::/\n";
        assert_eq!(confined(mount, own), 3000.0);
        // The limit may be below the usage.
        group(
            &mount.join("memory/slurm/job_3"),
            &files("1000\n", "2000\n"),
        );
        assert_eq!(confined(mount, own), 0.0);
        let beside = "4:memory:/slurm/job_4\n";
        assert!(confined(mount, beside) > 1e18);
    }

    #[test]
    fn the_setting_overrides_the_free_memory() {
        assert_eq!(budget(Some(2.0)), 2e9);
        assert_eq!(
            [bytes(2e3), bytes(3.2e7), bytes(2.34e9), bytes(6.4e10)],
            ["1 MB", "32 MB", "2.3 GB", "64 GB"]
        );
    }
}
