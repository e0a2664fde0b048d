//! A state as a picture for print: the deformed shape with modes, surface normals, contact forces and gaps, a
//! table of slave nodes, and the timeline at the bottom.
//!
//! Small displacements are magnified. Forces have a separate scale, shown below the shape. Modes differ in the
//! shape of their markers, and in colours that also differ in greyscale.

use super::chart;
use super::export_state::{ExportState, PicturePart};
use super::timeline::{self, chosen, marker};
use super::window::{FORCE, Window};
use crate::RoundOff;
use crate::explain::conditions::{Given, conditions};
use crate::explain::model_facts::{diagonal, solid_elements};
use crate::explain::outline::{self, Bounds, Point, Projection, curve, extent};
use crate::explain::{failures, names};
use crate::refusal::Refusal;
use stickslip_core::plane::distance;
use stickslip_core::{
    ContactRecord, Mode, Model, Outcome, Status, Stepper, SurfaceElement, counted,
};
use stickslip_scene::{shortest, shown, sig4};
use stickslip_study::drawn::PlotError;
use stickslip_study::origin;
use stickslip_study::placing::{OccupiedArea, Patch};
use stickslip_study::sheet::{
    Anchor, BLACK, Colour, GREY, LABEL, MARGIN, PALE, SMALL, Sheet, widest,
};

/// Projection of scenes in space.
pub(super) const OBLIQUE: Projection = Projection::Oblique;
/// Width of the picture, and height of the shape or the chart.
const WIDTH: f64 = 980.0;
const HIGH: f64 = 400.0;
/// Minimum height of the shape or the chart, and minimum width of a picture, in units of the small text.
const LOW: f64 = 120.0;
const NARROW: f64 = 480.0;
/// Length of the largest load and prescribed motion, in pixels.
pub(super) const LOAD: f64 = 52.0;
/// Length of a normal, in pixels.
const NORMAL: f64 = 13.0;
/// Pixels between two normals.
const SPACING: f64 = 46.0;
/// Elements with a shorter diagonal (in pixels) are drawn without edges.
const ELEMENT: f64 = 7.0;
/// Maximum number of slave nodes in the table and labelled in the shape.
const ROWS: usize = 14;
/// Colour of forces.
const VERMILION: Colour = (213, 94, 0);
/// Colour of bodies.
const DARK: Colour = (60, 60, 60);

pub(super) fn svg(shown: &ExportState, _: &mut Stepper) -> Result<Vec<u8>, Refusal> {
    Ok(sheet(shown)?.svg()?.into_bytes())
}

pub(super) fn png(shown: &ExportState, _: &mut Stepper) -> Result<Vec<u8>, Refusal> {
    let pixels = if shown.picture.size.is_some() {
        1.0
    } else {
        2.0
    };
    Ok(sheet(shown)?.png(pixels)?)
}

/// The picture as plain data.
///
/// # Errors
/// If the font cannot be read, or the text leaves no room in the requested size.
pub fn sheet(shown: &ExportState) -> Result<Sheet, PlotError> {
    let request = shown.picture;
    let factor = match (request.font, request.size) {
        (Some(font), _) => font / SMALL,
        (None, Some((width, _))) => f64::from(width) / WIDTH,
        (None, None) => 1.0,
    };
    let Some((width, height)) = request.size.map(|(w, h)| (f64::from(w), f64::from(h))) else {
        return Ok(parts(shown, WIDTH, HIGH)?.scaled(factor));
    };
    let (width, height) = (width / factor, height / factor);
    // What the shape or the chart does not need is known only after it was drawn once.
    let first = parts(shown, width, HIGH)?;
    let high = HIGH + height - first.height - MARGIN;
    if high < LOW || width < NARROW {
        let message =
            "the text leaves no room for the picture; use a smaller --font or a larger --size";
        return Err(PlotError::new(message));
    }
    let mut sheet = parts(shown, width, high)?;
    sheet.height = height - MARGIN;
    Ok(sheet.scaled(factor))
}

