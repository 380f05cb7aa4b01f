#pragma once

#include <algorithm>
#include <cstddef>
#include <memory>
#include <vector>

namespace dlo::energy_model {

/// Objects whose buffers are used again once nobody holds them any more.
template <typename T>
class Pool {
 public:
  /// One that nobody holds and that fits; where there is none a new one or, of a full pool, any.
  /// @param fits  const T& -> bool: its buffers have the size that is wanted
  template <typename Fits>
  [[nodiscard]] std::shared_ptr<T> take(const Fits& fits) {
    const auto is_unused = [](const auto& kept) { return kept.use_count() == 1; };
    auto unused = std::find_if(kept_.begin(), kept_.end(),
                               [&](const auto& kept) { return is_unused(kept) && fits(*kept); });
    const bool full = kept_.size() >= most_kept;
    if (unused == kept_.end() && full) unused = std::find_if(kept_.begin(), kept_.end(), is_unused);
    if (unused != kept_.end()) return *unused;
    auto made = std::make_shared<T>();
    if (!full) kept_.push_back(made);
    return made;
  }

 private:
  static constexpr std::size_t most_kept = 8;

  std::vector<std::shared_ptr<T>> kept_;
};

}  // namespace dlo::energy_model
