//! Where everything stands on the screen.
//!
//! Three arrangements. Small (80x24): the table, and under it one more pane, which Tab changes. Medium (120x40):
//! the table across, the decision over one more pane (whichever Tab or its key came to last) on the left, the shape
//! on the right. Large (200x60): two columns over the timeline. Whatever the size, the status is on top and message and footer
//! are at the bottom; below 80x24 there is one pane at a time. What is said has no part in it, so that no row jumps while one
//! steps: a long outcome or message is written over the panes' edges.

use ratatui::layout::{Constraint, Layout, Rect};

/// A part of the screen that can have the focus.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Pane {
    /// The table of slave nodes.
    Nodes,
    /// The decision on the selected node.
    Decision,
    /// The residual over the major iterations.
    Residual,
    /// The bodies and surfaces.
    Shape,
    /// The load factor over a monitor.
    Curve,
    /// Slave nodes by minor iterations.
    Timeline,
    /// Why the minor iterations cycle, and what gets out.
    Diagnosis,
    /// The branches of the history.
    Branches,
    /// What was tried, and what it costs.
    Remedies,
    /// Never has the focus, and is only there while a lesson is taken.
    Lesson,
}

impl Pane {
    /// All that Tab goes through, in its order.
    pub const ALL: [Pane; 9] = [
        Pane::Nodes,
        Pane::Decision,
        Pane::Residual,
        Pane::Shape,
        Pane::Curve,
        Pane::Timeline,
        Pane::Diagnosis,
        Pane::Branches,
        Pane::Remedies,
    ];

    /// Whether it takes turns with others where there is room for one of them.
    pub fn takes_turns(self) -> bool {
        !matches!(self, Pane::Nodes | Pane::Decision | Pane::Shape)
    }

    /// The pane so many places further on.
    pub fn turn(self, places: usize) -> Pane {
        Pane::ALL[(self as usize + places) % Pane::ALL.len()]
    }
}

/// What of the user's choices decides the arrangement.
#[derive(Debug, Clone, Copy)]
pub struct Choice {
    /// The pane with the focus.
    pub focus: Pane,
    /// The pane under the table on a small screen.
    pub page: Pane,
    /// Which of the panes that take turns is shown, where there is room for one.
    pub chart: Pane,
    /// Whether the pane with the focus has the screen for itself.
    pub zoomed: bool,
    /// Number of slave nodes, hence of the table's rows.
    pub slaves: usize,
    /// Whether the scene has a shape to draw; else the timeline takes its place.
    pub has_shape: bool,
    /// Rows that a lesson wants at the screen's width; 0 without a lesson.
    pub lesson: u16,
}

/// Where everything stands.
#[derive(Debug, Clone, PartialEq)]
pub struct Places {
    /// The line at the top.
    pub status: Rect,
    /// The panes that are shown, and where.
    pub panes: Vec<(Pane, Rect)>,
    /// The line for messages and prompts.
    pub message: Rect,
    /// The keys at the bottom.
    pub footer: Rect,
    /// Whether not all panes are on the screen, so that Tab turns pages.
    pub paged: bool,
}

/// Rows of the table that are no nodes: two of border, one of headings.
const TABLE_FRAME: u16 = 3;
/// Fewest rows in which the decision shows everything, border included, and its numbers on lines of their own.
const DECISION: u16 = 12;
const TALL_DECISION: u16 = 17;
/// Width of a lesson that has a column of its own.
const LESSON: u16 = 62;
/// Width from which on most outcomes fit into a line.
const WIDE: u16 = 110;
/// Height from which on there is room for an outcome of two lines.
const ROOMY: u16 = 30;
/// Fewest rows of a lesson, border included.
const LEAST_LESSON: u16 = 4;
/// Fewest rows of a page between the table and a lesson.
const PAGE: u16 = 5;
/// Rows of the timeline that are no nodes, border included, and most nodes that it shows on a large screen.
const TIMELINE_FRAME: u16 = 7;
const LONGEST_TIMELINE: usize = 6;
/// Rows of a large screen's body from which on the timeline has a place of its own.
const ROOM_FOR_TIMELINE: u16 = 50;

