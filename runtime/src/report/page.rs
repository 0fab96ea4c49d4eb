//! The page of a report: what was measured, the plots, and what to make of them.

use relief_front::sheet::number::{escaped, significant, whole};
use relief_front::sheet::{page, table};

use super::figures::Figure;
use super::{PAPER, Report};

/// The whole page; nothing outside it is loaded.
pub fn html(report: &Report, figures: &[Figure]) -> String {
    let title = format!("Speed against error: {}", report.file);
    let figure = |file: &str, caption: &str| match figures.iter().find(|figure| figure.file == file) {
        Some(figure) => format!(
            "<figure>\n{}<figcaption>{caption} <a href=\"{file}\">{file}</a></figcaption>\n</figure>\n",
            figure.svg.inline()
        ),
        None => String::new(),
    };
    let sections = [
        head(report, &title),
        cards(report),
        "<h2>The mesh</h2>\n<p>Each view is tessellated with several thresholds. The error is measured in f64: points \
         of S<sub>0</sub> in view against the points drawn in their place, so it is an upper bound of the distance to \
         the drawn surface.</p>\n"
            .into(),
        figure("triangles-against-error.svg", "Large dots: longest-edge bisection; small dots: the paper's scheme."),
        figure("promise.svg", "Bisection's threshold is a bound: every dot lies below the line."),
        mesh_table(report),
        "<h2>Shadows</h2>\n<p>One ray from a node to the sun. The oracle walks over every cell in f64 and knows no \
         pyramid; a ray counts as wrong when it differs although the oracle's margin is above 10<sup>-4</sup> rad + \
         2 mm / distance. A level offset tests a coarser surface than the truth: faster, and wrong where they \
         differ.</p>\n"
            .into(),
        figure("fetches.svg", "A count, which no machine's load changes."),
        shadow_table(report),
        "<p class=\"note\">The same figures as tables: <a href=\"meshes.csv\">meshes.csv</a>, \
         <a href=\"shadows.csv\">shadows.csv</a>.</p>\n"
            .into(),
    ];
    page::html(&title, &sections.concat())
}

fn head(report: &Report, title: &str) -> String {
    let machine = &report.machine;
    let busy = if machine.busy() {
        "<p class=\"note\">Other work kept the cores busy: times are too long, counts and errors are not touched.</p>\n"
    } else {
        ""
    };
    format!(
        "<h1>{}</h1>\n<p class=\"lead\">{}. Pictures of {} × {} pixels. Measured by reliefd {} on {}: {}, {} cores, \
         {}; CPU backend.</p>\n{busy}",
        escaped(title),
        escaped(&report.about),
        report.size[0],
        report.size[1],
        env!("CARGO_PKG_VERSION"),
        machine.date,
        escaped(&machine.cpu),
        machine.cores,
        escaped(&machine.system),
    )
}

/// The findings, one card each.
fn cards(report: &Report) -> String {
    let mut cards = String::from("<div class=\"cards\">\n");
    let mut card = |value: String, text: String| {
        cards += &format!("<div class=\"card\"><b>{}</b><span>{}</span></div>\n", escaped(&value), escaped(&text));
    };
    let leb = |px: f32| report.meshes.iter().filter(move |row| row.scheme == "leb" && row.threshold_px == Some(px));
    if let Some(row) = leb(1.0).max_by_key(|row| row.triangles) {
        let uniform = report.meshes.iter().find(|u| u.scheme == "uniform" && u.view == row.view);
        let against = uniform.map_or(String::new(), |u| format!(", {} as a uniform mesh", whole(u.triangles as u64)));
        card(
            format!("{} triangles", whole(row.triangles as u64)),
            format!("the most that one pixel asks for ({}){against}", row.view),
        );
    }
    let worst = report
        .meshes
        .iter()
        .filter(|row| row.scheme == "leb")
        .filter_map(|row| Some(row.error.largest_px / f64::from(row.threshold_px?)))
        .fold(0.0, f64::max);
    card(
        format!("{} of the promise", significant(worst, 2)),
        "the largest measured error, in thresholds, over all views of bisection".into(),
    );
    let exact = report.shadows.iter().filter(|row| row.level_offset == 0 && !PAPER.contains(&row.kernel));
    let (checked, wrong) = exact.clone().fold((0, 0), |sum, row| (sum.0 + row.checked, sum.1 + row.wrong));
    card(format!("{wrong} of {} rays wrong", whole(checked as u64)), "against the oracle, outside its margin".into());
    if let Some(fastest) = exact.max_by(|a, b| a.mray_per_s.total_cmp(&b.mray_per_s)) {
        card(
            format!("{} Mray/s", significant(fastest.mray_per_s, 2)),
            format!("{} at a sun of {}°, {} cores", fastest.kernel, fastest.elevation_deg, report.machine.cores),
        );
    }
    cards + "</div>\n"
}

fn mesh_table(report: &Report) -> String {
    let columns = [
        ("view", ""),
        ("scheme", ""),
        ("threshold", "px"),
        ("triangles", ""),
        ("time", "ms, CPU"),
        ("largest", "px"),
        ("RMS", "px"),
        ("largest", "m"),
        ("RMS", "m"),
    ];
    let rows: Vec<table::Row> = report
        .meshes
        .iter()
        .map(|row| {
            let cells = vec![
                row.view.into(),
                row.scheme.into(),
                row.threshold_px.map_or("-".into(), |px| px.to_string()),
                whole(row.triangles as u64),
                significant(row.cpu_ms, 3),
                significant(row.error.largest_px, 3),
                significant(row.error.rms_px, 3),
                significant(row.error.largest_m, 3),
                significant(row.error.rms_m, 3),
            ];
            (row.scheme == "leb" && row.threshold_px == Some(1.0), cells)
        })
        .collect();
    table::html(&columns, &rows)
}

fn shadow_table(report: &Report) -> String {
    let columns = [
        ("sun", "degrees"),
        ("kernel", ""),
        ("level offset", ""),
        ("speed", "Mray/s"),
        ("heights", "a ray"),
        ("extremes", "a ray"),
        ("in shadow", "%"),
        ("wrong", "of checked"),
        ("in the margin", "%"),
    ];
    let rows: Vec<table::Row> = report
        .shadows
        .iter()
        .map(|row| {
            let cells = vec![
                row.elevation_deg.to_string(),
                row.kernel.into(),
                row.level_offset.to_string(),
                significant(row.mray_per_s, 3),
                significant(row.heights_per_ray, 3),
                significant(row.extremes_per_ray, 3),
                format!("{:.1}", 100.0 * row.dark_share),
                format!("{} / {}", row.wrong, row.checked),
                format!("{:.2}", 100.0 * row.inside_margin as f64 / row.checked.max(1) as f64),
            ];
            (row.level_offset == 0, cells)
        })
        .collect();
    table::html(&columns, &rows)
}
