//! Opening the page, where somebody sits in front of the daemon.

use std::io::IsTerminal as _;
use std::process::{Command, Stdio};

/// Opens an address with `xdg-open`, where the daemon was started in a terminal beside a display.
pub fn open(address: &str, headless: bool) {
    let display =
        ["DISPLAY", "WAYLAND_DISPLAY"].iter().any(|name| std::env::var_os(name).is_some_and(|v| !v.is_empty()));
    if !wanted(headless, std::io::stdout().is_terminal(), display) {
        return;
    }
    let mut command = Command::new("xdg-open");
    command.arg(address).stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null());
    match command.spawn() {
        // Somebody must hear of its end.
        Ok(mut child) => drop(std::thread::spawn(move || child.wait())),
        Err(error) => tracing::debug!("xdg-open: {error}"),
    }
}

fn wanted(headless: bool, terminal: bool, display: bool) -> bool {
    !headless && terminal && display
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_before_somebodys_eyes() {
        assert!(wanted(false, true, true));
        assert!(!wanted(true, true, true) && !wanted(false, false, true) && !wanted(false, true, false));
    }
}
