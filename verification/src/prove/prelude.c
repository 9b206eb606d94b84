/* Gives the translated wasm module its meaning for cbmc.
 *
 * The runner puts the sizes before this file and the module's functions after it. Memory is an
 * array of 32-bit words: the stack below STACK_BYTES, constant data from there on.
 * MODE_PROVE: a panic, a trap and an access out of bounds are failures.
 * MODE_COVER: they end the path; a cover that can be reached is a "failure", which is wanted.
 */
typedef unsigned char u8;
typedef signed char s8;
typedef unsigned short u16;
typedef short s16;
typedef unsigned int u32;
typedef int s32;
typedef unsigned long long u64;
typedef long long s64;
typedef float f32;
typedef double f64;
typedef struct instance { int none; } instance_t;
struct proof_instance;

u32 nondet_any_u32(void);
u64 nondet_any_u64(void);

static u32 stack_words[STACK_BYTES / 4];
static u32 w2c___stack_pointer = STACK_BYTES;
static u32 w2c___data_end = STACK_BYTES + DATA_BYTES;
static u32 w2c___heap_base = STACK_BYTES + DATA_BYTES;

#ifdef MODE_COVER
#define FAIL(text) __CPROVER_assume(0)
#define REQUIRE(condition, text) __CPROVER_assume(condition)
#else
#define FAIL(text) do { __CPROVER_assert(0, text); __CPROVER_assume(0); } while (0)
#define REQUIRE(condition, text) \
  do { __CPROVER_assert(condition, text); __CPROVER_assume(condition); } while (0)
#endif

/* Where a panic happened: read from the trace by the runner. */
static u32 panic_file, panic_length, panic_line;

static void Z_proofZ_panicked(struct proof_instance *none, u32 file, u32 length, u32 line) {
  /* Free variables, so that they are not folded away as constants. */
  panic_file = nondet_any_u32();
  panic_length = nondet_any_u32();
  panic_line = nondet_any_u32();
  __CPROVER_assume(panic_file == file && panic_length == length && panic_line == line);
  /* Never true; it keeps the three in the trace. */
  REQUIRE((panic_file & panic_length & panic_line) == ~0u, "panic");
  __CPROVER_assume(0);
}
static void Z_proofZ_assume(struct proof_instance *none, u32 condition) {
  __CPROVER_assume(condition != 0);
}
/* The runner lists the covers of all harnesses in COVERS as C(id). */
static void Z_proofZ_cover(struct proof_instance *none, u32 condition, u32 id) {
#ifdef MODE_COVER
#define C(known) if (id == known) __CPROVER_assert(condition == 0, "cover " #known);
  COVERS
#endif
}
static u32 Z_proofZ_nondet_u32(struct proof_instance *none) { return nondet_any_u32(); }
static u64 Z_proofZ_nondet_u64(struct proof_instance *none) { return nondet_any_u64(); }

#define INFINITY __builtin_inff()
#define FUNC_PROLOGUE
#define FUNC_EPILOGUE
static u32 trap(void) { FAIL("trap"); return 0; }
#define UNREACHABLE trap()
#define TRAP(x) trap()
#define UNLIKELY(x) (x)
#define LIKELY(x) (x)

