//! The plots of a report.

use relief_formats::file::Plane;

use super::choice;
use super::measure::Measured;
use super::run::Report;
use relief_front::sheet::number::{megabytes, millions, power_of_two, significant};
use relief_front::sheet::plot::{Anchor, Log, Svg};

/// A plot and the name of its file.
pub struct Figure {
    /// File name.
    pub file: &'static str,
    /// The drawing.
    pub svg: Svg,
}

/// Files of all the plots that a report may have.
pub const NAMES: [&str; 5] = ["bytes-against-error.svg", "kernels.svg", "speed.svg", "planes.svg", "codecs.svg"];

/// What a plot takes from a case.
type Figured = fn(&Measured) -> f64;

const WIDTH: f64 = 480.0;
const LEFT: f64 = 62.0;
const RIGHT: f64 = 14.0;

/// All plots, in the order of the page; those without data are left out.
#[must_use]
pub fn all(report: &Report) -> Vec<Figure> {
    let drawn = [
        Some(bytes_against_error(report)),
        (!report.kernels.is_empty()).then(|| kernels(report)),
        Some(speed(report)),
        Some(planes(report)),
        (!report.codecs.is_empty()).then(|| codecs(report)),
    ];
    NAMES.into_iter().zip(drawn).filter_map(|(file, svg)| Some(Figure { file, svg: svg? })).collect()
}

fn bytes_against_error(report: &Report) -> Svg {
    let mut svg = Svg::new(WIDTH, 340.0, "Bytes of the file against its largest error at the nodes, for each step");
    let (top, bottom) = (16.0, 288.0);
    // A file that is exact has no place on a logarithmic axis: half a step is its bound.
    let error_m = |m: &Measured| m.case.step_m() / 2.0;
    let x = Log::around(report.steps.iter().map(error_m), [LEFT, WIDTH - RIGHT]).roomier();
    let y = Log::around(report.steps.iter().map(|m| m.file_bytes as f64 / 1e6), [bottom, top]);
    axes(&mut svg, &x, &y, (top, bottom), "largest error at a node, metres", "file, MB");
    let at = |m: &Measured| (x.at(error_m(m)), y.at(m.file_bytes as f64 / 1e6));
    svg.polyline(&report.steps.iter().map(at).collect::<Vec<_>>(), "la");
    let best = choice::step(&report.steps);
    for (n, measured) in report.steps.iter().enumerate() {
        let (px, py) = at(measured);
        let name = power_of_two(measured.case.step_exponent);
        let hint = format!(
            "step {name} m: {} MB, largest error {} m",
            megabytes(measured.file_bytes),
            significant(measured.at_nodes.max_m, 3)
        );
        svg.point((px, py), 4.0, "a", &hint);
        if best == Some(n) {
            svg.point((px, py), 8.0, "best", &hint);
        }
        let class = if best == Some(n) { "besttext" } else { "" };
        svg.text((px + 7.0, py - 9.0), Anchor::Start, class, &format!("{name} m"));
    }
    svg
}

fn axes(svg: &mut Svg, x: &Log, y: &Log, (top, bottom): (f64, f64), x_name: &str, y_name: &str) {
    for (value, name) in x.ticks() {
        svg.line((x.at(value), top), (x.at(value), bottom), "grid");
        svg.text((x.at(value), bottom + 18.0), Anchor::Middle, "soft", &name);
    }
    rows(svg, y, y_name, (top, bottom));
    svg.text(((LEFT + WIDTH - RIGHT) / 2.0, bottom + 40.0), Anchor::Middle, "", x_name);
}

fn rows(svg: &mut Svg, y: &Log, y_name: &str, (top, bottom): (f64, f64)) {
    for (value, name) in y.ticks() {
        svg.line((LEFT, y.at(value)), (WIDTH - RIGHT, y.at(value)), "grid");
        svg.text((LEFT - 7.0, y.at(value) + 4.5), Anchor::End, "soft", &name);
    }
    svg.line((LEFT, bottom), (WIDTH - RIGHT, bottom), "axis");
    svg.line((LEFT, top), (LEFT, bottom), "axis");
    svg.upwards((15.0, (top + bottom) / 2.0), "", y_name);
}

fn kernels(report: &Report) -> Svg {
    let mut svg = Svg::new(WIDTH, 318.0, "RMS and largest error at the sources' own samples, for each kernel");
    let best = choice::kernel(&report.kernels);
    let panels: [(&str, &str, Figured); 2] = [
        ("RMS error at the samples, metres", "a", |m| m.at_samples.rms_m()),
        ("largest error at the samples, metres", "b", |m| m.at_samples.max_m),
    ];
    for (panel, (title, class, value)) in panels.into_iter().enumerate() {
        let top = 8.0 + 158.0 * panel as f64;
        let bars: Vec<Bar> = report
            .kernels
            .iter()
            .enumerate()
            .map(|(n, m)| Bar { name: m.case.kernel(), value: value(m), best: panel == 0 && best == Some(n), class })
            .collect();
        bar_panel(&mut svg, top, title, 76.0, &bars, |v| significant(v, 3));
    }
    svg
}

struct Bar {
    name: String,
    value: f64,
    best: bool,
    class: &'static str,
}