/// The requested parts, with a shape, chart or timeline of a height.
fn parts(shown: &ExportState, width: f64, high: f64) -> Result<Sheet, PlotError> {
    let model = &shown.scene.model;
    let mut sheet = Sheet::new(width, &title(shown))?;
    sheet.paragraph(&[caption(shown)], LABEL, BLACK)?;
    let rows = chosen(model, shown.strips, ROWS);
    match shown.picture.only {
        None => {
            shape(&mut sheet, shown, &rows, high)?;
            table(&mut sheet, shown, &rows)?;
            timeline::draw(&mut sheet, model, shown.strips, None)?;
        }
        Some(PicturePart::Shape) => shape(&mut sheet, shown, &rows, high)?,
        Some(PicturePart::Timeline) => {
            let top = sheet.height;
            timeline::draw(&mut sheet, model, shown.strips, Some(high))?;
            sheet.height = sheet.height.max(top + high);
        }
        Some(PicturePart::Chart) => chart::load(&mut sheet, shown, high)?,
        Some(PicturePart::Cone) => chart::cone(&mut sheet, shown, high)?,
    }
    sheet.paragraph(&footer(shown), SMALL, GREY)?;
    Ok(sheet)
}

fn title(shown: &ExportState) -> String {
    match shown.scene.model.title.as_str() {
        "" => shown.scene.name.clone(),
        title => title.to_owned(),
    }
}

/// The position, load and outcome of the state.
fn caption(shown: &ExportState) -> String {
    let Some(event) = shown.event else {
        return "The start, before the first minor iteration.".to_owned();
    };
    let at = names::position(event.position);
    let load = shortest(event.load_factor);
    let what = match (&event.outcome, &shown.state.status) {
        (_, Status::Failed(failure)) | (Outcome::Failed(failure), _) => format!(
            "last state; the increment failed: {}",
            failures::describe(&shown.scene.model, failure)
        ),
        (Outcome::Increment { .. }, Status::Finished) => "accepted; end of the history".to_owned(),
        (Outcome::Increment { .. }, _) => "accepted".to_owned(),
        (Outcome::Major { .. } | Outcome::Refused { .. }, _) => "not in equilibrium yet".to_owned(),
        (Outcome::Motion(_), _) => "moving against viscous drag; not in equilibrium".to_owned(),
        (
            Outcome::Cut { .. }
            | Outcome::WholeIncrement { .. }
            | Outcome::Fallback { .. }
            | Outcome::PathCorner { .. },
            _,
        ) => "the increment restarts".to_owned(),
        _ => "modes or T_max still change".to_owned(),
    };
    let text = format!("{at}, load {load}: {what}");
    if text.ends_with('…') {
        text
    } else {
        text + "."
    }
}

/// The origin of the picture: scene, strategy and program.
fn footer(shown: &ExportState) -> Vec<String> {
    let mut from = format!("Scene: {}", shown.origin.scene);
    if !shown.origin.changes.is_empty() {
        from += &format!(", with {}", shown.origin.changes.join(", "));
    }
    let settings = &shown.state.controls.settings;
    let strategy = settings.strategy.name();
    vec![format!(
        "{from}; strategy {strategy}. {}.",
        origin::program()
    )]
}

/// How a line is drawn.
struct Pen {
    width: f64,
    colour: Colour,
    dashed: bool,
}

fn pen(width: f64, colour: Colour) -> Pen {
    Pen {
        width,
        colour,
        dashed: false,
    }
}

fn shape(
    sheet: &mut Sheet,
    shown: &ExportState,
    rows: &[usize],
    high: f64,
) -> Result<(), PlotError> {
    let model = &shown.scene.model;
    let magnified = outline::magnification(model, std::iter::once(&shown.state.u[..]));
    let now = |node: usize| outline::magnified(model, &shown.state.u, node, (magnified, OBLIQUE));
    let top = sheet.height;
    let patch = Patch {
        from: (MARGIN, top),
        to: (sheet.width - MARGIN, top + high),
    };
    let seen = extent(model, OBLIQUE, &now).unwrap_or(Bounds::UNIT);
    let window = Window::new(&seen, patch, room(shown));
    let mut shape = ShapeDrawing {
        marked: radius(&window, model, &now),
        taken: OccupiedArea::within(patch),
        sheet,
        window,
        shown,
        now: &now,
    };
    shape.bodies();
    shape.surfaces();
    shape.gaps();
    let pressure = shape.pressures();
    shape.conditions();
    let largest = shape.forces();
    let numbered = shape.slaves(rows)?;
    shape.sheet.height = top + high + 0.5 * MARGIN;
    shape.legend(largest, magnified, numbered)?;
    if pressure > 0.0 {
        let text = format!(
            "Blue: contact pressure F_n / A on undeformed areas, maximum {}",
            sig4(pressure)
        );
        sheet.paragraph(&[text], SMALL, GREY)?;
    }
    Ok(())
}

