//! Answers against heights in f64.

use relief_formats::body::Body;
use relief_formats::file::Relief;
use relief_formats::surface::{Place, Surface};
use relief_tests::folder::Folder;
use relief_tests::plane::plane;
use relief_tests::sample_file::{Sample, wavy_q};
use serde_json::Value;

use crate::program::{program, reliefd, with_input};

/// Backends to test: the GPU's too, unless `RELIEF_NO_GPU=1` says that there is none.
pub fn backends() -> Vec<&'static str> {
    match std::env::var_os("RELIEF_NO_GPU").is_some_and(|v| v == "1") {
        true => vec!["cpu"],
        false => vec!["cpu", "gpu"],
    }
}

#[test]
fn heights_are_those_of_the_surface() {
    let folder = Folder::new();
    let globe =
        folder.sample("globe.relief", &Sample { filled: |i, j| i < 300 && j < 200, ..Sample::new(Body::earth(), 9) });
    let plane = folder.sample("plane.relief", &plane(wavy_q));
    for (file, level) in [(&globe, 0), (&globe, 1), (&plane, 0)] {
        let relief = Relief::open(file).unwrap();
        let surface = Surface::new(&relief, 64 << 20);
        let scattered = |k: u32| [f64::from(k * 7919 % 1000) / 1000.0, f64::from(k * 104_729 % 997) / 997.0];
        let points: Vec<[f64; 2]> = (0..500)
            .map(scattered)
            .map(|[u, v]| match relief.grid().plane {
                true => [1000.0 + 7680.0 * u, 2000.0 + 7680.0 * v],
                false => [-540.0 + 1080.0 * u, -90.0 + 180.0 * v],
            })
            .chain((!relief.grid().plane).then_some([[180.0, 0.0], [0.0, 90.0], [12.0, -90.0]]).into_iter().flatten())
            .collect();
        let text: String = points.iter().map(|[x, y]| format!("{x} {y}\n")).collect();
        for backend in backends() {
            let run = with_input(&format!("probe FILE - --level {level} --backend {backend}"), file, &text).good();
            assert_eq!(run.stdout.lines().count(), points.len());
            for (line, &[x, y]) in run.stdout.lines().zip(&points) {
                let answer: Value = serde_json::from_str(line).unwrap();
                let place = match relief.grid().plane {
                    true => Place::from_xy(relief.body(), relief.grid(), level, x, y),
                    false => Place::from_deg(relief.grid(), level, x, y),
                };
                let sample = surface.sample(&place.unwrap()).unwrap();
                // Half a fixed-point unit of place on slopes of at most 0.2, and f32.
                let error_m = (answer["height_m"].as_f64().unwrap() - sample.height_m).abs();
                assert!(error_m < 2e-3, "{backend} {x} {y}: {line} against {}", sample.height_m);
                assert_eq!(answer["filled"], sample.filled);
                assert_eq!(answer["bounds_m"], serde_json::json!(sample.bounds_m));
                assert_eq!(answer["level"], level);
            }
        }
    }
}

/// A low and a high sun, over a globe and a plane.
#[test]
fn both_backends_see_the_same_sun() {
    let folder = Folder::new();
    let globe = folder.sample("globe.relief", &Sample::new(Body::moon(), 9));
    let plane = folder.sample("plane.relief", &plane(wavy_q));
    let count = 2000;
    for (file, sun) in [(&globe, "20,5"), (&globe, "-150,-70"), (&plane, "213,4"), (&plane, "100,30 --soft")] {
        let text: String = (0..count)
            .map(|k| [f64::from(k * 7919 % 1009) / 1009.0, f64::from(k * 104_729 % 997) / 997.0])
            .map(|[u, v]| match file == &plane {
                true => format!("{} {}\n", 1000.0 + 7680.0 * u, 2000.0 + 7680.0 * v),
                false => format!("{} {}\n", -180.0 + 360.0 * u, -90.0 + 180.0 * v),
            })
            .collect();
        let mut answers = backends().into_iter().map(|backend| {
            let run = with_input(&format!("probe FILE - --sun {sun} --backend {backend}"), file, &text).good();
            run.stdout.lines().map(|line| serde_json::from_str(line).unwrap()).collect::<Vec<Value>>()
        });
        let lit = |answer: &Value| answer["lit"].as_f64().unwrap();
        let cpu = answers.next().unwrap();
        let dark = cpu.iter().filter(|answer| lit(answer) == 0.0).count();
        assert!(cpu.len() == count as usize && (file == &plane || (500..1500).contains(&dark)), "{dark} dark");
        for gpu in answers {
            // A GPU's own arithmetic rounds rays that graze in its own way.
            let differ = cpu.iter().zip(&gpu).filter(|(a, b)| (lit(a) - lit(b)).abs() > 0.02).count();
            assert!(gpu.len() == cpu.len() && differ <= 2, "{sun}: {differ} points differ");
        }
    }
}