/// Arranges the screen.
pub fn places(area: Rect, choice: &Choice) -> Places {
    let status = match area.height {
        0..=5 => 1.min(area.height),
        6..=15 => 2,
        16..=23 => 3,
        // A narrow screen needs two lines for most outcomes, and a high one has them.
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
        _ if choice.zoomed && choice.lesson == 0 => vec![(choice.focus, body)],
        _ if choice.zoomed => zoomed_with_lesson(body, choice),
        _ if choice.lesson > 0 => with_lesson(body, choice),
        _ if !choice.has_shape && area.width >= 110 && body.height >= 30 => shapeless(body, choice),
        _ if area.width >= 160 && body.height >= 40 => large(body, choice),
        _ if area.width >= 110 && body.height >= 30 => medium(body, choice),
        _ => small(body, choice),
    };
    let listed = panes
        .iter()
        .filter(|(pane, _)| *pane != Pane::Lesson)
        .count();
    let paged = listed < 4 && !choice.zoomed;
    Places {
        status,
        panes,
        message,
        footer,
        paged,
    }
}

/// Rows for the table: as many as it has nodes, but no more than given.
fn table(choice: &Choice, most: u16) -> u16 {
    (choice.slaves.min(usize::from(u16::MAX - TABLE_FRAME)) as u16)
        .max(1)
        .saturating_add(TABLE_FRAME)
        .min(most)
}

fn small(body: Rect, choice: &Choice) -> Vec<(Pane, Rect)> {
    if body.height < DECISION + TABLE_FRAME + 1 || body.width < 40 {
        return vec![(choice.focus, body)];
    }
    let rows = [table(choice, body.height - DECISION), 0];
    let [upper, lower] =
        Layout::vertical([Constraint::Length(rows[0]), Constraint::Min(rows[1])]).areas(body);
    vec![(Pane::Nodes, upper), (choice.page, lower)]
}

/// The screen with a lesson: on a large one it has a column of its own, on a medium one the place of the chart, on a small
/// one as many rows as it needs at the bottom, and on a tiny one the place of the table.
fn with_lesson(body: Rect, choice: &Choice) -> Vec<(Pane, Rect)> {
    if body.width >= 110 + LESSON && body.height >= 30 {
        let columns = [Constraint::Min(0), Constraint::Length(LESSON)];
        let [left, right] = Layout::horizontal(columns).areas(body);
        let mut panes = medium(left, choice);
        panes.push((Pane::Lesson, right));
        return panes;
    }
    if body.width >= 110 && body.height >= 30 {
        let mut panes = medium(body, choice);
        let chart = panes.remove(2);
        panes.push((Pane::Lesson, chart.1));
        // A chart that is wanted takes the place of the shape.
        if choice.focus == choice.chart {
            panes[2].0 = choice.chart;
        }
        return panes;
    }
    let least = table(choice, TABLE_FRAME + 1);
    if body.height < least + PAGE {
        let pane = match choice.focus {
            Pane::Nodes => Pane::Lesson,
            other => other,
        };
        return vec![(pane, body)];
    }
    let lesson = choice.lesson.min(body.height - least);
    let rows = [Constraint::Min(0), Constraint::Length(lesson)];
    let [upper, lower] = Layout::vertical(rows).areas(body);
    let nodes = table(choice, upper.height);
    let mut panes = match upper.height.saturating_sub(nodes) {
        PAGE.. => {
            let rows = [Constraint::Length(nodes), Constraint::Min(0)];
            let [nodes, page] = Layout::vertical(rows).areas(upper);
            vec![(Pane::Nodes, nodes), (choice.page, page)]
        }
        _ if choice.focus == Pane::Nodes => vec![(Pane::Nodes, upper)],
        _ => vec![(choice.focus, upper)],
    };
    panes.push((Pane::Lesson, lower));
    panes
}

