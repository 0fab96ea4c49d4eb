//! `reliefd serve`: viewers attach.

mod args;
mod ask;
mod descriptors;
mod engine;
mod heights;
mod http;
mod hub;
mod idle;
#[cfg(target_os = "linux")]
mod local;
mod meters;
mod patience;
mod session;
mod truncated;
mod watch;

use std::net::SocketAddr;
use std::path::Path;
use std::sync::Arc;
use std::time::Duration;

use relief_front::error::ToolError;
use relief_front::stdout::print;
use relief_runtime::planet::Planet;

use crate::Outcome;
use crate::backend::Backend;
use crate::errors::{of_render, opened};
use engine::{Engine, Limits, StartError};
use hub::{Hub, Served};
use meters::Meters;

pub use args::Args;

/// Runs the command.
///
/// # Errors
/// What kept it from running.
pub fn run(args: &Args) -> Result<Outcome, ToolError> {
    let filter = tracing_subscriber::EnvFilter::try_from_default_env().unwrap_or_else(|_| "info".into());
    tracing_subscriber::fmt().with_env_filter(filter).with_writer(std::io::stderr).init();
    descriptors::raise();
    let runtime = tokio::runtime::Builder::new_multi_thread()
        .enable_all()
        // They pack pictures; more than these would only hold more of them.
        .max_blocking_threads(64)
        .thread_keep_alive(Duration::from_secs(2))
        .build()
        .map_err(|error| cannot("start its threads", &error))?;
    let hub = Arc::new(hub(args)?);
    runtime.block_on(serve(args, hub))?;
    Ok(Outcome::Good)
}

/// Opens all files.
fn hub(args: &Args) -> Result<Hub, ToolError> {
    let share = args.files.len().max(1) as u64;
    let mut hub = Hub::new(args.max_viewers, None, Arc::new(Meters::default()));
    for path in &args.files {
        let name = stem(path);
        let backend = Backend::find(args.backend)?;
        let ram = (1u64 << 30) / share;
        // The CPU's atlas lies in RAM too.
        let (cache_bytes, atlas_bytes) = match backend {
            Backend::Cpu => (ram / 2, ram / 2),
            Backend::Gpu(_) => (ram, (1 << 30) / share),
        };
        let planet = open(path, cache_bytes)?;
        let ear = hub.ear(&name, &planet);
        let time_budget = Duration::from_secs_f64(args.time_budget / 1e3);
        let limits = Limits { backend: args.backend, atlas_bytes, time_budget };
        let engine = Engine::start(planet, backend, limits, ear.clone()).map_err(|error| match error {
            StartError::Render(error) => of_render(path)(error),
            StartError::Thread(error) => cannot("start its threads", &error),
        })?;
        tracing::info!(planet = name, path = %path.display(), backend = engine.backend(), "serving");
        hub.add(Served::new(&ear, path.clone(), Arc::new(engine)));
    }
    Ok(hub)
}

fn open(path: &Path, cache_bytes: u64) -> Result<Arc<Planet>, ToolError> {
    let relief = truncated::open(path).map_err(ToolError::of_file(path))?;
    Planet::new(relief, cache_bytes).map_err(opened(path))
}

async fn serve(args: &Args, hub: Arc<Hub>) -> Result<(), ToolError> {
    let listen = if args.listen == "auto" { "127.0.0.1:0" } else { &args.listen };
    let address: SocketAddr = listen.parse().map_err(|_| {
        ToolError::usage(
            format!("--listen {}", args.listen),
            "an address is IP:PORT, or auto",
            "give one such as --listen 127.0.0.1:7878",
        )
    })?;
    let listener = tokio::net::TcpListener::bind(address).await.map_err(|error| {
        ToolError::usage(
            format!("--listen {listen}: {error}"),
            "a daemon listens where nobody else does",
            "give another port, or --listen auto",
        )
    })?;
    let address = listener.local_addr().map_err(|error| cannot("read its own address", &error))?;
    let local_viewers = local_viewers(args, &hub)?;
    print(&format!("http://{address}/\n"))?;
    tokio::spawn(watch::watch(Arc::clone(&hub)));
    let listener = idle::Idle::new(listener, patience::patience().idle);
    let web = axum::serve(listener, http::router(hub)).with_graceful_shutdown(async {
        // Without a handler for it there is nothing to wait for.
        let _ = tokio::signal::ctrl_c().await;
    });
    tokio::select! {
        done = web.into_future() => done.map_err(|error| cannot("serve", &error)),
        () = local_viewers => Ok(()),
    }
}

/// Takes viewers at the Unix socket, if there is to be one, for as long as it is polled.
#[cfg(target_os = "linux")]
fn local_viewers(args: &Args, hub: &Arc<Hub>) -> Result<impl Future<Output = ()> + use<>, ToolError> {
    let listener = args.unix.as_deref().map(local::Listener::bind).transpose()?;
    let hub = Arc::clone(hub);
    Ok(async move {
        match listener {
            Some(listener) => listener.serve(hub).await,
            None => std::future::pending().await,
        }
    })
}

#[cfg(not(target_os = "linux"))]
fn local_viewers(_: &Args, _: &Arc<Hub>) -> Result<impl Future<Output = ()> + use<>, ToolError> {
    Ok(std::future::pending())
}

fn stem(path: &Path) -> String {
    path.file_stem().unwrap_or_default().to_string_lossy().into_owned()
}

fn cannot(what: &str, error: &std::io::Error) -> ToolError {
    ToolError::usage(
        format!("the daemon cannot {what}: {error}"),
        "the operating system gives it what it needs",
        "close other programs, or raise the limits (ulimit)",
    )
}
