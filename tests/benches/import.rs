//! What a large mesh of Gmsh costs: `cargo bench --bench import`.
//!
//! A square of some 200,000 nodes is written as text, version 2.2, of triangles, and of quadrilaterals with 4 and with 8 nodes;
//! from the file to the model that the solver takes (of three times the median), the first frame of the debugger, 200 by 60, and
//! the longer of two keys with the frames that follow. A table, not a statistic: hence no harness.

use ratatui::buffer::Buffer;
use ratatui::layout::Rect;
use std::collections::BTreeMap;
use std::fmt::Write;
use std::fs;
use std::time::Instant;
use stickslip::scene::Scene;
use stickslip::session::Session;
use stickslip::tui::theme::Theme;
use stickslip::tui::{Debugger, keys, screen};

const SCENE: &str = "(title: \"A large mesh\", nodes: [Import(id: \"m\", file: \"large.msh\")],
    materials: [Elastic(id: \"e\", E: 100, nu: 0.3)], bodies: [Solid(id: \"b\", mesh: \"m.body\", material: \"e\")],
    supports: [(node: \"m.floor.all\", fix: [x, y])], loads: [Traction(along: \"m.lid\", y: -1)],
    history: (path: [0, 1], increment: 0.5))";

fn main() {
    let folder = std::env::temp_dir().join(format!("stickslip-import-{}", std::process::id()));
    fs::create_dir_all(&folder).unwrap_or_else(|e| panic!("{e}"));
    println!(
        "| elements | nodes | file MB | file to model s | first frame ms | a key and its frame ms |"
    );
    println!("|---|---|---|---|---|---|");
    for (name, gmsh, cells) in [("triangle3", 2, 446), ("quad4", 3, 446), ("quad8", 16, 258)] {
        row(&folder, name, gmsh, cells);
    }
    fs::remove_dir_all(&folder).unwrap_or_else(|e| panic!("{e}"));
}

fn row(folder: &std::path::Path, name: &str, gmsh: u8, cells: usize) {
    let text = mesh(gmsh, cells);
    fs::write(folder.join("large.msh"), &text).unwrap_or_else(|e| panic!("{e}"));
    let scene = folder.join("large.ron");
    fs::write(&scene, SCENE).unwrap_or_else(|e| panic!("{e}"));
    let path = scene.to_string_lossy();
    let open = || Scene::open(&path, &[]).unwrap_or_else(|e| panic!("{e}"));
    let opened = median(|| {
        open();
    });
    let scene = open();
    let nodes = scene.model.nodes.len();
    let mut debugger = Debugger::new(Theme::mono(), Vec::new(), Some(Session::new(scene)));
    let area = Rect::new(0, 0, 200, 60);
    let mut buffer = Buffer::empty(area);
    // The frame as it is opened, then two keys: the help, and back.
    let drawn = ["", "?", "Esc"].map(|name| {
        let began = Instant::now();
        if let Some(press) = keys::press(name) {
            debugger.key(&press);
        }
        debugger.advance();
        screen::draw(&mut buffer, area, &debugger.app, debugger.view().as_ref());
        1e3 * began.elapsed().as_secs_f64()
    });
    println!(
        "| {name} | {nodes} | {:.1} | {opened:.2} | {:.1} | {:.1} |",
        text.len() as f64 / 1e6,
        drawn[0],
        drawn[1].max(drawn[2])
    );
}

/// A square of so many cells a side in Gmsh's format 2.2, of elements of Gmsh's type 2, 3 or 16.
fn mesh(gmsh: u8, cells: usize) -> String {
    // Places of nodes on a grid of halves of cells.
    let step = if gmsh == 16 { 1 } else { 2 };
    let (mut labels, mut nodes) = (BTreeMap::new(), String::new());
    for row in (0..=2 * cells).step_by(step) {
        for column in (0..=2 * cells).step_by(step) {
            if row % 2 == 0 || column % 2 == 0 {
                let label = labels.len() + 1;
                labels.insert((column, row), label);
                let at = [column, row].map(|k| k as f64 / (2 * cells) as f64);
                writeln!(nodes, "{label} {} {} 0", at[0], at[1]).unwrap_or_default();
            }
        }
    }
    let mut elements = String::new();
    let mut count = 0;
    let mut element = |kind: u8, group: u8, places: &[(usize, usize)]| {
        count += 1;
        write!(elements, "{count} {kind} 2 {group} {group}").unwrap_or_default();
        for place in places {
            write!(elements, " {}", labels[place]).unwrap_or_default();
        }
        elements.push('\n');
    };
    for y in (0..2 * cells).step_by(2) {
        for x in (0..2 * cells).step_by(2) {
            let corners = [(x, y), (x + 2, y), (x + 2, y + 2), (x, y + 2)];
            let middles = [(x + 1, y), (x + 2, y + 1), (x + 1, y + 2), (x, y + 1)];
            match gmsh {
                2 => {
                    element(2, 1, &[corners[0], corners[1], corners[2]]);
                    element(2, 1, &[corners[0], corners[2], corners[3]]);
                }
                3 => element(3, 1, &corners),
                _ => element(16, 1, &[corners, middles].concat()),
            }
        }
    }
    for (group, y) in [(2, 0), (3, 2 * cells)] {
        for x in (0..2 * cells).step_by(2) {
            let ends = [(x, y), (x + 2, y)];
            match gmsh {
                16 => element(8, group, &[ends[0], ends[1], (x + 1, y)]),
                _ => element(1, group, &ends),
            }
        }
    }
    format!(
        "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n3\n2 1 \"body\"\n1 2 \"floor\"\n1 3 \"lid\"\n$EndPhysicalNames\n\
         $Nodes\n{}\n{nodes}$EndNodes\n$Elements\n{count}\n{elements}$EndElements\n",
        labels.len()
    )
}

/// Median of the seconds that three runs take.
fn median(mut run: impl FnMut()) -> f64 {
    let mut times = [0.0; 3].map(|_: f64| {
        let began = Instant::now();
        run();
        began.elapsed().as_secs_f64()
    });
    times.sort_unstable_by(f64::total_cmp);
    times[1]
}
