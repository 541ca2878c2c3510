//! Volumes that carving takes, against closed forms, over three sizes of the cell.
//!
//! `cargo run --release -p osculate-tools --example stock_volumes`; exits 1 where the finest is off by more than 0.1 %.

#![allow(clippy::print_stdout, reason = "a study prints its table")]

#[path = "../tests/removal/common.rs"]
#[allow(dead_code, reason = "shared with the tests")]
mod common;
#[path = "../tests/removal/volumes.rs"]
mod volumes;

use osculate_geom::{Box3, Point3};
use osculate_tools::removal::stock::{Blank, Resolution, Stock, StockJob};
use std::error::Error;
use std::process::ExitCode;

/// Cells, compared with those of the tests.
const COARSER: [f64; 3] = [4.0, 2.0, 1.0];
/// Allowed at the finest.
const ALLOWED: f64 = 1e-3;

fn main() -> Result<ExitCode, Box<dyn Error>> {
    println!(
        "{:<24} {:>8} {:>13} {:>13} {:>9} {:>11}",
        "cut", "cell mm", "closed mm3", "carved mm3", "off %", "spread mm3"
    );
    let mut good = true;
    for case in volumes::cases() {
        let whole = Box3 { min: Point3::origin(), max: Point3::from(case.size_mm) };
        let mut off = f64::INFINITY;
        for coarser in COARSER {
            let cell_mm = coarser * case.cell_mm;
            let resolution = Resolution { cell_mm, tri: true, budget_bytes: 1 << 30 };
            let mut stock = Stock::fill(&Blank::Box(whole), &resolution)?.stock;
            let job = StockJob { cutter: &case.cutter, uppers: &[], motions: &case.motions, touch_mm: 1e-3 };
            let carved = stock.carve(&job, &|_| ())?.volume_mm3();
            off = carved / case.volume_mm3 - 1.0;
            println!(
                "{:<24} {cell_mm:>8.3} {:>13.4} {carved:>13.4} {:>9.4} {:>11.4}",
                case.name,
                case.volume_mm3,
                100.0 * off,
                stock.volume().spread_mm3
            );
        }
        good &= off.abs() < ALLOWED;
    }
    println!("{}", if good { "all within 0.1 % at the finest" } else { "NOT all within 0.1 %" });
    Ok(ExitCode::from(u8::from(!good)))
}
