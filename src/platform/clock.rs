//! Clocks: the system's, or the one that the page provides where there is none.

#[cfg(target_family = "wasm")]
pub use page::{Instant, set_source};
#[cfg(not(target_family = "wasm"))]
pub use std::time::Instant;

use std::time::Duration;

/// Time since 1970-01-01 UTC; zero before.
pub fn since_1970() -> Duration {
    #[cfg(not(target_family = "wasm"))]
    let time = std::time::SystemTime::now()
        .duration_since(std::time::UNIX_EPOCH)
        .unwrap_or_default();
    #[cfg(target_family = "wasm")]
    let time = page::now();
    time
}

/// The clock of the page.
#[cfg(target_family = "wasm")]
mod page {
    use std::sync::OnceLock;
    use std::time::Duration;

    static SOURCE: OnceLock<fn() -> f64> = OnceLock::new();

    /// Installs the clock: milliseconds since 1970-01-01 UTC. Without one, time does not advance.
    pub fn set_source(milliseconds: fn() -> f64) {
        SOURCE.get_or_init(|| milliseconds);
    }

    pub fn now() -> Duration {
        let milliseconds = SOURCE.get().map_or(0.0, |source| source());
        Duration::try_from_secs_f64(milliseconds / 1e3).unwrap_or_default()
    }

    /// A point in time.
    #[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
    pub struct Instant(Duration);

    impl Instant {
        /// The current time.
        pub fn now() -> Instant {
            Instant(now())
        }

        /// Time since then; zero if the clock was set back.
        pub fn elapsed(&self) -> Duration {
            now().saturating_sub(self.0)
        }

        /// The point in time this much earlier; `None` before 1970.
        pub fn checked_sub(self, duration: Duration) -> Option<Instant> {
            self.0.checked_sub(duration).map(Instant)
        }
    }
}
