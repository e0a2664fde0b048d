//! The branch tree, with the outcome and cost of each branch, and a comparison of the selected branch with the current one.

use crate::app::App;
use crate::columns::rows_shown;
use crate::copied::NamedText;
use crate::layout::Pane;
use crate::paint;
use crate::pane_entry::{PaneEntry, frame};
use crate::view::View;
use ratatui::buffer::Buffer;
use ratatui::layout::{Margin, Position, Rect};
use ratatui::style::Style;
use ratatui::text::{Line, Span};
use std::ops::Range;
use stickslip_debugger::Tree;
use stickslip_debugger::action;
use stickslip_debugger::history::compare::{self, Side};
use stickslip_debugger::history::verdicts::{BranchEnd, Summary};
use stickslip_debugger::history::{branches, verdicts};
use stickslip_scene::number;
use stickslip_scene::shown;
use unicode_width::UnicodeWidthStr;

/// Width of one column of the comparison, and of its names; a narrow pane has narrower columns.
const SIDE: usize = 32;
const NAME: usize = 12;
/// Width of a mode in it, and least width of a number.
const MODE: usize = 4;
const NUMBER: usize = 8;

/// The pane.
pub const PANE: PaneEntry = PaneEntry {
    draw,
    actions: &[("repeat", "go there"), ("compare", "compare")],
    copied,
    is_ahead: true,
};

/// The command that goes to the selected branch.
fn copied(app: &App, view: &View) -> Result<NamedText, String> {
    let all = view.tree.map(verdicts::summaries).unwrap_or_default();
    let order = verdicts::order(&all);
    let row = order.get(app.branch).or(order.first());
    let (number, _) = row.ok_or("no branch to copy")?;
    Ok(("a command".into(), format!("branch b{}", number + 1)))
}

/// Draws the tree and the comparison.
fn draw(buffer: &mut Buffer, area: Rect, app: &App, view: &View) {
    let theme = &app.theme;
    let Some(tree) = view.tree else {
        frame(buffer, area, Pane::Branches, "Branches", app);
        return;
    };
    let all = verdicts::summaries(tree);
    let at = app.branch.min(all.len().saturating_sub(1));
    let title = format!("Branches  {}/{}", at + 1, all.len());
    let inner = frame(buffer, area, Pane::Branches, &title, app);
    let order = verdicts::order(&all);
    let width = usize::from(inner.width);
    let (shown, compared) = shown(inner, tree, &all, (app, view));
    let texts: Vec<RowTexts> = order
        .iter()
        .map(|&(number, depth)| RowTexts::new(tree, &all[number], depth, view))
        .collect();
    let widest = |width: fn(&RowTexts) -> usize| texts.iter().map(width).max().unwrap_or(0);
    // Columns of all rows, also of those that are scrolled out.
    let room = width.saturating_sub(widest(|texts| texts.cost.width()) + 7);
    let most = room.saturating_sub(widest(|texts| texts.verdict.width()));
    let names = widest(|texts| texts.name.width()).min(most.max(room * 3 / 5));
    let mut lines: Vec<Line> = shown
        .map(|row| {
            let branch = &all[order[row].0];
            let columns = [names, room - names];
            line(branch, &texts[row], row == at, columns, app)
        })
        .collect();
    if all.len() == 1 && !view.is_finished() {
        let text = "An intervention in an earlier state starts a new branch; nothing is lost.";
        lines.extend(paint::wrapped(text, width, theme.faint));
    }
    lines.extend(compared);
    paint::lines(buffer, inner, &lines);
}

/// The visible rows of the tree in the area inside the frame, and the comparison below them.
fn shown(
    inner: Rect,
    tree: &Tree,
    all: &[Summary],
    (app, view): (&App, &View),
) -> (Range<usize>, paint::Lines) {
    let order = verdicts::order(all);
    let at = app.branch.min(all.len().saturating_sub(1));
    let selected = order.get(at).map_or(0, |o| o.0);
    let compared = comparison(tree, all, selected, inner.width.into(), (app, view));
    let room = usize::from(inner.height).saturating_sub(compared.len());
    (rows_shown(room.max(3), at, order.len()), compared)
}

/// The row of the tree at a screen position.
pub fn row_at(area: Rect, app: &App, view: &View, at: Position) -> Option<usize> {
    let tree = view.tree?;
    let inner = area.inner(Margin::new(1, 1));
    let (shown, _) = shown(inner, tree, &verdicts::summaries(tree), (app, view));
    let row = usize::from(at.y).checked_sub(inner.y.into())?;
    let rows = shown.len().min(inner.height.into());
    (row < rows).then_some(shown.start + row)
}

/// The texts of a row that set the widths of the columns.
struct RowTexts {
    /// The name, behind its place in the tree.
    name: String,
    verdict: String,
    cost: String,
}

impl RowTexts {
    fn new(tree: &Tree, branch: &Summary, depth: usize, view: &View) -> RowTexts {
        let twig = match depth {
            0 => String::new(),
            depth => format!("{}└ ", "  ".repeat(depth - 1)),
        };
        let load = number::shortest(branch.load_factor);
        let (minors, majors) = (branch.whole.minors, branch.whole.majors);
        RowTexts {
            name: format!("{twig}{}", branch.name),
            verdict: verdicts::describe(tree, &branch.verdict),
            cost: match view.model.finished {
                None => format!("  load {load}  {minors} minor, {majors} major"),
                Some(_) => format!("  time {load}  {minors} iterations"),
            },
        }
    }
}

