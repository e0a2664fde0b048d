//! Beams whose nodes touch other beams, rigid curves and solids.

use super::draft::{Curve, Draft, Mesh, Phases, arc, kind, line, mesh, through};
use crate::outside::chain::Point;
use crate::outside::draw::{Draw, round};

/// A beam that stands on another with its end, or lies along it.
pub fn on_beam(d: &mut Draw) -> Draft {
    if d.chance(0.25) {
        return along(d);
    }
    let mut draft = Draft::new(d, String::new());
    draft.refine = d.pick(&[1, 1, 2]);
    let master = master(d, draft.refine);
    draft.nodes.push(master.text.clone());
    let master_ei = draft.beam(d, "m");
    draft.surface("f", "m");
    let cantilever = d.chance(0.5);
    if cantilever {
        draft.hold("m.1", "x, y, rotation");
    } else {
        draft.hold("m.1", "x, y");
        draft.hold(&format!("m.{}", master.nodes), "x, y");
    }
    let pushed = match (cantilever && d.chance(0.3)).then_some(()) {
        Some(()) => Some(format!("m.{}", master.nodes)),
        None => None,
    };
    stand(d, &mut draft, &master, pushed.map(|node| (node, master_ei)));
    draft
}

/// A line or an arc that a beam runs along.
fn master(d: &mut Draw, refine: usize) -> Curve {
    let (elements, per_element) = mesh(d);
    let mesh = (elements, per_element, refine);
    if d.chance(0.5) {
        let (length, turn) = (d.number(1.0, 5.0), d.number(0.0, 360.0).to_radians());
        let to = [round(length * turn.cos()), round(length * turn.sin())];
        line("m", [0.0, 0.0], to, mesh)
    } else {
        let (radius, from) = (d.number(1.0, 5.5), d.number(0.0, 180.0));
        let to = round(from + d.sign() * d.uniform(30.0, 90.0));
        arc("m", [0.0, 0.0], radius, [from, to], mesh)
    }
}

/// A beam "s" whose end stands on a curve, and what moves it. `pushed` is a node of the curve that may be pushed as well, and
/// the bending stiffness behind it.
fn stand(d: &mut Draw, draft: &mut Draft, floor: &Curve, pushed: Option<(String, f64)>) {
    let place = floor.place(d);
    let (foot, (n, t)) = (floor.chain.at(place).0, floor.chain.frame(place));
    let size = d.number(0.6, 3.0);
    let gap = if d.chance(0.6) {
        0.0
    } else {
        size * d.scale(0.0005, 0.08)
    };
    let lean = d.number(-65.0, 65.0).to_radians();
    let end = along_frame(foot, [n, t], [gap, 0.0]);
    let start = along_frame(end, [n, t], [size * lean.cos(), size * lean.sin()]).map(round);
    let (elements, per_element) = mesh(d);
    let beam = line("s", start, end, (elements, per_element, draft.refine));
    draft.nodes.push(beam.text.clone());
    let ei = draft.beam(d, "s");
    let tip = format!("s.{}", beam.nodes);
    let force = d.scale(0.1, 5.0) * ei / (size * size);
    let slaves = if d.chance(0.75) {
        vec![tip.clone()]
    } else {
        beam.names("s", 1)
    };
    draft.touch(d, &slaves, "f", force);
    let phases = Phases::draw(d);
    let (press, drag) = (phases.press(), phases.drag());
    let aside = d.sign();
    match pushed {
        Some((node, stiffness)) => {
            draft.title = "pushed from below".into();
            draft.hold("s.1", "x, y, rotation");
            let push = d.scale(0.1, 2.0) * stiffness;
            let by = [d.uniform(0.3, 1.0) * push, d.uniform(-0.5, 0.5) * push];
            draft.force(&node, along_frame([0.0; 2], [n, t], by), &press);
            let by = [-d.uniform(0.0, 1.0) * force, aside * force];
            draft.force(&tip, along_frame([0.0; 2], [n, t], by), &drag);
        }
        None if d.chance(0.45) => {
            draft.title = "pressed at its end".into();
            draft.hold("s.1", "x, y, rotation");
            let by = [-force, 0.0];
            draft.force(&tip, along_frame([0.0; 2], [n, t], by), &press);
            let by = [
                d.uniform(-0.6, 0.9) * force,
                aside * d.uniform(0.1, 1.5) * force,
            ];
            draft.force(&tip, along_frame([0.0; 2], [n, t], by), &drag);
        }
        None => {
            draft.title = "moved at its other end".into();
            draft.hold("s.1", "rotation");
            let down = [-gap - d.scale(0.02, 0.4) * size, 0.0];
            let by = [
                d.uniform(-0.03, 0.05) * size,
                aside * d.scale(0.05, 1.0) * size,
            ];
            let [down, by] = [down, by].map(|by| along_frame([0.0; 2], [n, t], by));
            draft.motion("s.1", down, by, &phases);
        }
    }
}

