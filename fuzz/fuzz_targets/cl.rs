//! The fuzzer's way to `looks/cl.rs`, which says what is looked at.

#![no_main]

#[path = "../looks/cl.rs"]
mod cl;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| cl::look(bytes));
