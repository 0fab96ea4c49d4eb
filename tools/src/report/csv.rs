//! The measurements as tables for programs; units are in the names of the columns.

use std::fmt::Write as _;

use relief_formats::file::Plane;

use super::measure::Measured;
use super::run::Report;

/// One row for each file that was baked.
#[must_use]
pub fn cases(report: &Report) -> String {
    let planes: Vec<String> = Plane::ALL.iter().map(|plane| format!("{}_bytes", plane.name())).collect();
    let mut text = format!(
        "varied,m,step_m,kernel,nodes,file_bytes,{},other_bytes,node_max_error_m,node_rms_error_m,nodes_compared,\
         sample_max_error_m,sample_rms_error_m,samples_compared,encode_s,encode_nodes_per_s,decode_s,decode_nodes_per_s\n",
        planes.join(",")
    );
    let mut row = |varied: &str, measured: &Measured| {
        let planes: Vec<String> = measured.plane_bytes.iter().map(u64::to_string).collect();
        // Writing to a string cannot fail.
        let _ = writeln!(
            text,
            "{varied},{},{},{},{},{},{},{},{},{},{},{},{},{},{:.6},{:.0},{:.6},{:.0}",
            report.m,
            measured.case.step_m(),
            measured.case.kernel(),
            measured.nodes,
            measured.file_bytes,
            planes.join(","),
            measured.other_bytes(),
            measured.at_nodes.max_m,
            measured.at_nodes.rms_m(),
            measured.at_nodes.count,
            measured.at_samples.max_m,
            measured.at_samples.rms_m(),
            measured.at_samples.count,
            measured.encode_s,
            measured.encode_nodes_per_s(),
            measured.decode_s,
            measured.decode_nodes_per_s(),
        );
    };
    report.steps.iter().for_each(|measured| row("step", measured));
    report.kernels.iter().for_each(|measured| row("kernel", measured));
    text
}

/// One row for each way of coding.
#[must_use]
pub fn codecs(report: &Report) -> String {
    let step_m = f64::from(report.step_exponent).exp2();
    let mut text = String::from("codec,holds,heights_only,m,step_m,nodes,bytes,thread_encode_s,thread_decode_s\n");
    for codec in &report.codecs {
        let _ = writeln!(
            text,
            "\"{}\",\"{}\",{},{},{step_m},{},{},{:.6},{:.6}",
            codec.name,
            codec.holds,
            codec.heights_only,
            report.m,
            codec.nodes,
            codec.bytes,
            codec.encode_s,
            codec.decode_s
        );
    }
    text
}
