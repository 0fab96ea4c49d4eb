//! What systemd is told: ready, stopping, still alive.

use std::sync::Arc;
use std::time::Duration;

use futures_util::future::join_all;
use sd_notify::NotifyState;

use super::hub::Hub;

/// The daemon answers from now on.
pub fn ready(status: &str) {
    tell(&[NotifyState::Ready, NotifyState::Status(status)]);
}

/// The daemon ends.
pub fn stopping() {
    tell(&[NotifyState::Stopping, NotifyState::Status("ending")]);
}

/// Answers systemd's watchdog, where it has one, for as long as every engine takes its turns.
pub async fn watchdog(hub: Arc<Hub>) {
    let Some(patience) = sd_notify::watchdog_enabled() else { return };
    let mut tick = tokio::time::interval(patience / 2);
    tick.set_missed_tick_behavior(tokio::time::MissedTickBehavior::Delay);
    let client = hub.client();
    loop {
        tick.tick().await;
        if alive(&hub, client, patience / 2).await {
            tell(&[NotifyState::Watchdog]);
        } else {
            tracing::error!("an engine is stuck; the watchdog is not answered");
        }
    }
}

async fn alive(hub: &Hub, client: u64, patience: Duration) -> bool {
    let turns = join_all(hub.all().map(|served| served.engine.run(client, |_| ())));
    tokio::time::timeout(patience, turns).await.is_ok_and(|turns| turns.iter().all(Result::is_ok))
}

/// Where nobody listens (no NOTIFY_SOCKET) nothing happens.
fn tell(states: &[NotifyState<'_>]) {
    if let Err(error) = sd_notify::notify(states) {
        tracing::warn!("cannot tell systemd: {error}");
    }
}