/// Bars from the left on a linear scale, with their values at their ends.
fn bar_panel(svg: &mut Svg, top: f64, title: &str, left: f64, bars: &[Bar], show: impl Fn(f64) -> String) {
    svg.text((0.0, top + 11.0), Anchor::Start, "strong", title);
    let largest = bars.iter().map(|bar| bar.value).fold(0.0, f64::max);
    let room = WIDTH - left - 62.0;
    for (n, bar) in bars.iter().enumerate() {
        let y = top + 24.0 + 25.0 * n as f64;
        let width = if largest > 0.0 { room * bar.value / largest } else { 0.0 };
        let text = if bar.best { "besttext" } else { "" };
        svg.text((left - 8.0, y + 14.0), Anchor::End, text, &bar.name);
        svg.bar((left, y), (width.max(1.0), 19.0), bar.class, &format!("{}: {}", bar.name, show(bar.value)));
        svg.text((left + width + 6.0, y + 14.0), Anchor::Start, text, &show(bar.value));
    }
}

fn speed(report: &Report) -> Svg {
    let mut svg = Svg::new(WIDTH, 330.0, "Nodes encoded and decoded in a second, for each step");
    let (top, bottom) = (16.0, 278.0);
    let series: [(&str, &str, &str, Figured); 2] = [
        ("decoding all of level 0", "b", "lb", |m| m.decode_nodes_per_s() / 1e6),
        ("baking, everything included", "a", "la", |m| m.encode_nodes_per_s() / 1e6),
    ];
    let values = report.steps.iter().flat_map(|m| series.iter().map(move |s| s.3(m)));
    let y = Log::around(values, [bottom, top]).roomier();
    rows(&mut svg, &y, "million nodes a second", (top, bottom));
    let gap = (WIDTH - RIGHT - LEFT) / report.steps.len().max(1) as f64;
    let x = |n: usize| LEFT + gap * (n as f64 + 0.5);
    for (n, measured) in report.steps.iter().enumerate() {
        svg.text((x(n), bottom + 18.0), Anchor::Middle, "soft", &power_of_two(measured.case.step_exponent));
    }
    svg.text(((LEFT + WIDTH - RIGHT) / 2.0, bottom + 40.0), Anchor::Middle, "", "step, metres");
    for (name, fill, stroke, value) in series {
        let points: Vec<_> = report.steps.iter().enumerate().map(|(n, m)| (x(n), y.at(value(m)))).collect();
        svg.polyline(&points, stroke);
        for (point, measured) in points.iter().zip(&report.steps) {
            let step = power_of_two(measured.case.step_exponent);
            let hint = format!("{name}, step {step} m: {} million nodes/s", millions(value(measured) * 1e6));
            svg.point(*point, 4.0, fill, &hint);
        }
        // The label stands over the line's highest point, so that it never crosses the line.
        let highest = points.iter().map(|point| point.1).fold(bottom, f64::min);
        svg.text((LEFT + 10.0, highest - 12.0), Anchor::Start, "strong", name);
    }
    svg
}

fn planes(report: &Report) -> Svg {
    let height = 62.0 + 26.0 * report.steps.len() as f64;
    let mut svg = Svg::new(WIDTH, height + 26.0, "Share of each plane in the file's bytes, for each step");
    let names = Plane::ALL.iter().map(|plane| plane.name()).chain(["other"]);
    let classes = ["a", "b", "c", "d", "e", "f"];
    let mut at = 0.0;
    for (name, class) in names.clone().zip(classes) {
        svg.bar((at, 4.0), (12.0, 12.0), class, name);
        svg.text((at + 17.0, 15.0), Anchor::Start, "", name);
        at += 34.0 + 7.6 * name.len() as f64;
    }
    let (left, right) = (60.0, WIDTH - 70.0);
    svg.text((left - 8.0, 44.0), Anchor::End, "soft", "step, m");
    svg.text((right + 8.0, 44.0), Anchor::Start, "soft", "file, MB");
    for (n, measured) in report.steps.iter().enumerate() {
        let y = 54.0 + 26.0 * n as f64;
        let step = power_of_two(measured.case.step_exponent);
        svg.text((left - 8.0, y + 15.0), Anchor::End, "", &step);
        let bytes = measured.plane_bytes.iter().copied().chain([measured.other_bytes()]);
        let mut from = left;
        for ((name, class), bytes) in names.clone().zip(classes).zip(bytes) {
            let share = bytes as f64 / measured.file_bytes as f64;
            let width = share * (right - left);
            let hint = format!("step {step} m, {name}: {:.1} %, {} MB", 100.0 * share, megabytes(bytes));
            svg.bar((from, y), (width, 21.0), class, &hint);
            from += width;
        }
        svg.text((right + 8.0, y + 15.0), Anchor::Start, "", &megabytes(measured.file_bytes));
    }
    for percent in [0, 25, 50, 75, 100] {
        let x = left + (right - left) * f64::from(percent) / 100.0;
        svg.text((x, height + 14.0), Anchor::Middle, "soft", &format!("{percent} %"));
    }
    svg
}

fn codecs(report: &Report) -> Svg {
    let count = report.codecs.len() as f64;
    let mut svg = Svg::new(WIDTH, 36.0 + 25.0 * count, "Bytes of the same heights, coded in several ways");
    let best = choice::codec(&report.codecs);
    let bars: Vec<Bar> = report
        .codecs
        .iter()
        .enumerate()
        .map(|(n, codec)| Bar {
            name: codec.name.into(),
            value: codec.bytes as f64,
            best: best == Some(n),
            class: if codec.heights_only { "a" } else { "b" },
        })
        .collect();
    bar_panel(&mut svg, 8.0, "bytes, MB", 186.0, &bars, |v| megabytes(v as u64));
    svg
}
