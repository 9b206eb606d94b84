//! From compiled harnesses to C that cbmc reads: cargo → wasm → wasm2c → our prelude.

use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use super::tools::{ProveError, Tools, run};
use super::wasm::Data;

/// Stack of the module, bytes: small, so that it stays an array of single variables for cbmc.
const STACK_BYTES: u32 = 8192;
const PRELUDE: &str = include_str!("prelude.c");

/// The harnesses of one crate as C, and what their addresses mean.
#[derive(Clone, Debug)]
pub struct Translated {
    /// The C file without an entry point.
    pub file: PathBuf,
    /// The constants.
    pub data: Data,
}

/// Builds the harness crate `manifest` and translates it into `folder`.
///
/// # Errors
/// If a tool is missing or fails.
pub fn translate(tools: &Tools, manifest: &Path, folder: &Path) -> Result<Translated, ProveError> {
    let module = build(manifest, folder)?;
    let bytes = fs::read(&module).map_err(|error| ProveError::file(&module, error))?;
    let data = Data::of(&bytes)
        .filter(|data| data.bytes.is_empty() || data.start >= STACK_BYTES)
        .ok_or_else(|| ProveError::Words("the harness module has an unexpected form".into()))?;
    let raw = folder.join("module.c");
    run(Command::new(&tools.wasm2c)
        .args(["-n", "harness"])
        .arg(&module)
        .arg("-o")
        .arg(&raw))?;
    let text = fs::read_to_string(&raw).map_err(|error| ProveError::file(&raw, error))?;
    let file = folder.join("proofs.c");
    let whole = assembled(&text, &data)
        .ok_or_else(|| ProveError::Words("wasm2c wrote C of an unexpected form".into()))?;
    fs::write(&file, whole).map_err(|error| ProveError::file(&file, error))?;
    Ok(Translated { file, data })
}

fn build(manifest: &Path, folder: &Path) -> Result<PathBuf, ProveError> {
    let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    // Panics name their files from the root of the repository.
    let root = manifest.ancestors().nth(3).unwrap_or(manifest);
    let flags = format!(
        "-Clink-arg=-zstack-size={STACK_BYTES} --remap-path-prefix={}/=",
        root.display()
    );
    run(Command::new(cargo)
        .args(["build", "--release", "--quiet", "--locked"])
        .args(["--target", "wasm32-unknown-unknown", "--manifest-path"])
        .arg(manifest)
        .arg("--target-dir")
        .arg(folder.join("target"))
        .env_remove("CARGO_ENCODED_RUSTFLAGS")
        .env("RUSTFLAGS", flags))?;
    Ok(folder.join("target/wasm32-unknown-unknown/release/haltline_proofs.wasm"))
}

/// Our prelude, the constants, and the functions of the module without wasm2c's own runtime.
fn assembled(raw: &str, data: &Data) -> Option<String> {
    let size = data.bytes.len().next_multiple_of(4);
    let gap = if data.bytes.is_empty() {
        0
    } else {
        data.start - STACK_BYTES
    } as usize;
    let mut out = format!(
        "#define STACK_BYTES {STACK_BYTES}u\n#define DATA_BYTES {}u\n",
        gap + size
    );
    // Constant from the start: stores would have to be followed one by one.
    let mut words = vec![0_u32; (gap + size) / 4 + 1];
    for (slot, four) in words.iter_mut().skip(gap / 4).zip(data.bytes.chunks(4)) {
        let byte = |at: usize| u32::from(four.get(at).copied().unwrap_or(0));
        *slot = byte(0) | byte(1) << 8 | byte(2) << 16 | byte(3) << 24;
    }
    out.push_str("static const unsigned int data_words[] = {");
    for word in words {
        let _ = write!(out, "{word}u,");
    }
    out.push_str("};\n");
    out.push_str(PRELUDE);
    // Prototypes follow the table of function types, functions follow the tables' set-up.
    let prototypes = raw.split("static void init_func_types(void)").nth(1)?;
    let prototypes = prototypes
        .split_once("}\n")?
        .1
        .split("static void init_globals")
        .next()?;
    let bodies = raw.split("static void init_tables").nth(1)?;
    let bodies = bodies
        .split_once("}\n")?
        .1
        .split("/* export: 'memory' */")
        .next()?;
    for line in prototypes.lines().chain(bodies.lines()) {
        let line = line
            .replace("Z_harness_instance_t*", "instance_t*")
            .replace("instance->w2c___stack_pointer", "w2c___stack_pointer")
            .replace("instance->Z_proof_instance", "(struct proof_instance *)0")
            .replace("&instance->w2c_memory", "0");
        let line = access(line);
        out.push_str(&line);
        out.push('\n');
    }
    Some(renamed_multiply(&out))
}

/// Names a memory access for what its constant offset says about it: beyond the stack it reads a
/// constant, and an odd offset is an access that the compiler has split across words.
fn access(line: String) -> String {
    let offset = line.split_once("(0, (u64)(").and_then(|(_, rest)| {
        let (_, rest) = rest.split_once(") + ")?;
        let digits: String = rest.chars().take_while(char::is_ascii_digit).collect();
        digits.parse::<u32>().ok()
    });
    let Some(offset) = offset else {
        return line;
    };
    let whole = ["i32_load(", "i64_load(", "i32_store(", "i64_store("];
    if line.contains("_load") && offset >= STACK_BYTES {
        line.replacen("_load", "_constant", 1)
    } else if offset & 3 != 0 && whole.iter().any(|name| line.contains(name)) {
        line.replacen("(0, ", "_split(0, ", 1)
    } else {
        line
    }
}

/// The compiler's 128-bit multiply gets our model's body.
fn renamed_multiply(text: &str) -> String {
    let head = "static void w2c___multi3(instance_t* instance, u32 w2c_p0, u64 w2c_p1, u64 w2c_p2, u64 w2c_p3, u64 w2c_p4) {\n";
    let Some((before, rest)) = text.split_once(head) else {
        return text.to_owned();
    };
    let Some((_, after)) = rest.split_once("\n}\n") else {
        return text.to_owned();
    };
    format!("{before}{head}  multiply_wide(w2c_p0, w2c_p1, w2c_p2, w2c_p3, w2c_p4);\n}}\n{after}")
}
