//! `reliefd serve`: viewers attach.

mod args;
mod ask;
mod browser;
mod config;
mod descriptors;
mod engine;
mod heights;
mod http;
mod hub;
mod idle;
mod listen;
#[cfg(target_os = "linux")]
mod local;
mod logs;
mod meters;
mod notify;
mod patience;
mod planets;
mod session;
mod stop;
mod token;
mod watch;

use std::net::TcpListener;
use std::sync::Arc;
use std::time::Duration;

use relief_front::error::ToolError;
use relief_front::stdout::print;
use relief_protocol::to_viewer::ToViewer;
use tokio::sync::Semaphore;
use tokio::task::JoinHandle;

use crate::Outcome;
use http::connections::Connections;
use http::shared::Shared;
use hub::Hub;
use stop::Stop;

pub use args::Args;
pub use config::configured;

/// Time for what is in flight when the daemon ends.
const ENDING: Duration = Duration::from_secs(10);
/// Time for work that nobody waits for any more.
const LEFT_BEHIND: Duration = Duration::from_secs(1);

/// Runs the command.
///
/// # Errors
/// What kept it from running.
pub fn run(args: &Args) -> Result<Outcome, ToolError> {
    logs::start(args.log);
    descriptors::raise();
    let token = args.token_file.as_deref().map(token::read).transpose()?;
    let listeners = listen::listeners(args.listen, token.is_some())?;
    let runtime = tokio::runtime::Builder::new_multi_thread()
        .enable_all()
        // They pack pictures; more than these would only hold more of them.
        .max_blocking_threads(64)
        .thread_keep_alive(Duration::from_secs(2))
        .build()
        .map_err(|error| cannot("start its threads", &error))?;
    let hub = Arc::new(planets::hub(args, token.as_deref())?);
    let ended = runtime.block_on(serve(args, &hub, listeners));
    runtime.shutdown_timeout(LEFT_BEHIND);
    ended.map(|()| Outcome::Good)
}

async fn serve(args: &Args, hub: &Arc<Hub>, listeners: Vec<TcpListener>) -> Result<(), ToolError> {
    let signal = stop::signals()?;
    let stop = Stop::new();
    let room = Arc::new(Semaphore::new(args.max_requests as usize));
    let shared = Shared { hub: Arc::clone(hub), stop: stop.clone(), room: Arc::clone(&room) };
    let (connections, closer) = Connections::new(http::router(shared));
    let mut addresses = Vec::new();
    for listener in listeners {
        let address = listener.local_addr().map_err(|error| cannot("read its own address", &error))?;
        addresses.push(listen::to_open(address));
        let taking = connections.clone().take(listener).map_err(|error| cannot("listen", &error))?;
        tokio::spawn(taking);
    }
    drop(connections);
    let local_viewers = local_viewers(args, hub, &stop)?;
    let watched = tokio::spawn(watch::watch(Arc::clone(hub)));
    let watchdog = tokio::spawn(notify::watchdog(Arc::clone(hub)));
    for address in &addresses {
        print(&format!("{address}\n"))?;
    }
    notify::ready(&format!("serving {} planets at {}", hub.all().count(), addresses.join(", ")));
    if let Some(address) = addresses.first() {
        browser::open(address, args.headless);
    }
    let name = signal.await;
    tracing::info!("{name}: ending");
    notify::stopping();
    watchdog.abort();
    watched.abort();
    stop.begin();
    hub.tell(ToViewer::Bye { reason: "the daemon is ending".into() });
    let ended = tokio::time::timeout(ENDING, async {
        // The socket's file goes with its listener.
        let _ = local_viewers.await;
        hub.emptied().await;
        // All that is in work has given its permit back.
        let _ = room.acquire_many(args.max_requests).await;
        closer.close().await;
    });
    if ended.await.is_err() {
        tracing::warn!("viewers or requests were left after {} s", ENDING.as_secs());
    }
    Ok(())
}

/// Takes viewers at the Unix socket, if there is to be one, until the daemon ends.
#[cfg(target_os = "linux")]
fn local_viewers(args: &Args, hub: &Arc<Hub>, stop: &Stop) -> Result<JoinHandle<()>, ToolError> {
    let listener = args.unix.as_deref().map(local::Listener::bind).transpose()?;
    let (hub, stop) = (Arc::clone(hub), stop.clone());
    Ok(tokio::spawn(async move {
        if let Some(listener) = listener {
            tokio::select! {
                () = listener.serve(hub) => {}
                () = stop.wait() => {}
            }
        }
    }))
}

#[cfg(not(target_os = "linux"))]
fn local_viewers(_: &Args, _: &Arc<Hub>, _: &Stop) -> Result<JoinHandle<()>, ToolError> {
    Ok(tokio::spawn(std::future::ready(())))
}

/// What the system refused.
fn cannot(what: &str, error: &std::io::Error) -> ToolError {
    ToolError::usage(
        format!("the daemon cannot {what}: {error}"),
        "the operating system gives it what it needs",
        "close other programs, or raise the limits (ulimit)",
    )
}