/// A shape being drawn.
pub(super) struct ShapeDrawing<'a> {
    pub sheet: &'a mut Sheet,
    pub window: Window,
    pub shown: &'a ExportState<'a>,
    /// Deformed position of a node.
    pub now: &'a dyn Fn(usize) -> Point,
    /// Size of the markers of slave nodes.
    pub marked: f64,
    /// What labels must not cover.
    pub taken: OccupiedArea,
}

impl ShapeDrawing<'_> {
    /// Deformed position of a node on the sheet.
    pub fn at(&self, node: usize) -> (f64, f64) {
        self.window.at((self.now)(node))
    }

    fn stroke(&mut self, points: &[Point], pen: &Pen) {
        for chain in self.window.inside(&curve(points)) {
            if pen.dashed {
                self.sheet.dashed(&chain, pen.width, pen.colour)
            } else {
                self.sheet.line(&chain, pen.width, pen.colour)
            }
        }
    }

    /// Draws a curve that labels must not cover.
    fn line(&mut self, points: &[Point], pen: &Pen) {
        self.stroke(points, pen);
        for chain in self.window.inside(&curve(points)) {
            for pair in chain.windows(2) {
                self.taken.take_line(pair[0], pair[1]);
            }
        }
    }

    /// Undeformed (dashed) and deformed elements.
    fn bodies(&mut self) {
        let model = &self.shown.scene.model;
        let lines = || model.bodies.iter().flat_map(|body| body.kind.lines());
        let before = Pen {
            dashed: true,
            ..pen(1.0, (150, 150, 150))
        };
        for element in lines() {
            let points: Vec<Point> = element
                .iter()
                .map(|&node| OBLIQUE.at(model, node))
                .collect();
            self.line(&points, &before);
        }
        for element in model.bodies.iter().flat_map(solid_elements) {
            let [a, b] = diagonal(element).map(self.now);
            if distance(a, b) * self.window.scale < ELEMENT {
                continue;
            }
            for face in element.kind.faces_of(&element.nodes) {
                let points: Vec<Point> = face.iter().map(|&node| (self.now)(node)).collect();
                self.stroke(&points, &pen(0.7, PALE));
            }
        }
        for element in lines() {
            let points: Vec<Point> = element.iter().map(|&node| (self.now)(node)).collect();
            self.line(&points, &pen(2.0, DARK));
        }
    }

    /// Master surfaces, with arrows to their outward side: on the right in the direction of travel.
    fn surfaces(&mut self) {
        for surface in &self.shown.scene.model.surfaces {
            let mut walked = 0.5 * SPACING;
            for element in SurfaceElement::all(surface) {
                let points = outline::element(element, self.now);
                self.stroke(&points, &pen(2.6, BLACK));
                for chain in self.window.inside(&curve(&points)) {
                    for pair in chain.windows(2) {
                        self.taken.take_line(pair[0], pair[1]);
                        self.normals(pair[0], pair[1], &mut walked);
                    }
                }
            }
        }
    }

    fn normals(&mut self, from: (f64, f64), to: (f64, f64), walked: &mut f64) {
        let (x, y) = (to.0 - from.0, to.1 - from.1);
        let length = x.hypot(y);
        if length <= 0.0 || !length.is_finite() {
            return;
        }
        let (x, y) = (x / length, y / length);
        while *walked < length {
            let foot = (from.0 + *walked * x, from.1 + *walked * y);
            // On the right in the direction of travel; y points down on the sheet.
            let tip = (foot.0 - NORMAL * y, foot.1 + NORMAL * x);
            self.sheet.arrow(foot, tip, 1.0, GREY);
            self.taken.take_line(foot, tip);
            *walked += SPACING;
        }
        *walked -= length;
    }

    /// Open gaps as lines from node to surface, if they are wide enough to see.
    fn gaps(&mut self) {
        let Some(event) = self.shown.event else {
            return;
        };
        for (contact, found) in self.shown.scene.model.contacts.iter().zip(&event.nodes) {
            let is_open = found.spot.is_some() && found.decision.before == Mode::Free;
            if !is_open || found.directions.is_some() {
                continue;
            }
            let at = (self.now)(contact.node);
            let foot = [0, 1].map(|axis| at[axis] - found.gap * found.normal[axis]);
            let (from, to) = (self.window.at(at), self.window.at(foot));
            let wide = (from.0 - to.0).hypot(from.1 - to.1);
            if wide > 2.0 && self.window.holds(from) && self.window.holds(to) {
                self.sheet.dashed(&[from, to], 1.0, (0, 114, 178));
            }
        }
    }

    /// Contact forces on the slave nodes, as arrows from the node in the direction in which the master pushes it; returns the largest.
    fn forces(&mut self) -> f64 {
        let largest = largest(self.shown);
        let Some(event) = self.shown.event.filter(|_| largest > 0.0) else {
            return 0.0;
        };
        for (slave, (contact, found)) in self
            .shown
            .scene
            .model
            .contacts
            .iter()
            .zip(&event.nodes)
            .enumerate()
        {
            let force = OBLIQUE.force(&self.shown.scene.model, event, slave);
            let scale = FORCE / largest;
            let node = self.at(contact.node);
            let along = |axis: usize| scale * force[axis];
            let long = scale * size(found) >= 1.0;
            if long && self.window.holds(node) {
                // The arrow starts next to the node's marker.
                let clear = (self.marked + 1.5) / (scale * size(found));
                let part = |by: f64| (node.0 + by * along(0), node.1 - by * along(1));
                let (tail, tip) = (part(clear), part(1.0 + clear));
                self.sheet.arrow(tail, tip, 2.0, VERMILION);
                self.taken.take_line(tail, tip);
            }
        }
        largest
    }

    /// Markers of the slave nodes; those in the table are labelled with their names or, where a name does not fit, with its row of
    /// the table. Returns the first such row.
    fn slaves(&mut self, rows: &[usize]) -> Result<Option<usize>, PlotError> {
        let has_table = self.shown.picture.only.is_none();
        let mut numbered = None;
        let model = &self.shown.scene.model;
        let at: Vec<_> = model
            .contacts
            .iter()
            .map(|contact| self.at(contact.node))
            .collect();
        for (slave, &at) in at
            .iter()
            .enumerate()
            .filter(|(_, at)| self.window.holds(**at))
        {
            marker(self.sheet, at, mode(self.shown, slave), self.marked);
            let side = 2.0 * self.marked + 4.0;
            self.taken.take(Patch::about(at, (side, side)));
        }
        for (row, &slave) in rows.iter().enumerate() {
            let at = at[slave];
            if !self.window.holds(at) {
                continue;
            }
            let number = has_table.then(|| format!("({})", row + 1));
            let texts = [Some(names::slave(model, slave).to_owned()), number];
            for (k, text) in texts.into_iter().flatten().enumerate() {
                let size = (widest([text.as_str()], SMALL)? + 4.0, 1.1 * SMALL);
                if let Some(patch) = self.taken.place(at, size, 60.0) {
                    self.sheet.leader(at, &patch, self.marked + 12.0);
                    self.sheet
                        .text(patch.middle(), &text, SMALL, BLACK, Anchor::Middle);
                    if k > 0 {
                        numbered.get_or_insert(row + 1);
                    }
                    break;
                }
            }
        }
        Ok(numbered)
    }

    /// A text in the legend; returns its width with the space after it.
    fn entry(&mut self, at: (f64, f64), text: &str) -> Result<f64, PlotError> {
        self.sheet.text(at, text, SMALL, BLACK, Anchor::Left);
        Ok(widest([text], SMALL)? + 22.0)
    }

    /// The legend: modes, the scales of lengths and forces, and the first node that is labelled with its row of the table.
    fn legend(
        &mut self,
        largest: f64,
        magnified: f64,
        numbered: Option<usize>,
    ) -> Result<(), PlotError> {
        let y = self.sheet.height + 0.7 * LABEL;
        let mut x = MARGIN + 6.0;
        for mode in [Mode::Free, Mode::Sliding, Mode::Fixed] {
            marker(self.sheet, (x, y), mode, 5.0);
            x += 12.0 + self.entry((x + 12.0, y), mode.word())?;
        }
        let unit = outline::round_down(90.0 / self.window.scale);
        if unit.is_finite() && unit > 0.0 {
            let wide = unit * self.window.scale;
            self.sheet.line(&[(x, y), (x + wide, y)], 2.0, BLACK);
            for end in [x, x + wide] {
                self.sheet
                    .line(&[(end, y - 5.0), (end, y + 5.0)], 1.5, BLACK);
            }
            x += wide + 8.0;
            x += self.entry((x, y), &format!("length {}", shortest(unit)))?;
        }
        if largest > 0.0 {
            let unit = outline::round_down(0.8 * largest);
            let wide = FORCE * unit / largest;
            self.sheet.arrow((x, y), (x + wide, y), 2.0, VERMILION);
            x += wide + 8.0;
            x += self.entry((x, y), &format!("contact force {}", shortest(unit)))?;
        }
        self.sheet.arrow((x, y + 6.0), (x, y - 7.0), 1.0, GREY);
        self.sheet
            .text((x + 10.0, y), "outward side", SMALL, BLACK, Anchor::Left);
        let moved = moved(self.shown);
        let scale = if magnified == 1.0 {
            "to scale".to_owned()
        } else {
            format!("magnified ×{}", shortest(magnified))
        };
        let number = numbered
            .map(|row| format!(" ({row}): the node in row {row} of the table."))
            .unwrap_or_default();
        let words = format!(
            "Displacements {scale}, maximum {}; dashed: undeformed; green: supports, loads, and prescribed motions (double line).{number}",
            sig4(moved)
        );
        self.sheet.height = y + 1.2 * LABEL;
        self.sheet.paragraph(&[words], SMALL, GREY)
    }
}

