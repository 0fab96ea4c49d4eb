//! `relief-bake inspect` as a user runs it.

use crate::common::{Folder, Run, earth, plane, program};

#[test]
fn json_has_the_promised_keys_and_values() {
    let folder = Folder::new();
    let file = folder.sample("a.relief", &earth(9));
    let facts = relief_bake!("inspect", file, "--json").json(0);
    let mut keys: Vec<_> = facts.as_object().unwrap().keys().map(String::as_str).collect();
    keys.sort_unstable();
    assert_eq!(
        keys,
        [
            "body",
            "bound_m",
            "content_id",
            "file_bytes",
            "height",
            "levels",
            "m",
            "max_m",
            "min_m",
            "north_pole_m",
            "planes",
            "sources",
            "south_pole_m",
            "step_m",
            "tiles",
            "vertical",
            "width",
        ]
    );
    assert_eq!((&facts["m"], &facts["width"], &facts["height"]), (&9.into(), &1024.into(), &512.into()));
    assert_eq!((&facts["step_m"], &facts["bound_m"]), (&0.0625.into(), &0.031_25.into()));
    assert_eq!((&facts["levels"], &facts["tiles"]), (&2.into(), &10.into()));
    assert_eq!((&facts["south_pole_m"], &facts["north_pole_m"]), (&(-177.1875).into(), &264.25.into()));
    assert_eq!(facts["body"]["name"], "earth");
    assert_eq!(facts["body"]["a_m"], 6_378_137.0);
    assert_eq!(facts["file_bytes"], std::fs::metadata(&file).unwrap().len());
    assert_eq!(facts["content_id"].as_str().unwrap().len(), 64);
    assert_eq!(facts["sources"][0]["file"], "formula");
    // Ten tiles of 256 x 256 samples of 16 bits; the eight of level 0 have no mip plane.
    assert_eq!(facts["planes"]["nodes"]["raw_bytes"], 10 * 65536 * 2);
    assert_eq!(facts["planes"]["mip"]["raw_bytes"], 2 * 65536 * 2);
    for plane in ["nodes", "mip", "hext", "deviation", "filled"] {
        let bytes = facts["planes"][plane]["bytes"].as_u64().unwrap();
        assert!(bytes <= facts["file_bytes"].as_u64().unwrap(), "{plane}");
        assert_eq!(bytes == 0, plane == "filled", "{plane}");
    }
}

#[test]
fn a_plane_says_where_it_lies() {
    let folder = Folder::new();
    let file = folder.sample("a.relief", &plane(8));
    let body = &relief_bake!("inspect", file, "--json").json(0)["body"];
    assert_eq!((&body["name"], &body["x0"], &body["dy"]), (&"plane".into(), &500_000.0.into(), &20.0.into()));
    assert!(body["crs"].as_str().unwrap().contains("UTM zone 11N"));
    let text = relief_bake!("inspect", file).stdout;
    assert!(text.contains("WGS 84 / UTM zone 11N") && text.contains("256 x 256 nodes"), "{text}");
}

#[test]
fn text_names_units() {
    let folder = Folder::new();
    let file = folder.sample("a.relief", &earth(8));
    let run = relief_bake!("inspect", file);
    assert_eq!(run.code, 0);
    for words in ["earth, a = 6378137 m", "512 x 256 nodes", "-177.1875 m", "error at most 0.03125 m", "content id"] {
        assert!(run.stdout.contains(words), "{words:?} is not in: {}", run.stdout);
    }
}

#[test]
fn what_is_no_relief_file_is_refused() {
    let folder = Folder::new();
    relief_bake!("inspect", folder.path("missing.relief")).refused(&["missing.relief"]);
    std::fs::write(folder.path("b.relief"), "not a relief file, though it has this name").unwrap();
    relief_bake!("inspect", folder.path("b.relief")).refused(&["b.relief", "not a .relief file"]);
    let cut = folder.sample("c.relief", &earth(8));
    let bytes = std::fs::read(&cut).unwrap();
    std::fs::write(&cut, &bytes[..bytes.len() - 100]).unwrap();
    relief_bake!("inspect", cut).refused(&["c.relief", "damaged"]);
}

/// The exit code says it where standard error is closed, as in `relief-bake ... 2>&1 | head -0`.
#[test]
fn an_error_that_nobody_reads_is_no_panic() {
    let missing = Folder::new().path("none.relief");
    assert_eq!(Run::unheard(program().arg("inspect").arg(missing)), Some(2));
}
