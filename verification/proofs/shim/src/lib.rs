//! The part of Kani's interface that the harnesses use, for the engine that translates wasm to C.
//!
//! Every function is an import of the wasm module; the runner's C prelude gives it its meaning
//! (`verification/src/prove/prelude.c`). Under `cargo kani` the real crate takes this one's place.
#![no_std]

pub use haltline_kani_macros::{proof, should_panic, solver, unwind};

mod imports {
    #[link(wasm_import_module = "proof")]
    unsafe extern "C" {
        pub safe fn nondet_u32() -> u32;
        pub safe fn nondet_u64() -> u64;
        pub safe fn assume(condition: u32);
        pub safe fn cover(condition: u32, id: u32);
        pub safe fn panicked(file: *const u8, length: usize, line: u32) -> !;
    }
}

/// A type of which the solver may choose any value.
pub trait Arbitrary: Sized {
    /// Any value.
    fn any() -> Self;
}

/// Any value of a type.
#[must_use]
#[inline(always)]
pub fn any<T: Arbitrary>() -> T {
    T::any()
}

macro_rules! from_word {
    ($($name:ty),*) => { $(
        impl Arbitrary for $name {
            #[inline(always)]
            fn any() -> Self { imports::nondet_u32() as Self }
        }
    )* };
}
from_word!(u8, u16, u32, i8, i16, i32, usize, isize);

impl Arbitrary for u64 {
    #[inline(always)]
    fn any() -> Self {
        imports::nondet_u64()
    }
}

impl Arbitrary for i64 {
    #[inline(always)]
    fn any() -> Self {
        imports::nondet_u64() as Self
    }
}

impl Arbitrary for bool {
    #[inline(always)]
    fn any() -> Self {
        imports::nondet_u32() & 1 == 1
    }
}

impl Arbitrary for f32 {
    #[inline(always)]
    fn any() -> Self {
        Self::from_bits(any())
    }
}

impl Arbitrary for f64 {
    #[inline(always)]
    fn any() -> Self {
        Self::from_bits(any())
    }
}

/// Restricts what follows to values for which `condition` holds.
#[inline(always)]
pub fn assume(condition: bool) {
    imports::assume(u32::from(condition));
}

/// Reports that `condition` can be reached at the place `id`; use [`cover!`].
#[doc(hidden)]
#[inline(always)]
pub fn reached(condition: bool, id: u32) {
    imports::cover(u32::from(condition), id);
}

/// A number for a place in the sources; the runner computes the same one.
#[doc(hidden)]
#[must_use]
pub const fn place(file: &str, line: u32) -> u32 {
    let bytes = file.as_bytes();
    let (mut hash, mut index) = (0x811c_9dc5_u32, 0);
    while index < bytes.len() {
        hash = (hash ^ bytes[index] as u32).wrapping_mul(0x0100_0193);
        index += 1;
    }
    (hash ^ line).wrapping_mul(0x0100_0193)
}

/// Asks whether a condition can be reached at all; a proof whose cover cannot is vacuous.
#[macro_export]
macro_rules! cover {
    ($condition:expr $(, $text:literal)?) => {
        $crate::reached($condition, const { $crate::place(file!(), line!()) })
    };
}

#[cfg(target_arch = "wasm32")]
#[panic_handler]
fn panic(info: &core::panic::PanicInfo<'_>) -> ! {
    let (file, line) = info
        .location()
        .map_or(("", 0), |place| (place.file(), place.line()));
    imports::panicked(file.as_ptr(), file.len(), line)
}
