//! Random numbers of one scene: a stream of its own of the PCG generator, so that it depends on seed and number alone.

use rand_pcg::Pcg64;
use rand_pcg::rand_core::Rng;

/// Numbers of one stream.
pub struct Draw(Pcg64);

impl Draw {
    pub fn new(seed: u64, number: u64) -> Self {
        Draw(Pcg64::new(u128::from(seed), u128::from(number)))
    }

    /// Uniform in low to high.
    pub fn uniform(&mut self, low: f64, high: f64) -> f64 {
        let part = (self.0.next_u64() >> 11) as f64 / (1u64 << 53) as f64;
        low + (high - low) * part
    }

    /// The same, rounded as an author would.
    pub fn number(&mut self, low: f64, high: f64) -> f64 {
        round(self.uniform(low, high))
    }

    /// Uniform on a logarithmic scale, rounded.
    pub fn scale(&mut self, low: f64, high: f64) -> f64 {
        round(self.uniform(low.ln(), high.ln()).exp())
    }

    /// True in that part of all cases.
    pub fn chance(&mut self, part: f64) -> bool {
        self.uniform(0.0, 1.0) < part
    }

    /// A whole number from low to high.
    pub fn whole(&mut self, low: usize, high: usize) -> usize {
        low + (self.0.next_u64() % (high - low + 1) as u64) as usize
    }

    /// One of these.
    pub fn pick<T: Copy>(&mut self, from: &[T]) -> T {
        from[self.whole(0, from.len() - 1)]
    }

    /// 1 or −1.
    pub fn sign(&mut self) -> f64 {
        if self.chance(0.5) { 1.0 } else { -1.0 }
    }
}

/// To four digits.
pub fn round(x: f64) -> f64 {
    // What is printed with four digits reads back.
    format!("{x:.3e}").parse().unwrap_or(x)
}