/// The pane with the focus, and the lesson beside it or under it, since it says what to do there.
fn zoomed_with_lesson(body: Rect, choice: &Choice) -> Vec<(Pane, Rect)> {
    if body.width >= 110 + LESSON {
        let columns = [Constraint::Min(0), Constraint::Length(LESSON)];
        let [left, right] = Layout::horizontal(columns).areas(body);
        return vec![(choice.focus, left), (Pane::Lesson, right)];
    }
    if body.height < LEAST_LESSON + PAGE {
        return vec![(choice.focus, body)];
    }
    let lesson = choice.lesson.min(body.height / 2).max(LEAST_LESSON);
    let rows = [Constraint::Min(0), Constraint::Length(lesson)];
    let [upper, lower] = Layout::vertical(rows).areas(body);
    vec![(choice.focus, upper), (Pane::Lesson, lower)]
}

/// Table over timeline, and decision and chart next to each other below.
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
    let other = match choice.chart {
        Pane::Timeline => Pane::Residual,
        chart => chart,
    };
    vec![
        (Pane::Nodes, nodes),
        (Pane::Timeline, timeline),
        (Pane::Decision, decision),
        (other, chart),
    ]
}

fn medium(body: Rect, choice: &Choice) -> Vec<(Pane, Rect)> {
    let most = body.height - TALL_DECISION - 7;
    let rows = [Constraint::Length(table(choice, most)), Constraint::Min(0)];
    let [upper, lower] = Layout::vertical(rows).areas(body);
    let columns = [
        Constraint::Length((body.width / 2).clamp(66, 76)),
        Constraint::Min(0),
    ];
    let [left, right] = Layout::horizontal(columns).areas(lower);
    let rows = [Constraint::Length(TALL_DECISION), Constraint::Min(0)];
    let [decision, residual] = Layout::vertical(rows).areas(left);
    vec![
        (Pane::Nodes, upper),
        (Pane::Decision, decision),
        (choice.chart, residual),
        (Pane::Shape, right),
    ]
}

fn large(body: Rect, choice: &Choice) -> Vec<(Pane, Rect)> {
    let timeline = match body.height {
        0..ROOM_FOR_TIMELINE => 0,
        _ => (choice.slaves.min(LONGEST_TIMELINE) as u16).max(1) + TIMELINE_FRAME,
    };
    let rows = [Constraint::Min(0), Constraint::Length(timeline)];
    let [body, timeline] = Layout::vertical(rows).areas(body);
    let columns = [
        Constraint::Length((body.width * 11 / 20).clamp(104, 130)),
        Constraint::Min(0),
    ];
    let [left, right] = Layout::horizontal(columns).areas(body);
    let most = left.height - TALL_DECISION - 7;
    let rows = [
        Constraint::Length(table(choice, most)),
        Constraint::Length(TALL_DECISION),
        Constraint::Min(0),
    ];
    let [nodes, decision, residual] = Layout::vertical(rows).areas(left);
    let rows = [Constraint::Fill(3), Constraint::Fill(2)];
    let [shape, curve] = Layout::vertical(rows).areas(right);
    let third = match choice.chart {
        Pane::Curve => Pane::Residual,
        Pane::Timeline if timeline.height > 0 => Pane::Residual,
        chart => chart,
    };
    let mut panes = vec![
        (Pane::Nodes, nodes),
        (Pane::Decision, decision),
        (third, residual),
        (Pane::Shape, shape),
        (Pane::Curve, curve),
    ];
    if timeline.height > 0 {
        panes.push((Pane::Timeline, timeline));
    }
    panes
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(width: u16, height: u16, slaves: usize) -> Places {
        let choice = Choice {
            focus: Pane::Nodes,
            page: Pane::Decision,
            chart: Pane::Residual,
            zoomed: false,
            slaves,
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
        assert_eq!(places.panes[1].1.height, DECISION);
        assert!(places.paged);
    }

    #[test]
    fn nothing_overlaps_and_nothing_leaves_the_screen() {
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
