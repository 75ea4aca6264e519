// Marks a plain loop function that the compiler shall vectorise.
#pragma once

// g++ 12 vectorises at -O2 only where that costs no code at all, so these functions ask for -O3.
// They are compiled for three instruction sets and the machine's best is picked at run time.
// Products and sums are never fused (-ffp-contract=off, repeated here because the attribute would
// reset it), so the result is the same bit for bit on every set and at every position in the array.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__)
#define DEX_VECTORIZED \
  __attribute__((optimize("O3", "fp-contract=off"), target_clones("default", "avx2", "avx512f")))
#else
#define DEX_VECTORIZED  // clang vectorises at -O2
#endif

// Before a loop whose iterations touch no element of another one.
#if defined(__clang__)
#define DEX_INDEPENDENT _Pragma("clang loop vectorize(assume_safety)")
#elif defined(__GNUC__)
#define DEX_INDEPENDENT _Pragma("GCC ivdep")
#else
#define DEX_INDEPENDENT
#endif