fn line<'a>(
    branch: &Summary,
    texts: &RowTexts,
    selected: bool,
    [names, room]: [usize; 2],
    app: &App,
) -> Line<'a> {
    let theme = &app.theme;
    let current = if branch.is_current { "●" } else { " " };
    let (glyph, style) = glyph(&branch.verdict, app);
    let name_style = if selected { theme.selected } else { theme.text };
    let [name, pad] = paint::cell(&texts.name, names, name_style);
    let [verdict, verdict_pad] = paint::cell(&texts.verdict, room, style);
    Line::from(vec![
        paint::cursor(selected, theme),
        Span::styled(current, theme.strong),
        Span::raw(" "),
        name,
        pad,
        Span::raw(" "),
        Span::styled(format!("{glyph} "), style),
        verdict,
        verdict_pad,
        Span::styled(texts.cost.clone(), theme.faint),
    ])
}

fn glyph(verdict: &BranchEnd, app: &App) -> (&'static str, Style) {
    let theme = &app.theme;
    match verdict {
        BranchEnd::Unfinished => ("▸", theme.text),
        BranchEnd::Accepted | BranchEnd::Same { .. } => ("✓", theme.good),
        BranchEnd::Marked => ("!", theme.warning),
        BranchEnd::Other { .. } => ("≠", theme.warning),
        BranchEnd::Cycle | BranchEnd::SameCycle { .. } => ("↺", theme.bad),
        BranchEnd::Diverged | BranchEnd::Failed => ("✗", theme.bad),
    }
}

/// Compares the selected branch with the current one.
fn comparison(
    tree: &Tree,
    all: &[Summary],
    selected: usize,
    width: usize,
    (app, view): (&App, &View),
) -> paint::Lines {
    let least = MODE + 2 * NUMBER;
    let wide = (width.saturating_sub(NAME + 2) / 2).clamp(least, SIDE);
    let number = (wide - MODE) / 2;
    let theme = &app.theme;
    let current = tree.current();
    if all.len() < 2 {
        return Vec::new();
    }
    if selected == current {
        let text = "Select another branch to compare it with this one; Enter goes to it.";
        let mut lines = vec![Line::default()];
        lines.extend(paint::wrapped(text, width, theme.faint));
        return lines;
    }
    let Some(found) = compare::compare(tree, selected, current) else {
        return Vec::new();
    };
    let sides = found.common.as_ref().unwrap_or(&found.tips);
    let verdict = compare::verdict(tree, &found);
    let head = |side: &Side| {
        let name = paint::cut(&branches::name(tree, side.branch), wide - 2);
        Span::styled(format!("{name:<wide$}"), theme.heading)
    };
    let mut lines = vec![
        Line::default(),
        Line::styled(format!(" Compared: {verdict}"), theme.strong),
        Line::from(vec![
            Span::raw(" ".repeat(NAME + 2)),
            head(&sides[0]),
            head(&sides[1]),
        ]),
    ];
    let row = |name: &str, style: Style, cells: [String; 2]| {
        let name = format!(" {} ", shown::padded(&paint::cut(name, NAME), NAME));
        let [a, b] = cells.map(|cell| Span::raw(format!("{cell:<wide$}")));
        Line::from(vec![Span::styled(name, style), a, b])
    };
    let of = |value: &dyn Fn(&Side) -> String| [value(&sides[0]), value(&sides[1])];
    lines.push(row(
        "cost",
        theme.faint,
        of(&|side| {
            let cost = format!("{} minor, {} major", side.cost.minors, side.cost.majors);
            let time = format!(", {:.1} ms", side.cost.seconds * 1e3);
            if cost.len() + time.len() < wide {
                cost + &time
            } else {
                cost
            }
        }),
    ));
    lines.push(row(
        "residual",
        theme.faint,
        of(&|side| number::sig2(side.residual)),
    ));
    let heads = format!("{:<MODE$} {:<rest$} F_t", "m→n", "F_n", rest = number - 1);
    lines.push(row("node", theme.faint, [heads.clone(), heads]));
    let round_off = view.round_off();
    for slave in 0..view.model.contacts.len() {
        let [a, b] = [&sides[0].nodes[slave], &sides[1].nodes[slave]];
        let style = if a.next == b.next {
            theme.text
        } else {
            theme.strong
        };
        let cell = |node: &compare::NodeSide| {
            let numbers = match node.forces {
                Some(forces) => forces
                    .map(|force| number::fixed_width(round_off.force(force), number))
                    .concat(),
                None => String::new(),
            };
            let modes = format!(
                "{}→{}",
                action::letter(node.mode),
                action::letter(node.next)
            );
            format!("{modes:<MODE$}{numbers}")
        };
        let name = format!(
            "{}{}",
            if a.next == b.next { "" } else { "*" },
            view.slave(slave)
        );
        lines.push(row(&name, style, [cell(a), cell(b)]));
    }
    lines
}
