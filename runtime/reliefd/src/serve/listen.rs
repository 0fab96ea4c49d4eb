//! Where the daemon listens: `--listen`, or the sockets that systemd hands over.

use std::net::{IpAddr, Ipv4Addr, Ipv6Addr, SocketAddr, TcpListener};
use std::str::FromStr;

use listenfd::ListenFd;
use relief_front::error::ToolError;

use super::cannot;

/// What `--listen` says.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Listen(SocketAddr);

impl FromStr for Listen {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let this_machine = |port| Self(SocketAddr::from((Ipv4Addr::LOCALHOST, port)));
        if text == "auto" {
            return Ok(this_machine(0));
        }
        let local = text.strip_prefix("localhost:").and_then(|port| port.parse().ok()).map(this_machine);
        local.or_else(|| text.parse().ok().map(Self)).ok_or_else(|| {
            "\n  rule: an address is IP:PORT, localhost:PORT or auto\n  remedy: give one such as --listen 127.0.0.1:7878"
                .into()
        })
    }
}

/// Listens where systemd says, or else at an address. Addresses that others can reach need a token.
///
/// # Errors
/// An address that is taken, not of this machine, or open to others without a token.
pub fn listeners(listen: Listen, has_token: bool) -> Result<Vec<TcpListener>, ToolError> {
    let mut handed = ListenFd::from_env();
    if handed.len() > 0 {
        return (0..handed.len()).map(|at| handed_over(&mut handed, at, has_token)).collect();
    }
    let Listen(address) = listen;
    check(address, &format!("--listen {address}"), has_token)?;
    let listener = TcpListener::bind(address).map_err(|error| {
        ToolError::usage(
            format!("--listen {address}: {error}"),
            "a daemon listens at an address of its machine, where nobody else does",
            "give another port, or --listen auto",
        )
    })?;
    Ok(vec![listener])
}

fn handed_over(handed: &mut ListenFd, at: usize, has_token: bool) -> Result<TcpListener, ToolError> {
    let listener = handed.take_tcp_listener(at).ok().flatten().ok_or_else(|| {
        ToolError::usage(
            format!("socket {at} of those that systemd hands over (LISTEN_FDS)"),
            "the daemon is handed TCP sockets; a Unix socket it makes itself",
            "give ListenStream=127.0.0.1:7878 in the .socket unit, and --unix PATH to the daemon",
        )
    })?;
    let address = listener.local_addr().map_err(|error| cannot("read its own address", &error))?;
    check(address, &format!("the socket {address} that systemd hands over"), has_token)?;
    Ok(listener)
}

/// Refuses what others could reach without a token.
fn check(address: SocketAddr, what: &str, has_token: bool) -> Result<(), ToolError> {
    if has_token || address.ip().to_canonical().is_loopback() {
        return Ok(());
    }
    Err(ToolError::usage(
        format!("{what} without --token-file"),
        "whoever reaches a daemon that is not on a loopback address alone shows a token",
        "give --token-file FILE, and put a server with TLS in front (README, \"A daemon for others\"), \
         or listen on 127.0.0.1",
    ))
}

/// An address as a browser on this machine opens it.
pub fn to_open(address: SocketAddr) -> String {
    let ip = match address.ip() {
        IpAddr::V4(ip) if ip.is_unspecified() => Ipv4Addr::LOCALHOST.into(),
        IpAddr::V6(ip) if ip.is_unspecified() => Ipv6Addr::LOCALHOST.into(),
        ip => ip,
    };
    format!("http://{}/", SocketAddr::new(ip, address.port()))
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "a test may end in a panic")]

    use super::*;

    #[test]
    fn addresses_are_words_or_numbers() {
        let of = |text: &str| text.parse::<Listen>().map(|Listen(address)| address.to_string());
        assert_eq!(of("auto").unwrap(), "127.0.0.1:0");
        assert_eq!(of("localhost:80").unwrap(), "127.0.0.1:80");
        assert_eq!(of("[::1]:7878").unwrap(), "[::1]:7878");
        for bad in ["", "7878", "127.0.0.1", "example.org:80", "localhost:", "127.0.0.1:99999"] {
            assert!(of(bad).unwrap_err().contains("remedy"), "{bad}");
        }
    }

    #[test]
    fn others_need_a_token() {
        let of = |address: &str, token| check(address.parse().unwrap(), "--listen", token);
        for own in ["127.0.0.1:1", "127.8.8.8:1", "[::1]:1", "[::ffff:127.0.0.1]:1"] {
            assert!(of(own, false).is_ok(), "{own}");
        }
        for open in ["0.0.0.0:1", "[::]:1", "192.168.1.4:1", "[::ffff:10.0.0.1]:1"] {
            assert!(of(open, true).is_ok(), "{open}");
            assert!(of(open, false).unwrap_err().to_string().contains("TLS in front"), "{open}");
        }
    }

    #[test]
    fn browsers_open_loopback() {
        assert_eq!(to_open("0.0.0.0:80".parse().unwrap()), "http://127.0.0.1:80/");
        assert_eq!(to_open("[::]:80".parse().unwrap()), "http://[::1]:80/");
        assert_eq!(to_open("10.1.2.3:80".parse().unwrap()), "http://10.1.2.3:80/");
    }
}
