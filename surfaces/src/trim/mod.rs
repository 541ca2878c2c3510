//! Trimming: boundary curves pulled onto a carrier, the inside of their loops, and integrals over it.

pub(crate) mod analytic;
mod area;
pub(crate) mod assemble;
mod balance;
mod bands;
pub(crate) mod boundary;
pub(crate) mod carrier;
pub(crate) mod chain;
pub(crate) mod compound;
pub(crate) mod curve;
pub(crate) mod edge;
pub(crate) mod foot;
pub(crate) mod motion;
mod outline;
pub(crate) mod pull;
pub(crate) mod region;
mod side;
pub(crate) mod spline;
pub(crate) mod sweep;

pub(crate) use area::{Cell, Crossing, crossing, integrate};
pub use balance::Imbalance;
pub(crate) use balance::imbalance;
