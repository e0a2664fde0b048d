//! Random bytes of the operating system.

use std::io;

/// Unpredictable bytes, for secrets.
///
/// # Errors
/// From the system.
pub fn bytes<const N: usize>() -> io::Result<[u8; N]> {
    let mut bytes = [0; N];
    getrandom::fill(&mut bytes)?;
    Ok(bytes)
}
