//! The fuzzer's way to `looks/mesh.rs`, which says what is looked at.

#![no_main]

#[path = "../looks/mesh.rs"]
mod mesh;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| mesh::look(bytes));
