//! The layout of the screen.
//!
//! - Small (80x24): the table, and below it one pane at a time, which Tab changes.
//! - Medium (120x40): the table across the top; below it on the left the decision and one more pane (the last one chosen), on the
//!   right the shape.
//! - Large (200x60): two columns above the timeline.
//!
//! The table gets the rows that it needs first; where there are few, the decision shrinks to the row of Table 2 that applies.
//!
//! The status is always at the top, the message and the footer at the bottom; below 80x24 there is one pane at a time. The length
//! of a message does not change the layout, so that rows stay in place while stepping: a long outcome or message is drawn over the
//! panes' edges.

use ratatui::layout::{Constraint, Layout, Rect};

stickslip_core::words! {
    /// A pane; all but [`Lesson`] can have the focus.
    pub enum Pane, title {
        /// The table of slave nodes.
        Nodes "slave nodes",
        /// The decision on the selected node.
        Decision "decision",
        /// The residual by major iteration.
        Residual "residual",
        /// The bodies and surfaces.
        Shape "shape",
        /// The load-displacement curve of a monitor.
        Curve "load",
        /// Slave nodes by minor iterations.
        Timeline "timeline",
        /// The cause of a cycle, and the consistent states.
        Diagnosis "diagnosis",
        /// The branches of the history.
        Branches "branches",
        /// The remedies that were tried, with their cost.
        Remedies "remedies",
        /// The contact of the selected node: its force in the friction cone, T_max by iteration, and who pushed it.
        Contact "contact",
        /// The current lesson; never has the focus.
        Lesson "lesson",
    }
}

use Pane::*;

impl Pane {
    /// The panes in Tab order.
    pub const ALL: [Pane; 10] = [
        Nodes, Decision, Residual, Shape, Curve, Timeline, Diagnosis, Branches, Remedies, Contact,
    ];

    /// Its number in Tab order, from 1.
    pub fn page(self) -> usize {
        Pane::ALL
            .iter()
            .position(|pane| *pane == self)
            .map_or(1, |at| at + 1)
    }

    /// Minimum height of the pane below a table that needs rows.
    fn least(self) -> u16 {
        match self {
            Decision | Nodes => SHORT_DECISION,
            _ => PAGE_BELOW,
        }
    }

    /// Whether the pane shares one place with others on medium screens.
    pub fn takes_turns(self) -> bool {
        !matches!(self, Nodes | Decision | Shape)
    }
}

/// Which panes the user looks at.
#[derive(Debug, Clone, Copy)]
pub struct ShownPanes {
    /// The pane with the focus.
    pub focus: Pane,
    /// The pane below the table on a small screen.
    pub page: Pane,
    /// Which of the panes that share one place is shown.
    pub chart: Pane,
    /// Whether the focused pane fills the screen.
    pub zoomed: bool,
}

impl Default for ShownPanes {
    fn default() -> ShownPanes {
        ShownPanes {
            focus: Nodes,
            page: Decision,
            chart: Residual,
            zoomed: false,
        }
    }
}

impl ShownPanes {
    /// Focuses the pane that is `places` steps further in Tab order.
    pub(super) fn turn(&mut self, places: usize) {
        self.look_at(Pane::ALL[(self.focus.page() - 1 + places) % Pane::ALL.len()]);
    }

    /// Focuses a pane and makes it visible.
    pub(super) fn look_at(&mut self, pane: Pane) {
        self.focus = pane;
        if pane != Nodes {
            self.page = pane;
        }
        if pane.takes_turns() {
            self.chart = pane;
        }
    }

    /// Zooms a pane, or ends the zoom.
    pub(super) fn zoom(&mut self, pane: Pane) {
        self.zoomed = !(self.zoomed && self.focus == pane);
        self.look_at(pane);
    }
}

/// What determines the layout.
#[derive(Debug, Clone, Copy)]
pub struct Choice {
    /// The user's choice.
    pub panes: ShownPanes,
    /// Number of slave nodes that the table shows.
    pub slaves: usize,
    /// Number of all slave nodes, which the timeline shows.
    pub all: usize,
    /// Whether the scene has a shape to draw; otherwise the timeline replaces it.
    pub has_shape: bool,
    /// Rows that the lesson needs at the screen's width; 0 without a lesson.
    pub lesson: u16,
}

