//! The page of a report: what was measured, the plots, and what to make of them.

mod sections;

use super::choice;
use super::figures::Figure;
use super::measure::{BAKE_S, Measured, RUNS};
use super::run::Report;
use relief_front::sheet;
use relief_front::sheet::machine::Machine;
use relief_front::sheet::number::{escaped, megabytes, millions, power_of_two, significant, whole};
use sections::{codecs, kernels, planes, speeds, steps};

/// The whole page; nothing outside it is loaded.
#[must_use]
pub fn html(report: &Report, figures: &[Figure]) -> String {
    let files: Vec<&str> = report.sources.iter().map(|source| source.file.as_str()).collect();
    let title = format!("Speed against error: {}", files.join(", "));
    let figure = |file: &str, caption: &str| match figures.iter().find(|figure| figure.file == file) {
        Some(figure) => format!(
            "<figure>\n{}<figcaption>{caption} <a href=\"{file}\">{file}</a></figcaption>\n</figure>\n",
            figure.svg.inline()
        ),
        None => String::new(),
    };
    let sections = [head(report, &title), cards(report), steps(report, &figure), kernels(report, &figure)].concat()
        + &[speeds(report, &figure), planes(&figure), codecs(report, &figure), method(report)].concat();
    sheet::page::html(&title, &sections)
}

fn head(report: &Report, title: &str) -> String {
    let Machine { cpu, cores, system, date, .. } = &report.machine;
    let smaller = if report.m < report.bake_m {
        format!(
            " A bake would choose m = {}; the report takes less, so that it is done in a minute or two (<code>--m {}</code> measures the whole).",
            report.bake_m,
            report.bake_m.min(20)
        )
    } else {
        String::new()
    };
    format!(
        "<h1>{}</h1>\n<p class=\"lead\">{} files baked and measured by relief-bake {} on {date}: {} × {} nodes \
         (m = {}), body {}, heights {}. Machine: {}, {cores} cores, {}; {} threads.{smaller}</p>\n",
        escaped(title),
        report.steps.len() + report.kernels.len(),
        env!("CARGO_PKG_VERSION"),
        whole(u64::from(report.size.0)),
        whole(u64::from(report.size.1)),
        report.m,
        escaped(&report.body),
        escaped(&vertical(report)),
        escaped(cpu),
        escaped(system),
        report.threads,
    )
}

fn vertical(report: &Report) -> String {
    match report.sources.first().map(|source| source.vertical.as_str()) {
        Some("ellipsoid") => "above the ellipsoid".into(),
        Some("as-given") | None => "as given".into(),
        Some(geoid) => format!("above the ellipsoid ({geoid} added)"),
    }
}

fn cards(report: &Report) -> String {
    let mut cards = Vec::new();
    let card = |value: String, text: String| {
        format!("<div class=\"card\"><b>{}</b><span>{text}</span></div>\n", escaped(&value))
    };
    if let Some(best) = choice::step(&report.steps)
        && let (Some(measured), Some(finest)) = (report.steps.get(best), report.steps.first())
    {
        cards.push(card(
            format!("step {}\u{a0}m", power_of_two(measured.case.step_exponent)),
            format!(
                "is the coarsest whose rounding does not show: {} MB, {:.0} % of the finest step’s bytes.",
                megabytes(measured.file_bytes),
                100.0 * measured.file_bytes as f64 / finest.file_bytes as f64
            ),
        ));
    }
    if let Some(measured) = choice::kernel(&report.kernels).and_then(|best| report.kernels.get(best)) {
        cards.push(card(
            measured.case.kernel(),
            format!("keeps the source’s samples best: RMS {} m.", significant(measured.at_samples.rms_m(), 3)),
        ));
    }
    if let Some(measured) = default_step(report) {
        cards.push(card(
            format!("{}\u{a0}M nodes/s", millions(measured.decode_nodes_per_s())),
            format!(
                "decoded at a step of {} m, {} M nodes/s baked.",
                power_of_two(report.step_exponent),
                millions(measured.encode_nodes_per_s())
            ),
        ));
    }
    format!("<div class=\"cards\">\n{}</div>\n", cards.concat())
}

fn nth(n: usize) -> String {
    match n {
        2 => "2nd".into(),
        3 => "3rd".into(),
        n => format!("{n}th"),
    }
}

/// The step that a bake takes.
fn default_step(report: &Report) -> Option<&Measured> {
    report.steps.iter().find(|measured| measured.case.step_exponent == report.step_exponent)
}

fn method(report: &Report) -> String {
    let noise = match (report.machine.busy(), report.machine.load) {
        (true, Some(load)) => format!(
            "<strong>The machine was busy</strong>: a load average of {} on {} cores when the report began. Bytes and \
             errors are not touched by that; take the speeds as lower bounds, and small differences between them as noise.",
            significant(load, 2),
            report.machine.cores
        ),
        _ => "Bytes and errors are the same in every run; speeds vary by some percent from run to run.".into(),
    };
    let compared = report.steps.first().map_or((0, 0), |m| (m.at_nodes.count, m.at_samples.count));
    let every = match report.every {
        1 => "every sample of the source".to_owned(),
        n => format!("the source’s samples in every {} row and column (so the largest error may be missed)", nth(n)),
    };
    format!(
        "<h2>How it was measured</h2>\n<p>{noise}</p>\n<p>Errors are over {} nodes and {} samples: {every} that has \
         data, on the finest level, away from filled nodes. Times are medians: of up to {} bakes, as \
         many as fit into {} seconds, and of {} decodes with the file in memory. A megabyte is 10<sup>6</sup> bytes. All figures, unrounded: \
         <a href=\"report.csv\">report.csv</a> and <a href=\"codecs.csv\">codecs.csv</a>.</p>\n",
        whole(compared.0),
        whole(compared.1),
        RUNS,
        BAKE_S,
        RUNS,
    )
}
