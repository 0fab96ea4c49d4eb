//! Puts each kernel together from its pieces, parses and validates it, and generates
//! `kernels.rs`: one constant with the source of each.
//!
//! A kernel is a file in `wgsl/`; pieces are files in `wgsl/lib/`. A line `// use: angle pages`
//! names the pieces a file needs; each comes once, before those who need it.

use std::error::Error;
use std::path::{Path, PathBuf};
use std::{env, fs};

use naga::valid::{Capabilities, ValidationFlags, Validator};

fn main() -> Result<(), Box<dyn Error>> {
    println!("cargo::rerun-if-changed=wgsl");
    let out = PathBuf::from(env::var("OUT_DIR")?);
    let mut kernels: Vec<PathBuf> =
        fs::read_dir("wgsl")?.map(|entry| entry.map(|e| e.path())).collect::<Result<_, _>>()?;
    kernels.retain(|path| path.extension().is_some_and(|e| e == "wgsl"));
    kernels.sort();
    let mut rust = String::new();
    let mut all = String::new();
    for path in kernels {
        let name = path.file_stem().and_then(|s| s.to_str()).ok_or("a kernel's name is not UTF-8")?.to_owned();
        let mut source = String::new();
        append(&path, &mut source, &mut Vec::new())?;
        validate(&source).map_err(|why| format!("{}:\n{why}", path.display()))?;
        fs::write(out.join(format!("{name}.wgsl")), &source)?;
        let constant = name.to_uppercase();
        rust += &format!(
            "/// `wgsl/{name}.wgsl` with its pieces.\npub const {constant}: &str = include_str!(concat!(env!(\"OUT_DIR\"), \"/{name}.wgsl\"));\n"
        );
        all += &format!("(\"{name}\", {constant}), ");
    }
    rust += &format!("/// All kernels: name and source.\npub const ALL: &[(&str, &str)] = &[{all}];\n");
    fs::write(out.join("kernels.rs"), rust)?;
    Ok(())
}

/// Appends a file after the pieces it uses.
fn append(path: &Path, source: &mut String, seen: &mut Vec<PathBuf>) -> Result<(), Box<dyn Error>> {
    if seen.iter().any(|p| p == path) {
        return Ok(());
    }
    seen.push(path.to_owned());
    let text = fs::read_to_string(path).map_err(|e| format!("{}: {e}", path.display()))?;
    for pieces in text.lines().filter_map(|line| line.strip_prefix("// use: ")) {
        for piece in pieces.split_whitespace() {
            append(&Path::new("wgsl/lib").join(format!("{piece}.wgsl")), source, seen)?;
        }
    }
    source.push_str(&text);
    source.push('\n');
    Ok(())
}

fn validate(source: &str) -> Result<(), String> {
    let module = naga::front::wgsl::parse_str(source).map_err(|e| e.emit_to_string(source))?;
    Validator::new(ValidationFlags::all(), Capabilities::default())
        .validate(&module)
        .map_err(|e| e.emit_to_string(source))?;
    Ok(())
}
