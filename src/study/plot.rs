//! Charts of curves: what they are ([`drawn`](super::drawn)), and who draws them as SVG and PNG ([`pen`](super::pen)).

pub use super::drawn::{Axis, Chart, Curve, CurveEnd, PlotError};
pub use super::pen::chart::{png, svg};
