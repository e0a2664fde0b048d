//! Converts a scene to a model: resolves every reference and checks every number.
//!
//! One file per part of the scene; each rejects invalid values with a [`Fault`] that contains the path of the value. `renewed`
//! changes values of an existing model.

mod arc;
mod bodies;
mod faces;
mod history;
mod in_space;
mod interface;
mod laws;
mod layout;
mod linear;
mod meeting_ends;
mod monitors;
mod point_force;
mod pressures;
mod renewed;
mod tractions;
mod volumes;

use super::areas::NamedSides;
use super::attached;
use super::corners;
use super::gaps;
use super::limits;
use super::nodes::Names;
use crate::Spec;
use crate::format::error::{Fault, at, bail};
pub use history::increments;
use interface::Surfaces;
use layout::Layout;
pub(crate) use layout::Loads;
pub(crate) use renewed::{Choices, Compiled, Groups, renewed};
use std::collections::HashSet;
use stickslip_core::groups::marked;
use stickslip_core::model::diagonal;
use stickslip_core::{Estimate, InitialGaps, Model};

/// Checks a scene.
pub(crate) fn compile(spec: &Spec) -> Result<(Model, Names), Fault> {
    if let Some(text) = &spec.attached {
        return attached::compile(spec, text);
    }
    check_texts(spec)?;
    if let Some(problem) = &spec.in_space {
        return in_space::compile(spec, problem);
    }
    history::memory(&spec.settings)?;
    check_lengths(spec)?;
    let mut names = Names::from_spec(spec)?;
    bodies::materials(spec)?;
    let mut bodies = bodies::bodies(spec, &names)?;
    let nodes = bodies.iter().flat_map(|body| &body.nodes);
    let mut on_body = marked(names.nodes.len(), nodes);
    let of_bodies = names.nodes.iter().zip(&on_body).filter(|(_, on)| **on);
    let mut length = diagonal(of_bodies.map(|(node, _)| node));
    if length == 0.0 {
        // Bodies given by matrices may have a single node, or all nodes at the same position.
        length = diagonal(names.nodes.iter());
    }
    bodies::check_axis(spec, &names, &bodies, length)?;
    bodies::check_bodies(spec, &names, &bodies, length)?;
    if length == 0.0 {
        bail!(
            at!["nodes"],
            "all nodes are at the same position, so the scene has no length scale"
        );
    }
    let mut surfaces = interface::surfaces(spec, &names, &on_body, length)?;
    let (mut slaves, mut pairs) = interface::slaves(spec, &names, &surfaces, length)?;
    interface::smoothed(spec, &names, &mut surfaces)?;
    interface::check_use(spec, &names, &on_body, &surfaces.made, &slaves, length)?;
    let named = NamedSides::from_spec(spec, &names)?;
    named.check(spec, &names, &bodies, &surfaces.made)?;
    faces::spread(
        spec,
        &mut names,
        &bodies,
        &surfaces.made,
        &named,
        &mut slaves,
        &mut pairs,
    )?;
    on_body.resize(names.nodes.len(), false);
    corners::face(&surfaces.cut(spec), &bodies, &pairs, &mut slaves);
    history::settings(&spec.settings)?;
    if spec.settings.initial_gaps == InitialGaps::Adjust {
        let within = spec.settings.adjust_gap;
        gaps::adjust(&mut names.nodes, &surfaces.made, &slaves, within);
        bodies::check_bodies(spec, &names, &bodies, length)?;
    }
    if laws::tie(
        spec,
        &mut names,
        &surfaces.made,
        &pairs,
        &mut slaves,
        length,
    )? {
        bodies::check_bodies(spec, &names, &bodies, length)?;
    }
    let mut supported = Layout::new(on_body.clone(), &bodies);
    supported.supports(spec, &names)?;
    let guided = |node, axis| {
        supported.is_guided(node, axis) && !interface::is_moved(spec, &names, node, axis)
    };
    meeting_ends::extend(
        &mut surfaces.made,
        &surfaces.automatic,
        &slaves,
        &names.nodes,
        &supported,
        guided,
        length,
    );
    if spec.settings.initial_gaps == InitialGaps::Ramp {
        gaps::ramp(&names.nodes, &surfaces.made, &mut slaves);
    }
    supported.prescribed(spec, &names)?;
    meeting_ends::divide(
        &mut names,
        &surfaces.made,
        &mut slaves,
        &mut pairs,
        &supported,
        length,
    );
    on_body.resize(names.nodes.len(), false);
    laws::apply(spec, &names, &bodies, &pairs, &named, &mut slaves)?;
    let mut layout = Layout::new(on_body.clone(), &bodies);
    layout.supports(spec, &names)?;
    let Loads {
        dead: mut loads,
        pressures,
        prescribed,
    } = layout.loads(spec, &names, &bodies)?;
    let dofs = layout.number(&mut bodies);
    loads.extend(linear::free_motions(spec, &bodies, &dofs));
    interface::find_rigid(&dofs, &mut surfaces)?;
    let moved: HashSet<usize> = prescribed
        .iter()
        .filter_map(|p| Some(dofs.node_of(p.dof)?.0))
        .collect();
    let is_moved = |node: usize| moved.contains(&node);
    let Surfaces {
        made: mut surfaces,
        listed,
        ..
    } = surfaces;
    meeting_ends::cross(
        &mut surfaces,
        &listed,
        &slaves,
        &names.nodes,
        is_moved,
        length,
    );
    point_force::find_gives(
        spec.settings.point_force,
        &bodies,
        &names.nodes,
        &mut surfaces,
    );
    interface::drop_idle_slaves(spec, &names, &dofs, &surfaces, &mut slaves);
    laws::stand_upright(&dofs, &surfaces, &mut slaves);
    laws::check_points(&surfaces, &slaves)?;
    laws::check_corners(spec, &names, &surfaces, &slaves)?;
    interface::check_held_slaves(spec, &names, &dofs, &surfaces, &slaves)?;
    history::history(&spec.history)?;
    history::check_bends(spec)?;
    let monitors = monitors::monitors(spec, &names, &on_body, &dofs, &slaves)?;
    let arc = arc::arc(spec, &names, &monitors, &slaves)?;
    let settings = history::resolved(&spec.settings, &bodies);
    let model = Model {
        title: spec.title.clone(),
        about: spec.about.clone(),
        nodes: names.nodes.clone(),
        bodies,
        surfaces,
        contacts: slaves,
        dofs,
        loads,
        pressures,
        prescribed,
        path: spec.history.path.clone(),
        increment: spec.history.increment,
        increments: spec.history.increments.clone(),
        least: spec.history.least,
        jumps: spec.history.jumps,
        control: spec.history.control,
        arc,
        settings,
        monitors,
        budget: crate::memory::free(),
        length,
        finished: None,
        space: None,
    };
    match Estimate::from_model(&model).too_large(model.settings.solver) {
        Some(message) => Err(Fault::new(at!["settings", "memory"], message.to_string())),
        None => Ok((model, names)),
    }
}

/// Rejects texts that would garble a terminal.
fn check_texts(spec: &Spec) -> Result<(), Fault> {
    if spec.title.trim().is_empty() || spec.title.chars().count() > limits::TITLE {
        bail!(
            at!["title"],
            "the title must have 1 to {} characters",
            limits::TITLE
        );
    }
    if spec.title.chars().any(char::is_control) {
        bail!(
            at!["title"],
            "the title must be one line without control characters"
        );
    }
    if spec
        .about
        .chars()
        .any(|c| c.is_control() && !matches!(c, '\n' | '\r' | '\t'))
    {
        bail!(
            at!["about"],
            "the text must have no control characters except line breaks"
        );
    }
    Ok(())
}

/// Rejects lists that are unreasonably long.
fn check_lengths(spec: &Spec) -> Result<(), Fault> {
    let lengths = [
        ("materials", spec.materials.len()),
        ("bodies", spec.bodies.len()),
        ("surfaces", spec.surfaces.len()),
        ("supports", spec.supports.len()),
        ("loads", spec.loads.len()),
        ("monitors", spec.monitors.len()),
    ];
    lengths
        .iter()
        .try_for_each(|(list, length)| limits::entries(list, *length))
}
