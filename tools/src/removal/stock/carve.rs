//! Carving: all tiles of rays side by side, and what they found put together in the order of the path.

use super::Stock;
use super::rays::Rays;
use super::report::{Bite, Carved, Collision, SECTORS, Work};
use super::world::{StockJob, World};
use crate::removal::body::Body as Moved;
use crate::removal::tree::Ways;
use crate::removal::{Body, JobError};
use rayon::prelude::*;
use std::collections::HashMap;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Tiles carved at a time, before what they found is put together: bounds memory.
const AT_ONCE: usize = 256;

impl Stock {
    /// Moves the tool through the whole path. `progress` gets the fraction done. The result does not depend on the
    /// number of threads.
    ///
    /// ```
    /// use osculate_geom::{Box3, Point3, Vec3};
    /// use osculate_tools::removal::stock::{Blank, Resolution, Stock, StockJob};
    /// use osculate_tools::removal::Swept;
    /// use osculate_tools::{Cutter, Pose};
    /// // A slot 10 mm wide and 2 mm deep through a block 30 mm long: 600 mm3, to the place of its walls between the rays.
    /// let block = Blank::Box(Box3::around(&[Point3::origin(), Point3::new(30.0, 20.0, 10.0)]));
    /// let resolution = Resolution { cell_mm: 0.5, tri: true, budget_bytes: 1 << 24 };
    /// let mut stock = Stock::fill(&block, &resolution)?.stock;
    /// let cutter = Cutter::cylinder(10.0, 40.0)?;
    /// let at = |x: f64| Pose { tip: Point3::new(x, 10.0, 8.0), axis: Vec3::z_axis() };
    /// let motions = [Swept { from: at(-10.0), to: at(40.0), rapid: false, block: 1 }];
    /// let job = StockJob { cutter: &cutter, uppers: &[], motions: &motions, touch_mm: 0.01 };
    /// let carved = stock.carve(&job, &|_| ())?;
    /// assert!((carved.volume_mm3() - 600.0).abs() < 10.0 && carved.collisions.is_empty());
    /// assert!((stock.volume().mm3 + carved.volume_mm3() - 6000.0).abs() < 1e-6);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`JobError`] for numbers that are not finite and axes that turn over.
    pub fn carve(&mut self, job: &StockJob<'_>, progress: &(dyn Fn(f64) + Sync)) -> Result<Carved, JobError> {
        let mut bodies = vec![Moved { cutter: job.cutter, above_mm: 0.0, tool: 0, intrudes: false }];
        bodies.extend(job.uppers.iter().map(|u| Moved {
            cutter: u.body,
            above_mm: u.above_mm,
            tool: 0,
            intrudes: true,
        }));
        let ways = Ways::of(job.motions, &bodies, std::iter::empty())?;
        let stray_mm = self.stray_mm();
        let world = World { job, bodies, ways, stray_mm };
        let all: usize = self.fields.iter().map(|f| f.tiles.len()).sum();
        let done = AtomicUsize::new(0);
        let share = 1.0 / self.fields.len() as f64;
        let mut found: HashMap<(u32, u8), Bite> = HashMap::new();
        for field in &mut self.fields {
            let lattice = &field.lattice;
            for (chunk, tiles) in field.tiles.chunks_mut(AT_ONCE).enumerate() {
                let bites: Vec<Vec<Bite>> = tiles
                    .par_iter_mut()
                    .enumerate()
                    .map(|(k, tile)| {
                        let bites = Rays::new(&world, lattice, tile, chunk * AT_ONCE + k).carve(tile);
                        let count = done.fetch_add(1, Ordering::Relaxed) + 1;
                        progress(count as f64 / all as f64);
                        bites
                    })
                    .collect();
                for bite in bites.into_iter().flatten() {
                    let bite = Bite { volume: bite.volume * lattice.area() * share, ..bite };
                    let sum =
                        found.entry((bite.motion, bite.body)).or_insert(Bite::none(bite.motion, bite.body));
                    sum.merge(&bite);
                }
            }
        }
        let mut found: Vec<Bite> = found.into_values().collect();
        found.sort_unstable_by_key(|b| (b.motion, b.body));
        Ok(world.sum_up(&found))
    }
}

impl World<'_> {
    fn sum_up(&self, bites: &[Bite]) -> Carved {
        let mut out = Carved::default();
        for bite in bites {
            let swept = &self.job.motions[bite.motion as usize];
            let (motion, block, volume_mm3) = (bite.motion, swept.block, bite.volume);
            let kind = match bite.body {
                0 => Body::Cutter,
                k => self.job.uppers[usize::from(k) - 1].kind,
            };
            if kind != Body::Cutter || swept.rapid {
                if bite.deepest > self.job.touch_mm {
                    out.collisions.push(Collision {
                        motion,
                        block,
                        body: kind,
                        rapid: swept.rapid,
                        volume_mm3,
                        deepest_mm: bite.deepest,
                        at: bite.at,
                    });
                }
                continue;
            }
            let length = (swept.to.tip - swept.from.tip).norm();
            out.work.push(Work {
                motion,
                block,
                volume_mm3,
                section_mm2: if length > 0.0 { volume_mm3 / length } else { 0.0 },
                arc_rad: f64::from(bite.sectors.count_ones()) * std::f64::consts::TAU / SECTORS,
                height_mm: bite.height,
            });
        }
        out
    }
}
