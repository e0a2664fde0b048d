//! stickslip-core: the two-level iteration for contact and friction of El-Sawy & Moore (1996), as a resumable stepper.
//!
//! A call of [`Stepper::step`] does one minor iteration and returns an [`Event`] that describes it: every number that was
//! compared, every mode that changed, and why. Between two calls a program may read everything, change the modes of nodes
//! ([`Stepper::intervene`]), and save the [`State`] to return to it later. The package reads and writes no files and starts no
//! threads.
//!
//! # Example
//!
//! A node on two springs is pressed onto a rough floor and pushed along it. The floor is a single endless line, walked from right
//! to left, since the outward side is on the right of the walk.
//!
//! ```
//! use std::sync::Arc;
//! use stickslip_core::model::{BodyKind, Component, Contact, Form, Friction, Linear, Model, Surface};
//! use stickslip_core::{Mode, Outcome, Stepper};
//!
//! let (spring, gap, push, press) = (100.0, 0.1, 30.0, 30.0);
//! let mut model = Model::builder("A node on two springs");
//! let slave = model.node("slave", [0.0, gap]);
//! let floor = [model.node("floor.1", [1.0, 0.0]), model.node("floor.2", [-1.0, 0.0])];
//! // f = K u, with K = spring times the unit matrix.
//! let springs = Linear {
//!     form: Form::Stiffness,
//!     entries: vec![(0, 0, spring), (1, 1, spring)],
//!     bars: Vec::new(),
//! };
//! model.body("springs", vec![slave], BodyKind::Linear(springs));
//! let floor = model.surface(Surface::endless("floor", floor));
//! model.contact(Contact::new(slave, vec![floor], Friction { angle: 20.0, cohesion: 0.0 }));
//! model.load(slave, Component::X, push).load(slave, Component::Y, -press);
//! model.history(vec![0.0, 1.0], 0.5);
//! let model = model.build()?;
//!
//! let mut stepper = Stepper::new(Arc::new(model));
//! while let Some(event) = stepper.step() {
//!     match &event.outcome {
//!         Outcome::Failed(why) => panic!("{why:?}"),
//!         Outcome::Increment { .. } => println!("load factor {} is done", event.load_factor),
//!         _ => {}
//!     }
//! }
//!
//! // It slides: F_t = −tan φ F_n, and the spring along the floor takes the rest.
//! let state = stepper.state();
//! let f_n = press - spring * gap;
//! let friction = 20_f64.to_radians().tan() * f_n;
//! assert_eq!(state.nodes[0].mode, Mode::Sliding);
//! assert!((state.nodes[0].f_n - f_n).abs() < 1e-9);
//! assert!((state.u[0] - (push - friction) / spring).abs() < 1e-9);
//! # Ok::<(), stickslip_core::builder::ModelError>(())
//! ```
//!
//! A scene file is a shorter way to define a model; the package `stickslip` reads scene files. Its examples show how to step a
//! scene, how to set up an interface problem without bodies, how to write a strategy, how to force a mode, and how to run a study
//! (`tests/examples` in its sources).
//!
//! # Modules
//!
//! Each takes only from those above it:
//!
//! - [`words`](macro@words): names of the variants of an enum, each written once.
//! - [`plane`]: vectors in the plane.
//! - [`groups`]: groups of connected nodes.
//! - [`executor`]: parallel work on bodies, on threads that the caller provides.
//! - [`linalg`]: sparsity patterns, factors, checked solves; a separate package.
//! - [`documented`]: types whose doc comments the program shows.
//! - [`elements`]: shape functions and integration rules; the kinds of continuum elements, one small file each.
//! - [`model`]: the problem as plain data: nodes, bodies, surfaces, contacts, loads, settings.
//! - [`builder`]: builds a model in code.
//! - [`fem`]: finite elements, one small file per kind. [`fem::isoparametric`] is the formulation that all continuum elements
//!   share; other elements return internal forces and their tangent themselves ([`fem::element`]). [`fem::assembly`] assembles
//!   the elements of all bodies, [`fem::recovery`] computes stresses for output.
//! - [`contact`]: one slave node: projection on its surface, the equations of Table 1, the decision of Table 2, and the judge,
//!   which checks every accepted state against the contact laws.
//! - [`interface`]: the interface problem of a major iteration: geometry and stiffness frozen, no bodies.
//! - [`strategy`]: the strategies, one per file. A strategy is a [`Method`]: it decides which mode a node takes next, which nodes
//!   may change at once, or what all nodes do together. The default of each decision is that of Table 2.
//! - [`linear`]: the linearised equations. [`linear::source::Source`] is the interface between the stepper and the deforming
//!   bodies: it linearises at a state, solves for the modes of the nodes, updates the forces, and returns the new positions of
//!   the nodes. [`linear::bodies`] is the source for bodies of this package; pass a custom source to
//!   [`Stepper::with_source`].
//! - [`step`]: increments, major and minor iterations: the algorithm box. [`Solver`] is the interface that a debugger steps.
//!
//! # Conventions
//!
//! Units are the user's: any consistent set of force and length; angles of friction are in degrees, rotations in radians.
//! The outward normal n of a surface is on the right of its walk, and t is n turned 90 degrees anticlockwise. Forces on a
//! slave node are F_n along n, where compression is positive, and F_t along t. A gap is positive where the node is outside.
//! Slip is u_tS* − u_tS: how far the point of the surface has moved ahead of the node.

