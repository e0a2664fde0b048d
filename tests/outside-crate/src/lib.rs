//! What another crate can add to `stickslip-core` without touching it: a strategy ([`SlidesFirst`]), a continuum element
//! ([`cubic`]) and something that deforms ([`Stiffening`]).

#![forbid(unsafe_code)]

pub mod cubic;
mod slides_first;
mod stiffening;

pub use slides_first::SlidesFirst;
pub use stiffening::Stiffening;
