//! GDAL kept quiet: what it would print is collected and goes into our errors.

use std::cell::RefCell;
use std::sync::Once;

use gdal::errors::CplErrType;

thread_local! {
    static MESSAGES: RefCell<Vec<String>> = const { RefCell::new(Vec::new()) };
}

static SET_UP: Once = Once::new();

/// At most this many messages are kept between two calls of [`drain`].
const KEPT: usize = 8;

/// Routes GDAL's messages here and sets its options. Idempotent; call before any use of GDAL.
pub(crate) fn set_up() {
    SET_UP.call_once(|| {
        gdal::config::set_error_handler(|class, _, text| {
            if matches!(class, CplErrType::Failure | CplErrType::Fatal) {
                MESSAGES.with_borrow_mut(|kept| {
                    if kept.len() < KEPT {
                        kept.push(text.trim().replace('\n', " "));
                    }
                });
            }
        });
        // Blocks are cached by this crate; GDAL's own cache would come on top of the budget.
        for (key, value) in [("GDAL_CACHEMAX", "64"), ("GDAL_PAM_ENABLED", "YES"), ("PROJ_NETWORK", "OFF")] {
            // Fails only for text with a NUL byte.
            let _ = gdal::config::set_config_option(key, value);
        }
    });
}

/// Takes this thread's collected failures.
pub(crate) fn drain() -> Vec<String> {
    MESSAGES.with_borrow_mut(std::mem::take)
}

/// GDAL's own words on what has just failed, without repetition; `error` where it kept silent.
pub(crate) fn explain(error: &gdal::errors::GdalError) -> String {
    let mut messages = drain();
    messages.dedup();
    if messages.is_empty() { error.to_string() } else { messages.join("; ") }
}
