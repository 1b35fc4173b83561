//! Priority of the threads that compute.

use crate::limits;

/// Lowers the priority of this thread and of those that it starts, so that short requests are answered first when there are more
/// threads than cores. Only Linux has priorities of threads.
pub(crate) fn lower_priority() {
    #[cfg(target_os = "linux")]
    {
        thread_local!(static STANDS: std::cell::Cell<bool> = const { std::cell::Cell::new(false) });
        if !STANDS.replace(true) {
            // If it is not permitted, only other requests get slower.
            let _ = rustix::process::nice(limits::COMPUTE_NICENESS);
        }
    }
}
