//! `/v1`: what scripts ask.

pub mod attach;
pub mod distance;
pub mod height;
pub mod heights;
pub mod mesh;
pub mod openapi;
pub mod planets;
pub mod render;
pub mod shadow;

use std::time::Duration;

/// Longest time to wait for tiles.
#[derive(Debug, clap::Args)]
pub struct WaitArgs {
    /// Longest time to wait for tiles, seconds, at most 600
    #[arg(long, value_name = "S", default_value_t = 60.0, value_parser = wait_s)]
    wait: f64,
}

impl WaitArgs {
    fn time(&self) -> Duration {
        Duration::from_secs_f64(self.wait)
    }
}

fn wait_s(text: &str) -> Result<f64, String> {
    text.parse().ok().filter(|s| (0.0..=600.0).contains(s)).ok_or_else(|| "a wait is 0 to 600 seconds".into())
}