/// Margins that the force arrows need outside the shape: left, top, right, bottom.
fn room(shown: &ExportState) -> [f64; 4] {
    let (largest, mut room) = (largest(shown), [0.0_f64; 4]);
    let mut reach = |x: f64, y: f64| {
        for (room, reach) in room.iter_mut().zip([-x, y, x, -y]) {
            *room = room.max(reach);
        }
    };
    let model = &shown.scene.model;
    let load_factor = shown.event.map_or(0.0, |event| event.load_factor);
    for arrow in conditions(model, load_factor, &|node| model.nodes[node].at).arrows {
        let length = match arrow.given {
            Given::Load => -1.2 * LOAD,
            Given::Motion => 1.2 * LOAD,
        };
        reach(length * arrow.along[0], length * arrow.along[1]);
    }
    if let Some(event) = shown.event.filter(|_| largest > 0.0) {
        for (slave, _) in event
            .nodes
            .iter()
            .enumerate()
            .filter(|(_, found)| size(found).is_finite())
        {
            let [x, y] = OBLIQUE
                .force(model, event, slave)
                .map(|f| FORCE / largest * f);
            reach(x, y);
        }
    }
    room
}

fn size(found: &ContactRecord) -> f64 {
    found.f_n.hypot(found.f_t)
}

