#pragma once

// GCC has a macro for it, Clang a feature.
#if defined(__SANITIZE_ADDRESS__)
#define DLO_SANITIZED
#elif defined(__has_feature)
#if __has_feature(address_sanitizer)
#define DLO_SANITIZED
#endif
#endif

#include "helpers.hpp"

namespace dlo::test {

/// Whether this is a sanitizer build. What is counted there is paths, not draws: statistics are
/// proven by the release build, which runs the same tests in full.
#if defined(DLO_SANITIZED)
inline constexpr bool sanitized = true;
#else
inline constexpr bool sanitized = false;
#endif

/// How many of `all` draws are made, and a count that grows with them.
constexpr int draws(int all) { return sanitized ? all / 4 : all; }

}  // namespace dlo::test
