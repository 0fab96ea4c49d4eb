//! The page of a report: what was measured, the plots, and what to make of them.

use super::choice;
use super::figures::Figure;
use super::measure::{BAKE_S, Measured, RUNS};
use super::run::Report;
use relief_front::sheet;
use relief_front::sheet::machine::Machine;
use relief_front::sheet::number::{escaped, megabytes, millions, power_of_two, significant, whole};
use relief_front::sheet::table;

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

fn steps(report: &Report, figure: &impl Fn(&str, &str) -> String) -> String {
    let best = choice::step(&report.steps);
    let advice = match best.and_then(|best| report.steps.get(best)) {
        Some(measured) if measured.at_nodes.rms_m() < 1e-6 => format!(
            "The marked step, {} m, is the coarsest that loses nothing.",
            power_of_two(measured.case.step_exponent)
        ),
        Some(measured) => format!(
            "The marked step, {} m, is the coarsest whose rounding (RMS at nodes) stays below a hundredth of the error at \
             the source’s samples: finer steps spend bytes on digits that resampling has already lost.",
            power_of_two(measured.case.step_exponent)
        ),
        None => "Here every finer step brings the file closer to the source’s samples, so none is marked: choose the \
                 error that you can bear."
            .into(),
    };
    let rows: Vec<table::Row> = report
        .steps
        .iter()
        .enumerate()
        .map(|(n, m)| {
            let cells = vec![
                power_of_two(m.case.step_exponent),
                megabytes(m.file_bytes),
                significant(m.bits_per_node(), 3),
                significant(m.at_nodes.max_m, 3),
                significant(m.at_nodes.rms_m(), 3),
                significant(m.at_samples.max_m, 4),
                significant(m.at_samples.rms_m(), 4),
            ];
            (best == Some(n), cells)
        })
        .collect();
    let columns = [
        ("step", "m"),
        ("file", "MB"),
        ("bits", "per node"),
        ("largest at nodes", "m"),
        ("RMS at nodes", "m"),
        ("largest at samples", "m"),
        ("RMS at samples", "m"),
    ];
    format!(
        "<h2>What a step costs</h2>\n<p>Heights are stored as whole steps of a power of two, so no node is off by more \
         than half a step. A coarser step makes a smaller file. {advice}</p>\n{}{}\
         <p class=\"note\"><em>At nodes</em> is rounding alone: the file’s nodes against the resampled heights before \
         rounding. <em>At samples</em> is what a user sees: the surface between the nodes against the source where \
         the source has its own samples. The files hold everything, pyramids and bounds too; the default of a bake is \
         {} m.{}</p>\n",
        figure("bytes-against-error.svg", "Down and left is better; both axes are logarithmic. Labels are steps."),
        table::html(&columns, &rows),
        power_of_two(report.step_exponent),
        unmoved(report),
    )
}

/// Why the error at the samples may hardly depend on the step.
fn unmoved(report: &Report) -> &'static str {
    match default_step(report) {
        Some(m) if !report.kernels.is_empty() && m.at_samples.rms_m() > 10.0 * m.at_nodes.rms_m() => {
            " The error at samples is far larger than any rounding, because nodes lie between the samples and terrain \
             may change much from one sample to the next; a larger <code>--m</code> or another kernel lowers it, a \
             finer step does not."
        }
        _ => "",
    }
}

