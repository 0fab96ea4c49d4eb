//! Files that are cut while they are mapped. Reading beyond the new end raises SIGBUS, and its default
//! ends the process, a daemon with all its viewers. Here zeros take the place of what was cut, so that checksums
//! tell of the damage and coarser tiles stand in.

use std::fs::File;
use std::path::Path;
use std::sync::OnceLock;
use std::sync::atomic::{AtomicI32, AtomicU64, AtomicUsize, Ordering};

use relief_formats::file::{FormatError, Relief};
use std::os::fd::AsRawFd as _;

/// Maps that can be guarded at a time.
const MOST_MAPS: usize = 256;
/// A place that is taken, but whose map is not known yet.
const TAKEN: usize = 1;

/// Maps, as a signal handler may read them: without locks, without allocation.
static MAPS: [Map; MOST_MAPS] = [const { Map::free() }; MOST_MAPS];
/// What SIGBUS did before, and the size of a page.
static BEFORE: OnceLock<(libc::sigaction, usize)> = OnceLock::new();

struct Map {
    /// Address of the first byte; 0 for a free place.
    start: AtomicUsize,
    bytes: AtomicUsize,
    file: AtomicI32,
    faults: AtomicU64,
}

/// Maps a file for as long as it is needed, whatever becomes of it.
///
/// # Errors
/// Those of [`Relief::open`].
pub fn open(path: &Path) -> Result<Relief, FormatError> {
    Relief::open_guarded(path, |bytes, file| {
        let guard = install().then(|| Guard::new(bytes, file)).flatten();
        if guard.is_none() {
            tracing::warn!(path = %path.display(), "not guarded: if this file is cut while it is read, the program ends");
        }
        guard
    })
}

/// How often reading mapped bytes met what was cut off, or what the disk does not give.
pub fn faults(bytes: &[u8]) -> u64 {
    let start = bytes.as_ptr().addr();
    MAPS.iter()
        .filter(|map| map.start.load(Ordering::Acquire) == start)
        .map(|map| map.faults.load(Ordering::Relaxed))
        .sum()
}

