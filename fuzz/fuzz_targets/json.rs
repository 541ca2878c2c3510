//! The fuzzer's way to `looks/json.rs`, which says what is looked at.

#![no_main]

#[path = "../looks/json.rs"]
mod json;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| json::look(bytes));