/// The largest contact force that is drawn; 0 if there is none.
fn largest(shown: &ExportState) -> f64 {
    let Some(event) = shown.event else { return 0.0 };
    let round_off = RoundOff::new(&shown.scene.model, &event.before);
    event
        .nodes
        .iter()
        .map(|found| round_off.arrow(size(found)))
        .filter(|f| f.is_finite())
        .fold(0.0, f64::max)
}

/// The largest marker size without overlap.
fn radius(window: &Window, model: &Model, now: &dyn Fn(usize) -> Point) -> f64 {
    let at: Vec<(f64, f64)> = model
        .contacts
        .iter()
        .map(|c| window.at(now(c.node)))
        .collect();
    let apart = at
        .windows(2)
        .map(|pair| {
            let (a, b) = (pair[0], pair[1]);
            (a.0 - b.0).hypot(a.1 - b.1)
        })
        .filter(|d| *d > 0.0)
        .fold(f64::INFINITY, f64::min);
    (0.34 * apart).clamp(2.0, 5.0)
}

/// The mode in the shown minor iteration; before the first one, the initial mode.
fn mode(shown: &ExportState, slave: usize) -> Mode {
    let found = shown.event.and_then(|event| event.nodes.get(slave));
    found.map_or(shown.state.nodes[slave].mode, |found| found.decision.before)
}

