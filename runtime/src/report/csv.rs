//! The measurements as tables for programs; units are in the names of the columns.

use std::fmt::Write as _;

use super::meshes::MeshRow;
use super::shadows::ShadowRow;

/// One row for each mesh.
pub fn meshes(rows: &[MeshRow]) -> String {
    let mut text =
        String::from("view,scheme,threshold_px,triangles,cpu_ms,largest_px,rms_px,largest_m,rms_m,points_in_view\n");
    for row in rows {
        let threshold = row.threshold_px.map_or(String::new(), |px| px.to_string());
        let e = &row.error;
        // Writing to a string cannot fail.
        let _ = writeln!(
            text,
            "\"{}\",{},{threshold},{},{:.3},{:.4},{:.4},{:.4},{:.4},{}",
            row.view, row.scheme, row.triangles, row.cpu_ms, e.largest_px, e.rms_px, e.largest_m, e.rms_m, e.points
        );
    }
    text
}

/// One row for each sun and kernel.
pub fn shadows(rows: &[ShadowRow]) -> String {
    let mut text = String::from(
        "sun_elevation_deg,kernel,level_offset,rays,mray_per_s,heights_per_ray,extremes_per_ray,\
         checked,wrong,inside_margin,dark_share\n",
    );
    for row in rows {
        let _ = writeln!(
            text,
            "{},{},{},{},{:.4},{:.3},{:.3},{},{},{},{:.4}",
            row.elevation_deg,
            row.kernel,
            row.level_offset,
            row.rays,
            row.mray_per_s,
            row.heights_per_ray,
            row.extremes_per_ray,
            row.checked,
            row.wrong,
            row.inside_margin,
            row.dark_share
        );
    }
    text
}
