//! The work-precision page: error over cost on log scales, from a chart that was just measured or a table (`stickslip chart
//! --csv`).
//!
//! Each run is drawn as its series' letter, a capital if it is on the Pareto front; failed runs are ✗ in a row at the top. Details
//! of the selected run are shown below the plot.

use crate::canvas::Canvas;
use crate::chartframe::ChartFrame;
use crate::chartpage::ChartPage;
use crate::paint;
use crate::theme::Theme;
use ratatui::buffer::Buffer;
use ratatui::layout::Rect;
use ratatui::style::Style;
use ratatui::text::{Line, Span};
use stickslip_core::counted;
use stickslip_scene::{joined, number};
use stickslip_study::log_axis::{LogAxis, written};
use stickslip_study::precision::{Point, Precision, ROUND_OFF};

/// Columns left of the plot, for the axis labels.
const LEFT: u16 = 8;
/// Rows below the plot: numbers, axis, selected run (two), and the source, or without a column for them the series in two rows.
const BELOW: u16 = 5;
const BELOW_NARROW: u16 = 6;
/// Columns for the list of series, if there is room.
const LEGEND: u16 = 36;

/// A series' letter; after z the letters repeat.
fn letter(series: usize, front: bool) -> char {
    let letter = char::from(b'a' + (series % 26) as u8);
    if front {
        letter.to_ascii_uppercase()
    } else {
        letter
    }
}

/// Draws the page.
pub fn draw(buffer: &mut Buffer, area: Rect, page: &ChartPage, theme: &Theme) {
    let chart = page.shown();
    let number = match page.charts.len() {
        1 => String::new(),
        all => format!("  {}/{all}", page.chart + 1),
    };
    let title = format!("Work and precision  {}{number}", chart.title);
    let inner = paint::frame(buffer, area, &title, true, theme);
    if inner.height < BELOW_NARROW + 4 || inner.width < LEFT + 12 {
        paint::note(buffer, inner, "no room", theme);
        return;
    }
    let legend = if inner.width >= LEFT + 40 + LEGEND {
        LEGEND
    } else {
        0
    };
    let below = if legend > 0 { BELOW } else { BELOW_NARROW };
    let plot = Rect {
        x: inner.x + LEFT,
        y: inner.y + 1,
        width: inner.width - LEFT - legend - 1,
        height: inner.height - 1 - below,
    };
    plot_runs(buffer, plot, page, theme);
    if legend > 0 {
        let area = Rect {
            x: plot.right() + 1,
            width: legend,
            ..plot
        };
        paint::lines(buffer, area, &series(chart, theme, usize::from(legend)));
    }
    let below = Rect {
        y: plot.bottom() + 1,
        height: below - 1,
        ..inner
    };
    paint::lines(
        buffer,
        below,
        &details(page, theme, usize::from(inner.width), legend > 0),
    );
}