static u32 word(u32 address) {
  REQUIRE((address & 3) == 0, "aligned");
  if (address < STACK_BYTES)
    return stack_words[address >> 2];
  REQUIRE(address < STACK_BYTES + DATA_BYTES, "in memory");
  return data_words[(address - STACK_BYTES) >> 2];
}
/* A load whose address has a constant part beyond the stack. */
static u32 constant(u32 address) {
  REQUIRE((address & 3) == 0, "aligned");
  REQUIRE(address >= STACK_BYTES && address < STACK_BYTES + DATA_BYTES, "in memory");
  return data_words[(address - STACK_BYTES) >> 2];
}
static void put_word(u32 address, u32 value) {
  REQUIRE((address & 3) == 0, "aligned");
  REQUIRE(address < STACK_BYTES, "store on the stack");
  stack_words[address >> 2] = value;
}
static u32 at(u64 address) {
  REQUIRE(address < STACK_BYTES + DATA_BYTES, "in memory");
  return (u32)address;
}
static u32 load8(u32 a) { return (word(a & ~3u) >> ((a & 3) * 8)) & 0xff; }
static u32 load16(u32 a) {
  REQUIRE((a & 1) == 0, "aligned");
  return (word(a & ~3u) >> ((a & 2) * 8)) & 0xffff;
}
/* Accesses that the compiler splits across words, at odd constant offsets. */
static u32 split_word(u32 a) {
  return load8(a) | load8(a + 1) << 8 | load8(a + 2) << 16 | load8(a + 3) << 24;
}
static u64 load64(u32 a) { return (u64)word(a) | (u64)word(a + 4) << 32; }
static void store8(u32 a, u32 v) {
  u32 shift = (a & 3) * 8, old = word(a & ~3u);
  put_word(a & ~3u, (old & ~(0xffu << shift)) | (v & 0xff) << shift);
}
static void store16(u32 a, u32 v) {
  u32 shift = (a & 2) * 8, old = word(a & ~3u);
  REQUIRE((a & 1) == 0, "aligned");
  put_word(a & ~3u, (old & ~(0xffffu << shift)) | (v & 0xffff) << shift);
}
static void split_put(u32 a, u32 v) {
  for (u32 i = 0; i < 4; i++) store8(a + i, v >> (8 * i));
}
static void store64(u32 a, u64 v) { put_word(a, (u32)v); put_word(a + 4, (u32)(v >> 32)); }

union bits32 { u32 i; f32 f; };
union bits64 { u64 i; f64 f; };
static f32 f32_reinterpret_i32(u32 i) { union bits32 b; b.i = i; return b.f; }
static u32 i32_reinterpret_f32(f32 f) { union bits32 b; b.f = f; return b.i; }
static f64 f64_reinterpret_i64(u64 i) { union bits64 b; b.i = i; return b.f; }
static u64 i64_reinterpret_f64(f64 f) { union bits64 b; b.f = f; return b.i; }

#define i32_load(m, a) word(at(a))
#define i64_load(m, a) load64(at(a))
#define f32_load(m, a) f32_reinterpret_i32(word(at(a)))
#define f64_load(m, a) f64_reinterpret_i64(load64(at(a)))
#define i32_load8_s(m, a) ((u32)(s32)(s8)load8(at(a)))
#define i64_load8_s(m, a) ((u64)(s64)(s8)load8(at(a)))
#define i32_load8_u(m, a) load8(at(a))
#define i64_load8_u(m, a) ((u64)load8(at(a)))
#define i32_load16_s(m, a) ((u32)(s32)(s16)load16(at(a)))
#define i64_load16_s(m, a) ((u64)(s64)(s16)load16(at(a)))
#define i32_load16_u(m, a) load16(at(a))
#define i64_load16_u(m, a) ((u64)load16(at(a)))
#define i64_load32_s(m, a) ((u64)(s64)(s32)word(at(a)))
#define i64_load32_u(m, a) ((u64)word(at(a)))
#define i32_store(m, a, v) put_word(at(a), v)
#define i64_store(m, a, v) store64(at(a), v)
#define f32_store(m, a, v) put_word(at(a), i32_reinterpret_f32(v))
#define f64_store(m, a, v) store64(at(a), i64_reinterpret_f64(v))
#define i32_load_split(m, a) split_word(at(a))
#define i64_load_split(m, a) ((u64)split_word(at(a)) | (u64)split_word(at(a) + 4) << 32)
#define i32_store_split(m, a, v) split_put(at(a), v)
#define i64_store_split(m, a, v) \
  do { split_put(at(a), (u32)(v)); split_put(at(a) + 4, (u32)((v) >> 32)); } while (0)
