#pragma once

#include <functional>
#include <vector>

namespace dlo::compare {

/// A function of one variable; infinite where it has no value.
using Function = std::function<double(double)>;

/// Equal steps over a range and what a function is there.
struct Scan {
  std::vector<double> x;
  std::vector<double> value;

  [[nodiscard]] std::size_t best() const;
  /// The least value is inside the range, not at an end.
  [[nodiscard]] bool is_bracketed() const;
};

[[nodiscard]] Scan scan(const Function& function, double low, double high, int steps);

struct Minimum {
  double x = 0;
  double value = 0;
};

/// GSL's Brent minimiser about the best point of a bracketed scan, to `tolerance` in x: it ends
/// where the step after a short one is below it, or the interval.
[[nodiscard]] Minimum minimum_near(const Function& function, const Scan& scan,
                                   double tolerance = 1e-7);

/// GSL's Brent root finder: where the function crosses `level` between `inside`, where it is below,
/// and `outside`, where it is above; to `tolerance` in x.
[[nodiscard]] double crossing(const Function& function, double inside, double outside, double level,
                              double tolerance = 1e-5);

}  // namespace dlo::compare
