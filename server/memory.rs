//! Memory of this process: the least of the machine's memory, the limits of its control groups, and its resource limits.
//!
//! It is a pure function of the texts of files and two numbers, so that it is tested without a container.

use std::fs;
use std::path::Path;

use rustix::process::{Resource, getrlimit};

/// Resource limits of this process.
#[derive(Debug, Clone, Copy, Default)]
pub struct ResourceLimits {
    /// Address space (`RLIMIT_AS`), bytes.
    pub address_space: Option<u64>,
    /// Data segment, private mappings included (`RLIMIT_DATA`), bytes.
    pub data: Option<u64>,
}

/// Memory of this process, bytes; None if it is unknown.
pub fn allowed() -> Option<u64> {
    let of = |resource| getrlimit(resource).current;
    let limits = ResourceLimits { address_space: of(Resource::As), data: of(Resource::Data) };
    least(|path| fs::read_to_string(path).ok(), limits)
}

/// The least of all limits, bytes. `read` gives the text of a file, if it exists.
///
/// A control group is also limited by all groups above it. A container often sees its own group as the root of the mounted tree,
/// but its path as on the host, so that only the root exists. Therefore every group on the path is tried, and missing ones are
/// skipped.
pub fn least(read: impl Fn(&Path) -> Option<String>, limits: ResourceLimits) -> Option<u64> {
    let physical = read(Path::new("/proc/meminfo")).and_then(|text| physical(&text));
    let groups = read(Path::new("/proc/self/cgroup")).unwrap_or_default();
    let of_groups = groups.lines().filter_map(Hierarchy::read).flat_map(|hierarchy| hierarchy.limits(&read));
    of_groups.chain([physical, limits.address_space, limits.data].into_iter().flatten()).min()
}

/// `MemTotal` of `/proc/meminfo`, bytes.
fn physical(text: &str) -> Option<u64> {
    let kib = text.lines().find_map(|line| line.strip_prefix("MemTotal:")?.trim().strip_suffix("kB"))?;
    kib.trim().parse::<u64>().ok()?.checked_mul(1024)
}

/// A tree of control groups with memory limits, and this process's place in it.
struct Hierarchy<'a> {
    mounted: &'static str,
    /// Files of a group that may hold a limit.
    files: &'static [&'static str],
    path: &'a str,
}

impl<'a> Hierarchy<'a> {
    /// Parses a line of `/proc/self/cgroup` (cgroups(7)): `0::/path` of version 2, `4:memory:/path` of version 1.
    fn read(line: &'a str) -> Option<Self> {
        let (number, rest) = line.split_once(':')?;
        let (controllers, path) = rest.split_once(':')?;
        if number == "0" && controllers.is_empty() {
            return Some(Self { mounted: "/sys/fs/cgroup", files: &["memory.max", "memory.high"], path });
        }
        let is_memory = controllers.split(',').any(|controller| controller == "memory");
        is_memory.then_some(Self { mounted: "/sys/fs/cgroup/memory", files: &["memory.limit_in_bytes"], path })
    }

    /// Limits of the group and of all above it, bytes. `max` means none. Version 1 has a number near 2^63 instead, which is never
    /// the least.
    fn limits(self, read: impl Fn(&Path) -> Option<String>) -> Vec<u64> {
        let relative = Path::new(self.path.trim_start_matches('/'));
        // A group outside the mounted tree.
        let relative = if relative.starts_with("..") { Path::new("") } else { relative };
        let groups = relative.ancestors().map(|group| Path::new(self.mounted).join(group));
        let files = groups.flat_map(|group| self.files.iter().map(move |file| group.join(file)));
        files.filter_map(|file| read(&file)?.trim().parse().ok()).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const GIB: u64 = 1 << 30;

    fn least_of(files: &[(&str, &str)], limits: ResourceLimits) -> Option<u64> {
        let read =
            |path: &Path| files.iter().find(|(name, _)| Path::new(name) == path).map(|(_, text)| (*text).to_owned());
        least(read, limits)
    }

    const MACHINE: (&str, &str) = ("/proc/meminfo", "MemTotal:       16777216 kB\nMemFree:         1 kB\n");

    #[test]
    fn without_a_limit_it_is_the_machines() {
        assert_eq!(least_of(&[MACHINE], ResourceLimits::default()), Some(16 * GIB));
        assert_eq!(least_of(&[], ResourceLimits::default()), None);
        let unlimited = [
            MACHINE,
            ("/proc/self/cgroup", "0::/user.slice/a\n"),
            ("/sys/fs/cgroup/user.slice/a/memory.max", "max\n"),
            ("/sys/fs/cgroup/user.slice/memory.high", "max\n"),
        ];
        assert_eq!(least_of(&unlimited, ResourceLimits::default()), Some(16 * GIB));
        for nonsense in ["", "MemTotal: much kB", "MemTotal: 18446744073709551615 kB"] {
            assert_eq!(least_of(&[("/proc/meminfo", nonsense)], ResourceLimits::default()), None);
        }
    }

    #[test]
    fn a_control_group_and_every_one_above_it_count() {
        let group = ("/proc/self/cgroup", "0::/kubepods/pod1/server\n");
        for (file, text, expected) in [
            ("/sys/fs/cgroup/kubepods/pod1/server/memory.max", "536870912\n", GIB / 2),
            ("/sys/fs/cgroup/kubepods/pod1/memory.max", "1073741824\n", GIB),
            ("/sys/fs/cgroup/kubepods/memory.high", "2147483648\n", 2 * GIB),
            // The only one that a container sees.
            ("/sys/fs/cgroup/memory.max", "268435456\n", GIB / 4),
            // A limit of another group.
            ("/sys/fs/cgroup/kubepods/pod2/memory.max", "1\n", 16 * GIB),
        ] {
            let files = [MACHINE, group, (file, text)];
            assert_eq!(least_of(&files, ResourceLimits::default()), Some(expected), "{file}");
        }
        let outside = [MACHINE, ("/proc/self/cgroup", "0::/../x\n"), ("/sys/fs/cgroup/memory.max", "4096\n")];
        assert_eq!(least_of(&outside, ResourceLimits::default()), Some(4096));
    }

    #[test]
    fn version_1_is_read_too_and_beside_version_2() {
        let groups = ("/proc/self/cgroup", "9:name=systemd:/\n4:cpu,memory:/docker/1\n0::/\n");
        let none = ("/sys/fs/cgroup/memory/docker/1/memory.limit_in_bytes", "9223372036854771712\n");
        assert_eq!(least_of(&[MACHINE, groups, none], ResourceLimits::default()), Some(16 * GIB));
        let above = ("/sys/fs/cgroup/memory/docker/memory.limit_in_bytes", "1073741824\n");
        assert_eq!(least_of(&[MACHINE, groups, none, above], ResourceLimits::default()), Some(GIB));
    }

    #[test]
    fn resource_limits_count() {
        let limits = ResourceLimits { address_space: Some(8 * GIB), data: None };
        assert_eq!(least_of(&[MACHINE], limits), Some(8 * GIB));
        assert_eq!(least_of(&[], ResourceLimits { data: Some(GIB), ..limits }), Some(GIB));
    }

    #[test]
    fn this_machine_has_some() {
        assert!(allowed().is_none_or(|bytes| bytes > 1 << 20));
    }
}
