use std::path::Path;

use relief_formats::body::Body;
use relief_formats::surface::Surface;

use super::*;
use crate::cpu::Cpu;
use crate::frame::{Renderer as _, Scheme, Settings};
use crate::view::{Sun, View};
use relief_tests::sample_file::Sample;

fn planet(folder: &Path, body: Body) -> Arc<Planet> {
    let path = folder.join("p.relief");
    Sample::new(body, 9).write(&path);
    Planet::open(&path).unwrap()
}

fn small() -> Options {
    Options { size: [320, 180], thresholds_px: vec![1.0, 4.0], points: 3_000, rays: 400, checked: 200 }
}

#[test]
fn a_globe_is_measured_and_the_page_holds_what_was_found() {
    let folder = tempfile::tempdir().unwrap();
    let planet = planet(folder.path(), Body::earth());
    let report = run(&planet, "p.relief", &small(), &|_, _| {}).unwrap();
    assert_eq!(report.meshes.len(), 4 * (2 * 2 + 1));
    for row in &report.meshes {
        assert!(row.triangles > 0 && row.error.points > 100, "{row:?}");
        if row.scheme == "leb" {
            assert!(row.error.largest_px <= f64::from(row.threshold_px.unwrap()) * 1.01, "{row:?}");
        }
    }
    for row in report.shadows.iter().filter(|row| row.level_offset == 0) {
        assert!(row.wrong == 0 && row.checked == 200 && row.heights_per_ray > 0.0, "{row:?}");
    }
    let out = folder.path().join("report");
    write(&report, &out, false).unwrap();
    let page = std::fs::read_to_string(out.join("index.html")).unwrap();
    assert!(
        page.contains("p.relief") && page.contains("<svg") && !page.contains("=\"http://cdn") && !page.contains("src=")
    );
    assert_eq!(std::fs::read_to_string(out.join("meshes.csv")).unwrap().lines().count(), 21);
    assert!(write(&report, &out, false).is_err(), "nothing is replaced unasked");
}

#[test]
fn on_a_plane_the_papers_kernel_stands_beside_ours() {
    let folder = tempfile::tempdir().unwrap();
    let body = Body::Plane { crs_wkt: String::new(), x0: 0.0, y0: 0.0, dx: 90.0, dy: 90.0 };
    let report = run(&planet(folder.path(), body), "p.relief", &small(), &|_, _| {}).unwrap();
    let wrong = |kernel: &str| -> usize {
        let rows = report.shadows.iter().filter(|row| row.kernel == kernel && row.level_offset == 0);
        rows.map(|row| row.wrong).sum()
    };
    assert_eq!((wrong("exact"), wrong("sweep")), (0, 0));
    // What the paper gets wrong, the oracle notices.
    assert!(wrong(PAPER[0]) > 0, "{:?}", report.shadows);
    assert_eq!(report.shadows.iter().filter(|row| PAPER.contains(&row.kernel)).count(), 4 * 2 * 2);
}

#[test]
fn the_measure_notices_a_mesh_that_is_off() {
    let folder = tempfile::tempdir().unwrap();
    let planet = planet(folder.path(), Body::moon());
    let surface = Surface::new(planet.relief(), 16 << 20);
    let mut cpu = Cpu::new(Arc::clone(&planet), 256 << 20).unwrap();
    let camera = shots(&planet).unwrap()[1].camera;
    let view = View::new(camera, [320, 180], Sun::over(0.0, 0.0).unwrap());
    cpu.render_until_complete(&view, &Settings::default(), std::time::Duration::from_secs(20)).unwrap();
    let mut triangles = cpu.mesh(&view, Scheme::Leb).unwrap();
    let good = measure(&planet, &surface, &view, &triangles, 5_000).unwrap();
    assert!(good.largest_px <= 1.01, "{good:?}");
    for corner in triangles.iter_mut().flatten() {
        corner.height_m += 3_000.0;
    }
    let lifted = measure(&planet, &surface, &view, &triangles, 5_000).unwrap();
    assert!(lifted.largest_m > 2_000.0 && lifted.largest_px > 2.0, "{lifted:?}");
}
