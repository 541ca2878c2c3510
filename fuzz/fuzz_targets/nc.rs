//! The fuzzer's way to `looks/nc.rs`, which says what is looked at.

#![no_main]

#[path = "../looks/nc.rs"]
mod nc;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| nc::look(bytes));
