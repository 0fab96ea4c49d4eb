//! The command line of `reliefd serve`.

use std::path::PathBuf;
use std::time::Duration;

use clap::builder::FalseyValueParser;
use relief_front::bytes::parse_bytes;

use super::listen::Listen;
use super::logs::LogFormat;
use crate::backend::BackendChoice;

/// The daemon: viewers attach, and a page in the browser flies over the planet
#[derive(Debug, clap::Args)]
#[command(
    long_about = "The daemon: one process maps the files, holds one set of tiles for each, and serves any number of \
        viewers, each with cameras of its own: a page in the browser, programs over a WebSocket or a Unix socket \
        (runtime/PROTOCOL.md), scripts over HTTP (/v1/openapi.json).\n\n\
        Prints the address to open. It ends on SIGTERM and Ctrl-C: requests and frames in flight first, 10 s at \
        most. Each flag can also come from the environment (RELIEFD_LISTEN, ...) or from --config; the flag counts \
        most, then the environment, then the file. Under systemd it says when it is ready, answers the watchdog \
        and takes the sockets it is given.",
    after_long_help = "Examples:\n  reliefd serve earth.relief\n  \
        reliefd serve earth.relief moon.relief --listen auto --backend cpu\n  \
        reliefd serve earth.relief --listen 0.0.0.0:7878 --token-file token --unix /run/reliefd.sock\n  \
        reliefd serve --config /etc/reliefd.toml, with lines such as\n    \
        files = [\"earth.relief\"]\n    max-viewers = 16"
)]
pub struct Args {
    /// The .relief files; each is served under its stem
    #[arg(value_name = "FILE", required = true)]
    pub files: Vec<PathBuf>,
    /// Where to listen: IP:PORT; `auto` takes a free port of this machine. Others than this machine
    /// need --token-file
    #[arg(long, env = "RELIEFD_LISTEN", value_name = "ADDRESS:PORT|auto", default_value = "127.0.0.1:7878")]
    pub listen: Listen,
    /// Also a Unix socket for viewers on this machine, who get their pictures in shared memory; only
    /// its owner may open it
    #[cfg(target_os = "linux")]
    #[arg(long, env = "RELIEFD_UNIX", value_name = "PATH")]
    pub unix: Option<PathBuf>,
    /// A file whose first line viewers must show as their token
    #[arg(long, env = "RELIEFD_TOKEN_FILE", value_name = "FILE")]
    pub token_file: Option<PathBuf>,
    /// Most viewers at a time
    #[arg(long, env = "RELIEFD_MAX_VIEWERS", value_name = "N", default_value_t = 256,
        value_parser = clap::value_parser!(u32).range(1..=65_536))]
    pub max_viewers: u32,
    /// Most HTTP requests in work at a time
    #[arg(long, env = "RELIEFD_MAX_REQUESTS", value_name = "N", default_value_t = 32,
        value_parser = clap::value_parser!(u32).range(1..=65_536))]
    pub max_requests: u32,
    /// Most RAM for tiles, all files together; K, M, G, KiB, MiB, GiB are understood
    #[arg(long, env = "RELIEFD_MEMORY_LIMIT", value_name = "BYTES", default_value = "1GiB", value_parser = parse_bytes)]
    pub memory_limit: u64,
    /// Most GPU memory for tiles, all files together
    #[arg(long, env = "RELIEFD_GPU_MEMORY_LIMIT", value_name = "BYTES", default_value = "1GiB",
        value_parser = parse_bytes)]
    pub gpu_memory_limit: u64,
    /// Time for loading tiles between two rounds of frames, milliseconds
    #[arg(long, env = "RELIEFD_TIME_BUDGET", value_name = "MS", default_value = "10", value_parser = time_budget)]
    pub time_budget: Duration,
    /// Do not try to open a browser
    #[arg(long, env = "RELIEFD_HEADLESS", value_parser = FalseyValueParser::new())]
    pub headless: bool,
    /// Where the kernels run
    #[arg(long, env = "RELIEFD_BACKEND", value_enum, default_value = "auto")]
    pub backend: BackendChoice,
    /// How the log on standard error is written; RUST_LOG says how much
    #[arg(long, env = "RELIEFD_LOG", value_enum, default_value = "text")]
    pub log: LogFormat,
    /// A TOML file with these flags' names as keys; paths in it start at its folder
    #[arg(long, env = "RELIEFD_CONFIG", value_name = "FILE.toml")]
    pub config: Option<PathBuf>,
}

fn time_budget(text: &str) -> Result<Duration, String> {
    let ms: Option<f64> = text.parse().ok().filter(|ms| (0.0..=10_000.0).contains(ms));
    let refusal = "\n  rule: a budget is 0 to 10000 milliseconds\n  remedy: leave it at 10";
    ms.map(|ms| Duration::from_secs_f64(ms / 1e3)).ok_or_else(|| refusal.into())
}
