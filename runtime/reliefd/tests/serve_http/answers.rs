//! Good questions: the answers are those of the commands and of the file itself.

use geographiclib_rs::{DirectGeodesic as _, Geodesic};
use relief_formats::body::Body;
use relief_formats::file::Relief;
use relief_formats::surface::{Place, Surface};
use relief_tests::png::decode;
use relief_tests::sample_file::Sample;
use serde_json::{Value, json};

use crate::client::ask;
use crate::daemon::{Daemon, Files, read, run};

const VIEW: &str = "camera=20,10,300000,30,-25&fov=50&size=160x90&sun=60,10";
const VIEW_FLAGS: &str = "--camera 20,10,300000,30,-25 --fov 50 --size 160x90 --sun 60,10";

#[test]
fn planets_are_described() {
    let files = Files::new();
    let daemon = Daemon::start(&files, "");
    let all = daemon.get("/v1/planets").json(200);
    let names: Vec<&Value> = all.as_array().unwrap().iter().map(|planet| &planet["name"]).collect();
    assert_eq!(names, ["globe", "plane"]);
    for planet in all.as_array().unwrap() {
        let name = planet["name"].as_str().unwrap();
        assert_eq!(&daemon.get(&format!("/v1/planets/{name}")).json(200), planet);
    }
    assert_eq!((&all[0]["m"], &all[0]["plane"], &all[0]["a_m"]), (&json!(9), &json!(false), &json!(6_378_137.0)));
    assert_eq!(all[1]["bounds"], json!([1000.0, 2000.0, 8680.0, 9680.0]));
}

#[test]
fn heights_are_those_of_the_file() {
    let files = Files::new();
    let daemon = Daemon::start(&files, "");
    let globe = Relief::open(&files.path("globe.relief")).unwrap();
    let surface = Surface::new(&globe, 1 << 20);
    for (lon, lat, level) in [(86.925, 27.988, 0), (-180.0, 90.0, 1), (540.25, -45.5, 0), (0.0, 0.0, 1)] {
        let found = daemon.get(&format!("/v1/planets/globe/height?lon={lon}&lat={lat}&level={level}")).json(200);
        let known = surface.sample(&Place::from_deg(globe.grid(), level, lon, lat).unwrap()).unwrap();
        assert_eq!(found["height_m"].as_f64(), Some(known.height_m));
        assert_eq!((&found["level"], &found["filled"]), (&json!(level), &json!(known.filled)));
        assert_eq!(found["bounds_m"], json!(known.bounds_m));
        let ecef_m: Vec<f64> = found["ecef_m"].as_array().unwrap().iter().map(|x| x.as_f64().unwrap()).collect();
        let radius_m = ecef_m.iter().map(|x| x * x).sum::<f64>().sqrt();
        assert!((6.35e6..6.39e6).contains(&radius_m), "{radius_m}");
    }
    let plane = Relief::open(&files.path("plane.relief")).unwrap();
    let surface = Surface::new(&plane, 1 << 20);
    let found = daemon.get("/v1/planets/plane/height?x=2345.6&y=6543.2").json(200);
    let known = surface.sample(&Place::from_xy(plane.body(), plane.grid(), 0, 2345.6, 6543.2).unwrap()).unwrap();
    assert_eq!(found["height_m"].as_f64(), Some(known.height_m));
    assert_eq!(found.get("ecef_m"), None);
}

