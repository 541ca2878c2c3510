//! The fuzzer's way to `looks/iges.rs`, which says what is looked at.

#![no_main]

#[path = "../looks/iges.rs"]
mod iges;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| iges::look(bytes));
