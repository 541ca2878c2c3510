//! What is moved: a cutter and what is mounted above it.

use crate::cutter::Cutter;
use crate::holder::{Holder, HolderSection};

/// Most bodies above a cutter: one word of bits tells which of them a point can still meet.
const MOST: usize = 31;

/// A body on the cutter's axis: shank, holder, or a section of one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mounted {
    /// The body, its lower end down.
    pub body: Cutter,
    /// Height of its lower end above the cutter's tip, mm.
    pub height_mm: f64,
}

/// A body of a tool.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Member {
    /// The cutter.
    Cutter,
    /// What is mounted above it, by its place in [`Tool::mounted`].
    Mounted(usize),
}

/// Why there is no such tool.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ToolError {
    /// A body hangs below the tip, or nowhere.
    #[error(
        "a body cannot be mounted {height_mm} mm above the tip: the height must be finite and not negative"
    )]
    Height {
        /// Its height, mm.
        height_mm: f64,
    },
    /// Too many bodies.
    #[error("a tool can have at most {most} bodies above its cutter")]
    Count {
        /// The most.
        most: usize,
    },
}

/// A cutter and the bodies above it.
#[derive(Clone, Debug, PartialEq)]
pub struct Tool {
    cutter: Cutter,
    mounted: Vec<Mounted>,
}

impl Tool {
    /// A cutter with a holder that sits where the cutter's length ends.
    #[must_use]
    pub fn new(cutter: Cutter, holder: Option<&Holder>) -> Self {
        let sections = holder.map(Holder::sections).unwrap_or_default();
        let mounted =
            |s: &HolderSection| Mounted { body: s.body, height_mm: cutter.length_mm() + s.above_mm };
        Self { cutter, mounted: sections.iter().map(mounted).collect() }
    }

    /// The tool with one more body above its cutter.
    ///
    /// ```
    /// use osculate_tools::reach::{Mounted, Tool};
    /// use osculate_tools::{Cutter, CutterSpec};
    /// // A shank that is thicker than the cutter, from 20 mm above the tip on.
    /// let cutter = Cutter::try_from(CutterSpec::Ball { diameter_mm: 6.0, length_mm: 20.0 })?;
    /// let shank = Mounted { body: Cutter::cylinder(10.0, 40.0)?, height_mm: 20.0 };
    /// let tool = Tool::new(cutter, None).with(shank)?;
    /// assert_eq!(tool.mounted().len(), 1);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`ToolError`] for a height that is negative or not finite, and for more than 31 bodies.
    pub fn with(mut self, body: Mounted) -> Result<Self, ToolError> {
        let height_mm = body.height_mm;
        if !(height_mm.is_finite() && height_mm >= 0.0) {
            return Err(ToolError::Height { height_mm });
        }
        if self.mounted.len() >= MOST {
            return Err(ToolError::Count { most: MOST });
        }
        self.mounted.push(body);
        Ok(self)
    }

    /// The cutter.
    #[must_use]
    pub const fn cutter(&self) -> &Cutter {
        &self.cutter
    }

    /// The bodies above it.
    #[must_use]
    pub fn mounted(&self) -> &[Mounted] {
        &self.mounted
    }
}
