#pragma once

#include <tbb/task_arena.h>

#include <algorithm>

namespace dlo::compare {

/// Threads of a task arena: at most `threads`, or as many as the machine has for 0. oneTBB takes
/// more as well, with a warning on standard error.
inline int arena_threads(int threads) {
  const int available = tbb::this_task_arena::max_concurrency();
  return threads > 0 ? std::min(threads, available) : available;
}

}  // namespace dlo::compare