/// What was cut off is missed, by a message: reading it would raise SIGBUS.
#[cfg(target_os = "linux")]
#[test]
fn a_file_that_is_cut_while_it_is_read_ends_no_program() {
    use std::io::{BufRead as _, BufReader, Read as _, Write as _};
    use std::process::Stdio;

    let folder = Folder::new();
    let file = folder.sample("globe.relief", &Sample::new(Body::earth(), 11));
    let mut child = program()
        .args(["probe", "--backend", "cpu"])
        .args([file.as_os_str(), "-".as_ref()])
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let (mut questions, mut answers) = (child.stdin.take().unwrap(), BufReader::new(child.stdout.take().unwrap()));
    let mut line = String::new();
    questions.write_all(b"10 20\n").unwrap();
    answers.read_line(&mut line).unwrap();
    assert!(line.contains("height_m"), "{line}");
    let bytes = std::fs::metadata(&file).unwrap().len();
    std::fs::File::options().write(true).open(&file).unwrap().set_len(bytes / 4).unwrap();
    // Finer tiles lie behind the coarser ones, so some of these are gone.
    for lon in (-180..180).step_by(15) {
        questions.write_all(format!("{lon} 85\n{lon} 45\n{lon} -45\n").as_bytes()).unwrap();
    }
    drop(questions);
    let mut said = String::new();
    child.stderr.take().unwrap().read_to_string(&mut said).unwrap();
    assert_eq!(child.wait().unwrap().code(), Some(2), "{said}");
    assert!(said.contains("remedy"), "{said}");
}

#[test]
fn bad_lines_are_answered_in_their_place() {
    let folder = Folder::new();
    let file = folder.sample("globe.relief", &Sample::new(Body::moon(), 8));
    let run = with_input("probe FILE - --sun 0,0 --backend cpu", &file, "1 2\nx 2\n\n3,4\n5 95");
    assert_eq!(run.code, 1, "{}", run.stderr);
    let lines: Vec<Value> = run.stdout.lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    assert_eq!(lines.len(), 5);
    for (k, line) in lines.iter().enumerate() {
        match k {
            0 | 3 => assert!(line["height_m"].is_f64() && line["lit"] == 1.0, "{line}"),
            _ => assert_eq!(line["line"], k + 1, "{line}"),
        }
    }
    assert!(lines[4]["error"].as_str().unwrap().contains("latitude 95"));
}

#[test]
fn people_and_programs_are_answered() {
    let folder = Folder::new();
    let file = folder.sample("globe.relief", &Sample::new(Body::moon(), 8));
    let day = reliefd("probe FILE 10 20 --sun 10,20 --json --backend cpu", &file).json(0);
    let night = reliefd("probe FILE 10 20 --sun -170,-20 --json --backend cpu", &file).json(0);
    assert_eq!((&day["lit"], &night["lit"]), (&Value::from(1.0), &Value::from(0.0)));
    let dark = reliefd("probe FILE 10 20 --json --backend cpu", &file).json(0);
    assert!(dark.get("lit").is_none());
    let text = reliefd("probe FILE 10 20 --sun 10,20 --backend cpu", &file).good().stdout;
    assert!(text.contains("height") && text.contains("lit       100.0 %"), "{text}");
}
