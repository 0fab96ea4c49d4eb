//! Flags, environment, file and defaults: who counts most.

use crate::daemon::{Daemon, Files, run};

/// Where it listens, by the address that it prints.
fn listens(files: &Files, words: &str, environment: &[(&str, &str)]) -> String {
    let mut command = files.command(&format!("serve --backend cpu {words}"));
    command.envs(environment.iter().copied());
    let daemon = Daemon::spawn(command);
    daemon.address().split_once(':').unwrap().0.to_owned()
}

#[test]
fn flags_count_more_than_environment_and_file() {
    let files = Files::new();
    // Relative paths start at the file's folder.
    let text = "files = ['globe.relief']\nlisten = '127.0.0.2:0'\nheadless = true\nmax-viewers = 3\n";
    std::fs::write(files.path("reliefd.toml"), text).unwrap();
    let path = files.path("reliefd.toml").display().to_string();
    let environment = ("RELIEFD_LISTEN", "127.0.0.3:0");
    assert_eq!(listens(&files, "--config DIR/reliefd.toml", &[]), "127.0.0.2");
    assert_eq!(listens(&files, "", &[("RELIEFD_CONFIG", &path)]), "127.0.0.2");
    assert_eq!(listens(&files, "--config DIR/reliefd.toml", &[environment]), "127.0.0.3");
    assert_eq!(listens(&files, "--config DIR/reliefd.toml --listen 127.0.0.4:0", &[environment]), "127.0.0.4");
    assert_eq!(listens(&files, "DIR/plane.relief", &[environment, ("RELIEFD_HEADLESS", "1")]), "127.0.0.3");
}

#[test]
fn files_on_the_command_line_replace_those_of_the_file() {
    let files = Files::new();
    std::fs::write(files.path("a.toml"), "files = ['globe.relief']\nlisten = 'auto'\nbackend = 'cpu'\n").unwrap();
    let names = |words: &str| {
        let daemon = Daemon::spawn(files.command(words));
        let planets = daemon.get("/v1/planets").json(200);
        planets.as_array().unwrap().iter().map(|p| p["name"].as_str().unwrap().to_owned()).collect::<Vec<_>>()
    };
    assert_eq!(names("serve --config DIR/a.toml"), ["globe"]);
    assert_eq!(names("serve DIR/plane.relief --config DIR/a.toml"), ["plane"]);
}

#[test]
fn what_a_file_cannot_say_is_refused() {
    let files = Files::new();
    for (text, says) in [
        ("listne = 'auto'", "the key listne"),
        ("max-viewers = 'many'", "many"),
        ("listen = auto", "a.toml"),
        ("token-file = ''", "cannot read the token"),
    ] {
        std::fs::write(files.path("a.toml"), text).unwrap();
        let (code, log) = run(&files, "serve DIR/globe.relief --backend cpu --config DIR/a.toml");
        assert!(code == 2 && log.contains(says) && log.contains("remedy:"), "{text}: {code} {log}");
    }
    let (code, log) = run(&files, "serve DIR/globe.relief --config DIR/none.toml");
    assert!(code == 2 && log.contains("none.toml"), "{log}");
    let (code, log) = run(&files, "serve --help");
    assert!(code == 0, "{log}");
}

#[test]
fn the_log_is_text_or_json() {
    let files = Files::new();
    let daemon = Daemon::start(&files, "--log json");
    daemon.get("/v1/planets/none");
    daemon.signal("TERM");
    let (code, log) = daemon.ended();
    assert_eq!(code, 0);
    let lines: Vec<serde_json::Value> = log.lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    let refused = lines.iter().find(|line| line["message"] == "refused").unwrap();
    assert_eq!((&refused["status"], &refused["path"]), (&404.into(), &"/v1/planets/none".into()));
}
