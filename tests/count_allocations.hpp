#pragma once

#include <cstddef>

#include "sanitized.hpp"

// The sanitizers bring an allocator of their own.
#if !defined(DLO_SANITIZED)
#define DLO_COUNTS_ALLOCATIONS

namespace dlo::test {

/// Number of calls of malloc() of this program. One source of a program may include this header.
inline long allocations = 0;

}  // namespace dlo::test

extern "C" {
// NOLINTNEXTLINE(bugprone-reserved-identifier): glibc's name
void* __libc_malloc(std::size_t size);

void* malloc(std::size_t size) {
  ++dlo::test::allocations;
  return __libc_malloc(size);
}
}
#endif
