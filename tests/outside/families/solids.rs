//! Solids on rigid curves and on each other.

use super::draft::{Draft, Phases, arc, kind, line, through};
use crate::outside::chain::{Place, Point};
use crate::outside::draw::{Draw, round};

/// A block on a rigid floor, an arch, or corners.
pub fn on_rigid(d: &mut Draw) -> Draft {
    let mut draft = Draft::new(d, String::new());
    let width = d.number(0.6, 2.5);
    let reach = width * d.uniform(0.8, 1.6);
    let per_element = d.pick(&[2, 3, 5]);
    let mesh = (d.whole(2, 6), per_element, 1);
    let (what, floor) = match d.whole(0, 3) {
        0 => {
            let ends = [round(0.5 * width + reach), round(0.5 * width - reach)];
            ("floor", line("f", [ends[0], 0.0], [ends[1], 0.0], mesh))
        }
        1 => {
            let radius = width * d.number(1.0, 5.0);
            let half = (reach / radius).min(1.2).to_degrees();
            let center = [round(width * d.uniform(0.1, 0.9)), -radius];
            let angles = [round(90.0 - half), round(90.0 + half)];
            ("arch", arc("f", center, radius, angles, mesh))
        }
        _ => {
            let count = d.whole(2, 5);
            let rough = d.pick(&[0.0, 0.03, 0.1]);
            let points: Vec<Point> = (0..=count)
                .map(|k| {
                    let x = 0.5 * width + reach * (1.0 - 2.0 * k as f64 / count as f64);
                    [round(x), round(d.uniform(-rough, rough) * width)]
                })
                .collect();
            ("corners", through("f", &points, 2))
        }
    };
    // The block lies over the highest point below it.
    let place = |k: usize| Place {
        element: k / 64,
        xi: (k % 64) as f64 / 32.0 - 1.0,
    };
    let heights = (0..64 * floor.chain.count())
        .map(|k| floor.chain.at(place(k)).0)
        .filter(|p| p[0] > -0.02 * width && p[0] < 1.02 * width)
        .map(|p| p[1]);
    let gap = if d.chance(0.5) {
        0.0
    } else {
        d.scale(0.001, 0.03) * width
    };
    let base = heights.fold(f64::NEG_INFINITY, f64::max) + gap;
    let height = d.number(0.3, 1.0) * width;
    let tilt = if d.chance(0.6) {
        0.0
    } else {
        round(d.uniform(0.0, 0.08) * width)
    };
    let top = round(base + tilt + height);
    let cells = (d.whole(1, 5), d.whole(1, 2));
    draft.nodes.extend([
        format!(
            "Block(id: \"u\", corners: [(0.0, {:?}), ({width:?}, {base:?}), ({width:?}, {top:?}), (0.0, {top:?})], elements: {cells:?})",
            base + tilt
        ),
        floor.text,
    ]);
    let young = d.scale(50.0, 3000.0);
    let kind = kind(d);
    draft.solid("u", young, &kind);
    draft.surface("f", "f");
    let nodes = 2.0 * cells.0 as f64 + 1.0;
    let pressure = young * d.scale(0.005, 0.1);
    draft.touch(d, &["u.bottom".into()], "f", pressure * width / nodes);
    draft.title = format!(
        "on {what}, {}",
        drive(d, &mut draft, "u", [width, height], [young, pressure])
    );
    draft
}

/// Presses a block down and aside at its top, by traction (held by soft springs) or by a motion; says which.
fn drive(
    d: &mut Draw,
    draft: &mut Draft,
    id: &str,
    [width, height]: [f64; 2],
    [young, pressure]: [f64; 2],
) -> &'static str {
    let phases = Phases::draw(d);
    let top = format!("{id}.top");
    let aside = d.sign();
    if d.chance(0.5) {
        let stiffness = [d.scale(0.002, 0.3), d.scale(0.0005, 0.05)].map(|k| k * young);
        draft.springs("tl", &format!("{top}.start"), stiffness);
        draft.springs("tr", &format!("{top}.end"), stiffness);
        draft.traction(&top, [0.0, -pressure], &phases.press());
        let by = [
            aside * d.uniform(0.05, 1.0) * pressure,
            d.uniform(-0.7, 0.5) * pressure,
        ];
        draft.traction(&top, by, &phases.drag());
        "by traction"
    } else {
        let down = -d.scale(0.005, 0.1) * height;
        let by = [
            aside * d.scale(0.01, 0.3) * width,
            d.uniform(-0.3, 0.3) * down,
        ];
        draft.motion(&top, [0.0, down], by, &phases);
        "by motion"
    }
}

