//! `stickslip export INPUT -o FILE`: converts a scene, snapshot, journal or mesh; the extension selects the format
//! ([`stickslip_debugger::record::export`]).

use super::base::{Error, Exit, SetArgs, notify, spare_input, usage};
use super::course::Course;
use super::front;
use super::interrupt::Interrupt;
use super::place::{RunPosition, missed, seek};
use super::solver::{SolverArgs, session_of, step_to_end};
use std::ops::RangeInclusive;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use stickslip_core::{Model, Position, RunEnd, Solver, State, Stepper};
use stickslip_debugger::explain::{failures, names, report};
use stickslip_debugger::record::export::export_state::{ExportState, PicturePart, PictureRequest};
use stickslip_debugger::record::export::run_history::RunHistory;
use stickslip_debugger::record::export::skeleton::skeleton;
use stickslip_debugger::record::export::{self, ExportKind, ExportSource, Origin};
use stickslip_debugger::record::journal::Record;
use stickslip_debugger::recorded::calculix::{self as recorded, switches};
use stickslip_debugger::session::exports::{self, Export};
use stickslip_debugger::{ExportScope, Snapshot};
use stickslip_exchange::fclib;
use stickslip_exchange::vtu;
use stickslip_platform::files::{self, Output};
use stickslip_scene::calculix;
use stickslip_scene::solver::solver;
use stickslip_scene::{FileKind, Scene, SceneError};
use stickslip_scene::{import, shown};
use stickslip_study::pen;

#[derive(Debug, clap::Args)]
#[command(after_help = "\
.svg, .png: the deformed shape of a scene or a snapshot with modes, forces and gaps, and the timeline; with --only, the \
shape, the timeline, the load over a monitor (chart), or the force of a contact in its friction cone (cone).
.ron: the scene as opened; for a Gmsh mesh, a scene that imports it, to be edited; with --frozen, the interface \
problem that is solved next, as a separate scene.
.dat, .mtx, .h5: the same interface problem for other solvers: for Siconos, as Matrix Market files \
(NAME_W.mtx, NAME_q.mtx, NAME_mu.mtx), for fclib.
.vtu: the state for ParaView (stickslip run --vtu writes all states); of a CalculiX run (.cel) the mesh of its deck, with \
the switches, last status and pressure of each slave node.
.cast: a journal as a film for asciinema.

A scene is exported at its end, or where it fails. Exit codes: 0 the file was written, even if the scene failed;
2 bad input or usage; 3 --at is not reached, or the state cannot be written in this format.")]
pub struct Args {
    /// A scene file, the name of a built-in scene, a snapshot, a journal, a mesh, or the .cel file of a CalculiX run
    #[arg(
        value_name = "SCENE|SNAPSHOT|JOURNAL|MESH|CEL",
        required_unless_present_any = ["command", "listen"]
    )]
    input: Option<String>,
    #[command(flatten)]
    set: SetArgs,
    /// Output file; its extension selects the format
    #[arg(short, long, value_name = "FILE")]
    output: PathBuf,
    /// The minor iteration after which to export; without MINOR the end of the major, without MAJOR the end of the increment
    /// [default: the end of the history, or the failure]
    #[arg(long, value_name = "INC[.MAJOR[.MINOR]]")]
    at: Option<RunPosition>,
    /// Exports the frozen interface problem as a separate scene
    #[arg(long)]
    frozen: bool,
    /// Draws only this part of a picture
    #[arg(long, value_name = "PART", value_parser = clap::builder::PossibleValuesParser::new(PicturePart::NAMES))]
    only: Option<String>,
    /// Size of a picture in pixels, or of a film in columns and rows
    #[arg(long, value_name = "WxH", value_parser = size)]
    size: Option<(u16, u16)>,
    /// Height of the small text of a picture, in pixels [default: in proportion to the size]
    #[arg(long, value_name = "PIXELS", value_parser = font)]
    font: Option<f64>,
    /// The slave node of the cone [default: the one with the largest force]
    #[arg(long, value_name = "NODE")]
    node: Option<String>,
    /// The monitor of the chart [default: the first that moves]
    #[arg(long, value_name = "MONITOR")]
    monitor: Option<String>,
    /// Overwrites an existing file
    #[arg(long)]
    force: bool,
    /// An attached solver: of a journal, or of a frozen problem
    #[command(flatten)]
    solver: SolverArgs,
}

