//! The panes, pages and bars of the screen, one file each. Each is a function that draws the app and the view into an area, with
//! the helpers of [`crate::paint`] and without reference to another pane. A pane also has an entry.

pub mod branches;
pub mod chooser;
pub mod contact;
pub mod curve;
pub mod decision;
pub mod diagnosis;
pub mod footer;
pub mod help;
pub mod lesson;
pub mod manual;
pub mod nodes;
pub mod remedies;
pub mod residual;
pub mod shape;
pub mod solver;
pub mod status;
pub mod timeline;
pub mod workprecision;

use crate::layout::Pane;
use crate::pane_entry::PaneEntry;

/// The entry of a pane.
pub fn entry(pane: Pane) -> &'static PaneEntry {
    match pane {
        Pane::Nodes => &nodes::PANE,
        Pane::Decision => &decision::PANE,
        Pane::Residual => &residual::PANE,
        Pane::Shape => &shape::PANE,
        Pane::Curve => &curve::PANE,
        Pane::Timeline => &timeline::PANE,
        Pane::Diagnosis => &diagnosis::PANE,
        Pane::Branches => &branches::PANE,
        Pane::Remedies => &remedies::PANE,
        Pane::Contact => &contact::PANE,
        Pane::Lesson => &lesson::PANE,
    }
}