#![forbid(unsafe_code)]

pub mod words;

pub mod builder;
pub mod contact;
pub mod documented;
pub mod elements;
pub mod fem;
pub mod groups;
pub mod interface;
pub mod linear;
pub mod model;
pub mod plane;
pub mod step;
pub mod strategy;

pub use contact::element::{ElementPositions, SurfaceElement};
pub use contact::laws::{Finding, JudgedLaw, JudgedNumbers, Scales, Verdict};
pub use contact::projection::SurfacePoint;
pub use contact::record::{ContactRecord, Forced};
pub use contact::state::ContactState;
pub use contact::table1::{Equation, RelativeMotion};
pub use contact::table2::{Decision, Numbers, Rule, Test, TestedQuantity, Ties};
pub use fem::deformation::{Deformation, PointDeformation};
pub use fem::element::ElementOutput;
pub use fem::material::Material;
pub use interface::kinematics::{NodeIncrement, NodeKinematics};
pub use interface::method::{Method, NotFound, SearchProgress};
pub use interface::minor_history::Cycle;
pub use interface::problem::{AssumedMode, InterfaceProblem, NodeAnswer, ProblemNode};
pub use interface::response::InterfaceResponse;
pub use interface::sweep::Sweep;
pub use interface::trials::Trials;
pub use linear::condensed::CondensedSystem;
pub use linear::estimate::Estimate;
pub use linear::norms::Norms;
pub use linear::singular::{RigidMotion, Singular};
pub use linear::source::{LinearisationPoint, SolveResult, Source, Work};
pub use linear::stability::Stability;
pub use model::{
    Body, BodyKind, Bond, BoundUpdate, Component, Contact, Control, Dofs, Elastic, ElementKind,
    Friction, InitialGaps, InitialState, Jumps, Law, Mode, Model, Monitor, MonitorQuantity, Node,
    Plane, RunFinding, SearchBudget, SearchMode, Settings, Solid, Strategy, Surface, Touch, Update,
};
pub use step::drive::{RunEnd, Until};
pub use step::event::{MotionEvent, Position};
pub use step::intervene::{Intervention, Refusal};
pub use step::major_history::MajorCycle;
pub use step::pace::Pace;
pub use step::recovery::fallback::Fallback;
pub use step::recovery::motion::Motion;
pub use step::solver::{
    Capabilities, Now, Parameter, ReportedForm, ReportedProblem, RewindSupport, SolverLost,
};
pub use step::state::IncrementStart;
pub use step::stored_states::StoredStates;
pub use step::sub_increment::SubIncrement;
pub use step::watch::StabilityLoss;
pub use step::{Event, Failure, Outcome, Solver, State, Status, Stepper};
pub use stickslip_linalg as linalg;
pub use stickslip_linalg::executor;
pub use words::counted;