/// A block on another.
pub fn on_solid(d: &mut Draw) -> Draft {
    let mut draft = Draft::new(d, String::new());
    let width = d.number(1.0, 2.0);
    let height = d.number(0.3, 1.0);
    let cells = (d.whole(1, 5), d.whole(1, 2));
    draft.nodes.push(format!(
        "Block(id: \"p\", corners: [(0.0, 0.0), ({width:?}, {height:?})], elements: {cells:?})"
    ));
    let ends = [
        round(d.uniform(-0.1, 0.35) * width),
        round(d.uniform(0.6, 1.1) * width),
    ];
    let gap = if d.chance(0.6) {
        0.0
    } else {
        d.scale(0.001, 0.03)
    };
    let tilt = if d.chance(0.7) {
        0.0
    } else {
        d.scale(0.002, 0.08)
    };
    let size = [ends[1] - ends[0], d.number(0.3, 0.9)];
    let cells = (d.whole(1, 4), d.whole(1, 2));
    let (left, right) = (height + gap, height + gap + tilt);
    let top = round(right + size[1]);
    draft.nodes.push(format!(
        "Block(id: \"q\", corners: [({x0:?}, {left:?}), ({x1:?}, {right:?}), ({x1:?}, {top:?}), ({x0:?}, {top:?})], elements: {cells:?})",
        x0 = ends[0],
        x1 = ends[1],
    ));
    let young = d.scale(50.0, 3000.0);
    for (id, young) in [("p", young), ("q", young * d.scale(0.1, 10.0))] {
        let kind = kind(d);
        draft.solid(id, young, &kind);
    }
    draft.hold("p.bottom", "x, y");
    let pressure = young * d.scale(0.005, 0.1);
    let force = 0.2 * pressure * width;
    let roles = if d.chance(0.6) {
        draft.surface("f", "p.top");
        draft.touch(d, &["q.bottom".into()], "f", force);
        "upper nodes"
    } else {
        draft.surface("f", "q.bottom");
        draft.touch(d, &["p.top".into()], "f", force);
        "lower nodes"
    };
    draft.title = format!(
        "{roles}, {}",
        drive(d, &mut draft, "q", size, [young, pressure])
    );
    draft
}

/// Three blocks, the middle one loose but for soft springs.
pub fn stack(d: &mut Draw) -> Draft {
    let mut draft = Draft::new(d, String::new());
    let width = d.number(1.2, 2.0);
    let mut base = 0.0;
    let mut sizes = Vec::new();
    for id in ["p", "q", "r"] {
        let height = d.number(0.2, 0.6);
        let (low, high) = match id {
            "q" => (0.05, 0.95),
            _ => (-0.1, 1.1),
        };
        let x = [low, high].map(|part| round((part + d.uniform(-0.05, 0.05)) * width));
        let cells = (d.whole(1, 4), d.whole(1, 2));
        let (gap, top) = (
            if base > 0.0 && d.chance(0.3) {
                d.scale(0.001, 0.02)
            } else {
                0.0
            },
            round(base + height),
        );
        draft.nodes.push(format!(
            "Block(id: \"{id}\", corners: [({:?}, {:?}), ({:?}, {top:?})], elements: {cells:?})",
            x[0],
            base + gap,
            x[1]
        ));
        sizes.push([x[1] - x[0], height]);
        base = top;
    }
    let young = d.scale(50.0, 3000.0);
    let middle = young * d.scale(0.2, 5.0);
    let kind = kind(d);
    for (id, young) in [("p", young), ("q", middle), ("r", young)] {
        draft.solid(id, young, &kind);
    }
    draft.hold("p.bottom", "x, y");
    let soft = [young * d.scale(0.005, 0.1); 2];
    draft.springs("sl", "q.left.start", soft);
    draft.springs("sr", "q.right.start", soft);
    let pressure = young * d.scale(0.005, 0.08);
    let force = 0.2 * pressure * width;
    // Either side of each joint may have the slave nodes.
    for (below, above) in [("p", "q"), ("q", "r")] {
        let (master, slave) = if d.chance(0.7) {
            (format!("{below}.top"), format!("{above}.bottom"))
        } else {
            (format!("{above}.bottom"), format!("{below}.top"))
        };
        let id = format!("f{below}");
        draft.surface(&id, &master);
        draft.touch(d, &[slave], &id, force);
    }
    draft.title = drive(d, &mut draft, "r", sizes[2], [young, pressure]).into();
    draft
}
