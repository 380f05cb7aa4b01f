#pragma once

#include <algorithm>
#include <cstddef>
#include <memory>
#include <vector>

namespace dlo::energy_model {

/// Pool of objects whose buffers are reused when no one else owns them.
template <typename T>
class Pool {
 public:
  /// Returns an unused object that fits. If there is none, returns a new object or, from a full
  /// pool, any unused one.
  /// @param fits  const T& -> bool: whether its buffers have the required size
  template <typename Fits>
  [[nodiscard]] std::shared_ptr<T> take(const Fits& fits) {
    const auto is_unused = [](const auto& kept) { return kept.use_count() == 1; };
    auto unused = std::ranges::find_if(
        kept_, [&](const auto& kept) { return is_unused(kept) && fits(*kept); });
    const bool full = kept_.size() >= most_kept;
    if (unused == kept_.end() && full) unused = std::ranges::find_if(kept_, is_unused);
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