/// The areas of a screen.
#[derive(Debug, Clone, PartialEq)]
pub struct ScreenAreas {
    /// The lines at the top.
    pub status: Rect,
    /// The visible panes and their areas.
    pub panes: Vec<(Pane, Rect)>,
    /// The message and prompt line.
    pub message: Rect,
    /// The key hints.
    pub footer: Rect,
    /// Whether some panes are not visible, so that Tab turns pages.
    pub paged: bool,
}

/// Rows of the table besides nodes: two for the border, one for the headings.
const TABLE_FRAME: u16 = 3;
/// Height of a decision that shows only the row of Table 2 that applies, of a complete one with a line per inequality, and of one
/// with rules between the rows.
const SHORT_DECISION: u16 = 8;
const DECISION: u16 = 12;
const TALL_DECISION: u16 = 17;
/// Minimum height of another pane below the table on a small screen, and of a chart below the decision.
const PAGE_BELOW: u16 = 11;
const CHART: u16 = 7;
/// Width of a lesson in a separate column, on a large and on a medium screen.
const LESSON: u16 = 62;
const NARROW_LESSON: u16 = 44;
/// Width of a decision with explanations, and minimum width for the contact next to it.
const EXPLAINED: u16 = 116;
const BOTH: u16 = 160;
/// Width at which most outcomes fit into one line.
const WIDE: u16 = 110;
/// Minimum height for outcomes of two lines.
const ROOMY: u16 = 30;
/// Minimum height of a lesson, with border.
const LEAST_LESSON: u16 = 4;
/// Minimum height of a page between the table and a lesson.
const PAGE: u16 = 5;
/// Rows of the timeline besides nodes, with border, and the maximum number of nodes that it shows on a large screen.
const TIMELINE_FRAME: u16 = 7;
const LONGEST_TIMELINE: usize = 6;
/// Minimum height of a large screen's body for a separate timeline.
const ROOM_FOR_TIMELINE: u16 = 50;

/// Computes the layout.
pub fn places(area: Rect, choice: &Choice) -> ScreenAreas {
    let status = match area.height {
        0..=5 => 1.min(area.height),
        6..=15 => 2,
        16..=23 => 3,
        // Most outcomes need two lines on a narrow screen, which a high screen has room for.
        _ if area.width < WIDE || area.height >= ROOMY => 4,
        _ => 3,
    };
    let footer = u16::from(area.height > 6);
    let message = u16::from(area.height > 2);
    let rows = [
        status,
        area.height - status - footer - message,
        message,
        footer,
    ]
    .map(Constraint::Length);
    let [status, body, message, footer] = Layout::vertical(rows).areas(area);
    let panes = match () {
        _ if choice.panes.zoomed && choice.lesson == 0 => zoomed(body, choice),
        _ if choice.panes.zoomed => zoomed_with_lesson(body, choice),
        _ if choice.lesson > 0 => with_lesson(body, choice),
        _ if !choice.has_shape && area.width >= 110 && body.height >= 30 => shapeless(body, choice),
        _ if area.width >= 160 && body.height >= 40 => large(body, choice),
        _ if area.width >= 110 && body.height >= 30 => medium(body, choice),
        _ => small(body, choice),
    };
    let listed = panes.iter().filter(|(pane, _)| *pane != Lesson).count();
    let paged = listed < 4 && !choice.panes.zoomed;
    ScreenAreas {
        status,
        panes,
        message,
        footer,
        paged,
    }
}

/// Rows for the table: enough for all nodes, but at most `most`.
fn table(choice: &Choice, most: u16) -> u16 {
    (choice.slaves.min(usize::from(u16::MAX - TABLE_FRAME)) as u16)
        .max(1)
        .saturating_add(TABLE_FRAME)
        .min(most)
}

/// The upper rows of an area, and the others.
pub(crate) fn top(area: Rect, rows: u16) -> [Rect; 2] {
    Layout::vertical([Constraint::Length(rows), Constraint::Min(0)]).areas(area)
}

/// The left columns of an area, and the others.
fn left(area: Rect, columns: u16) -> [Rect; 2] {
    Layout::horizontal([Constraint::Length(columns), Constraint::Min(0)]).areas(area)
}

