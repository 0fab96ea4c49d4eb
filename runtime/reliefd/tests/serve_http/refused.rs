//! Bad questions: a status, and what is wrong in words.

use crate::client::ask;
use crate::daemon::{Daemon, Files};

/// A target under /v1/planets/, its status, its code, and words of the problem.
type Case = (&'static str, u16, &'static str, &'static str);

const CASES: &[Case] = &[
    ("mars", 404, "unknown", "globe, plane"),
    ("mars/height?lon=1&lat=1", 404, "unknown", "mars"),
    ("%ff/height?lon=1&lat=1", 400, "malformed", "UTF-8"),
    ("globe/nothing", 404, "unknown", "/v1/planets/globe/nothing"),
    ("globe/height", 400, "bad_view", "without a point"),
    ("globe/height?lon=1", 400, "bad_view", "lon alone"),
    ("globe/height?x=1&y=1", 400, "bad_view", "lon and lat"),
    ("plane/height?lon=1&lat=1", 400, "bad_view", "x and y"),
    ("plane/height?x=1&y=1", 400, "bad_view", "X 1"),
    ("globe/height?lon=1&lat=91", 400, "bad_view", "latitude 91"),
    ("globe/height?lon=nan&lat=1", 400, "bad_view", "longitude NaN"),
    ("globe/height?lon=inf&lat=1", 400, "bad_view", "longitude inf"),
    ("globe/height?lon=1&lat=1&level=9", 400, "bad_view", "0 (finest) to 1"),
    ("globe/height?lon=1&lat=1&level=-1", 400, "malformed", "level=-1"),
    ("globe/height?lon=1&lat=1&zoom=3", 400, "malformed", "the parameter zoom"),
    ("globe/height?lon=1&lat=1&lon=2", 400, "malformed", "lon twice"),
    ("globe/distance?from=1,2", 400, "malformed", "no to"),
    ("globe/distance?from=1,2&to=3", 400, "malformed", "to=3"),
    ("globe/distance?from=1,92&to=3,4", 400, "bad_view", "latitude 92"),
    ("globe/render", 400, "malformed", "no camera"),
    ("globe/render?camera=NaN,0,1000", 400, "malformed", "finite"),
    ("globe/render?camera=0,91,1000", 400, "bad_view", "latitude 91"),
    ("globe/render?camera=0,0,1000&size=0x5", 400, "malformed", "WIDTHxHEIGHT"),
    ("globe/render?camera=0,0,1000&size=99999x99999", 413, "too_large", "8388608 pixels"),
    ("globe/render?camera=0,0,1000&fov=0", 400, "bad_view", "field of view of 0"),
    ("globe/render?camera=0,0,1000&pixel_error=nan", 400, "bad_view", "pixel error of NaN"),
    ("globe/render?camera=0,0,1000&sun=0,95", 400, "bad_view", "sub-solar latitude of 95"),
    ("globe/render?camera=0,0,1000&sun=0,9&time=2026-06-21T00:00:00Z", 400, "malformed", "only one of them"),
    ("globe/render?camera=0,0,1000&shadow=paper", 400, "bad_view", "over a plane"),
    ("globe/render?camera=0,0,1000&scheme=other", 400, "malformed", "leb, paper"),
    ("globe/render?camera=0,0,1000&wait=1e9", 400, "malformed", "0 to 600 seconds"),
    ("globe/render?camera=0,0,1000&quality=0", 400, "malformed", "quality=0"),
    ("globe/render?camera=0,0,1000&format=gif", 400, "malformed", "png, jpeg"),
    ("globe/render?camera=0,0,1000&soft=maybe", 400, "malformed", "1 or 0"),
    ("globe/render?camera=0,0,1000&backend=cpu", 400, "malformed", "the parameter backend"),
    ("globe/render?camera=0,0,1000&out=x.png", 400, "malformed", "the parameter out"),
    ("plane/render?camera=4840,5840,3000&time=2026-06-21T00:00:00Z", 400, "bad_view", "time for a plane"),
    ("globe/mesh.glb?camera=0,0,300000,0,80&size=8x8", 400, "bad_view", "view of the sky"),
    ("globe/shadow", 400, "bad_view", "sun LON,LAT or time"),
    ("plane/shadow", 400, "bad_view", "sun AZIMUTH,ELEVATION"),
    ("globe/shadow?sun=0,0&level=3", 400, "bad_view", "0 (finest) to 1"),
    ("globe/shadow?sun=0,0&window=5,5,4,4", 400, "bad_view", "south"),
    ("globe/shadow?sun=0,0&window=0.01,0.01,0.02,0.02", 400, "bad_view", "at least one node"),
    ("globe/shadow?sun=0,0&air=-1", 400, "bad_view", "air -1"),
    ("globe/shadow?sun=0,0&format=bmp", 400, "malformed", "png, tif, aux"),
    ("globe/shadow?format=aux", 404, "unknown", "GeoTIFF says all"),
];

#[test]
fn what_cannot_be_answered_is_said() {
    let files = Files::new();
    let daemon = Daemon::start(&files, "");
    for &(target, status, code, words) in CASES {
        let problem = daemon.get(&format!("/v1/planets/{target}")).json(status);
        assert_eq!(problem["code"], code, "{target}: {problem}");
        let names: Vec<&String> = problem.as_object().unwrap().keys().collect();
        assert_eq!(names, ["code", "remedy", "rule", "what"], "{target}");
        let text = ["what", "rule", "remedy"].map(|name| problem[name].as_str().unwrap()).join("\n");
        assert!(text.contains(words), "{target}: {words:?} is not in {problem}");
        assert!(!text.contains("--") && !text.contains("\n\n"), "{target}: {problem}");
    }
    // Nothing of this was a fault of the daemon's.
    assert_eq!(daemon.get("/healthz").json(200)["status"], "good");
}

#[test]
fn bodies_are_checked() {
    let files = Files::new();
    let daemon = Daemon::start(&files, "");
    let many = |count: usize| format!("{{\"points\":[{}[0,0]]}}", "[0,0],".repeat(count - 1));
    let cases = [
        ("".to_owned(), 400, "malformed", "points"),
        ("{\"points\":[[0,0]]".to_owned(), 400, "malformed", "points"),
        ("{\"points\":[[0]]}".to_owned(), 400, "malformed", "points"),
        ("{\"points\":[[0,0]],\"levle\":1}".to_owned(), 400, "malformed", "levle"),
        ("{\"points\":[[0,0],[0,-90.5]]}".to_owned(), 400, "bad_view", "point 1: latitude -90.5"),
        ("{\"points\":[[0,0]],\"level\":7}".to_owned(), 400, "bad_view", "level 7"),
        (many(100_001), 413, "too_large", "100001 points"),
        (format!("{{\"points\":[{}]}}", " ".repeat(9 << 20)), 413, "too_large", "8388608 bytes"),
    ];
    for (body, status, code, words) in cases {
        let problem = daemon.post("/v1/planets/globe/heights", &body).json(status);
        let start = &body[..body.len().min(60)];
        assert!(problem["code"] == code && problem.to_string().contains(words), "{start}: {problem}");
    }
    let heights = daemon.post("/v1/planets/globe/heights", &many(100_000)).json(200);
    assert_eq!(heights["heights_m"].as_array().map(Vec::len), Some(100_000));
    let plain = ask(daemon.address(), "POST", "/v1/planets/globe/heights", &[], b"{\"points\":[]}").json(400);
    assert!(plain["rule"].as_str().unwrap().contains("application/json"), "{plain}");
}

#[test]
fn routes_and_methods_are_told_apart() {
    let files = Files::new();
    let daemon = Daemon::start(&files, "");
    for target in ["/v1", "/v2/planets", "/v1/planets/", "/nothing", "/v1/planets/globe/render/more"] {
        assert_eq!(daemon.get(target).json(404)["code"], "unknown", "{target}");
    }
    for (method, target) in [("POST", "/v1/planets"), ("DELETE", "/v1/planets/globe/heights"), ("PUT", "/healthz")] {
        let answer = ask(daemon.address(), method, target, &[], b"");
        assert!(answer.header("allow").is_some(), "{answer:?}");
        assert_eq!(answer.json(405)["code"], "malformed");
    }
    assert_eq!(daemon.get("/v1/attach").json(400)["code"], "malformed");
}