/// The largest displacement of a node.
fn moved(shown: &ExportState) -> f64 {
    let model = &shown.scene.model;
    let largest = (0..model.nodes.len())
        .map(|node| outline::displacement(model, &shown.state.u, node))
        .filter(|d| d.is_finite())
        .fold(0.0, f64::max);
    let round_off = shown.event.map(|event| RoundOff::new(model, &event.before));
    round_off.map_or(largest, |round_off| round_off.length(largest))
}

/// The table of some slave nodes.
fn table(sheet: &mut Sheet, shown: &ExportState, rows: &[usize]) -> Result<(), PlotError> {
    let Some(event) = shown.event.filter(|event| !event.nodes.is_empty()) else {
        return Ok(());
    };
    let model = &shown.scene.model;
    /// Number columns with the positions of their right ends.
    const COLUMNS: [(&str, f64); 5] = [
        ("gap", 430.0),
        ("F_n", 560.0),
        ("F_t", 690.0),
        ("T_max", 820.0),
        ("F_n / A", 950.0),
    ];
    /// Characters of a name that fit left of its mode.
    const NAME: usize = 20;
    let part = sheet.width / WIDTH;
    let wide = |x: f64| x * part;
    let mut y = sheet.height + 0.6 * SMALL;
    sheet.text((MARGIN + 40.0, y), "slave node", SMALL, GREY, Anchor::Left);
    sheet.text((MARGIN + 214.0, y), "mode", SMALL, GREY, Anchor::Left);
    let areas = model.contacts.iter().any(|contact| contact.area.is_some());
    let heads = if areas { &COLUMNS[..] } else { &COLUMNS[..4] };
    for &(head, x) in heads {
        sheet.text((wide(x), y), head, SMALL, GREY, Anchor::Right);
    }
    for (row, &slave) in rows.iter().enumerate() {
        let Some(found) = event.nodes.get(slave) else {
            continue;
        };
        y += 1.45 * SMALL;
        let mode = mode(shown, slave);
        sheet.text(
            (MARGIN + 32.0, y),
            &format!("({})", row + 1),
            SMALL,
            GREY,
            Anchor::Right,
        );
        sheet.text(
            (MARGIN + 40.0, y),
            &shown::cut(names::slave(model, slave), NAME),
            SMALL,
            BLACK,
            Anchor::Left,
        );
        marker(sheet, (MARGIN + 202.0, y), mode, 4.0);
        sheet.text((MARGIN + 214.0, y), mode.word(), SMALL, BLACK, Anchor::Left);
        let round_off = RoundOff::new(model, &event.before);
        let forces = [found.f_n, found.f_t, found.t_max];
        let mut values = vec![sig4(round_off.length(found.gap))];
        values.extend(forces.map(|force| sig4(round_off.force(force))));
        let by_area = model.contacts[slave].pressure(round_off.force(found.f_n), 0.0);
        values.extend(by_area.map(|[pressure, _]| sig4(pressure)));
        for ((_, x), value) in COLUMNS.iter().zip(values) {
            sheet.text((wide(*x), y), &value, SMALL, BLACK, Anchor::Right);
        }
    }
    sheet.height = y + SMALL;
    let left = model.contacts.len() - rows.len();
    if left > 0 {
        let words = format!("and {}", counted(left, "more slave node"));
        sheet.paragraph(&[words], SMALL, GREY)?;
    }
    sheet.height += 0.5 * SMALL;
    Ok(())
}
