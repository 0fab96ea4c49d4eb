//! The same bytes whatever the threads, in one go or resumed after a kill; memory within its bound.

use std::path::{Path, PathBuf};
use std::process::{Child, Command, ExitStatus, Stdio};
use std::time::{Duration, Instant};

use crate::common::{Folder, Run, Value, data, program};

/// Length of a work file that holds its head and no block.
const HEAD_BYTES: u64 = 48;

/// A bake that can be started again and again.
struct Bake<'a> {
    source: PathBuf,
    options: &'a [&'a str],
    folder: Folder,
}

impl Bake<'_> {
    /// The Earth at m = 12: nine blocks.
    fn earth() -> Self {
        let options = &["--vertical", "ellipsoid", "--m", "12"];
        Bake { source: data("earth_etopo1_6min.tif"), options, folder: Folder::new() }
    }

    fn output(&self) -> PathBuf {
        self.folder.path("a.relief")
    }

    fn work(&self) -> PathBuf {
        self.folder.path("a.relief.part")
    }

    fn command(&self, more: &[&str]) -> Command {
        let mut command = program();
        command.args(["bake", "--json", "--quiet", "-o"]).arg(self.output()).arg(&self.source);
        command.args(self.options).args(more).stdout(Stdio::piped()).stderr(Stdio::piped());
        command
    }

    /// Runs to the end: what was printed, and the file, which is taken away.
    fn bytes(&self, more: &[&str]) -> (Value, Vec<u8>) {
        let report = Run::of(&mut self.command(more), "").json(0);
        assert_eq!(self.folder.names(), ["a.relief"]);
        let bytes = std::fs::read(self.output()).unwrap();
        std::fs::remove_file(self.output()).unwrap();
        (report, bytes)
    }

    /// Starts, and ends the process with a signal once the work file holds more than one block.
    fn interrupted(&self, signal: &str, more: &[&str]) -> ExitStatus {
        let mut child = self.command(more).spawn().unwrap();
        let start = Instant::now();
        let grown = || std::fs::metadata(self.work()).is_ok_and(|work| work.len() > (12 << 20));
        while !grown() {
            assert!(child.try_wait().unwrap().is_none(), "the bake ended before it was interrupted");
            assert!(start.elapsed() < Duration::from_secs(120), "the work file does not grow");
            std::thread::sleep(Duration::from_millis(1));
        }
        let sent = Command::new("kill").args([&format!("-{signal}"), &child.id().to_string()]).status().unwrap();
        assert!(sent.success());
        child.wait().unwrap()
    }
}

fn resumed(report: &Value) -> u64 {
    report["resumed_blocks"].as_u64().unwrap()
}

/// Kept short of `assert_eq`, which would print both files.
fn same(a: &[u8], b: &[u8]) {
    assert!(a == b, "files of {} and {} bytes differ", a.len(), b.len());
}

#[test]
fn after_a_kill_the_rest_is_baked_to_the_same_bytes() {
    let bake = Bake::earth();
    let (report, whole) = bake.bytes(&["--threads", "2"]);
    assert_eq!(resumed(&report), 0);

    let status = bake.interrupted("KILL", &["--threads", "1"]);
    assert_eq!(status.code(), None);
    assert_eq!(bake.folder.names(), ["a.relief.part"]);
    let work = std::fs::read(bake.work()).unwrap();
    let (report, bytes) = bake.bytes(&["--threads", "1", "--resume"]);
    let blocks = resumed(&report);
    assert!((2..9).contains(&blocks), "{report}");
    same(&whole, &bytes);

    // A record that was cut short is baked again; threads and memory are no part of a bake.
    let mut end = HEAD_BYTES as usize;
    for _ in 0..blocks {
        end += 8 + u64::from_le_bytes(work[end..][..8].try_into().unwrap()) as usize + 32;
    }
    std::fs::write(bake.work(), &work[..end - 1]).unwrap();
    let (report, bytes) = bake.bytes(&["--resume", "--threads", "2", "--memory", "600MiB"]);
    assert_eq!(resumed(&report), blocks - 1, "{report}");
    same(&whole, &bytes);

    // So are a damaged one and all behind it.
    let first_bytes = u64::from_le_bytes(work[HEAD_BYTES as usize..][..8].try_into().unwrap()) as usize;
    let second = HEAD_BYTES as usize + 8 + first_bytes + 32;
    let mut damaged = work.clone();
    damaged[second + 5000] ^= 1;
    std::fs::write(bake.work(), &damaged).unwrap();
    let (report, bytes) = bake.bytes(&["--resume"]);
    assert_eq!(resumed(&report), 1);
    same(&whole, &bytes);

    // A length that the file has not earned.
    let mut long = work.clone();
    long[HEAD_BYTES as usize..][..8].copy_from_slice(&u64::MAX.to_le_bytes());
    std::fs::write(bake.work(), &long).unwrap();
    assert_eq!(resumed(&bake.bytes(&["--resume"]).0), 0);

    // The work of another bake is not used, and without --resume none is.
    std::fs::write(bake.work(), &work).unwrap();
    let (report, other) = bake.bytes(&["--resume", "--resample", "nearest"]);
    assert_eq!(resumed(&report), 0);
    assert!(other != whole);
    std::fs::write(bake.work(), &work).unwrap();
    let (report, bytes) = bake.bytes(&[]);
    assert_eq!(resumed(&report), 0);
    same(&whole, &bytes);
}

