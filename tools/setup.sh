#!/usr/bin/env bash
# Installs what building and testing relief needs on Debian 12, and nothing that is there already.
set -euo pipefail

usage() {
  cat <<'TEXT'
usage: bash tools/setup.sh [--help]

Installs the Debian packages that relief needs to build and to test, without a prompt, as root
or through sudo. Does nothing when they are all there. Checks that Rust 1.90 or later is there;
it does not install Rust.

exit: 0 ready, 2 something is missing that this script cannot install
TEXT
}

case "${1-}" in
  '') ;;
  -h | --help) usage; exit 0 ;;
  *) printf 'setup: unknown argument %s (see --help)\n' "$1" >&2; exit 2 ;;
esac

readonly rust_needed=1.90
packages=(
  build-essential pkg-config          # the C compiler for zstd, and the way to find GDAL
  libgdal-dev gdal-bin proj-data      # rasters in and out, the EGM96 geoid
  libvulkan1 mesa-vulkan-drivers      # lavapipe, a GPU in software
  python3 python3-numpy python3-gdal  # the oracles of the tests
  python3-zstandard                   # the second reader of the tests
  python3-websockets                  # the viewer in Python
  geographiclib-tools                 # CartConvert, the oracle for ECEF
  chromium                            # the browser of the page's tests
)
# A newer Node from elsewhere does, too.
command -v node >/dev/null && command -v npm >/dev/null || packages+=(nodejs npm)
readonly packages

fail() {
  printf 'setup: %s\n' "$1" >&2
  exit 2
}

is_installed() {
  [[ $(dpkg-query -W -f='${db:Status-Status}' "$1" 2>/dev/null) == installed ]]
}

has_apt() { command -v dpkg-query >/dev/null && command -v apt-get >/dev/null; }
has_apt ||
  fail "this is not Debian; install the counterparts of: ${packages[*]}"

missing=()
for package in "${packages[@]}"; do
  is_installed "$package" || missing+=("$package")
done

if ((${#missing[@]} > 0)); then
  if ((EUID == 0)); then
    as_root=(env)
  elif command -v sudo >/dev/null; then
    as_root=(sudo env)
    [[ -t 0 ]] || as_root=(sudo -n env)
  else
    fail "neither root nor sudo; as root run: apt-get install ${missing[*]}"
  fi
  as_root+=(DEBIAN_FRONTEND=noninteractive)
  apt=(apt-get -q -o Dpkg::Use-Pty=0 -o DPkg::Lock::Timeout=120)
  printf 'setup: installing %s\n' "${missing[*]}"
  "${as_root[@]}" "${apt[@]}" update ||
    fail "apt-get update failed; check the network and the package sources, or install by hand: ${missing[*]}"
  "${as_root[@]}" "${apt[@]}" install -y --no-install-recommends "${missing[@]}" </dev/null ||
    fail "apt-get could not install: ${missing[*]}"
fi

# rustup's folder is not on the PATH of a shell that was open before Rust was installed.
if ! command -v cargo >/dev/null && [[ -x ${HOME-}/.cargo/bin/cargo ]]; then
  export PATH="$HOME/.cargo/bin:$PATH"
fi
has_rust() { command -v cargo >/dev/null && command -v rustc >/dev/null; }
has_rust ||
  fail "Rust is missing; install Rust $rust_needed or later with rustup (https://rustup.rs), then run this again"

rust_found=$(rustc --version | sed -n 's/^rustc \([0-9.]*\).*/\1/p')
[[ -n $rust_found ]] || fail "cannot read the version that rustc --version prints; reinstall Rust with rustup (https://rustup.rs)"
[[ $(printf '%s\n' "$rust_needed" "$rust_found" | sort -V | head -n 1) == "$rust_needed" ]] ||
  fail "Rust $rust_found is too old, $rust_needed or later is needed; run: rustup update stable"

if ((${#missing[@]} > 0)); then
  printf 'setup: ready (Rust %s)\n' "$rust_found"
else
  printf 'setup: all is there (Rust %s), nothing to do\n' "$rust_found"
fi
