#pragma once

#include <mutex>
#include <utility>

#include "dlo/compare/progress.hpp"

namespace dlo::compare {

/// Counts the work that several threads have completed.
class ProgressCounter {
 public:
  ProgressCounter(Progress progress, std::int64_t total)
      : progress_(std::move(progress)), total_(total) {}

  void add_one() {
    if (!progress_) return;
    const std::scoped_lock lock(mutex_);
    ++done_;
    progress_(done_, total_);
  }

 private:
  Progress progress_;
  std::int64_t total_;
  std::mutex mutex_;
  std::int64_t done_ = 0;
};

}  // namespace dlo::compare
