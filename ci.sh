#!/usr/bin/env bash
# Everything that must hold before a change lands, in one command; the hosted run calls this, too.
# Usage: ./ci.sh            all steps, in order
#        ./ci.sh STEP...    only these: setup fmt clippy doc test proofs timing certify
set -euo pipefail
cd "$(dirname "$0")"
export CARGO_TERM_COLOR="${CARGO_TERM_COLOR:-auto}"

step_setup() { # Debian packages the later steps need
    local missing=()
    command -v cc >/dev/null || missing+=(gcc libc6-dev)
    command -v nm >/dev/null || missing+=(binutils)
    command -v valgrind >/dev/null || missing+=(valgrind)
    if ((${#missing[@]})); then
        local sudo=""
        [ "$(id -u)" -eq 0 ] || sudo=sudo
        $sudo apt-get update -q
        $sudo env DEBIAN_FRONTEND=noninteractive apt-get install -qy --no-install-recommends "${missing[@]}"
    fi
    cargo fmt --version >/dev/null 2>&1 || rustup component add rustfmt
    cargo clippy --version >/dev/null 2>&1 || rustup component add clippy
}

step_fmt() {
    cargo fmt --all --check
    cargo fmt --manifest-path verification/image/Cargo.toml --check
    cargo fmt --manifest-path verification/proofs/Cargo.toml --check
}

step_clippy() {
    cargo clippy --workspace --all-targets --quiet -- -D warnings
}

step_doc() {
    RUSTDOCFLAGS="-D warnings" cargo doc --workspace --no-deps --quiet
}

step_test() {
    # The kernel once more with overflow checks and debug assertions.
    cargo test --quiet -p haltline
    cargo test --workspace --release
}

step_proofs() { # no proof is run again here; the ledger must match the sources
    cargo run --release --quiet -p haltline-verification -- prove --check
}

step_timing() { # instruction counts; the machine's load does not matter
    cargo run --release --quiet -p haltline-verification -- timing
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
[ ${#steps[@]} -gt 0 ] || steps=(setup fmt clippy doc test proofs timing certify)
for step in "${steps[@]}"; do
    if ! declare -F "step_$step" >/dev/null; then
        echo "ci.sh: no step '$step'; the steps are: setup fmt clippy doc test proofs timing certify" >&2
        exit 2
    fi
    started=$SECONDS
    echo "== $step"
    "step_$step"
    echo "== $step: $((SECONDS - started)) s"
done
