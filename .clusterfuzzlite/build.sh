#!/usr/bin/env bash
# Builds every fuzz target into $OUT, each with its seed corpus, as ClusterFuzzLite and OSS-Fuzz expect it.
# Also run by `./ci.sh fuzz` with a folder of its own as $OUT.
set -euo pipefail
: "${OUT:?a folder for the targets}"
cd "$(dirname "$(readlink -f "$0")")"
[ -d fuzz ] || cd .. # beside the project's folder in the image, inside it elsewhere
[ -d fuzz ] || cd "$SRC/haltline"

corpus() { cargo run --quiet --release -p haltline-fuzz-properties --bin corpus -- "$@"; }

cargo fuzz build -O --sanitizer "${SANITIZER:-none}"
built=fuzz/target/x86_64-unknown-linux-gnu/release
seeds=$(mktemp -d)
trap 'rm -rf "$seeds"' EXIT
for target in $(corpus list); do
    # Nothing ends up in $OUT that was built before.
    rm -f "$OUT/$target" "$OUT/${target}_seed_corpus.zip"
    cp "$built/$target" "$OUT/$target"
    corpus unpack "$target" "$seeds/$target"
    (cd "$seeds/$target" && zip --quiet --recurse-paths "$OUT/${target}_seed_corpus.zip" .)
    printf '[libfuzzer]\nmax_len = 8192\n' >"$OUT/$target.options"
done
