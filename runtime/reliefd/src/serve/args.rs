//! The command line of `reliefd serve`.

use std::path::PathBuf;

use crate::backend::BackendChoice;

/// The daemon: viewers attach, and a page in the browser flies over the planet
#[derive(Debug, clap::Args)]
#[command(
    long_about = "The daemon: one process maps the files, holds one set of tiles for each, and serves any number of \
        viewers, each with cameras of its own: a page in the browser, programs over a WebSocket or a Unix socket \
        (runtime/PROTOCOL.md), scripts over HTTP.\n\n\
        Prints the address to open. It ends on SIGTERM and Ctrl-C, frames in flight first.",
    after_long_help = "Examples:\n  reliefd serve earth.relief\n  \
        reliefd serve earth.relief moon.relief --listen auto --backend cpu\n  \
        reliefd serve earth.relief --listen 0.0.0.0:7878 --token-file token --unix /run/reliefd.sock"
)]
pub struct Args {
    /// The .relief files; each is served under its stem
    #[arg(value_name = "FILE", required = true)]
    pub files: Vec<PathBuf>,
    /// Where to listen; `auto` takes a free port of this machine
    #[arg(long, value_name = "ADDRESS:PORT|auto", default_value = "127.0.0.1:7878")]
    pub listen: String,
    /// A Unix socket for viewers on this machine, who get their pictures in shared memory; only its owner may open it
    #[cfg(target_os = "linux")]
    #[arg(long, value_name = "PATH")]
    pub unix: Option<PathBuf>,
    /// A file whose first line viewers must show as their token
    #[arg(long, value_name = "FILE")]
    pub token_file: Option<PathBuf>,
    /// Most viewers at a time
    #[arg(long, value_name = "N", default_value_t = 256)]
    pub max_viewers: usize,
    /// Most RAM for tiles, bytes, all files together; K, M, G, KiB, MiB, GiB are understood
    #[arg(long, value_name = "BYTES", default_value = "1GiB")]
    pub memory_limit: String,
    /// Most GPU memory for tiles, bytes, all files together
    #[arg(long, value_name = "BYTES", default_value = "1GiB")]
    pub gpu_memory_limit: String,
    /// Time for loading tiles between two rounds of frames, milliseconds
    #[arg(long, value_name = "MS", default_value_t = 10.0)]
    pub time_budget: f64,
    /// Do not try to open a browser
    #[arg(long)]
    pub headless: bool,
    /// Where the kernels run
    #[arg(long, value_enum, default_value = "auto")]
    pub backend: BackendChoice,
}
