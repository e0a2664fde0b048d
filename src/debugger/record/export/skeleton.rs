//! Generates a scene around a mesh, as a starting point: its bodies, all named lines of sides, and guesses for
//! contact, supports and loads.
//!
//! The guesses are simple. The contact is between the two lines of different bodies whose nodes are closest on
//! average. The lowest horizontal line is fixed; the highest one moves down by a hundredth of the height.

use stickslip_core::plane::{distance, range};
use stickslip_scene::nodes::lines::Line;
use stickslip_scene::shown;
use stickslip_scene::{Scene, SceneError};

/// Id of the mesh.
const ID: &str = "m";

/// The text of a scene that imports a mesh. `scene` is the scene's path, `file` the path of the mesh relative
/// to it, and `parts` are the bodies.
///
/// # Errors
/// If the mesh cannot be read or is invalid.
pub fn skeleton(scene: &str, file: &str, parts: &[String]) -> Result<String, SceneError> {
    let bare = text(file, parts, &[], &OutlineGuess::default());
    let lines = Scene::from_text(scene, &bare, &[])?.names().lines(ID);
    let guessed = text(file, parts, &lines, &OutlineGuess::new(&lines));
    match Scene::from_text(scene, &guessed, &[]) {
        Ok(_) => Ok(guessed),
        // The guesses are not valid; leave them to the author.
        Err(_) => Ok(text(file, parts, &lines, &OutlineGuess::default())),
    }
}

/// Lines, by index in the list.
#[derive(Default)]
struct OutlineGuess {
    /// Slave line and master line.
    contact: Option<(usize, usize)>,
    held: Option<usize>,
    /// The loaded line, and its displacement downwards.
    pressed: Option<(usize, f64)>,
}

impl OutlineGuess {
    fn new(lines: &[Line]) -> OutlineGuess {
        let heights = lines.iter().flat_map(|line| &line.at).map(|at| at[1]);
        let [low, high] = range(heights);
        let height = high - low;
        let level = |y: f64| {
            lines
                .iter()
                .position(|line| line.at.iter().all(|at| (at[1] - y).abs() <= 1e-6 * height))
        };
        let mut best: Option<(f64, usize, usize)> = None;
        for (a, slave) in lines.iter().enumerate() {
            for (b, master) in lines.iter().enumerate() {
                let apart =
                    slave.part.is_some() && master.part.is_some() && slave.part != master.part;
                if !apart || slave.is_inside || master.is_inside {
                    continue;
                }
                let far = mean_distance(slave, master);
                if best.is_none_or(|(least, ..)| far < least) {
                    best = Some((far, a, b));
                }
            }
        }
        OutlineGuess {
            contact: best.map(|(_, a, b)| (a, b)),
            held: level(low).filter(|_| height > 0.0),
            pressed: level(high)
                .filter(|_| height > 0.0)
                .map(|k| (k, 0.01 * height)),
        }
    }
}

/// Mean distance of some nodes of a line from the nearest node of another line.
fn mean_distance(line: &Line, other: &Line) -> f64 {
    const FEW: usize = 16;
    let few = |at: &[[f64; 2]], most: usize| -> Vec<[f64; 2]> {
        at.iter()
            .step_by(at.len().div_ceil(most).max(1))
            .copied()
            .collect()
    };
    let (own, others) = (few(&line.at, FEW), few(&other.at, 16 * FEW));
    own.iter()
        .map(|a| {
            others
                .iter()
                .map(|b| distance(*a, *b))
                .fold(f64::INFINITY, f64::min)
        })
        .sum::<f64>()
        / own.len().max(1) as f64
}

fn text(file: &str, parts: &[String], lines: &[Line], guess: &OutlineGuess) -> String {
    let name = |k: usize| &lines[k].name;
    let solid = |k: usize| {
        let (id, part) = (body(parts, k), &parts[k]);
        format!("        Solid(id: \"{id}\", mesh: \"{ID}.{part}\", material: \"material\"),\n")
    };
    let bodies: String = (0..parts.len()).map(solid).collect();
    let mut out = format!(
        "(\n    title: {:?},\n    nodes: [Import(id: {ID:?}, file: {file:?})],\n",
        format!("Mesh: {}", shown::cut(file, 80))
    );
    out += "    // All numbers here are placeholders; E is a force per area.\n";
    out += "    materials: [Elastic(id: \"material\", E: 1000, nu: 0.3)],\n";
    out += &format!("    bodies: [\n{bodies}    ],\n");
    if !lines.is_empty() {
        out += "    // Lines for surfaces, slaves, supports and loads, each with its body on the left:\n";
    }
    out.extend(
        lines
            .iter()
            .map(|line| format!("    //   {}\n", line.words)),
    );
    out += &match guess.contact {
        Some((slave, master)) => format!(
            "    // Guess: the closest lines of two bodies.\n    surfaces: [(id: \"master\", along: {:?})],\n    slaves: [(nodes: [{:?}], on: [\"master\"])],\n",
            name(master),
            name(slave)
        ),
        None => format!(
            "    // surfaces: [(id: \"master\", along: \"{ID}.LINE\")],\n    // slaves: [(nodes: [\"{ID}.LINE\"], on: [\"master\"])],\n"
        ),
    };
    out += "    friction: (angle: 0),\n";
    out += &match guess.held {
        Some(held) => format!(
            "    // Guess: the lowest line is fixed.\n    supports: [(node: {:?}, fix: [x, y])],\n",
            name(held)
        ),
        None => format!("    // supports: [(node: \"{ID}.LINE\", fix: [x, y])],\n"),
    };
    out += &match guess.pressed {
        Some((pressed, far)) => {
            let motion = |axis: &str, value: &str| {
                format!(
                    "        Displacement(node: {:?}, component: {axis}, value: {value}),\n",
                    name(pressed)
                )
            };
            let motions = motion("x", "0") + &motion("y", &format!("{:?}", -far));
            format!(
                "    // Guess: the highest line is pressed down.\n    loads: [\n{motions}    ],\n"
            )
        }
        None => format!(
            "    // loads: [Displacement(node: \"{ID}.LINE\", component: y, value: -0.1)],\n"
        ),
    };
    out += "    history: (path: [0, 1], increment: 0.25),\n";
    if guess.contact.is_some() {
        out += "    monitors: [(name: \"force\", of: Contact(component: y))],\n";
    }
    out + ")\n"
}

/// The id of a body: the name of its part, restricted to the characters of an id.
fn body(parts: &[String], k: usize) -> String {
    let id = |part: &String| -> String {
        part.chars()
            .map(|c| {
                if c.is_alphanumeric() || c == '-' {
                    c
                } else {
                    '_'
                }
            })
            .collect()
    };
    let own = id(&parts[k]);
    match parts.iter().filter(|part| id(part) == own).count() {
        1 => own,
        _ => format!("{own}-{}", k + 1),
    }
}