/// A guarded map; dropped before it is unmapped.
struct Guard(&'static Map);

impl Guard {
    fn new(bytes: &[u8], file: &File) -> Option<Self> {
        let free = |map: &&Map| map.start.compare_exchange(0, TAKEN, Ordering::AcqRel, Ordering::Relaxed).is_ok();
        let map = MAPS.iter().find(free)?;
        map.bytes.store(bytes.len(), Ordering::Relaxed);
        map.file.store(file.as_raw_fd(), Ordering::Relaxed);
        map.faults.store(0, Ordering::Relaxed);
        map.start.store(bytes.as_ptr().addr(), Ordering::Release);
        Some(Self(map))
    }
}

impl Drop for Guard {
    fn drop(&mut self) {
        self.0.start.store(0, Ordering::Release);
    }
}

impl Map {
    const fn free() -> Self {
        Self {
            start: AtomicUsize::new(0),
            bytes: AtomicUsize::new(0),
            file: AtomicI32::new(-1),
            faults: AtomicU64::new(0),
        }
    }

    /// Puts zeros where `address` cannot be read; false when it is not within this map.
    ///
    /// Called by a signal handler: only system calls and atomics.
    #[allow(unsafe_code, reason = "pages are replaced under a map, which is what this file is for")]
    fn mend(&self, address: usize, page: usize) -> bool {
        let start = self.start.load(Ordering::Acquire);
        if start <= TAKEN {
            return false;
        }
        let end = start + self.bytes.load(Ordering::Relaxed).next_multiple_of(page);
        if !(start..end).contains(&address) {
            return false;
        }
        // SAFETY: all zeros is a valid `stat`, and the descriptor is open while the map is guarded.
        let whole = unsafe {
            let mut stat: libc::stat = std::mem::zeroed();
            match libc::fstat(self.file.load(Ordering::Relaxed), &mut stat) {
                0 => (stat.st_size.max(0) as usize).next_multiple_of(page),
                _ => 0,
            }
        };
        let (from, bytes) = match address >= start + whole {
            // All that was cut off.
            true => (start + whole, end - start - whole),
            // Inside the file: the disk does not give this page.
            false => (address - address % page, page),
        };
        // SAFETY: the range lies within a map of ours, which is read-only and stays mapped: who reads
        // it sees zeros instead of ending. Nothing else is mapped there.
        let mapped = unsafe {
            let kind = libc::MAP_PRIVATE | libc::MAP_ANONYMOUS | libc::MAP_FIXED;
            libc::mmap(std::ptr::without_provenance_mut(from), bytes, libc::PROT_READ, kind, -1, 0)
        };
        self.faults.fetch_add(1, Ordering::Relaxed);
        mapped != libc::MAP_FAILED
    }
}

/// Sets the handler, once; false when the system does not let us.
#[allow(unsafe_code, reason = "signal handlers are unsafe by nature")]
fn install() -> bool {
    static INSTALLED: OnceLock<bool> = OnceLock::new();
    *INSTALLED.get_or_init(|| {
        // SAFETY: all zeros is a valid `sigaction`; the handler does only what handlers may.
        unsafe {
            let mut before: libc::sigaction = std::mem::zeroed();
            let page = usize::try_from(libc::sysconf(libc::_SC_PAGESIZE)).unwrap_or(0);
            if !page.is_power_of_two() || libc::sigaction(libc::SIGBUS, std::ptr::null(), &mut before) != 0 {
                return false;
            }
            // Known before the first signal comes.
            let _ = BEFORE.set((before, page));
            let mut ours: libc::sigaction = std::mem::zeroed();
            ours.sa_sigaction = on_bus_error as *const () as usize;
            ours.sa_flags = libc::SA_SIGINFO | libc::SA_ONSTACK | libc::SA_RESTART;
            libc::sigaction(libc::SIGBUS, &ours, std::ptr::null_mut()) == 0
        }
    })
}

/// The handler. A fault elsewhere is none of ours: what was set before gets it, by default the end.
#[allow(unsafe_code, reason = "signal handlers are unsafe by nature")]
extern "C" fn on_bus_error(_: libc::c_int, info: *mut libc::siginfo_t, _: *mut libc::c_void) {
    let Some((before, page)) = BEFORE.get() else { return };
    // SAFETY: the system gives a handler with SA_SIGINFO a valid `siginfo_t`; `errno` belongs to the
    // thread that was interrupted and is given back as it was; `sigaction` may be called here, and
    // returning then repeats the fault for the handler that was set before.
    unsafe {
        let errno = *libc::__errno_location();
        let address = (*info).si_addr().addr();
        let ours = (*info).si_code == libc::BUS_ADRERR && MAPS.iter().any(|map| map.mend(address, *page));
        if !ours {
            libc::sigaction(libc::SIGBUS, before, std::ptr::null_mut());
        }
        *libc::__errno_location() = errno;
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "a test may end in a panic")]

    use super::*;
    use std::os::unix::process::ExitStatusExt as _;

    const PAGES: usize = 64;

    fn mapped(folder: &Path) -> (memmap2::Mmap, File) {
        let path = folder.join("file");
        std::fs::write(&path, vec![7; PAGES * 4096]).unwrap();
        let file = File::options().read(true).write(true).open(path).unwrap();
        #[allow(unsafe_code, reason = "a map to be cut")]
        // SAFETY: the file is ours; that it changes under the map is what is tested.
        let map = unsafe { memmap2::Mmap::map(&file) }.unwrap();
        (map, file)
    }

    #[test]
    fn what_was_cut_reads_as_zeros_and_the_rest_as_it_was() {
        let folder = tempfile::tempdir().unwrap();
        let (map, file) = mapped(folder.path());
        assert!(install());
        let guard = Guard::new(&map, &file).unwrap();
        file.set_len(10 * 4096 + 5).unwrap();
        let at = |k: usize| std::hint::black_box(&map)[k];
        assert_eq!(at(PAGES * 4096 - 1), 0);
        assert_eq!((at(10 * 4096 + 4), at(10 * 4096 + 5), at(11 * 4096), at(0)), (7, 0, 0, 7));
        assert_eq!(faults(&map), 1, "all that was cut is mended at once");
        // Cut again, by another thread's reading.
        file.set_len(0).unwrap();
        assert!(std::thread::scope(|scope| scope.spawn(|| (0..PAGES).all(|k| at(k * 4096) == 0)).join().unwrap()));
        drop(guard);
        assert_eq!(faults(&map), 0);
    }

    #[test]
    fn a_fault_elsewhere_ends_the_process_as_ever() {
        const CHILD: &str = "RELIEFD_TEST_UNGUARDED";
        if std::env::var_os(CHILD).is_none() {
            let name = "truncated::tests::a_fault_elsewhere_ends_the_process_as_ever";
            let mut child = std::process::Command::new(std::env::current_exe().unwrap());
            let status = child.args([name, "--exact", "--nocapture"]).env(CHILD, "1").output().unwrap().status;
            assert_eq!(status.signal(), Some(libc::SIGBUS), "{status:?}");
            return;
        }
        let folder = tempfile::tempdir().unwrap();
        let (map, file) = mapped(folder.path());
        assert!(install());
        file.set_len(0).unwrap();
        std::fs::remove_dir_all(folder.path()).unwrap();
        assert_eq!(std::hint::black_box(&map)[5000], 1, "nobody guards this map");
    }
}
