//! The panes, pages and bars of the screen, one file each. Each is a function that draws the app and the view into an area, with
//! the helpers of [`crate::paint`] and without reference to another pane.

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
