//! `--token-file`.

use std::path::Path;

use relief_front::error::ToolError;

/// A shorter one can be found by trying.
const GOOD_BYTES: usize = 16;

/// The token: the file's first line.
///
/// # Errors
/// A file that cannot be read, or a line that is no token.
pub fn read(path: &Path) -> Result<String, ToolError> {
    let text = std::fs::read_to_string(path).map_err(|error| ToolError::Io {
        action: "cannot read the token in",
        path: path.to_path_buf(),
        error,
        remedy: "name a file that the daemon may read, such as one made by `openssl rand -hex 32`".into(),
    })?;
    let token = text.lines().next().unwrap_or_default();
    let refused = |what: &str| {
        Err(ToolError::usage(
            format!("--token-file: {what}: {}", path.display()),
            "a token is the first line of its file, visible ASCII without spaces",
            format!("make one: (umask 077; openssl rand -hex 32 > {})", path.display()),
        ))
    };
    if token.trim().is_empty() {
        return refused("an empty first line");
    }
    if !token.bytes().all(|byte| byte.is_ascii_graphic()) {
        return refused("a token with spaces or other signs that no header can carry");
    }
    if token.len() < GOOD_BYTES {
        tracing::warn!("the token has only {} signs: whoever tries long enough finds it", token.len());
    }
    if open_to_others(path) {
        tracing::warn!("others may read the token (chmod 600): {}", path.display());
    }
    Ok(token.to_owned())
}

#[cfg(unix)]
fn open_to_others(path: &Path) -> bool {
    use std::os::unix::fs::PermissionsExt as _;
    std::fs::metadata(path).is_ok_and(|file| file.permissions().mode() & 0o077 != 0)
}

#[cfg(not(unix))]
fn open_to_others(_: &Path) -> bool {
    false
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "a test may end in a panic")]

    use super::*;

    #[test]
    fn the_first_line_is_the_token() {
        let file = tempfile::NamedTempFile::new().unwrap();
        let of = |text: &[u8]| {
            std::fs::write(file.path(), text).unwrap();
            read(file.path())
        };
        assert_eq!(of(b"0123456789abcdef\nmore").unwrap(), "0123456789abcdef");
        assert_eq!(of(b"short\r\n").unwrap(), "short");
        for bad in [&b""[..], b"\nsecret", b"  \t\n", b"two words", b"sn\xc3\xa9", b" leads"] {
            let error = of(bad).unwrap_err().to_string();
            assert!(error.contains("rule: a token") && !error.contains("secret"), "{error}");
        }
        assert!(of(b"\xff\xfe").unwrap_err().to_string().contains("remedy:"));
        assert!(read(Path::new("no/such/file")).unwrap_err().to_string().contains("cannot read the token"));
    }

    #[test]
    #[cfg(unix)]
    fn open_files_are_noticed() {
        use std::os::unix::fs::PermissionsExt as _;
        let file = tempfile::NamedTempFile::new().unwrap();
        assert!(!open_to_others(file.path()));
        std::fs::set_permissions(file.path(), std::fs::Permissions::from_mode(0o640)).unwrap();
        assert!(open_to_others(file.path()));
    }
}