impl Args {
    /// The input file or scene; empty for an attached solver alone.
    fn input(&self) -> &str {
        self.input.as_deref().unwrap_or_default()
    }
}

pub fn main(args: &Args) -> Result<Exit, Error> {
    let interrupt = Interrupt::listen();
    let usage = |why: String| Error::Usage(why);
    let kind = match args.frozen {
        true => export::frozen_kind(&args.output),
        false => export::kind(&args.output),
    };
    let kind = kind.map_err(|e| usage(e.to_string()))?;
    let of_pictures = [
        ("--only", args.only.is_some()),
        ("--font", args.font.is_some()),
        ("--node", args.node.is_some()),
        ("--monitor", args.monitor.is_some()),
    ];
    let given = of_pictures.into_iter().find(|(_, given)| *given);
    if let (Some((option, _)), false) = (given, ["svg", "png"].contains(&kind.extension)) {
        return Err(usage(format!(
            "{option} is for pictures only: -o FILE.svg or FILE.png"
        )));
    }
    if args.node.is_some() && args.only.as_deref() != Some("cone") {
        return Err(usage("--node selects the contact of --only cone".into()));
    }
    let fits = |range: RangeInclusive<u16>| {
        args.size
            .is_none_or(|(w, h)| range.contains(&w) && range.contains(&h))
    };
    match kind.extension {
        "svg" | "png" if fits(100..=8000) => {}
        "cast" if fits(10..=400) => {}
        _ if args.size.is_none() => {}
        _ => return Err(usage("--size: a picture has 100 to 8000 pixels per side, a film (.cast) 10 to 400 columns and rows".into())),
    }
    match kind.extension {
        "svg" | "png" => pen::ready().map_err(|e| usage(e.to_string()))?,
        "cast" => front::ready()?,
        "h5" => fclib::ready().map_err(|e| usage(e.to_string()))?,
        _ => {}
    }
    // Checked before the solve, so that the result of a long solve can be written; leaves no file behind.
    let names = kind.files(&args.output).map_err(usage)?;
    for name in &names {
        spare_input(args.input(), name)?;
        drop(Output::create(name, args.force)?);
    }
    if args.input.is_none() {
        return reported(args, &interrupt);
    }
    let contents = match kind.made_of {
        _ if calculix::is_cel(args.input()) => vec![switches(args, kind)?],
        _ if import::is_mesh(args.input()) => vec![around_mesh(args, kind)?],
        ExportSource::Journal => vec![film(args)?],
        ExportSource::State(_) | ExportSource::Parts(_) => state(args, kind, &interrupt)?,
    };
    let whole: Vec<_> = names.into_iter().zip(contents).collect();
    files::write_all(&whole, args.force)?;
    for (name, _) in &whole {
        notify(&format!("wrote {}", name.display()));
    }
    Ok(Exit::Good)
}

/// Writes the interface problem that an attached solver reports.
fn reported(args: &Args, interrupt: &Interrupt) -> Result<Exit, Error> {
    if !args.frozen {
        return Err(usage!(
            "only the frozen interface problem of an attached solver can be exported; add --frozen"
        ));
    }
    let Some((scene, mut solver)) = args
        .solver
        .attached(&args.set, args.force, Some(interrupt))?
    else {
        return Err(usage!("no input given"));
    };
    match args.at {
        Some(at) => {
            seek(&mut solver, at, interrupt, &mut |_| ())
                .map_err(|why| missed(&scene, &solver, at, why))?;
        }
        None => {
            if step_to_end(&mut solver, Some(interrupt), &mut |_| ())? == RunEnd::Interrupted {
                return Err(Error::ended(Exit::Interrupted, &scene.name, "interrupted"));
            }
        }
    }
    let state = solver.state().clone();
    let posed = solver.interface_problem(&state).map_err(Error::usage)?;
    let event = solver.event();
    let ask = Export {
        what: ExportScope::Whole,
        file: args.output.clone(),
        overwrite: args.force,
        origin: Origin {
            scene: scene.model.title.clone(),
            changes: Vec::new(),
            at: event.position,
            load: event.load_factor,
        },
        state: Box::new(state),
        shown: None,
    };
    exports::write_posed(&scene.model, &posed, &ask)
        .map_err(|why| Error::ended(Exit::Unconverged, &scene.name, why))?;
    notify(&format!("wrote {}", args.output.display()));
    Ok(Exit::Good)
}