#define i32_store8(m, a, v) store8(at(a), v)
#define i32_store16(m, a, v) store16(at(a), v)
#define i64_store8(m, a, v) store8(at(a), (u32)(v))
#define i64_store16(m, a, v) store16(at(a), (u32)(v))
#define i64_store32(m, a, v) put_word(at(a), (u32)(v))

static u32 constant8(u32 a) { return (constant(a & ~3u) >> ((a & 3) * 8)) & 0xff; }
static u32 constant16(u32 a) {
  REQUIRE((a & 1) == 0, "aligned");
  return (constant(a & ~3u) >> ((a & 2) * 8)) & 0xffff;
}
static u64 constant64(u32 a) { return (u64)constant(a) | (u64)constant(a + 4) << 32; }
#define i32_constant(m, a) constant(at(a))
#define i64_constant(m, a) constant64(at(a))
#define f64_constant(m, a) f64_reinterpret_i64(constant64(at(a)))
#define i32_constant8_s(m, a) ((u32)(s32)(s8)constant8(at(a)))
#define i32_constant8_u(m, a) constant8(at(a))
#define i64_constant8_u(m, a) ((u64)constant8(at(a)))
#define i32_constant16_s(m, a) ((u32)(s32)(s16)constant16(at(a)))
#define i32_constant16_u(m, a) constant16(at(a))
#define i64_constant16_u(m, a) ((u64)constant16(at(a)))
#define i64_constant32_s(m, a) ((u64)(s64)(s32)constant(at(a)))
#define i64_constant32_u(m, a) ((u64)constant(at(a)))

/* Words as long as everything is aligned, then bytes. Lengths are constants in compiled code. */
static void copy_memory(u32 to, u32 from, u32 length) {
  if (to <= from) {
    u32 i = 0;
    if (((to | from) & 3) == 0)
      for (; i + 4 <= length; i += 4) put_word(to + i, word(from + i));
    for (; i < length; i++) store8(to + i, load8(from + i));
  } else {
    u32 i = length;
    if (((to | from) & 3) == 0) {
      for (; (i & 3) != 0; i--) store8(to + i - 1, load8(from + i - 1));
      for (; i > 0; i -= 4) put_word(to + i - 4, word(from + i - 4));
    }
    for (; i > 0; i--) store8(to + i - 1, load8(from + i - 1));
  }
}
static void fill_memory(u32 to, u32 value, u32 length) {
  u32 byte = value & 0xff, i = 0;
  if ((to & 3) == 0)
    for (; i + 4 <= length; i += 4) put_word(to + i, byte * 0x01010101u);
  for (; i < length; i++) store8(to + i, byte);
}
#define memory_copy(d, s, to, from, n) copy_memory(to, from, n)
#define memory_fill(m, to, v, n) fill_memory(to, v, n)

static u32 clz32(u32 x) {
  u32 n = 0;
  if (x == 0) return 32;
  if (!(x >> 16)) { n += 16; x <<= 16; }
  if (!(x >> 24)) { n += 8; x <<= 8; }
  if (!(x >> 28)) { n += 4; x <<= 4; }
  if (!(x >> 30)) { n += 2; x <<= 2; }
  if (!(x >> 31)) n += 1;
  return n;
}
static u64 clz64(u64 x) { return x >> 32 ? clz32((u32)(x >> 32)) : 32 + clz32((u32)x); }
#define I32_CLZ(x) clz32(x)
#define I64_CLZ(x) clz64(x)
static u32 ctz32(u32 x) { return x ? 31 - clz32(x & -x) : 32; }
#define I32_CTZ(x) ctz32(x)
#define I64_CTZ(x) ((u32)(x) ? (u64)ctz32((u32)(x)) : 32 + (u64)ctz32((u32)((u64)(x) >> 32)))

