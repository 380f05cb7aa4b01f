#pragma once

namespace dlo::test {

/// Whether this is a sanitizer build. What is counted there is paths, not draws: statistics are
/// proven by the release build, which runs the same tests in full.
#if defined(__SANITIZE_ADDRESS__)
inline constexpr bool sanitized = true;
#else
inline constexpr bool sanitized = false;
#endif

}  // namespace dlo::test