fn plot_runs(buffer: &mut Buffer, plot: Rect, page: &ChartPage, theme: &Theme) {
    let chart = page.shown();
    let cost = |p: &Point| page.cost.of(p);
    let x = LogAxis::new(chart.points.iter().map(cost));
    let y = LogAxis::new(
        chart
            .points
            .iter()
            .filter_map(|p| Some(page.error(p)?.max(ROUND_OFF))),
    );
    let column = |value: f64| plot.x + (x.part(value) * f64::from(plot.width - 1)).round() as u16;
    let row = |error: f64| {
        let part = 1.0 - y.part(error.max(ROUND_OFF));
        plot.y + (part * f64::from(plot.height - 1)).round() as u16
    };
    let frame = ChartFrame::around(plot, LEFT);
    for value in y.ticks(usize::from(plot.height).div_ceil(2)) {
        let words = written(value);
        frame.tick(buffer, row(value) - plot.y, &words, theme.faint);
    }
    let mut free = 0;
    for value in x.ticks(usize::from(plot.width) / 9) {
        let (at, words) = (column(value), written(value));
        let left = at
            .saturating_sub(words.len() as u16 / 2)
            .min(plot.right().saturating_sub(words.len() as u16));
        if left >= free {
            frame.below(buffer, left, &words, theme.faint);
            free = left + words.len() as u16 + 1;
        }
    }
    // Series are connected, and the front is drawn in bold.
    let dot = |x: u16, y: u16| {
        [
            2.0 * f64::from(x - plot.x) + 0.5,
            4.0 * f64::from(y - plot.y) + 2.0,
        ]
    };
    let mut canvas = Canvas::new(plot);
    let solved = |wanted: &dyn Fn(&Point) -> bool| {
        let points = chart.points.iter().filter(|point| wanted(point));
        let mut at: Vec<(f64, [f64; 2])> = points
            .filter_map(|point| {
                Some((
                    cost(point),
                    dot(column(cost(point)), row(page.error(point)?)),
                ))
            })
            .collect();
        at.sort_by(|a, b| a.0.total_cmp(&b.0));
        at.into_iter().map(|(_, dot)| dot).collect::<Vec<_>>()
    };
    for k in 0..chart.series.len() {
        canvas.polyline(&solved(&|point| point.series == k), theme.faint);
    }
    canvas.polyline(&solved(&|point| point.front && !page.is_force), theme.good);
    canvas.render(buffer);
    let mut put = |x: u16, y: u16, text: &str, style: Style| {
        buffer.set_string(x, y, text, style);
    };
    for dot in (plot.x..plot.right()).step_by(2) {
        put(dot, plot.y - 1, "┄", theme.faint);
    }
    let mut selected = None;
    for (k, point) in chart.points.iter().enumerate() {
        let (style, text, at) = match (page.error(point), &point.failed) {
            (Some(error), _) => {
                let style = if point.front { theme.good } else { theme.text };
                (
                    style,
                    letter(point.series, point.front).to_string(),
                    row(error),
                )
            }
            (None, Some(_)) => (theme.bad, "✗".to_owned(), plot.y - 1),
            (None, None) => (theme.strong, "▾".to_owned(), plot.bottom() - 1),
        };
        put(column(cost(point)), at, &text, style);
        if k == page.run {
            selected = Some((column(cost(point)), at, text));
        }
    }
    // The selected run is drawn last, over the others.
    if let Some((x, y, text)) = selected {
        put(x, y, &text, theme.selected);
    }
}

/// The legend of the series.
fn series(chart: &Precision, theme: &Theme, width: usize) -> paint::Lines {
    let mut lines: Vec<Line> = chart
        .series
        .iter()
        .enumerate()
        .map(|(k, name)| {
            Line::from(vec![
                Span::styled(format!(" {} ", letter(k, false)), theme.strong),
                Span::styled(paint::cut(name, width.saturating_sub(3)), theme.text),
            ])
        })
        .collect();
    lines.push(Line::default());
    for (mark, words) in [
        ("A", "capital: on the Pareto front"),
        ("⠒", "line: a series; bright: the front"),
        ("✗", "failed"),
        ("▾", "reference"),
    ] {
        lines.push(Line::styled(format!(" {mark} {words}"), theme.faint));
    }
    lines
}