#[test]
fn many_heights_come_in_the_order_of_their_points() {
    let files = Files::new();
    let daemon = Daemon::start(&files, "");
    let globe = Relief::open(&files.path("globe.relief")).unwrap();
    let surface = Surface::new(&globe, 1 << 20);
    let points: Vec<[f64; 2]> = (0..5000)
        .map(|k| f64::from(k) * 0.618_034)
        .map(|k| [k * 360.0 % 360.0 - 180.0, k * 37.0 % 180.0 - 90.0])
        .collect();
    let body = json!({"points": points, "level": 0}).to_string();
    let found = daemon.post("/v1/planets/globe/heights", &body).json(200);
    let known = points.iter().map(|&[x, y]| Place::from_deg(globe.grid(), 0, x, y).unwrap());
    let known: Vec<f64> = known.map(|place| surface.height_m(&place).unwrap()).collect();
    assert_eq!(found["heights_m"], json!(known));
    assert_eq!(found["filled"].as_array().map(Vec::len), Some(points.len()));
    let none = daemon.post("/v1/planets/globe/heights", r#"{"points":[]}"#).json(200);
    assert_eq!(none["heights_m"], json!([]));
}

#[test]
fn distances_are_geodesics() {
    let files = Files::new();
    let daemon = Daemon::start(&files, "");
    // GeographicLib's own example: Wellington to Salamanca.
    let found = daemon.get("/v1/planets/globe/distance?from=174.81,-41.32&to=-5.50,40.96").json(200);
    let number = |name: &str| found[name].as_f64().unwrap();
    assert!((number("distance_m") - 19_959_679.267_353_82).abs() < 1e-6, "{found}");
    assert!((number("azimuth_from_deg") - 161.067_669_986_16).abs() < 1e-9, "{found}");
    assert!((number("azimuth_to_deg") - 18.825_195_123_25).abs() < 1e-9, "{found}");
    let (lat, lon): (f64, f64) =
        Geodesic::wgs84().direct(-41.32, 174.81, number("azimuth_from_deg"), number("distance_m"));
    assert!((lat - 40.96).abs() < 1e-9 && (lon + 5.5).abs() < 1e-9);
    let turned = daemon.get("/v1/planets/globe/distance?from=534.81,-41.32&to=-5.50,40.96").json(200);
    assert!((turned["distance_m"].as_f64().unwrap() - number("distance_m")).abs() < 1e-6);
    let flat = daemon.get("/v1/planets/plane/distance?from=1000,2000&to=1300,1600").json(200);
    assert_eq!((&flat["distance_m"], flat["azimuth_from_deg"].as_f64().unwrap().round()), (&json!(500.0), 143.0));
}

#[test]
fn pictures_are_those_of_render() {
    let files = Files::new();
    let daemon = Daemon::start(&files, "");
    let words = format!("render DIR/globe.relief --backend cpu {VIEW_FLAGS} --out DIR/a.png --mesh DIR/a.glb");
    assert_eq!(run(&files, &words).0, 0);
    let (width, height, 3, known) = decode(&read(&files.path("a.png"))) else { panic!("not RGB") };
    let answer = daemon.get(&format!("/v1/planets/globe/render?{VIEW}")).good();
    assert_eq!(answer.header("content-type"), Some("image/png"));
    assert_eq!(answer.header("x-relief-complete"), Some("true"));
    assert_eq!(answer.header("x-relief-sun"), Some("60.000000,10.000000"));
    let (w, h, 4, found) = decode(&answer.body) else { panic!("not RGBA") };
    assert_eq!((w, h), (width, height));
    assert!(known.as_chunks::<3>().0.iter().zip(found.as_chunks::<4>().0).all(|(a, b)| a == &b[..3] && b[3] == 255));
    let mesh = daemon.get(&format!("/v1/planets/globe/mesh.glb?{VIEW}")).good();
    assert_eq!(mesh.header("content-type"), Some("model/gltf-binary"));
    assert_eq!(mesh.header("x-relief-triangles"), answer.header("x-relief-triangles"));
    assert!(mesh.body == read(&files.path("a.glb")), "another mesh than render's");
    let figures = daemon.get(&format!("/v1/planets/globe/render?{VIEW}&stats=1")).json(200);
    assert_eq!(figures["stats"]["triangles"].to_string(), answer.header("x-relief-triangles").unwrap());
    assert_eq!((&figures["complete"], &figures["sun"]), (&json!(true), &json!([60.0, 10.0])));
}

#[test]
fn pictures_are_packed_as_asked() {
    let files = Files::new();
    let daemon = Daemon::start(&files, "");
    let jpeg = |answer: &crate::client::Answer| answer.body.starts_with(b"\xff\xd8");
    let target = format!("/v1/planets/globe/render?{VIEW}");
    let best = daemon.get(&format!("{target}&format=jpeg&quality=95")).good();
    let small = daemon.get(&format!("{target}&format=jpeg&quality=10")).good();
    assert!(jpeg(&best) && jpeg(&small) && small.body.len() < best.body.len());
    let accepted = |accept: &str| ask(daemon.address(), "GET", &target, &[accept], b"").good();
    let wanted = accepted("Accept: image/jpeg");
    assert!(jpeg(&wanted) && wanted.header("content-type") == Some("image/jpeg"));
    assert!(!jpeg(&accepted("Accept: */*")));
    // Both ways to write a name of two words.
    let coarse = |name: &str| daemon.get(&format!("{target}&{name}=9")).good();
    assert_eq!(coarse("pixel_error").body, coarse("pixel-error").body);
    assert_ne!(coarse("pixel_error").header("x-relief-triangles"), wanted.header("x-relief-triangles"));
    let plane = daemon.get("/v1/planets/plane/render?camera=4840,5840,3000&size=64x48&sun=135,12&soft=1&overlay=lod");
    assert_eq!(decode(&plane.good().body).0, 64);
}

#[test]
fn masks_are_those_of_mask() {
    let files = Files::new();
    let daemon = Daemon::start(&files, "");
    let words = "mask DIR/globe.relief --backend cpu --sun 60,10 --window -20,-30,40,50 --soft -o DIR/a";
    for ending in ["tif", "png"] {
        assert_eq!(run(&files, &format!("{words}.{ending}")).0, 0);
        let target = format!("/v1/planets/globe/shadow?sun=60,10&window=-20,-30,40,50&soft=1&format={ending}");
        let answer = daemon.get(&target).good();
        assert!(answer.body == read(&files.path(&format!("a.{ending}"))), "another {ending} than mask's");
        assert_eq!(answer.header("x-relief-geotransform").unwrap().split(',').count(), 6);
    }
    let at = daemon.get("/v1/planets/globe/shadow?time=2026-06-21T12:00:00Z&level=1").good();
    let (width, height, 1, lit) = decode(&at.body) else { panic!("not grey") };
    assert_eq!((width, height), (512, 257));
    let share = lit.iter().map(|&lit| f64::from(lit)).sum::<f64>() / 255.0 / lit.len() as f64;
    assert!((share - at.header("x-relief-lit").unwrap().parse::<f64>().unwrap()).abs() < 1e-6);
    assert!((0.2..0.8).contains(&share), "{share}");
    for (name, words) in [("whole", "--sun 90,20"), ("soft", "--sun 200,8 --soft"), ("air", "--sun 45,3 --air 1")] {
        assert_eq!(run(&files, &format!("mask DIR/plane.relief --backend cpu {words} -o DIR/{name}.png")).0, 0);
        let query = words.replace(" --soft", "&soft=1").replace(" --air ", "&air=").replace("--sun ", "sun=");
        let plane = daemon.get(&format!("/v1/planets/plane/shadow?{query}")).good();
        assert_eq!((decode(&plane.body).0, decode(&plane.body).1), (256, 256));
        assert!(plane.body == read(&files.path(&format!("{name}.png"))), "another {name} mask than mask's");
    }
}

/// Tiles that are not at hand come in turns of their own.
#[test]
fn masks_wait_for_their_tiles() {
    let files = Files::new();
    Sample::new(Body::moon(), 10).write(&files.path("moon.relief"));
    let words = "serve DIR/moon.relief --backend cpu --listen auto --headless --time-budget 1";
    let daemon = Daemon::spawn(files.command(words));
    let answer = daemon.get("/v1/planets/moon/shadow?sun=90,-1.5").good();
    assert_eq!(run(&files, "mask DIR/moon.relief --backend cpu --sun 90,-1.5 -o DIR/a.png").0, 0);
    assert!(answer.body == read(&files.path("a.png")), "another mask than mask's");
}