/// Reads `1920x1080`.
pub fn size(text: &str) -> Result<(u16, u16), String> {
    // Any larger number is too large as well.
    let side = |side: &str| {
        let size = side.parse::<u64>().ok()?;
        Some(u16::try_from(size).unwrap_or(u16::MAX))
    };
    let sides = text.split_once('x').and_then(|(w, h)| side(w).zip(side(h)));
    sides.ok_or_else(|| "a size has the form 120x40".into())
}

/// Reads the height of a text.
fn font(text: &str) -> Result<f64, String> {
    text.parse()
        .ok()
        .filter(|size: &f64| (4.0..=200.0).contains(size))
        .ok_or_else(|| "a font has 4 to 200 pixels".into())
}

/// What a picture of a model contains.
fn picture(args: &Args, model: &Model) -> Result<PictureRequest, Error> {
    let find = |what: &str, name: &Option<String>, names: Vec<&str>| match name {
        None => Ok(None),
        Some(name) => match names.iter().position(|known| known == name) {
            None => Err(Error::Usage(format!(
                "unknown {what} '{name}'; known: {}",
                shown::cut(&names.join(", "), 200)
            ))),
            found => Ok(found),
        },
    };
    let slaves = (0..model.contacts.len()).map(|slave| names::slave(model, slave));
    let monitors = model.monitors.iter().map(|monitor| monitor.name.as_str());
    Ok(PictureRequest {
        only: args.only.as_deref().and_then(PicturePart::from_word),
        size: args.size.map(|(w, h)| (w.into(), h.into())),
        font: args.font,
        node: find("slave node", &args.node, slaves.collect())?,
        monitor: find("monitor", &args.monitor, monitors.collect())?,
    })
}

/// The kind of the input: journal, snapshot, or otherwise a scene.
fn input_kind(input: &str) -> FileKind {
    let found = FileKind::from_file(Path::new(input));
    found
        .filter(|kind| matches!(kind, FileKind::Journal | FileKind::Snapshot))
        .unwrap_or(FileKind::Scene)
}

/// A scene that imports a mesh.
fn around_mesh(args: &Args, kind: &ExportKind) -> Result<Vec<u8>, Error> {
    let file = args.input();
    let usage = |why: &str| usage!("{file}: {why}");
    if kind.extension != "ron" || args.frozen {
        return Err(usage(
            "a mesh can only be exported as a scene that imports it: -o FILE.ron",
        ));
    }
    scene_only(args, "a mesh has no states or values")?;
    let folder = |path: &Path| {
        path.parent()
            .filter(|folder| *folder != Path::new(""))
            .unwrap_or(Path::new("."))
            .canonicalize()
            .ok()
    };
    let mesh = Path::new(file);
    let below = folder(mesh).zip(folder(&args.output)).zip(mesh.file_name());
    let below =
        below.and_then(|((mesh, scene), name)| Some(mesh.strip_prefix(scene).ok()?.join(name)));
    let Some(below) = below else {
        return Err(usage(
            "the scene must be written to the mesh's folder or a folder above it; change -o",
        ));
    };
    let scene = args.output.to_string_lossy();
    let parts = import::bodies(file)?;
    // The error is one of the mesh: the scene has not been written.
    let written = skeleton(&scene, &below.to_string_lossy(), &parts).map_err(|why| SceneError {
        file: file.to_owned(),
        at: None,
        ..why
    })?;
    Ok(written.into_bytes())
}

/// The mesh of a CalculiX run with the switches of its contacts.
fn switches(args: &Args, kind: &ExportKind) -> Result<Vec<u8>, Error> {
    let file = args.input();
    if kind.extension != "vtu" {
        return Err(usage!(
            "{file}: a CalculiX run can only be exported for ParaView: -o FILE.vtu"
        ));
    }
    scene_only(args, "a finished run is exported as recorded")?;
    let pressures = calculix::pressures(Path::new(file)).map_err(Error::Usage)?;
    let Some(opened) = recorded::file(file) else {
        return Err(usage!("{file}: not the .cel of a CalculiX run"));
    };
    let run = opened.map_err(Error::Usage)?.run;
    let (grid, lost) = switches::grid(&run, &pressures).map_err(Error::Usage)?;
    if lost > 0 {
        notify(&format!(
            "note: {lost} of {} slaves are not in the deck, because CalculiX makes plane elements three-dimensional; they are left out",
            run.files.slaves.len()
        ));
    }
    Ok(vtu::write(&grid).into_bytes())
}

