#pragma once

#include <map>
#include <optional>
#include <vector>

#include "polygon/scalar_search.hpp"

namespace dlo::compare {

/// Returns `count` equally spaced logarithms at which a profile is drawn, from half an interval's
/// width below the interval to as far above it. An interval that is open on a side is taken to end
/// there at a factor of two from `best`.
[[nodiscard]] std::vector<double> drawn_logarithms(const std::optional<double>& low, double best,
                                                   const std::optional<double>& high, int count);

/// A sum of squares as a function of the logarithm of a parameter: its minima, and the interval in
/// which it is below a level.
class LogProfile {
 public:
  /// Evaluates the function at multiples of a quarter of a decade, from 0 to both sides. The range
  /// from `low` to `high` is rounded outwards to such multiples. A side ends earlier if the
  /// function is above a hundred times its least value and has not decreased by more than 10 % per
  /// step over the last decade. Local minima up to a hundred times the least value are then
  /// refined.
  LogProfile(Function function, double low, double high);

  [[nodiscard]] const Minimum& minimum() const { return minimum_; }

  /// The outermost crossings of a level. A side is open if the function is below the level up to
  /// the end of the range, or is undefined beyond. An undefined value between values below and
  /// above the level counts as below.
  struct Interval {
    std::optional<double> low, high;
  };
  [[nodiscard]] Interval below(double level);

  /// Returns the local minima up to a level, also those at an end of the evaluated range, by
  /// growing parameter.
  [[nodiscard]] std::vector<Minimum> minima_below(double level) const;

 private:
  [[nodiscard]] double value_at(int step);
  [[nodiscard]] bool has_risen(int side) const;
  void search();
  void refine();
  [[nodiscard]] std::optional<double> outermost_crossing(double level, int side);

  Function function_;
  int first_, last_;          // range of steps from 0
  int left_ = 0, right_ = 0;  // range of steps evaluated so far
  std::map<double, double> values_;
  Minimum minimum_;
};

}  // namespace dlo::compare
