//! Tests of the program, run as a user runs it, and of its library.
//!
//! One program for all of them: each file is a module, `cargo test --test all NAME::` runs one.
#![allow(clippy::unwrap_used)]

mod axes;
mod axis_view;
mod bad_input;
mod bodies;
mod choice;
mod common;
mod export;
mod flank;
mod golden_messages;
mod init;
mod inspect;
mod left_out;
mod library;
mod lines;
mod main_job;
mod matrix;
mod measured_data;
mod mesh;
mod operations;
mod outputs;
mod repeat;
mod rest;
mod saved_stock;
mod second;
mod second_opinion;
mod second_posted;
mod sides;
mod sizes;
mod stop;
mod strip;
mod sweep;
mod three_axis;
mod tools_library;
mod verdicts;
mod verify_setup;
mod verify_stock;
