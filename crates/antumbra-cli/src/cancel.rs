//! Ctrl-C: finish what is saved and stop.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use crate::failure::Failure;

/// A flag that Ctrl-C (or a request to terminate) sets. A second one ends the program at once.
pub(crate) fn on_interrupt() -> Result<Arc<AtomicBool>, Failure> {
    let flag = Arc::new(AtomicBool::new(false));
    let shared = Arc::clone(&flag);
    let handler = move || {
        if shared.swap(true, Ordering::SeqCst) {
            std::process::exit(5);
        }
    };
    ctrlc::set_handler(handler)
        .map_err(|cause| Failure::Path(format!("Ctrl-C cannot be handled here ({cause})")))?;
    Ok(flag)
}
