//! What stands on the screen, one file a pane, a page or a bar. Each is a function from the app and the view into its
//! part of the screen, and knows the brush ([`crate::paint`]) but no other pane.

pub mod branches;
pub mod chooser;
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
