#pragma once

#include "clearway/macros.hpp"

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define CLEARWAY_SANITIZED 1
#elif defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer)
#define CLEARWAY_SANITIZED 1
#endif
#endif

/// CLEARWAY_SIMD_CLONES compiles a function once per vector width and picks one at load time.
/// Contraction stays off in every clone, so all of them round alike.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && !defined(__CUDACC__) && \
    !defined(CLEARWAY_SANITIZED)
#define CLEARWAY_SIMD_CLONES __attribute__((target_clones("avx512f", "avx2", "default")))
#else
#define CLEARWAY_SIMD_CLONES
#endif

/// CLEARWAY_IN_CLONE marks an inline function that clones consist of, so that it is compiled into
/// each of them, whatever its size. On its own it would be compiled once, without their vectors.
#if defined(__GNUC__) && !defined(__CUDACC__)
#define CLEARWAY_IN_CLONE __attribute__((always_inline))
#else
#define CLEARWAY_IN_CLONE
#endif