/// A point that lies from another by these parts along two directions.
fn along_frame(from: Point, [a, b]: [Point; 2], by: [f64; 2]) -> Point {
    [0, 1].map(|k| from[k] + by[0] * a[k] + by[1] * b[k])
}

/// A beam that lies along another, all of its nodes over it.
fn along(d: &mut Draw) -> Draft {
    let mut draft = Draft::new(d, "one along the other".into());
    let length = d.number(1.5, 5.0);
    let (elements, per_element) = mesh(d);
    let below = line(
        "m",
        [0.0, 0.0],
        [-length, 0.0],
        (elements, per_element, draft.refine),
    );
    draft.nodes.push(below.text.clone());
    draft.beam(d, "m");
    draft.surface("f", "m");
    draft.hold("m.1", "x, y, rotation");
    if d.chance(0.4) {
        draft.hold(&format!("m.{}", below.nodes), "x, y");
    }
    let gap = if d.chance(0.4) {
        0.0
    } else {
        d.scale(0.002, 0.1) * length
    };
    let rise = if d.chance(0.5) {
        0.0
    } else {
        d.scale(0.005, 0.2) * length
    };
    let ends = [
        [round(-d.uniform(0.02, 0.3) * length), round(gap + rise)],
        [round(-d.uniform(0.55, 1.1) * length), round(gap)],
    ];
    let turned = d.chance(0.5);
    let [from, to] = if turned { [ends[1], ends[0]] } else { ends };
    let (elements, per_element) = mesh(d);
    let above = line("s", from, to, (elements, per_element, draft.refine));
    draft.nodes.push(above.text.clone());
    let ei = draft.beam(d, "s");
    draft.hold("s.1", "x, y, rotation");
    let size = (to[0] - from[0]).abs();
    let force = d.scale(0.2, 6.0) * ei / (size * size);
    draft.touch(d, &above.names("s", 1), "f", force);
    let phases = Phases::draw(d);
    let (press, drag) = (phases.press(), phases.drag());
    let tip = format!("s.{}", above.nodes);
    draft.force(&tip, [0.0, -force], &press);
    let by = [
        d.sign() * d.uniform(0.1, 1.5) * force,
        d.uniform(-0.5, 0.5) * force,
    ];
    draft.force(&tip, by, &drag);
    draft
}

/// A beam that stands on a rigid curve, or is bent round one.
pub fn on_rigid(d: &mut Draw) -> Draft {
    if d.chance(0.2) {
        return around(d);
    }
    let mut draft = Draft::new(d, String::new());
    draft.refine = d.pick(&[1, 1, 2]);
    let (kind, floor) = rigid(d, draft.refine);
    draft.nodes.push(floor.text.clone());
    draft.surface("f", "f");
    stand(d, &mut draft, &floor, None);
    draft.title = format!("{}, {kind}", draft.title);
    draft
}

/// A rigid curve "f", walked towards −x where it is flat, so that up is outward.
fn rigid(d: &mut Draw, refine: usize) -> (&'static str, Curve) {
    let (elements, per_element) = mesh(d);
    let mesh: Mesh = (elements + 1, per_element, refine);
    match d.whole(0, 4) {
        0 => {
            let half = d.number(20.0, 80.0);
            let curve = arc(
                "f",
                [0.0, 0.0],
                d.number(1.0, 5.0),
                [90.0 - half, 90.0 + half],
                mesh,
            );
            ("arch", curve)
        }
        1 => {
            let half = d.number(20.0, 80.0);
            let curve = arc(
                "f",
                [0.0, 0.0],
                d.number(2.0, 6.0),
                [half - 90.0, -half - 90.0],
                mesh,
            );
            ("bowl", curve)
        }
        k => {
            let per_element = if k == 4 { 3 } else { 2 };
            let count = d.whole(2, 5) * (per_element - 1);
            let rough = d.pick(&[0.05, 0.15, 0.35]);
            let step = d.number(0.5, 2.0) / (per_element - 1) as f64;
            let mut points: Vec<Point> = Vec::new();
            for k in 0..=count {
                let x = (0.5 * count as f64 - k as f64) * step;
                points.push([round(x), d.number(-rough, rough) * step]);
            }
            ("corners", through("f", &points, per_element))
        }
    }
}

