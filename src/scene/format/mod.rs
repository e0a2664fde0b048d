//! The scene file as written by its author: converts text to a [`Spec`], and back.
//!
//! - [`spec`]: the types of the file; [`loads`]: loads; [`arc`]: arc-length control; [`given`]: meshes node by node;
//!   [`condensed`]: files with an interface problem; [`stored`]: files about a stiffness stored by another program.
//! - [`described`]: descriptions of the types, used by [`paths`] and by the [`reference`](mod@reference).
//! - [`notation`]: the RON dialect; [`read`]: converts text to values; [`locate`]: converts paths to lines.
//! - [`paths`]: lists and sets every scalar of a scene by its path.
//! - [`error`]: errors with their location.
//!
//! [`scene`](crate) checks whether the values make sense.

pub mod arc;
pub mod condensed;
pub mod contact_law;
pub mod described;
pub mod error;
pub mod given;
pub mod in_space;
pub mod loads;
pub mod locate;
pub mod monitor;
pub mod notation;
pub mod paths;
pub mod read;
pub mod reference;
pub mod spec;
pub mod stored;

pub use error::Fault;
pub use error::SceneError;
pub use spec::Spec;
