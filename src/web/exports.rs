//! The functions that the worker calls, and the clock that it provides. Messages are JSON in two buffers.

#![allow(unsafe_code)] // names of functions for JavaScript; no pointer is read here

use crate::message::{Request, Update};
use crate::page::Page;
use std::cell::RefCell;
use stickslip_platform::clock;

unsafe extern "C" {
    /// Milliseconds since 1970-01-01 UTC.
    safe fn now() -> f64;
}

thread_local! {
    static INPUT: RefCell<Vec<u8>> = const { RefCell::new(Vec::new()) };
    static OUTPUT: RefCell<Vec<u8>> = const { RefCell::new(Vec::new()) };
    static PAGE: RefCell<Option<Page>> = const { RefCell::new(None) };
}

/// Makes room for a request and returns its address.
#[unsafe(no_mangle)]
pub extern "C" fn input(length: usize) -> *mut u8 {
    INPUT.with_borrow_mut(|input| {
        input.resize(length, 0);
        input.as_mut_ptr()
    })
}

/// Handles the request and returns the length of the update.
#[unsafe(no_mangle)]
pub extern "C" fn handle() -> usize {
    let update = PAGE.with_borrow_mut(|page| {
        let page = page.get_or_insert_with(|| {
            clock::set_source(|| now());
            std::panic::set_hook(Box::new(|panic| answer(panic.to_string().into_bytes())));
            Page::new()
        });
        INPUT
            .with_borrow(|input| serde_json::from_slice::<Request>(input))
            .map_or_else(|_| Update::default(), |request| page.handle(request))
    });
    answer(serde_json::to_vec(&update).unwrap_or_default());
    OUTPUT.with_borrow(Vec::len)
}

/// The address of the update; after a panic, of its message.
#[unsafe(no_mangle)]
pub extern "C" fn output() -> *const u8 {
    OUTPUT.with_borrow(|output| output.as_ptr())
}

/// The length of the update or message.
#[unsafe(no_mangle)]
pub extern "C" fn output_length() -> usize {
    OUTPUT.with_borrow(Vec::len)
}

fn answer(bytes: Vec<u8>) {
    OUTPUT.with_borrow_mut(|output| *output = bytes);
}