fn kernels(report: &Report, figure: &impl Fn(&str, &str) -> String) -> String {
    let heading = "<h2>What a kernel costs</h2>\n";
    let best = choice::kernel(&report.kernels);
    let Some(chosen) = best.and_then(|best| report.kernels.get(best)) else {
        return format!("{heading}<p>On a plane the nodes are the source’s own samples: nothing is resampled.</p>\n");
    };
    let rows: Vec<table::Row> = report
        .kernels
        .iter()
        .enumerate()
        .map(|(n, m)| {
            let cells = vec![
                m.case.kernel(),
                significant(m.at_samples.rms_m(), 4),
                significant(m.at_samples.max_m, 4),
                megabytes(m.file_bytes),
                millions(m.encode_nodes_per_s()),
            ];
            (best == Some(n), cells)
        })
        .collect();
    let columns =
        [("kernel", ""), ("RMS at samples", "m"), ("largest", "m"), ("file", "MB"), ("bake", "million nodes/s")];
    format!(
        "{heading}<p>The kernel turns the source’s samples into heights at the nodes. The error is that of the surface \
         between the nodes, measured back at the source’s own samples: here <strong>{}</strong> keeps them best.</p>\n{}{}\
         <p class=\"note\">Fidelity to samples is not everything. Where the source is finer than the grid, \
         <code>average</code> loses peaks on purpose: it does not alias, and keeps volumes. <code>nearest</code> \
         invents no height, but moves the terrain by up to half a sample; <code>lanczos</code> may overshoot at \
         cliffs. All at a step of {} m.</p>\n",
        chosen.case.kernel(),
        figure("kernels.svg", "Shorter is better."),
        table::html(&columns, &rows),
        power_of_two(report.step_exponent),
    )
}

fn speeds(report: &Report, figure: &impl Fn(&str, &str) -> String) -> String {
    let best = choice::step(&report.steps);
    let rows: Vec<table::Row> = report
        .steps
        .iter()
        .enumerate()
        .map(|(n, m)| {
            let cells = vec![
                power_of_two(m.case.step_exponent),
                significant(m.encode_s, 3),
                millions(m.encode_nodes_per_s()),
                significant(1e3 * m.decode_s, 3),
                millions(m.decode_nodes_per_s()),
            ];
            (best == Some(n), cells)
        })
        .collect();
    let columns =
        [("step", "m"), ("bake", "s"), ("bake", "million nodes/s"), ("decode", "ms"), ("decode", "million nodes/s")];
    format!(
        "<h2>Speed</h2>\n<p>A bake reads, resamples, derives the pyramids, bounds and deviations, encodes and writes; \
         decoding gives all heights of level 0, with the coarser levels that they rest on. Both use {} threads.</p>\n{}{}",
        report.threads,
        figure("speed.svg", "Up is better; the vertical axis is logarithmic."),
        table::html(&columns, &rows),
    )
}

fn planes(figure: &impl Fn(&str, &str) -> String) -> String {
    format!(
        "<h2>Where the bytes are</h2>\n<p>Each tile has five planes: <em>nodes</em>, the heights; <em>mip</em>, their \
         filtered means; <em>hext</em>, least and greatest heights for shadows; <em>deviation</em>, how far coarser \
         triangles are off; <em>filled</em>, which nodes were not measured. <em>Other</em> is header, index, patch mesh \
         and metadata.</p>\n{}",
        figure("planes.svg", "Share of the file by plane, over all levels."),
    )
}

fn codecs(report: &Report, figure: &impl Fn(&str, &str) -> String) -> String {
    let best = choice::codec(&report.codecs);
    let rows: Vec<table::Row> = report
        .codecs
        .iter()
        .enumerate()
        .map(|(n, codec)| {
            let cells = vec![
                codec.name.to_owned(),
                megabytes(codec.bytes),
                significant(8.0 * codec.bytes as f64 / codec.nodes as f64, 3),
                millions(codec.nodes as f64 / codec.encode_s),
                millions(codec.nodes as f64 / codec.decode_s),
            ];
            (best == Some(n), cells)
        })
        .collect();
    let columns = [
        ("coded by", ""),
        ("bytes", "MB"),
        ("bits", "per node"),
        ("encode", "million nodes/s"),
        ("decode", "million nodes/s"),
    ];
    format!(
        "<h2>What the codec buys</h2>\n<p>The same tiles at a step of {} m, coded in several ways, with plain zstd as \
         a measure that everyone knows. The marked way has the fewest bytes for heights alone. The relief rows hold \
         every level of the pyramid, those of zstd only the finest.</p>\n{}{}\
         <p class=\"note\">Speeds here are of one thread and of coding alone: nothing is read, resampled, derived or \
         written. <em>Everything</em> includes hashing each plane when encoding.</p>\n",
        power_of_two(report.step_exponent),
        figure("codecs.svg", "Shorter is better. Blue: heights alone; orange: more than heights."),
        table::html(&columns, &rows),
    )
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
