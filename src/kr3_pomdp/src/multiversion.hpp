#pragma once

/// Marks a function that is compiled for several instruction sets; the one that the machine has is
/// taken when the program starts. A macro, because only some compilers and machines know the
/// attribute; sanitizers are not ready when the choice is made. Sums keep their order in all
/// versions (with -ffp-contract=off), so results do not depend on the machine.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && \
    !defined(__SANITIZE_THREAD__) && !defined(__SANITIZE_ADDRESS__)
#define KR3_POMDP_MULTIVERSION [[gnu::target_clones("avx512f", "avx2", "default")]]
#else
#define KR3_POMDP_MULTIVERSION
#endif