/// A cantilever beside a rigid circle that touches it at the clamp.
fn around(d: &mut Draw) -> Draft {
    let mut draft = Draft::new(d, "round a circle".into());
    let length = d.number(0.8, 2.0);
    let (elements, per_element) = mesh(d);
    let beam = line(
        "s",
        [0.0, 0.0],
        [0.0, length],
        (elements + 1, per_element, 1),
    );
    let radius = d.number(0.6, 3.0) * length;
    let half = d.number(45.0, 90.0);
    let apart = d.scale(0.001, 0.05) * length;
    let (elements, per_element) = mesh(d);
    let circle = arc(
        "f",
        [round(radius + apart), 0.0],
        radius,
        [180.0 - half, 180.0 + half],
        (elements + 2, per_element, 1),
    );
    draft.nodes.extend([beam.text.clone(), circle.text]);
    let ei = draft.beam(d, "s");
    draft.surface("f", "f");
    draft.hold("s.1", "x, y, rotation");
    let force = d.scale(0.3, 4.0) * ei / (length * length);
    draft.touch(d, &beam.names("s", 1), "f", 0.3 * force);
    let phases = Phases::draw(d);
    let (press, drag) = (phases.press(), phases.drag());
    let tip = format!("s.{}", beam.nodes);
    draft.force(&tip, [force, 0.0], &press);
    draft.force(&tip, [0.0, d.uniform(-0.6, 0.6) * force], &drag);
    draft
}

/// A cantilever beside a block, either of which has the slave nodes.
pub fn on_solid(d: &mut Draw) -> Draft {
    let mut draft = Draft::new(d, String::new());
    let height = 2.0;
    let (elements, per_element) = mesh(d);
    let beam = line(
        "b",
        [0.0, 0.0],
        [0.0, height],
        (elements + 1, per_element, 1),
    );
    let (low, high) = (d.number(0.0, 0.6), d.number(0.8, 1.9));
    let gap = if d.chance(0.5) {
        0.0
    } else {
        d.scale(0.002, 0.08)
    };
    let slant = if d.chance(0.5) {
        0.0
    } else {
        d.scale(0.005, 0.15)
    };
    let [bottom, top] = if d.chance(0.5) {
        [gap, gap + slant]
    } else {
        [gap + slant, gap]
    };
    let width = d.number(0.4, 1.3);
    let cells = (d.whole(1, 3), d.whole(1, 4));
    draft.nodes.extend([
        beam.text.clone(),
        format!(
            "Block(id: \"k\", corners: [({bottom:?}, {low:?}), ({right:?}, {low:?}), ({right:?}, {high:?}), ({top:?}, {high:?})], elements: {cells:?})",
            right = round(width + bottom.max(top)),
        ),
    ]);
    let ei = draft.beam(d, "b");
    let kind = kind(d);
    draft.solid("k", ei * d.scale(8.0, 300.0), &kind);
    draft.hold("k.right", "x, y");
    draft.hold("b.1", "x, y, rotation");
    let tip = format!("b.{}", beam.nodes);
    let force = d.scale(0.3, 8.0) * ei / (height * height);
    if d.chance(0.6) {
        draft.title = "nodes of the beam".into();
        draft.surface("f", "k.left");
        draft.touch(d, &beam.names("b", 1), "f", 0.3 * force);
    } else {
        draft.title = "nodes of the block".into();
        draft.surface("f", "b");
        draft.touch(d, &["k.left".into()], "f", 0.3 * force);
    }
    let phases = Phases::draw(d);
    let (press, drag) = (phases.press(), phases.drag());
    let aside = d.sign() * d.uniform(0.1, 0.9);
    if d.chance(0.7) {
        draft.force(&tip, [force, 0.0], &press);
        draft.force(&tip, [0.0, aside * force], &drag);
    } else {
        let by = [gap + d.scale(0.03, 0.5), 0.0];
        draft.motion(&tip, by, [0.0, aside * d.scale(0.005, 0.1)], &phases);
    }
    draft
}
