//! The fuzzer's way to `looks/job.rs`, which says what is looked at.

#![no_main]

#[path = "../looks/job.rs"]
mod job;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| job::look(bytes));
