# Every habitual command. `just` alone lists them; `just RECIPE` runs one.

set shell := ["bash", "-euo", "pipefail", "-c"]

python := env("RELIEF_PYTHON", "/usr/bin/python3")
bake := "cargo run --quiet --release --locked -p relief-tools --bin relief-bake --"

[private]
default:
    @just --list --unsorted

# Install what is missing (Debian packages), check Rust
setup:
    bash tools/setup.sh

# Build everything, optimised
build:
    cargo build --release --locked --workspace

# Bake, validate, picture and serve the Earth: just demo --out DIR
demo *arguments:
    bash tools/demo.sh {{ arguments }}

# Set up, build and run every test, as CI does
test:
    bash tools/test.sh

# Run the Rust tests whose name holds a word
test-one word:
    cargo test --release --locked --workspace {{ word }}

# Run relief-bake: just run probe out/earth.relief 86.925 27.988
run *arguments:
    @{{ bake }} {{ arguments }}

# Run reliefd: just view render out/earth.relief --camera 86.9,25.6,120000,0,-35 --out out/view.png
view *arguments:
    @cargo run --quiet --release --locked -p reliefd -- {{ arguments }}

# Serve a .relief file to the browser: just serve out/earth.relief
serve *arguments="out/earth.relief":
    @cargo run --quiet --release --locked -p reliefd -- serve {{ arguments }}

# Type-check everything, tests included
check:
    cargo check --release --locked --workspace --all-targets

# Format the Rust code
fmt:
    cargo fmt --all

# Formatting, clippy and the shell scripts, warnings as errors
lint:
    cargo fmt --all --check
    cargo clippy --release --locked --workspace --all-targets -- -D warnings
    if command -v shellcheck >/dev/null; then shellcheck tools/*.sh .ci/run; else echo 'lint: no shellcheck, scripts not checked'; fi

alias bench := bench-bake

# Measure meshes, shadows and frames beside their peers, write BENCHMARKS-RUNTIME.md and .json
bench-runtime *arguments:
    cargo build --release --locked -p relief-tools -p reliefd -p relief-runtime -p relief-shaders -p relief-formats --bins --examples
    {{ python }} tools/bench_runtime.py {{ arguments }}

# Measure the daemon with many viewers, write BENCHMARKS-SERVE.md and .json: just bench-serve --churn-minutes 10
bench-serve *arguments:
    cargo build --release --locked -p relief-tools -p reliefd -p relief-client --bins --examples
    {{ python }} tools/bench_serve.py {{ arguments }}

# Measure the bake against GDAL's own tools, write BENCHMARKS.md and .json: just bench-bake --quick
bench-bake *arguments:
    cargo build --release --locked -p relief-tools
    {{ python }} tools/bench_bake.py {{ arguments }}

# Fuzz the reader for some seconds (needs cargo-fuzz and a nightly Rust)
fuzz target="open_and_read" seconds="60":
    cd formats && cargo +nightly fuzz run {{ target }} -- -max_total_time={{ seconds }}

# Fuzz the protocol's parsers: to_server, envelope or mesh
fuzz-protocol target="to_server" seconds="60":
    cd runtime/protocol && cargo +nightly fuzz run {{ target }} -- -max_total_time={{ seconds }}

# Build the API documentation, warnings as errors
doc:
    RUSTDOCFLAGS='-D warnings' cargo doc --release --locked --workspace --no-deps

# Draw a .relief file as a PNG: just picture out/earth.relief out/earth.png
picture file="out/earth.relief" png="out/earth.png" size="1440":
    {{ bake }} preview {{ quote(file) }} -o {{ quote(png) }} --size {{ size }}

# Delete what was built and baked
clean:
    cargo clean
    rm -rf out
