//! The plots of a report.

use relief_front::sheet::number::significant;
use relief_front::sheet::plot::{Anchor, Log, Svg};

use super::Report;
use super::meshes::MeshRow;

/// A plot and the name of its file.
pub struct Figure {
    /// File name.
    pub file: &'static str,
    /// The drawing.
    pub svg: Svg,
}

/// Files of all the plots that a report may have.
pub const NAMES: [&str; 3] = ["triangles-against-error.svg", "promise.svg", "fetches.svg"];

const WIDTH: f64 = 480.0;
const LEFT: f64 = 78.0;
const RIGHT: f64 = 14.0;
const TOP: f64 = 40.0;
const BOTTOM: f64 = 300.0;

/// All plots, in the order of the page.
pub fn all(report: &Report) -> Vec<Figure> {
    let drawn = [triangles(report), promise(report), fetches(report)];
    NAMES.into_iter().zip(drawn).map(|(file, svg)| Figure { file, svg }).collect()
}

/// The views of a report, in order.
pub fn views(report: &Report) -> Vec<&'static str> {
    let mut names: Vec<&str> = report.meshes.iter().map(|row| row.view).collect();
    names.dedup();
    names
}

/// Rows of a scheme in a view with something to show on a logarithmic axis.
pub fn series<'a>(report: &'a Report, view: &str, scheme: &str) -> Vec<&'a MeshRow> {
    report
        .meshes
        .iter()
        .filter(|row| row.view == view && row.scheme == scheme && row.error.largest_px > 0.0 && row.triangles > 0)
        .collect()
}

const COLOURS: [&str; 4] = ["a", "b", "c", "d"];

fn triangles(report: &Report) -> Svg {
    let mut svg = Svg::new(WIDTH, 350.0, "Triangles of bisection against the largest measured error, for each view");
    let shown = report.meshes.iter().filter(|row| row.scheme != "uniform" && row.error.largest_px > 0.0);
    let x = Log::around(shown.clone().map(|row| row.error.largest_px), [LEFT, WIDTH - RIGHT]).roomier();
    let y = Log::around(shown.map(|row| row.triangles as f64), [BOTTOM, TOP]).roomier();
    axes(&mut svg, &x, &y, "largest measured error, pixels", "triangles");
    for (view, colour) in views(report).into_iter().zip(COLOURS) {
        for scheme in ["leb", "paper"] {
            let rows = series(report, view, scheme);
            for row in &rows {
                let radius = if scheme == "leb" { 4.5 } else { 2.5 };
                let hint = format!(
                    "{scheme}, {view}, threshold {} px: {} triangles, at most {} px, {} ms",
                    row.threshold_px.unwrap_or(0.0),
                    row.triangles,
                    significant(row.error.largest_px, 2),
                    significant(row.cpu_ms, 2)
                );
                svg.point((x.at(row.error.largest_px), y.at(row.triangles as f64)), radius, colour, &hint);
            }
        }
    }
    legend(&mut svg, &views(report));
    svg
}

fn promise(report: &Report) -> Svg {
    let mut svg = Svg::new(WIDTH, 350.0, "Largest measured error of bisection against the threshold it promises");
    let shown = report.meshes.iter().filter(|row| row.threshold_px.is_some() && row.error.largest_px > 0.0);
    let thresholds = shown.clone().filter_map(|row| row.threshold_px).map(f64::from);
    let x = Log::around(thresholds.clone(), [LEFT, WIDTH - RIGHT]).roomier();
    let y = Log::around(shown.map(|row| row.error.largest_px).chain(thresholds.clone()), [BOTTOM, TOP]).roomier();
    axes(&mut svg, &x, &y, "threshold, pixels", "largest measured error, pixels");
    let (low, high) = (thresholds.clone().fold(f64::INFINITY, f64::min), thresholds.fold(0.0, f64::max));
    if low < high {
        svg.line((x.at(low), y.at(low)), (x.at(high), y.at(high)), "axis");
        svg.text((x.at(high), y.at(high) - 8.0), Anchor::End, "soft", "the promise");
    }
    for (view, colour) in views(report).into_iter().zip(COLOURS) {
        for row in series(report, view, "leb") {
            let threshold = f64::from(row.threshold_px.unwrap_or(1.0));
            let hint = format!("{view}: {} px of {threshold} px", significant(row.error.largest_px, 2));
            svg.point((x.at(threshold), y.at(row.error.largest_px)), 4.5, colour, &hint);
        }
    }
    legend(&mut svg, &views(report));
    svg
}

fn fetches(report: &Report) -> Svg {
    let rows: Vec<_> = report.shadows.iter().filter(|row| row.level_offset == 0).collect();
    let height = 40.0 + 25.0 * rows.len() as f64;
    let mut svg = Svg::new(WIDTH, height, "Fetches a ray, for each sun and kernel");
    svg.text((0.0, 14.0), Anchor::Start, "strong", "fetches a ray: heights, pairs of extremes");
    let left = 92.0;
    let most = rows.iter().map(|row| row.heights_per_ray + row.extremes_per_ray).fold(1e-9, f64::max);
    let unit = (WIDTH - left - 50.0) / most;
    for (n, row) in rows.iter().enumerate() {
        let y = 26.0 + 25.0 * n as f64;
        svg.text((left - 8.0, y + 14.0), Anchor::End, "", &format!("{}°, {}", row.elevation_deg, row.kernel));
        let heights = unit * row.heights_per_ray;
        let extremes = unit * row.extremes_per_ray;
        let hint = format!("{} heights", significant(row.heights_per_ray, 3));
        svg.bar((left, y), (heights.max(0.5), 19.0), "a", &hint);
        let hint = format!("{} pairs of extremes", significant(row.extremes_per_ray, 3));
        svg.bar((left + heights, y), (extremes.max(0.5), 19.0), "b", &hint);
        let sum = significant(row.heights_per_ray + row.extremes_per_ray, 3);
        svg.text((left + heights + extremes + 6.0, y + 14.0), Anchor::Start, "", &sum);
    }
    svg
}

fn axes(svg: &mut Svg, x: &Log, y: &Log, x_name: &str, y_name: &str) {
    for (value, name) in x.ticks() {
        svg.line((x.at(value), TOP), (x.at(value), BOTTOM), "grid");
        svg.text((x.at(value), BOTTOM + 18.0), Anchor::Middle, "soft", &name);
    }
    for (value, name) in y.ticks() {
        svg.line((LEFT, y.at(value)), (WIDTH - RIGHT, y.at(value)), "grid");
        svg.text((LEFT - 7.0, y.at(value) + 4.5), Anchor::End, "soft", &name);
    }
    svg.line((LEFT, BOTTOM), (WIDTH - RIGHT, BOTTOM), "axis");
    svg.line((LEFT, TOP), (LEFT, BOTTOM), "axis");
    svg.text(((LEFT + WIDTH - RIGHT) / 2.0, BOTTOM + 40.0), Anchor::Middle, "", x_name);
    svg.upwards((15.0, (TOP + BOTTOM) / 2.0), "", y_name);
}

/// The views' colours, two to a line.
fn legend(svg: &mut Svg, views: &[&str]) {
    for (n, (view, colour)) in views.iter().zip(COLOURS).enumerate() {
        let (x, y) = (LEFT + 210.0 * (n % 2) as f64, 2.0 + 17.0 * (n / 2) as f64);
        svg.bar((x, y), (11.0, 11.0), colour, view);
        svg.text((x + 16.0, y + 10.0), Anchor::Start, "", view);
    }
}