/// Details of the selected run, and the source of the chart.
fn details(page: &ChartPage, theme: &Theme, width: usize, has_legend: bool) -> paint::Lines {
    let chart = page.shown();
    let forces = if page.is_force {
        " of contact forces"
    } else {
        ""
    };
    let axis = format!(" error{forces} over {}", page.cost.axis());
    let Some(point) = chart.points.get(page.run) else {
        return vec![Line::styled(axis, theme.faint)];
    };
    let name = format!(
        " ▸ {} {}, {}",
        letter(point.series, point.front),
        chart.series[point.series],
        point.name
    );
    let error = match (page.error(point), &point.failed) {
        (Some(error), _) if error < ROUND_OFF => {
            format!("error {} (round-off)", number::sig4(error))
        }
        (Some(error), _) => format!("error {}", number::sig4(error)),
        (None, Some(why)) => format!("✗ {why}"),
        (None, None) => "reference".to_owned(),
    };
    let cost = format!(
        "   {error}   {} s, {}, {}",
        number::sig4(point.seconds),
        counted(point.factorizations, "factorization"),
        counted(point.minors, "minor")
    );
    let about = page.charts.last().and_then(|chart| chart.about.last());
    let lines = [
        (axis, theme.faint),
        (name, theme.strong),
        (cost, theme.text),
    ];
    let lines = lines.map(|(text, style)| Line::styled(paint::cut(&text, width), style));
    // Without a column for the series, they replace the source.
    let last = if has_legend {
        let about = format!(" {}", about.map_or("", String::as_str));
        vec![Line::styled(paint::cut(&about, width), theme.faint)]
    } else {
        let names = chart
            .series
            .iter()
            .enumerate()
            .map(|(k, name)| format!("{} {name}", letter(k, false)));
        paint::wrapped(&joined(names, "  "), width, theme.faint)
    };
    lines.into_iter().chain(last).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn page() -> ChartPage {
        let directory = tempfile::tempdir().unwrap();
        let file = directory.path().join("a.csv");
        let table = "# made by hand\nscene,series,run,status,error,seconds,factorizations,minors\n\
                     one,mesh,refine=1,whole,1e-2,0.1,10,20\none,mesh,refine=2,whole,1e-4,1,20,10\n\
                     one,other,a=1,2-cycle of minors at load 1,,0.5,5,5\ntwo,mesh,b=1,whole,1e-3,1,1,1\n";
        std::fs::write(&file, table).unwrap();
        ChartPage::open(&file.to_string_lossy()).unwrap()
    }

    fn text(page: &ChartPage, width: u16, height: u16) -> String {
        let area = Rect::new(0, 0, width, height);
        let mut buffer = Buffer::empty(area);
        draw(&mut buffer, area, page, &Theme::mono());
        let row = |row: Rect| {
            row.columns()
                .map(|c| buffer[(c.x, c.y)].symbol().to_owned())
                .collect()
        };
        area.rows().map(row).collect::<Vec<String>>().join("\n")
    }

    #[test]
    fn runs_are_letters_failures_are_crosses_and_the_selected_run_is_told() {
        let mut page = page();
        let shown = text(&page, 100, 24);
        let rows: Vec<&str> = shown.lines().collect();
        // The failed run is above the plot, the more accurate run below the other.
        assert!(rows[1].contains('✗'), "{shown}");
        let of = |mark: char| {
            rows[2..19]
                .iter()
                .position(|row| row.chars().take(60).any(|c| c == mark))
        };
        assert!(of('A').is_some(), "{shown}");
        assert!(
            shown.contains("▸ A mesh, refine=1") && shown.contains("error 0.01"),
            "{shown}"
        );
        assert!(page.key("Left"));
        let shown = text(&page, 100, 24);
        assert!(shown.contains("✗ 2-cycle of minors at load 1"), "{shown}");
        assert!(page.key("x") && page.key("x"));
        // Measured in minor iterations, the finer mesh is better than the coarser one.
        let shown = text(&page, 100, 24);
        assert!(shown.contains("error over minor iterations"), "{shown}");
        page.run = 0;
        assert!(text(&page, 100, 24).contains("▸ a mesh, refine=1"));
        // No run has an error of the contact forces.
        assert!(page.key("f") && !text(&page, 100, 24).contains("contact forces"));
        assert!(page.key("Tab"));
        assert!(text(&page, 100, 24).contains("two  2/2"));
        assert!(!page.key("s"));
    }

    #[test]
    fn any_size_shows_something() {
        let page = page();
        for (width, height) in [(1, 1), (20, 5), (40, 12), (80, 24), (200, 60)] {
            let shown = text(&page, width, height);
            assert_eq!(shown.lines().count(), usize::from(height));
            let blank = shown.chars().all(char::is_whitespace);
            assert!(!blank, "{width}x{height}");
        }
    }
}
