//! The attributes of Kani's interface that the harnesses use.
//!
//! `#[kani::proof]` exports the function under its own name; the others mean something to the
//! runner, which reads them in the source, and nothing to the compiler.

use proc_macro::{TokenStream, TokenTree};

/// Exports a harness under its own name.
#[proc_macro_attribute]
pub fn proof(_: TokenStream, item: TokenStream) -> TokenStream {
    let mut out: TokenStream = TokenStream::new();
    let mut done = false;
    for token in item {
        let is_fn = matches!(&token, TokenTree::Ident(word) if word.to_string() == "fn");
        if is_fn && !done {
            done = true;
            let prefix: TokenStream = "pub extern \"C\"".parse().unwrap_or_default();
            out.extend(prefix);
        }
        out.extend([token]);
    }
    let mut exported: TokenStream = "#[unsafe(no_mangle)]".parse().unwrap_or_default();
    exported.extend(out);
    exported
}

/// How many times loops are unrolled; read by the runner.
#[proc_macro_attribute]
pub fn unwind(_: TokenStream, item: TokenStream) -> TokenStream {
    item
}

/// Which solver is used; read by the runner.
#[proc_macro_attribute]
pub fn solver(_: TokenStream, item: TokenStream) -> TokenStream {
    item
}

/// The harness is a false twin and must fail; read by the runner.
#[proc_macro_attribute]
pub fn should_panic(_: TokenStream, item: TokenStream) -> TokenStream {
    item
}