/// The film of a journal.
fn film(args: &Args) -> Result<Vec<u8>, Error> {
    if input_kind(args.input()) != FileKind::Journal {
        return Err(usage!(
            "{}: not a journal; .cast files are made from a journal of the debugger (:journal shows its path)",
            args.input()
        ));
    }
    scene_only(args, "a journal is replayed as recorded")?;
    let record = Record::read(Path::new(args.input()))?;
    let session = session_of(&record, &args.solver)?;
    Ok(front::film(&record, session, args.size)?.into_bytes())
}

/// Rejects options that only apply to scenes.
fn scene_only(args: &Args, why: &str) -> Result<(), Error> {
    let given = match (args.set.set.is_empty(), args.at) {
        (true, None) => return Ok(()),
        (false, _) => "--set",
        (true, Some(_)) => "--at",
    };
    Err(usage!(
        "{}: {why}; {given} is for scenes only",
        args.input()
    ))
}

fn open(args: &Args) -> Result<Course, Error> {
    match input_kind(args.input()) {
        FileKind::Snapshot => {
            scene_only(args, "a snapshot is exported as recorded")?;
            let snapshot = Snapshot::read(Path::new(args.input()))?;
            let name = snapshot.name.clone();
            Course::from_snapshot(&name, snapshot)
        }
        FileKind::Journal => {
            let name = args.input();
            Err(usage!(
                "{name}: a journal can only be exported as .cast; `w` in the debugger (`stickslip resume {name}`) \
                 writes a snapshot of the shown state"
            ))
        }
        _ => Ok(Course::from_scene(Scene::open(
            args.input(),
            &args.set.set,
        )?)),
    }
}

/// The files' contents, or the exit code if there are none.
fn state(args: &Args, kind: &ExportKind, interrupt: &Interrupt) -> Result<Vec<Vec<u8>>, Error> {
    let course = open(args)?;
    let scene = &course.scene;
    let mut stepper = solver(Arc::new(scene.model.clone()));
    let picture = picture(args, &scene.model)?;
    let parts: Vec<_> = picture.only.into_iter().collect();
    let mut seen = RunHistory::at_start(&mut stepper, &parts);
    // The scene file itself needs no solve.
    let solves = kind.extension != "ron" || args.frozen;
    if solves {
        drive(&course, args.at, &mut stepper, &mut seen, interrupt)?;
    }
    let event = seen.has_started().then(|| stepper.event().clone());
    let state = stepper.state().clone();
    let at = event.as_ref().map_or(state.next, |event| event.position);
    let origin = origin(&course, at, &state);
    let shown = ExportState {
        frozen: args.frozen,
        ..seen.shown(scene, &origin, (&state, event.as_ref()), &picture)
    };
    let made = kind.made(&shown, &mut stepper);
    let made = made.ok_or_else(|| usage!("{}: a journal is not made from a state", scene.name))?;
    made.map_err(|why| Error::ended(Exit::Unconverged, &scene.name, why))
}

fn origin(course: &Course, at: Position, state: &State) -> Origin {
    let mut origin = Origin::new(&course.scene, at, state.major.target);
    let model = &course.scene.model;
    let words = course
        .applied
        .iter()
        .map(|a| report::intervention(model, &a.intervention));
    origin.changes.extend(words);
    origin
}

/// Runs to the requested state; returns the exit code if there is no such state.
fn drive(
    course: &Course,
    at: Option<RunPosition>,
    stepper: &mut Stepper,
    seen: &mut RunHistory<'_>,
    interrupt: &Interrupt,
) -> Result<(), Error> {
    let (scene, name) = (&course.scene, &course.scene.name);
    if let Some(at) = at {
        return seek(stepper, at, interrupt, &mut |stepper| seen.add(stepper))
            .map(drop)
            .map_err(|why| missed(scene, stepper, at, why));
    }
    match course.go(stepper, interrupt, |stepper| seen.add(stepper))? {
        RunEnd::Interrupted => Err(Error::ended(Exit::Interrupted, name, "interrupted")),
        RunEnd::Failed(failure) => {
            let words = failures::describe(&scene.model, &failure);
            let at = names::position(stepper.event().position);
            notify(&format!("{name}: {at}: {words}; exporting this state"));
            Ok(())
        }
        _ => Ok(()),
    }
}
