#!/usr/bin/env bash
# Everything that must hold before a change lands, in one command; the hosted run calls this, too.
# Usage: ./ci.sh            all steps, in order
#        ./ci.sh STEP...    only these: setup fmt clippy doc test fuzz proofs faults attack timing certify,
#                           and on demand: coverage mutants
set -euo pipefail
cd "$(dirname "$0")"
export CARGO_TERM_COLOR="${CARGO_TERM_COLOR:-auto}"

step_setup() { # Debian packages the later steps need
    local missing=()
    command -v cc >/dev/null || missing+=(gcc libc6-dev)
    command -v nm >/dev/null || missing+=(binutils)
    command -v valgrind >/dev/null || missing+=(valgrind)
    command -v c++ >/dev/null || missing+=(g++)
    command -v zip >/dev/null || missing+=(zip)
    command -v unzip >/dev/null || missing+=(unzip)
    if ((${#missing[@]})); then
        local sudo=""
        [ "$(id -u)" -eq 0 ] || sudo=sudo
        $sudo apt-get update -q
        $sudo env DEBIAN_FRONTEND=noninteractive apt-get install -qy --no-install-recommends "${missing[@]}"
    fi
    cargo fmt --version >/dev/null 2>&1 || rustup component add rustfmt
    cargo clippy --version >/dev/null 2>&1 || rustup component add clippy
    cargo fuzz --version >/dev/null 2>&1 || cargo install --quiet --locked cargo-fuzz --version 0.13.1
}

step_fmt() {
    cargo fmt --all --check
    cargo fmt --manifest-path verification/image/Cargo.toml --check
    cargo fmt --manifest-path verification/proofs/Cargo.toml --check
    cargo fmt --manifest-path fuzz/Cargo.toml --check
}

step_clippy() {
    cargo clippy --workspace --all-targets --quiet -- -D warnings
    # Wire formats and adapters without std.
    cargo clippy -p haltline-drives --no-default-features --quiet -- -D warnings
}

step_doc() {
    RUSTDOCFLAGS="-D warnings" cargo doc --workspace --no-deps --quiet
}

step_test() {
    # The kernel once more with overflow checks and debug assertions.
    cargo test --quiet -p haltline
    cargo test --workspace --release
}

step_fuzz() { # the fuzzing service's build script for real, then every corpus and a short search on every target
    local out target seeds cases runs
    out=$PWD/target/fuzz-out
    rm -rf "$out"
    mkdir -p "$out"
    OUT=$out .clusterfuzzlite/build.sh
    while read -r target runs; do
        seeds=$out/seeds/$target
        mkdir -p "$seeds"
        unzip -q "$out/${target}_seed_corpus.zip" -d "$seeds"
        cases=$(find "$seeds" -type f | wc -l)
        # A number of runs, no time: the same search on every machine. What the engine keeps goes into the first folder.
        "$out/$target" -seed=1 -runs=$((cases + runs)) -max_len=2048 "$seeds" >"$out/$target.log" 2>&1 \
            || { cat "$out/$target.log"; return 1; }
        echo "$target: $cases cases and a search: $(grep -h '^Done' "$out/$target.log" | tail -1)"
    done < <(cargo run --quiet --release -p haltline-fuzz-properties --bin corpus -- list --runs)
}

step_proofs() { # runs every proof again; says so if a tool cannot be had and only the ledger was compared
    cargo run --release --quiet -p haltline-verification -- prove --again
}

step_faults() { # an eighth of the seeded faults; which one follows from the commit, so that a rerun is the same
    local commit shard
    commit=$(git rev-parse HEAD)
    shard=$((16#${commit:0:7} % 8 + 1))
    echo "commit ${commit:0:7}: shard $shard of 8; all: cargo run --release -p haltline-verification -- faults"
    cargo run --release --quiet -p haltline-verification -- faults --shard "$shard/8"
}

step_attack() { # fixed numbers of runs: the same on every machine
    # Told less than the truth, the attacker must find it; told the truth, nothing.
    cargo test --release --quiet -p haltline-attack --test finds -- --include-ignored --nocapture --test-threads 1
    # Two terms are no settings: taken out of copies of the kernel.
    cargo run --release --quiet -p haltline-verification -- faults finds
    cargo run --release --quiet -- attack robots/seekur_jr.toml --break --strategy random --budget 1200 --out target/attack
}

step_timing() { # instruction counts; the machine's load does not matter
    cargo run --release --quiet -p haltline-verification -- timing
}

step_coverage() { # not among the steps of a change: writes verification/measured.json
    cargo run --release --quiet -p haltline-verification -- coverage
}

step_mutants() { # not among the steps of a change: hours for all; writes verification/measured.json
    cargo run --release --quiet -p haltline-verification -- mutants
}

step_certify() { # the main job, as a user runs it; twice, and the certificate must not change
    cargo run --release --quiet -- certify robots/seekur_jr.toml --out target/certify-1
    cargo run --release --quiet -- certify robots/seekur_jr.toml --out target/certify-2 >/dev/null
    for file in certificate.json junit.xml report.html; do
        cmp "target/certify-1/$file" "target/certify-2/$file"
    done
    echo "certificate, report and junit are byte-identical in two runs"
}

steps=("$@")
[ ${#steps[@]} -gt 0 ] || steps=(setup fmt clippy doc test fuzz proofs faults attack timing certify)
for step in "${steps[@]}"; do
    if ! declare -F "step_$step" >/dev/null; then
        echo "ci.sh: no step '$step'; the steps are: setup fmt clippy doc test fuzz proofs faults attack timing certify;" \
            "on demand: coverage mutants" >&2
        exit 2
    fi
    started=$SECONDS
    echo "== $step"
    "step_$step"
    echo "== $step: $((SECONDS - started)) s"
done