#[test]
fn what_is_no_work_file_is_replaced() {
    let bake = Bake { source: data("moon_dem_halfmetre_dn.tif"), options: &[], folder: Folder::new() };
    let (_, whole) = bake.bytes(&[]);
    for text in [&b""[..], b"relief-bake wk 1", b"some notes of the user's that are longer than a head is, by a little"]
    {
        std::fs::write(bake.work(), text).unwrap();
        let (report, bytes) = bake.bytes(&["--resume"]);
        assert_eq!(resumed(&report), 0);
        same(&whole, &bytes);
    }
    // Without any work file --resume starts from nothing.
    same(&whole, &bake.bytes(&["--resume"]).1);
}

#[cfg(target_os = "linux")]
#[test]
fn what_was_killed_while_publishing_goes() {
    let bake = Bake { source: data("moon_dem_halfmetre_dn.tif"), options: &[], folder: Folder::new() };
    let mut killed = program().stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap();
    killed.wait().unwrap();
    std::fs::write(bake.folder.path(&format!(".a.relief.{}.tmp", killed.id())), b"half a file").unwrap();
    bake.bytes(&[]);
}

#[test]
fn ctrl_c_leaves_no_output_and_can_be_resumed() {
    for signal in ["INT", "TERM"] {
        let bake = Bake::earth();
        let status = bake.interrupted(signal, &["--threads", "1"]);
        assert_eq!(status.code(), Some(2), "{signal}");
        assert_eq!(bake.folder.names(), ["a.relief.part"], "{signal}");
        let (report, bytes) = bake.bytes(&["--resume"]);
        assert!(resumed(&report) > 0, "{report}");
        if signal == "INT" {
            same(&bake.bytes(&[]).1, &bytes);
        }
    }
}

#[test]
fn ctrl_c_says_how_to_go_on() {
    let bake = Bake::earth();
    let mut child = bake.command(&["--threads", "1"]).spawn().unwrap();
    while !bake.work().exists() {
        assert!(child.try_wait().unwrap().is_none(), "the bake ended before it was interrupted");
        std::thread::sleep(Duration::from_millis(1));
    }
    assert!(Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap().success());
    let run = Run::from(child.wait_with_output().unwrap());
    run.refused(&["interrupted", "rule:", "--resume"]);
    assert!(!bake.output().exists());
}

#[test]
fn bytes_do_not_depend_on_threads() {
    let cases: [(&str, &[&str]); 4] = [
        ("fiji_across_180.tif", &["--vertical", "ellipsoid"]),
        ("antarctica_epsg3031.tif", &["--vertical", "egm96", "--fill", "interpolate"]),
        ("bathymetry_utm30n_nan_untagged.tif", &["--body", "plane", "--max-error", "0.01"]),
        ("moon_dem_halfmetre_dn.tif", &["--m", "11", "--layout", "paper"]),
    ];
    for (name, options) in cases {
        let bake = Bake { source: data(name), options, folder: Folder::new() };
        let (_, one) = bake.bytes(&["--threads", "1"]);
        same(&one, &bake.bytes(&["--threads", "2"]).1);
        same(&one, &bake.bytes(&["--threads", "5", "--memory", "300MiB"]).1);
    }
}

/// The folder of the file is no part of it.
#[test]
fn bytes_do_not_depend_on_where_the_input_lies() {
    let bake = Bake { source: data("moon_dem_halfmetre_dn.tif"), options: &[], folder: Folder::new() };
    let (_, here) = bake.bytes(&[]);
    let elsewhere = Folder::new();
    let copy = elsewhere.path("moon_dem_halfmetre_dn.tif");
    std::fs::copy(&bake.source, &copy).unwrap();
    let moved = Bake { source: copy, options: &[], folder: Folder::new() };
    same(&here, &moved.bytes(&[]).1);
}

#[cfg(target_os = "linux")]
#[test]
fn memory_stays_within_its_bound() {
    let options = &["--vertical", "ellipsoid", "--m", "13", "--memory", "512MiB", "--threads", "2"];
    let bake = Bake { source: data("earth_etopo1_6min.tif"), options, folder: Folder::new() };
    let mut child = bake.command(&[]).spawn().unwrap();
    let peak_bytes = watch(&mut child);
    assert!(child.wait().unwrap().success());
    assert!(peak_bytes > 50 << 20, "{peak_bytes} bytes at most: nothing was measured");
    assert!(peak_bytes < 700 << 20, "{} MiB", peak_bytes >> 20);
}

/// The largest resident set of a process, bytes, seen until it ends.
fn watch(child: &mut Child) -> u64 {
    let status = format!("/proc/{}/status", child.id());
    let mut peak = 0;
    while child.try_wait().unwrap().is_none() {
        let text = std::fs::read_to_string(Path::new(&status)).unwrap_or_default();
        let line = text.lines().find_map(|line| line.strip_prefix("VmHWM:"));
        let kib = line.and_then(|line| line.split_whitespace().next()).and_then(|n| n.parse::<u64>().ok());
        peak = peak.max(kib.unwrap_or(0) * 1024);
        std::thread::sleep(Duration::from_millis(10));
    }
    peak
}
