#pragma once

// GCC defines a macro for a sanitizer build, Clang a feature.
#if defined(__SANITIZE_ADDRESS__)
#define DLO_SANITIZED
#elif defined(__has_feature)
#if __has_feature(address_sanitizer)
#define DLO_SANITIZED
#endif
#endif

#include "helpers.hpp"

namespace dlo::test {

/// Whether this is a sanitizer build. Such a build checks code paths with fewer draws; the release
/// build runs the same tests with all draws, which the statistics need.
#if defined(DLO_SANITIZED)
inline constexpr bool sanitized = true;
#else
inline constexpr bool sanitized = false;
#endif

/// Returns the number of draws, or a count proportional to it: `all`, or a quarter in a sanitizer
/// build.
constexpr int draws(int all) { return sanitized ? all / 4 : all; }

}  // namespace dlo::test
