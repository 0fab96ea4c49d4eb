use super::*;
use relief_tests::sample_file::Sample;

fn open(body: Body) -> Result<Arc<Planet>, OpenError> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("p.relief");
    Sample::new(body, 8).write(&path);
    Planet::open(&path)
}

#[test]
fn the_kernels_are_told_what_the_file_says() {
    let planet = open(Body::earth()).unwrap();
    let told = planet.uniform();
    assert_eq!((told.m, told.plane, told.root_level), (8, 0, 0));
    assert_eq!((told.a_m, told.b_m), (6_378_137.0, 6_356_752.5));
    assert!((f64::from(told.e2) - planet.ellipsoid().unwrap().e2()).abs() < 1e-9);
    assert_eq!(told.step_m, 1.0 / 16.0);
    assert!(told.min_m < told.max_m);
    assert!((planet.spacing_m() * 512.0 / (std::f64::consts::TAU * 6_378_137.0) - 1.0).abs() < 1e-12);
}

#[test]
fn a_plane_has_metres_in_a_unit() {
    let planet = open(Body::Plane { crs_wkt: String::new(), x0: 5.0, y0: 6.0, dx: 30.0, dy: 20.0 }).unwrap();
    let told = planet.uniform();
    let side = f64::from(1u32 << 31);
    assert_eq!(f64::from(told.unit_x_m) * side, 30.0 * 256.0);
    assert_eq!(f64::from(told.unit_y_m) * side, 20.0 * 256.0);
    assert_eq!(planet.spacing_m(), 20.0);
}

#[test]
fn what_cannot_be_viewed_is_refused() {
    assert!(matches!(Planet::open(Path::new("no such file")), Err(OpenError::File(FormatError::Io { .. }))));
    let huge = Body::Ellipsoid { name: "huge".into(), a_m: 1e13, b_m: 1e13 };
    assert!(matches!(open(huge), Err(OpenError::Range { .. })));
}