fn small(body: Rect, choice: &Choice) -> Vec<(Pane, Rect)> {
    if body.height < DECISION + TABLE_FRAME + 1 || body.width < 40 {
        return vec![(choice.panes.focus, body)];
    }
    let least = choice.panes.page.least();
    let [upper, lower] = top(body, table(choice, body.height - least));
    vec![(Nodes, upper), (choice.panes.page, lower)]
}

/// The layout with a lesson: a separate column on a large screen, the place of the chart on a medium one, the rows at the bottom on
/// a small one, and the place of the table on a tiny one.
fn with_lesson(body: Rect, choice: &Choice) -> Vec<(Pane, Rect)> {
    if body.width >= 110 + LESSON && body.height >= 30 {
        let [left, right] = left(body, body.width - LESSON);
        let mut panes = medium(left, choice);
        panes.push((Lesson, right));
        return panes;
    }
    if body.width >= 110 && body.height >= 30 {
        let [left, right] = left(body, body.width - NARROW_LESSON);
        let most = left.height - SHORT_DECISION - PAGE_BELOW;
        let [nodes, below] = top(left, table(choice, most));
        let decision = (below.height / 2).clamp(SHORT_DECISION, DECISION + 1);
        let [decision, shape] = top(below, decision);
        // A chart with the focus replaces the shape.
        let other = if choice.panes.focus == choice.panes.chart {
            choice.panes.chart
        } else {
            Shape
        };
        return vec![
            (Nodes, nodes),
            (Decision, decision),
            (other, shape),
            (Lesson, right),
        ];
    }
    let least = table(choice, TABLE_FRAME + 1);
    if body.height < least + PAGE {
        let pane = match choice.panes.focus {
            Nodes => Lesson,
            other => other,
        };
        return vec![(pane, body)];
    }
    let lesson = choice.lesson.min(body.height - least);
    let [upper, lower] = top(body, body.height - lesson);
    let nodes = table(choice, upper.height);
    let mut panes = match upper.height.saturating_sub(nodes) {
        PAGE.. => {
            let [nodes, page] = top(upper, nodes);
            vec![(Nodes, nodes), (choice.panes.page, page)]
        }
        _ => vec![(choice.panes.focus, upper)],
    };
    panes.push((Lesson, lower));
    panes
}

/// The focused pane alone; on a wide screen, the contact is next to the decision that it explains.
fn zoomed(body: Rect, choice: &Choice) -> Vec<(Pane, Rect)> {
    if choice.panes.focus != Decision || body.width < BOTH || !choice.has_shape {
        return vec![(choice.panes.focus, body)];
    }
    let [left, right] = left(body, EXPLAINED.max(body.width * 3 / 5));
    vec![(Decision, left), (Contact, right)]
}

/// The focused pane with the lesson next to it or below it, since the lesson says what to do there.
fn zoomed_with_lesson(body: Rect, choice: &Choice) -> Vec<(Pane, Rect)> {
    if body.width >= 110 {
        let lesson = if body.width >= 110 + LESSON {
            LESSON
        } else {
            NARROW_LESSON
        };
        let [left, right] = left(body, body.width - lesson);
        return vec![(choice.panes.focus, left), (Lesson, right)];
    }
    if body.height < LEAST_LESSON + PAGE {
        return vec![(choice.panes.focus, body)];
    }
    let lesson = choice.lesson.min(body.height / 2).max(LEAST_LESSON);
    let [upper, lower] = top(body, body.height - lesson);
    vec![(choice.panes.focus, upper), (Lesson, lower)]
}

/// The table above the timeline, then the decision next to the chart.
fn shapeless(body: Rect, choice: &Choice) -> Vec<(Pane, Rect)> {
    let nodes = table(choice, body.height / 3);
    let timeline = table(choice, body.height - nodes - DECISION) + TIMELINE_FRAME - TABLE_FRAME;
    let rows = [
        Constraint::Length(nodes),
        Constraint::Length(timeline),
        Constraint::Min(0),
    ];
    let [nodes, timeline, lower] = Layout::vertical(rows).areas(body);
    let columns = [2, 3].map(Constraint::Fill);
    let [decision, chart] = Layout::horizontal(columns).areas(lower);
    let other = match choice.panes.chart {
        Timeline => Residual,
        chart => chart,
    };
    vec![
        (Nodes, nodes),
        (Timeline, timeline),
        (Decision, decision),
        (other, chart),
    ]
}

