//! What a process holds: to see that nothing leaks.

use std::fs;

/// Growth of the resident set that allocators and counters may cause.
const MAY_GROW_BYTES: u64 = 24 << 20;

/// Threads that wait for work a while before they end.
const MAY_IDLE_THREADS: usize = 2;

/// Descriptors, threads, memory.
#[derive(Clone, Copy, Debug)]
pub struct Balance {
    pub descriptors: usize,
    pub threads: usize,
    pub resident_bytes: u64,
}

impl Balance {
    /// Of a process.
    pub fn of(pid: u32) -> Self {
        let entries = |folder: &str| fs::read_dir(format!("/proc/{pid}/{folder}")).unwrap().count();
        let status = fs::read_to_string(format!("/proc/{pid}/status")).unwrap();
        let line = status.lines().find_map(|line| line.strip_prefix("VmRSS:")).unwrap();
        let kib: u64 = line.trim().trim_end_matches(" kB").parse().unwrap();
        Self { descriptors: entries("fd"), threads: entries("task"), resident_bytes: kib << 10 }
    }

    /// Whether no more is held than before.
    pub fn against(self, before: Self) -> Result<(), String> {
        let good = self.descriptors <= before.descriptors
            && self.threads <= before.threads + MAY_IDLE_THREADS
            && self.resident_bytes <= before.resident_bytes + MAY_GROW_BYTES;
        if good { Ok(()) } else { Err(format!("{before:?} became {self:?}")) }
    }
}

#[test]
fn what_grows_is_found() {
    let pid = std::process::id();
    let before = Balance::of(pid);
    let kept = vec![1u8; 2 * MAY_GROW_BYTES as usize];
    assert!(std::hint::black_box(&kept).iter().all(|&byte| byte == 1));
    let error = Balance::of(pid).against(Balance { descriptors: 1000, threads: 1000, ..before }).unwrap_err();
    assert!(error.contains("resident_bytes"), "{error}");
    drop(kept);
    // Other tests run in this process, so these are compared with numbers that no test reaches.
    let now = Balance { resident_bytes: 0, ..Balance::of(pid) };
    now.against(Balance { descriptors: now.descriptors, threads: now.threads, ..now }).unwrap();
    now.against(Balance { descriptors: now.descriptors - 1, ..now }).unwrap_err();
    let now = Balance { threads: 9, ..now };
    now.against(Balance { threads: now.threads - MAY_IDLE_THREADS - 1, ..now }).unwrap_err();
    let file = fs::File::open("/proc/self/status").unwrap();
    assert!(Balance::of(pid).descriptors >= 4, "{file:?} and the three that every process has");
}
