//! The description at /v1/openapi.json against what the daemon does, and against the README.

use std::collections::BTreeSet;

use serde_json::{Value, json};

use crate::client::{Answer, ask};
use crate::daemon::{Daemon, Files};
use crate::schema::check;

const VIEW: &str = "camera=20,10,300000&size=32x18";
const README: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../README.md");

/// A question for each route: method, route, what is asked, status.
const QUESTIONS: &[(&str, &str, &str, &str)] = &[
    ("get", "/healthz", "/healthz", "200"),
    ("get", "/metrics", "/metrics", "200"),
    ("get", "/v1/openapi.json", "/v1/openapi.json", "200"),
    ("get", "/v1/attach", "/v1/attach", "default"),
    ("get", "/v1/planets", "/v1/planets", "200"),
    ("get", "/v1/planets/{name}", "/v1/planets/plane", "200"),
    ("get", "/v1/planets/{name}", "/v1/planets/none", "default"),
    ("get", "/v1/planets/{name}/render", "/v1/planets/globe/render?VIEW", "200"),
    ("get", "/v1/planets/{name}/render", "/v1/planets/globe/render?VIEW&stats=1", "200"),
    ("get", "/v1/planets/{name}/render", "/v1/planets/globe/render?VIEW&shadow=none&stats=1", "200"),
    ("get", "/v1/planets/{name}/render", "/v1/planets/globe/render?VIEW&format=jpeg", "200"),
    ("get", "/v1/planets/{name}/render", "/v1/planets/globe/render", "default"),
    ("get", "/v1/planets/{name}/mesh.glb", "/v1/planets/globe/mesh.glb?VIEW", "200"),
    ("get", "/v1/planets/{name}/shadow", "/v1/planets/globe/shadow?sun=1,2&level=1", "200"),
    ("get", "/v1/planets/{name}/shadow", "/v1/planets/globe/shadow?sun=1,2&level=1&format=tif", "200"),
    ("get", "/v1/planets/{name}/height", "/v1/planets/globe/height?lon=1&lat=2", "200"),
    ("get", "/v1/planets/{name}/height", "/v1/planets/plane/height?x=1500&y=2500", "200"),
    ("get", "/v1/planets/{name}/height", "/v1/planets/globe/height?lon=1", "default"),
    ("post", "/v1/planets/{name}/heights", "/v1/planets/globe/heights", "200"),
    ("get", "/v1/planets/{name}/distance", "/v1/planets/globe/distance?from=1,2&to=3,4", "200"),
];

/// Method and route of all that is described.
fn described(document: &Value) -> BTreeSet<(String, String)> {
    let paths = document["paths"].as_object().unwrap();
    let of = |(path, item): (&String, &Value)| {
        item.as_object().unwrap().keys().map(|method| (method.clone(), path.clone())).collect::<Vec<_>>()
    };
    paths.iter().flat_map(of).collect()
}

#[test]
fn answers_are_as_described() {
    let files = Files::new();
    let daemon = Daemon::start(&files, "");
    let document = daemon.get("/v1/openapi.json").json(200);
    assert_eq!(document["openapi"], "3.1.0");
    for &(method, route, target, status) in QUESTIONS {
        let target = target.replace("VIEW", VIEW);
        let body: &[u8] = if method == "post" { b"{\"points\":[[1,2],[3,4]]}" } else { b"" };
        let lines = ["Content-Type: application/json"];
        let answer = ask(daemon.address(), &method.to_uppercase(), &target, &lines, body);
        let response = &document["paths"][route][method]["responses"][status];
        fits(&document, response, &answer).unwrap_or_else(|error| panic!("{method} {target}: {error}"));
        assert_eq!(status == "200", answer.status == 200, "{method} {target}: {}", answer.text());
    }
    let asked = QUESTIONS.iter().map(|&(method, route, ..)| (method.to_owned(), route.to_owned()));
    assert_eq!(asked.collect::<BTreeSet<_>>(), described(&document), "each route is asked, and described");
}

