//! The fuzzer's way to `looks/step.rs`, which says what is looked at.

#![no_main]

#[path = "../looks/step.rs"]
mod step;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| step::look(bytes));
