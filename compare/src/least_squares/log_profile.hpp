#pragma once

#include <map>
#include <optional>
#include <vector>

#include "polygon/scalar_search.hpp"

namespace dlo::compare {

/// Where a profile is drawn: `count` logarithms, equally spaced, from half an interval's width
/// below the interval to as far above; an open side goes to a factor of two from `best`.
[[nodiscard]] std::vector<double> drawn_logarithms(const std::optional<double>& low, double best,
                                                   const std::optional<double>& high, int count);

/// A sum of squares over the logarithm of a parameter: its minima, and where it is below a level.
class LogProfile {
 public:
  /// Looks at steps of a quarter of a decade from 0 to both sides, as far as `low` and `high`; a
  /// side ends before where the function has risen for a decade, to above a hundred times its
  /// least. Then at every local minimum among these that is not above that.
  LogProfile(Function function, double low, double high);

  [[nodiscard]] const Minimum& minimum() const { return minimum_; }

  /// The outermost crossings of a level; open where the function is below it as far as was
  /// searched, or has no values beyond. Where it has none between values below and above the level,
  /// it is taken to be below.
  struct Interval {
    std::optional<double> low, high;
  };
  [[nodiscard]] Interval below(double level);

  /// Local minima up to a level, the least among them, by growing parameter.
  [[nodiscard]] std::vector<Minimum> minima_below(double level) const;

 private:
  [[nodiscard]] double value_at(int step);
  [[nodiscard]] bool has_risen(int way) const;
  void search();
  void refine();
  [[nodiscard]] std::optional<double> outermost(double level, int way);

  Function function_;
  int first_, last_;          // steps from 0
  int left_ = 0, right_ = 0;  // reached so far
  std::map<double, double> values_;
  Minimum minimum_;
};

}  // namespace dlo::compare
