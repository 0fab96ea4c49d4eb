//! The socket's file.

use std::os::unix::fs::PermissionsExt as _;
use std::os::unix::net;
use std::path::Path;

use crate::serve::local::Listener;

fn refusal(path: &Path) -> String {
    Listener::bind(path).unwrap_err().to_string()
}

#[tokio::test]
async fn only_the_owner_may_open_it_and_it_goes_with_the_daemon() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("relief.sock");
    let listener = Listener::bind(&path).unwrap();
    assert_eq!(std::fs::metadata(&path).unwrap().permissions().mode() & 0o777, 0o600);
    assert!(refusal(&path).contains("somebody listens there"));
    drop(listener);
    assert!(!path.exists());
}

#[tokio::test]
async fn a_socket_that_nobody_uses_is_replaced_and_nothing_else() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("relief.sock");
    drop(net::UnixListener::bind(&path).unwrap());
    assert!(path.exists(), "left behind as by a daemon that was killed");
    let listener = Listener::bind(&path).unwrap();
    // Another daemon's file in its place stays.
    std::fs::remove_file(&path).unwrap();
    let other = net::UnixListener::bind(&path).unwrap();
    drop(listener);
    assert!(path.exists());
    drop(other);

    let file = folder.path().join("notes.txt");
    std::fs::write(&file, "kept").unwrap();
    assert!(refusal(&file).contains("no socket"));
    assert_eq!(std::fs::read_to_string(&file).unwrap(), "kept");
    for nowhere in [folder.path().join("no/such/folder.sock"), folder.path().join("x".repeat(120))] {
        assert!(refusal(&nowhere).contains("rule: a socket's path has at most 107 bytes"), "{}", refusal(&nowhere));
    }
}