static u32 div_s32(u32 x, u32 y) {
  REQUIRE(y != 0 && !(x == 0x80000000u && y == ~0u), "division");
  return (u32)((s32)x / (s32)y);
}
static u32 rem_s32(u32 x, u32 y) {
  REQUIRE(y != 0, "division");
  return x == 0x80000000u && y == ~0u ? 0 : (u32)((s32)x % (s32)y);
}
static u64 div_s64(u64 x, u64 y) {
  REQUIRE(y != 0 && !(x == 0x8000000000000000ull && y == ~0ull), "division");
  return (u64)((s64)x / (s64)y);
}
static u64 rem_s64(u64 x, u64 y) {
  REQUIRE(y != 0, "division");
  return x == 0x8000000000000000ull && y == ~0ull ? 0 : (u64)((s64)x % (s64)y);
}
#define I32_DIV_S(x, y) div_s32(x, y)
#define I32_REM_S(x, y) rem_s32(x, y)
#define I64_DIV_S(x, y) div_s64(x, y)
#define I64_REM_S(x, y) rem_s64(x, y)
#define DIV_U(x, y) ((y) == 0 ? trap() : (x) / (y))
#define REM_U(x, y) ((y) == 0 ? trap() : (x) % (y))
#define ROTATE(x, left, right, mask) (((x) << ((left) & (mask))) | ((x) >> ((right) & (mask))))
#define I32_ROTL(x, y) ROTATE(x, y, 32 - (y), 31)
#define I64_ROTL(x, y) ROTATE(x, y, 64 - (y), 63)
#define I32_ROTR(x, y) ROTATE(x, 32 - (y), y, 31)
#define I64_ROTR(x, y) ROTATE(x, 64 - (y), y, 63)

#define I32_TRUNC_SAT_S_F64(x) \
  ((x) != (x) ? 0u : (x) <= -2147483649. ? 0x80000000u : (x) >= 2147483648. ? 0x7fffffffu : (u32)(s32)(x))
#define I64_TRUNC_SAT_S_F64(x) \
  ((x) != (x) ? 0ull : (x) < -9223372036854775808. ? 0x8000000000000000ull \
   : (x) >= 9223372036854775808. ? 0x7fffffffffffffffull : (u64)(s64)(x))
#define I32_TRUNC_SAT_U_F64(x) \
  ((x) != (x) || (x) <= -1. ? 0u : (x) >= 4294967296. ? ~0u : (u32)(x))
#define I64_TRUNC_S_F64(x) \
  ((x) >= -9223372036854775808. && (x) < 9223372036854775808. ? (u64)(s64)(x) : (u64)trap())
#define I32_TRUNC_S_F64(x) \
  ((x) > -2147483649. && (x) < 2147483648. ? (u32)(s32)(x) : trap())
static f64 wasm_quiet(f64 x) { return x; }
static f32 wasm_quietf(f32 x) { return x; }
static f64 wasm_fabs(f64 x) { return f64_reinterpret_i64(i64_reinterpret_f64(x) & ~(1ull << 63)); }
static f32 wasm_fabsf(f32 x) { return f32_reinterpret_i32(i32_reinterpret_f32(x) & ~(1u << 31)); }

/* 128-bit product, of which compiled code only asks whether 64 bits suffice. Where they do, the
 * result is exact; where they do not, the upper half is any value that says so. */
static void multiply_wide(u32 result, u64 a, u64 a_high, u64 b, u64 b_high) {
#ifdef COARSE
  /* Any product at all: what holds then holds for the true one, too. */
  store64(result, nondet_any_u64());
  store64(result + 8, nondet_any_u64());
  return;
#endif
  u64 low = a * b, high = nondet_any_u64();
  if (a_high == 0 && b_high == 0) {
    if (__CPROVER_overflow_mult(a, b))
      __CPROVER_assume(high != 0 && high != ~0ull);
    else
      high = 0;
  } else {
    u64 sign = (u64)((s64)low >> 63);
    REQUIRE(a_high == (u64)((s64)a >> 63) && b_high == (u64)((s64)b >> 63), "wide factor");
    if (__CPROVER_overflow_mult((s64)a, (s64)b))
      __CPROVER_assume(high != sign);
    else
      high = sign;
  }
  store64(result, low);
  store64(result + 8, high);
}
