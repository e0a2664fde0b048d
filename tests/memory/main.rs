//! What is allocated and what is kept. A program of its own, since it counts in the allocator.

#![allow(unsafe_code, reason = "an allocator is unsafe to implement")]

// Shared: the allocator that counts, for each thread by itself.
mod counting;
// The iteration loops allocate nothing once they are warm.
mod allocations;
// A long history stays within its stated memory.
mod history;
