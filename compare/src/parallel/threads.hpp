#pragma once

#include <tbb/task_arena.h>

#include <algorithm>
#include <stdexcept>
#include <system_error>
#include <typeinfo>

namespace dlo::compare {

/// Returns the number of threads of a task arena: at most `threads`, or all that are available for
/// 0. oneTBB accepts larger numbers too, but prints a warning to standard error.
inline int arena_threads(int threads) {
  const int available = tbb::this_task_arena::max_concurrency();
  return threads > 0 ? std::min(threads, available) : available;
}

/// Runs a function in an arena. If the system provides no more threads, oneTBB throws a plain
/// std::runtime_error. One that `function` itself throws is not distinguished from it.
/// @throws std::system_error instead of a plain std::runtime_error
template <typename Function>
void execute(tbb::task_arena& arena, const Function& function) {
  try {
    arena.execute(function);
  } catch (const std::runtime_error& error) {
    if (typeid(error) != typeid(std::runtime_error)) throw;
    throw std::system_error(std::make_error_code(std::errc::resource_unavailable_try_again),
                            "a worker thread");
  }
}

}  // namespace dlo::compare
