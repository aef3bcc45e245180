// Plain loops that the compiler may turn into instructions of 256 bits.
#pragma once

// Before a function: it is compiled for AVX2, too, and the processor that runs it decides which of the two is called.
// Products and sums are not fused (-ffp-contract=off), so both give the same bits. For loops without branches over
// arrays, where Highway would say no more. Such a function is not inlined: it should take a block of pixels.
// tests/finish/same_pictures.sh compares pictures of both.
#if defined(__x86_64__) && defined(__gnu_linux__) && defined(__GNUC__) && !defined(__clang__) && \
    !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#define SCUMBLE_WIDE_LOOPS __attribute__((target_clones("avx2", "default")))
#else
#define SCUMBLE_WIDE_LOOPS
#endif