/// Whether an answer is one of a described response.
fn fits(document: &Value, response: &Value, answer: &Answer) -> Result<(), String> {
    let kind = answer.header("content-type").ok_or("an answer without a type")?;
    response["description"].as_str().filter(|text| !text.is_empty()).ok_or("a response without words")?;
    let content = response["content"].get(kind).ok_or_else(|| format!("{kind} is not described: {response}"))?;
    match kind {
        "application/json" => {
            let value: Value = serde_json::from_slice(&answer.body).map_err(|error| error.to_string())?;
            check(document, content.get("schema").unwrap_or(&json!({})), &value)
        }
        _ => Ok(()),
    }
}

/// Routes that requests found, as the daemon counts them, are the described ones and the page.
#[test]
fn no_route_is_left_out() {
    let files = Files::new();
    let daemon = Daemon::start(&files, "");
    let document = daemon.get("/v1/openapi.json").json(200);
    let words = ["planets", "globe", "render", "mesh", "mesh.glb", "shadow", "mask", "height", "heights", "distance"];
    let ends = words.iter().chain(&["attach", "openapi.json", "metrics", "healthz", "page", "debug"]);
    for end in ends {
        for start in ["", "v1/", "v1/planets/", "v1/planets/globe/", "page/"] {
            ask(daemon.address(), "HEAD", &format!("/{start}{end}"), &[], b"");
        }
    }
    let metrics = daemon.get("/metrics").good().text();
    let route =
        |line: &str| Some(line.strip_prefix("relief_http_requests_total{route=\"")?.split_once('"')?.0.to_owned());
    let found: BTreeSet<String> = metrics.lines().filter_map(route).collect();
    let mut known: BTreeSet<String> = described(&document).into_iter().map(|(_, path)| path).collect();
    // That of the scrape is counted once it is answered.
    known.remove("/metrics");
    known.extend(["/page/{name}".to_owned(), "none".to_owned()]);
    let found: BTreeSet<String> = found.into_iter().filter(|route| route != "/metrics").collect();
    assert_eq!(found, known);
}

#[test]
fn every_parameter_says_what_it_is() {
    let files = Files::new();
    let daemon = Daemon::start(&files, "");
    let document = daemon.get("/v1/openapi.json").json(200);
    let mut count = 0;
    for (path, item) in document["paths"].as_object().unwrap() {
        for operation in item.as_object().unwrap().values() {
            assert!(operation["summary"].is_string(), "{path}");
            for parameter in operation["parameters"].as_array().into_iter().flatten() {
                assert!(parameter["description"].is_string() && parameter["schema"]["type"].is_string(), "{parameter}");
                count += 1;
            }
        }
    }
    assert!(count > 30, "{count}");
    let render = document["paths"]["/v1/planets/{name}/render"]["get"]["parameters"].clone();
    let named = |name: &str| render.as_array().unwrap().iter().find(|p| p["name"] == name).cloned().unwrap();
    assert_eq!(named("camera")["required"], true);
    assert_eq!(named("pixel_error")["schema"], json!({"type": "number", "default": 1}));
}

/// The table of endpoints in the README is that of the description.
#[test]
fn the_readme_names_every_route() {
    let files = Files::new();
    let daemon = Daemon::start(&files, "");
    let document = daemon.get("/v1/openapi.json").json(200);
    let readme = std::fs::read_to_string(README).unwrap();
    let row = |line: &str| {
        let (method, rest) = line.strip_prefix("| `")?.split_once(' ')?;
        let path = rest.split(['`', '?']).next()?;
        let full = match path.strip_prefix("…/") {
            Some(rest) => format!("/v1/planets/{{name}}/{rest}"),
            None => path.to_owned(),
        };
        matches!(method, "GET" | "POST").then(|| (method.to_ascii_lowercase(), full))
    };
    let mut rows: BTreeSet<(String, String)> = readme.lines().filter_map(row).collect();
    assert!(rows.remove(&("get".to_owned(), "/".to_owned())), "the page");
    assert_eq!(rows, described(&document));
}
