use std::time::{Instant, SystemTime};

use super::*;

/// Names of the folder once stale temporaries of `a.relief` are gone.
fn left(folder: &Path) -> Vec<String> {
    remove_stale(&folder.join("a.relief"));
    let entries = std::fs::read_dir(folder).unwrap();
    let mut names: Vec<_> = entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    names
}

/// Waits until no more than this is left: a process that another test is about to start may hold a
/// copy of a closed handle for a moment.
fn is_left(folder: &Path, names: &[String]) {
    let deadline = Instant::now() + Duration::from_secs(20);
    while left(folder) != names {
        assert!(Instant::now() < deadline, "{:?} is left, not {names:?}", left(folder));
        std::thread::sleep(Duration::from_millis(1));
    }
}

/// The number of a process that has ended.
#[cfg(target_os = "linux")]
fn dead() -> u32 {
    let mut child = std::process::Command::new("true").spawn().unwrap();
    child.wait().unwrap();
    child.id()
}

/// Makes a file that nobody has written for two days.
fn old(path: &Path) {
    let file = File::create(path).unwrap();
    file.set_modified(SystemTime::now() - 2 * DAY).unwrap();
}

#[test]
fn a_name_holds_its_process() {
    let of = |name: &str| writer(OsStr::new(name), &prefix(Path::new("x/a.relief")));
    assert_eq!(of(".a.relief.17.tmp"), Some(17));
    assert_eq!(of(".a.relief.17.Xy9.tmp"), Some(17));
    let stem = stem(Path::new("a.relief")).into_string().unwrap();
    assert_eq!(of(&format!("{stem}{SUFFIX}")), Some(std::process::id()));
    for other in [
        "a.relief",
        ".b.relief.17.tmp",
        ".a.relief.17",
        ".a.relief.17x.tmp",
        ".a.relief.+17.tmp",
        ".a.relief..tmp",
        ".a.relief.x.17.tmp",
        ".a.relief.17.x.y.tmp",
        ".a.relief.99999999999.tmp",
    ] {
        assert_eq!(of(other), None, "{other}");
    }
}

#[test]
fn names_that_are_long_have_short_temporaries() {
    let long = PathBuf::from("n".repeat(250));
    assert!(stem(&long).len() < 30);
    assert_eq!(writer(OsStr::new(".relief-output.5.tmp"), &prefix(&long)), Some(5));
}

#[cfg(target_os = "linux")]
#[test]
fn what_a_dead_process_left_goes_and_what_is_in_work_stays() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: String| folder.path().join(name);
    let (dead, own) = (dead(), std::process::id());
    for name in [format!(".a.relief.{dead}.tmp"), format!(".b.relief.{dead}.tmp"), format!(".a.relief.{own}.tmp")] {
        std::fs::write(path(name), "bytes").unwrap();
    }
    std::fs::create_dir(path(format!(".a.relief.{dead}.F0.tmp"))).unwrap();
    std::fs::write(path(format!(".a.relief.{dead}.F0.tmp")).join("model.glb"), "bytes").unwrap();
    std::fs::write(path("a.relief".into()), "the output").unwrap();
    std::os::unix::fs::symlink("a.relief", path(format!(".a.relief.{dead}.link.tmp"))).unwrap();
    let mut stays = [
        format!(".a.relief.{dead}.link.tmp"),
        format!(".a.relief.{own}.tmp"),
        format!(".b.relief.{dead}.tmp"),
        "a.relief".into(),
    ];
    stays.sort();
    assert_eq!(left(folder.path()), stays);
}

/// As in a folder that is shared: the writer is no process of this system.
#[cfg(target_os = "linux")]
#[test]
fn what_is_held_stays_until_it_is_let_go() {
    let folder = tempfile::tempdir().unwrap();
    let (file, staging) = (format!(".a.relief.{}.tmp", dead()), format!(".a.relief.{}.F0.tmp", dead()));
    let held = File::create(folder.path().join(&file)).unwrap();
    std::fs::create_dir(folder.path().join(&staging)).unwrap();
    let held_folder = File::open(folder.path().join(&staging)).unwrap();
    hold(&held);
    hold(&held_folder);
    assert_eq!(left(folder.path()).len(), 2);
    drop(held);
    is_left(folder.path(), &[staging]);
    drop(held_folder);
    is_left(folder.path(), &[]);
}

#[test]
fn a_number_that_came_again_does_not_keep_it() {
    let folder = tempfile::tempdir().unwrap();
    let name = format!(".a.relief.{}.tmp", std::process::id());
    let path = folder.path().join(&name);
    std::fs::write(&path, "bytes").unwrap();
    assert_eq!(left(folder.path()).len(), 1);
    old(&path);
    let held = File::options().write(true).open(&path).unwrap();
    hold(&held);
    assert_eq!(left(folder.path()), [name]);
    drop(held);
    is_left(folder.path(), &[]);
}

/// A folder that does not exist is whoever writes there to tell of.
#[test]
fn nothing_is_done_where_nothing_is() {
    remove_stale(Path::new("/nowhere/a.relief"));
    remove_stale(Path::new(""));
}
