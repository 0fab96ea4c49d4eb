#!/usr/bin/env bash
# From a fresh clone to the Earth: set up, build, bake, validate, picture.
set -euo pipefail

usage() {
  cat <<'TEXT'
usage: bash tools/demo.sh [--no-serve] [--out DIR] [--help]

Installs what is missing (tools/setup.sh), builds relief-bake, bakes the Earth from the ETOPO1
heights in tests/data, validates the result against them, draws a shaded picture, prints where
everything is, and serves the Earth to the browser until Ctrl-C.

  --out DIR    where the results go (default: out)
  --no-serve   do not serve it at the end

exit: 0 good, 1 the baked file failed its validation, 2 could not run
TEXT
}

fail() {
  printf 'demo: %s\n' "$1" >&2
  exit 2
}

caller=$PWD
out=
serve=true
while (($# > 0)); do
  case "$1" in
    -h | --help) usage; exit 0 ;;
    --no-serve) serve=false ;;
    --out)
      [[ -n ${2-} ]] || fail '--out needs a folder (see --help)'
      out=$2
      shift
      ;;
    *) fail "unknown argument $1 (see --help)" ;;
  esac
  shift
done

cd "$(dirname "${BASH_SOURCE[0]}")/.."
root=$PWD
case "$out" in
  '') out=$root/out ;;
  /*) ;;
  *) out=$caller/$out ;;
esac
readonly source=tests/data/earth_etopo1_6min.tif

step() { printf '\n==> %s\n' "$1"; }

step 'Set up'
bash tools/setup.sh
if ! command -v cargo >/dev/null; then
  export PATH="${HOME-}/.cargo/bin:$PATH"
fi

step 'Build relief-bake and reliefd (the first build takes minutes)'
cargo build --release --locked -p relief-tools -p reliefd --bins || fail 'the build failed; the compiler said why above'
bake=${CARGO_TARGET_DIR:-$root/target}/release/relief-bake
reliefd=${CARGO_TARGET_DIR:-$root/target}/release/reliefd

mkdir -p "$out" || fail "cannot make the folder $out; choose another with --out"
relief=$out/earth.relief
picture=$out/earth.png
view=$out/himalaya.png

step "Bake the Earth from $source"
"$bake" bake "$source" -o "$relief" --vertical egm96 --force || fail 'the bake failed; its message is above'

step 'Validate it, against the source too'
"$bake" validate "$relief" --against "$source" || {
  code=$?
  printf 'demo: the validation failed; its findings are above\n' >&2
  exit "$code"
}

step 'Draw it'
"$bake" preview "$relief" -o "$picture" --size 1440 || fail 'the preview failed; its message is above'

step 'Look at the Himalaya in the evening'
# Mesa complains on standard error where there is none.
export XDG_RUNTIME_DIR=${XDG_RUNTIME_DIR:-$out}
"$reliefd" render "$relief" --camera 85,19,600000,5,-38 --sun 4,15 --size 1280x720 --out "$view" ||
  fail 'the frame failed; its message is above'

quoted_bake=$(printf '%q' "$bake")
quoted_reliefd=$(printf '%q' "$reliefd")
quoted_relief=$(printf '%q' "$relief")
cat <<TEXT

The Earth is ready:
  $(printf '%10d bytes  %s' "$(stat -c %s "$relief")" "$relief")
  $(printf '%10d bytes  %s' "$(stat -c %s "$picture")" "$picture")
  $(printf '%10d bytes  %s' "$(stat -c %s "$view")" "$view")
  tools:            $bake
                    $reliefd

Try next:
  $quoted_bake inspect $quoted_relief                     what is in the file
  $quoted_bake probe $quoted_relief 86.925 27.988         the height of Everest
  $quoted_bake export $quoted_relief -o earth.glb         the patch mesh for a glTF viewer
  $quoted_bake bake YOUR.tif -o yours.relief              your own heights
  $quoted_reliefd render $quoted_relief --camera 7.6,45.2,60000,0,-20 --sun 80,10 --out alps.png
  $quoted_reliefd report $quoted_relief -o report         speed against error, a page
  $quoted_reliefd serve $quoted_relief                    a page that flies over it, and viewers of your own
  $quoted_bake --help                                     everything else
TEXT

if $serve; then
  # The usual port, or a free one where somebody listens there.
  listen=127.0.0.1:7878
  if (exec 3<>/dev/tcp/127.0.0.1/7878) 2>/dev/null; then listen=auto; fi
  step 'Serve it: open the address in a browser; Ctrl-C ends'
  exec "$reliefd" serve "$relief" --listen "$listen"
fi
