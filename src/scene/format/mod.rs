//! The scene file as its author writes it: from its text to a [`Spec`], and from that back to a line.
//!
//! - [`spec`]: the types of the file; [`loads`]: loads; [`arc`]: how a path is followed; [`given`]: meshes node by node;
//!   [`condensed`]: those of a file with an interface problem without bodies; [`stored`]: those of one about a stiffness that
//!   another program has stored.
//! - [`described`]: the types, described once for [`paths`] and for the [`reference`](mod@reference), which
//!   [`markdown`] writes.
//! - [`notation`]: how RON is written here; [`read`]: from a text to a value; [`locate`]: from a path to its line.
//! - [`paths`]: every scalar of a scene by its path, to list and to set.
//! - [`error`]: what is wrong, and where; [`kind`]: what a file is that is none of these.
//!
//! Whether what is written makes sense is for [`scene`](crate) to say.

pub mod arc;
pub mod condensed;
pub mod contact_law;
pub mod described;
pub mod error;
pub mod given;
pub mod kind;
pub mod loads;
pub mod locate;
pub mod markdown;
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
