#!/usr/bin/env bash
# Sets up, builds and runs every test; a later step runs even when an earlier one failed.
set -euo pipefail

usage() {
  cat <<'TEXT'
usage: bash tools/test.sh [--help]

Installs what is missing (tools/setup.sh), builds the workspace, runs the Rust tests, the Python
tests and those of the daemon's page in Chromium, and closes with a summary. Tests that need a GPU
run on Mesa's lavapipe; screenshots of the page are kept in target/web-screenshots.

RELIEF_PYTHON names the Python that has numpy, osgeo, websockets and zstandard (default: found by trying).

exit: 0 all passed, 1 a test failed, 2 could not run
TEXT
}

case "${1-}" in
  '') ;;
  -h | --help) usage; exit 0 ;;
  *) printf 'test: unknown argument %s (see --help)\n' "$1" >&2; exit 2 ;;
esac

cd "$(dirname "${BASH_SOURCE[0]}")/.."
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT

failures=()
timings=()

# Runs one step, keeps its output, notes its time and whether it failed.
step() {
  local name=$1 begin=$SECONDS status=0
  shift
  printf '\n==> %s\n' "$name"
  "$@" 2>&1 | tee "$scratch/$name.log" || status=${PIPESTATUS[0]}
  timings+=("$(printf '%-12s %4d s' "$name" $((SECONDS - begin)))")
  if ((status != 0)); then
    failures+=("$name (exit $status)")
  fi
  return "$status"
}

# Sums the numbers that a pattern's first group captures in a log.
total() {
  local log=$scratch/$1.log
  [[ -f $log ]] || { echo 0; return; }
  sed -nE "s/$2/\\1/p" "$log" | awk '{ sum += $1 } END { print sum + 0 }'
}

# The page in a browser; without --test the file's own summary counts each test.
test_web() {
  (cd tests/web && npm ci --no-audit --no-fund && node --test-reporter=tap page.test.js)
}

find_python() {
  local candidate
  for candidate in "${RELIEF_PYTHON-}" /usr/bin/python3 python3; do
    if [[ -n $candidate ]] && "$candidate" -c 'import numpy, osgeo.gdal, websockets, zstandard' 2>/dev/null; then
      printf '%s\n' "$candidate"
      return
    fi
  done
  return 1
}

bash tools/setup.sh
if ! command -v cargo >/dev/null; then
  export PATH="${HOME-}/.cargo/bin:$PATH"
fi
RELIEF_PYTHON=$(find_python) || {
  printf 'test: no Python has numpy, osgeo, websockets and zstandard; name one in RELIEF_PYTHON\n' >&2
  exit 2
}
export RELIEF_PYTHON
export PYTHONDONTWRITEBYTECODE=1
export CARGO_TERM_COLOR=never # the summary reads what cargo prints

# Software Vulkan where there is no GPU, so that the same tests run everywhere.
lavapipe=/usr/share/vulkan/icd.d/lvp_icd.$(uname -m).json
if [[ -z ${VK_ICD_FILENAMES-}${VK_DRIVER_FILES-} && -f $lavapipe ]]; then
  export VK_ICD_FILENAMES=$lavapipe VK_DRIVER_FILES=$lavapipe
fi

if step build cargo build --release --locked --workspace; then
  step rust cargo test --release --locked --workspace --no-fail-fast || true
fi
step python "$RELIEF_PYTHON" -m unittest discover -s tests/python -p 'test_*.py' || true
step web test_web || true

rust_result='^test result: .* ([0-9]+)'
passed=$(total rust "$rust_result passed;.*")
failed=$(total rust "$rust_result failed;.*")
skipped=$(total rust "$rust_result ignored;.*")
python_ran=$(total python '^Ran ([0-9]+) tests?.*')
python_failed=$(($(total python '^FAILED.*failures=([0-9]+).*') + $(total python '^FAILED.*errors=([0-9]+).*') +
  $(total python '^FAILED.*unexpected successes=([0-9]+).*')))
python_skipped=$(total python '^[OKFAILED]+ \(.*skipped=([0-9]+).*')
passed=$((passed + python_ran - python_failed - python_skipped + $(total web '^# pass ([0-9]+)$')))
failed=$((failed + python_failed + $(total web '^# fail ([0-9]+)$')))
skipped=$((skipped + python_skipped + $(total web '^# skipped ([0-9]+)$')))

printf '\n==> Summary\n'
printf '  %s\n' "${timings[@]}"
printf '  %-12s %4d s\n' all "$SECONDS"
printf '%d passed, %d failed, %d skipped\n' "$passed" "$failed" "$skipped"
if ((${#failures[@]} > 0)); then
  printf 'FAILED: %s\n' "${failures[@]}"
  exit 1
fi
if ((passed == 0)); then
  printf 'FAILED: no test ran\n'
  exit 1
fi
printf 'all passed\n'
