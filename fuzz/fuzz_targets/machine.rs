//! The fuzzer's way to `looks/machine.rs`, which says what is looked at.

#![no_main]

#[path = "../looks/machine.rs"]
mod machine;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| machine::look(bytes));