fn medium(body: Rect, choice: &Choice) -> Vec<(Pane, Rect)> {
    let most = body.height - SHORT_DECISION - CHART;
    let [upper, lower] = top(body, table(choice, most));
    let [left, right] = left(lower, (body.width / 2).clamp(66, 76));
    let [decision, residual] = top(left, decision_rows(lower.height));
    vec![
        (Nodes, upper),
        (Decision, decision),
        (choice.panes.chart, residual),
        (Shape, right),
    ]
}

/// Rows of the decision above a chart.
fn decision_rows(both: u16) -> u16 {
    both.saturating_sub(CHART).min(TALL_DECISION)
}

fn large(body: Rect, choice: &Choice) -> Vec<(Pane, Rect)> {
    let timeline = match body.height {
        0..ROOM_FOR_TIMELINE => 0,
        _ => (choice.all.min(LONGEST_TIMELINE) as u16).max(1) + TIMELINE_FRAME,
    };
    let [body, timeline] = top(body, body.height - timeline);
    let [left, right] = left(body, (body.width * 11 / 20).clamp(104, 130));
    let table = table(choice, left.height - SHORT_DECISION - CHART);
    let rows = [
        Constraint::Length(table),
        Constraint::Length(decision_rows(left.height - table)),
        Constraint::Min(0),
    ];
    let [nodes, decision, residual] = Layout::vertical(rows).areas(left);
    let rows = [Constraint::Fill(3), Constraint::Fill(2)];
    let [shape, curve] = Layout::vertical(rows).areas(right);
    let third = match choice.panes.chart {
        Curve => Residual,
        Timeline if timeline.height > 0 => Residual,
        chart => chart,
    };
    let mut panes = vec![
        (Nodes, nodes),
        (Decision, decision),
        (third, residual),
        (Shape, shape),
        (Curve, curve),
    ];
    if timeline.height > 0 {
        panes.push((Timeline, timeline));
    }
    panes
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(width: u16, height: u16, slaves: usize) -> ScreenAreas {
        let choice = Choice {
            panes: ShownPanes::default(),
            slaves,
            all: slaves,
            has_shape: true,
            lesson: 0,
        };
        places(Rect::new(0, 0, width, height), &choice)
    }

    #[test]
    fn medium_and_large_screens_show_all_panes() {
        for (width, height) in [(120, 40), (200, 60), (110, 36), (160, 46)] {
            for slaves in [0, 1, 9, 1000] {
                let places = at(width, height, slaves);
                let panes = match (width, height) {
                    (0..160, _) => 4,
                    (_, 0..55) => 5,
                    _ => 6,
                };
                assert_eq!(places.panes.len(), panes);
                assert!(!places.paged);
                assert!(
                    places
                        .panes
                        .iter()
                        .all(|(_, area)| area.height >= 4 && area.width >= 40)
                );
            }
        }
    }

    #[test]
    fn the_small_screen_has_the_table_and_a_page() {
        let places = at(80, 24, 500);
        assert_eq!(
            places.panes.iter().map(|p| p.0).collect::<Vec<_>>(),
            [Pane::Nodes, Pane::Decision]
        );
        assert_eq!(places.panes[1].1.height, SHORT_DECISION);
        assert!(places.paged);
    }

    #[test]
    fn the_table_gets_the_rows_that_it_needs_first() {
        for (width, height, slaves, rows) in [
            (120, 36, 20, 12),
            (120, 36, 8, 8),
            (80, 24, 73, 7),
            (200, 60, 20, 20),
        ] {
            let table = at(width, height, slaves).panes[0].1.height - TABLE_FRAME;
            assert_eq!(table, rows, "{width}x{height}, {slaves} nodes");
        }
    }

    #[test]
    fn panes_neither_overlap_nor_leave_the_screen() {
        for (width, height) in [(1, 1), (3, 2), (40, 10), (80, 24), (120, 40), (250, 80)] {
            let places = at(width, height, 7);
            let whole = Rect::new(0, 0, width, height);
            let mut areas: Vec<Rect> = places.panes.iter().map(|p| p.1).collect();
            areas.extend([places.status, places.message, places.footer]);
            for (index, area) in areas.iter().enumerate() {
                assert_eq!(whole.intersection(*area).area(), area.area());
                assert!(
                    areas[..index]
                        .iter()
                        .all(|other| !other.intersects(*area) || area.area() == 0)
                );
            }
        }
    }
}
