//! The sections of the page that have a table: steps, kernels, speed, planes, codecs.

use super::default_step;
use crate::report::choice;
use crate::report::run::Report;
use relief_front::sheet::number::{megabytes, millions, power_of_two, significant};
use relief_front::sheet::table;

pub fn steps(report: &Report, figure: &impl Fn(&str, &str) -> String) -> String {
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
    let rows = marked(&report.steps, best, |m| {
        vec![
            power_of_two(m.case.step_exponent),
            megabytes(m.file_bytes),
            significant(m.bits_per_node(), 3),
            significant(m.at_nodes.max_m, 3),
            significant(m.at_nodes.rms_m(), 3),
            significant(m.at_samples.max_m, 4),
            significant(m.at_samples.rms_m(), 4),
        ]
    });
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

pub fn kernels(report: &Report, figure: &impl Fn(&str, &str) -> String) -> String {
    let heading = "<h2>What a kernel costs</h2>\n";
    let best = choice::kernel(&report.kernels);
    let Some(chosen) = best.and_then(|best| report.kernels.get(best)) else {
        return format!("{heading}<p>On a plane the nodes are the source’s own samples: nothing is resampled.</p>\n");
    };
    let rows = marked(&report.kernels, best, |m| {
        vec![
            m.case.kernel(),
            significant(m.at_samples.rms_m(), 4),
            significant(m.at_samples.max_m, 4),
            megabytes(m.file_bytes),
            millions(m.encode_nodes_per_s()),
        ]
    });
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

pub fn speeds(report: &Report, figure: &impl Fn(&str, &str) -> String) -> String {
    let best = choice::step(&report.steps);
    let rows = marked(&report.steps, best, |m| {
        vec![
            power_of_two(m.case.step_exponent),
            significant(m.encode_s, 3),
            millions(m.encode_nodes_per_s()),
            significant(1e3 * m.decode_s, 3),
            millions(m.decode_nodes_per_s()),
        ]
    });
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

pub fn planes(figure: &impl Fn(&str, &str) -> String) -> String {
    format!(
        "<h2>Where the bytes are</h2>\n<p>Each tile has five planes: <em>nodes</em>, the heights; <em>mip</em>, their \
         filtered means; <em>hext</em>, least and greatest heights for shadows; <em>deviation</em>, how far coarser \
         triangles are off; <em>filled</em>, which nodes were not measured. <em>Other</em> is header, index, patch mesh \
         and metadata.</p>\n{}",
        figure("planes.svg", "Share of the file by plane, over all levels."),
    )
}

pub fn codecs(report: &Report, figure: &impl Fn(&str, &str) -> String) -> String {
    let best = choice::codec(&report.codecs);
    let rows = marked(&report.codecs, best, |codec| {
        vec![
            codec.name.to_owned(),
            megabytes(codec.bytes),
            significant(8.0 * codec.bytes as f64 / codec.nodes as f64, 3),
            millions(codec.nodes as f64 / codec.encode_s),
            millions(codec.nodes as f64 / codec.decode_s),
        ]
    });
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

/// Rows of a table, the best of them marked.
fn marked<T>(items: &[T], best: Option<usize>, cells: impl Fn(&T) -> Vec<String>) -> Vec<table::Row> {
    items.iter().enumerate().map(|(n, item)| (best == Some(n), cells(item))).collect()
}
