#pragma once

#include <functional>
#include <vector>

namespace dlo::compare {

/// A function of one variable; infinite where it is undefined.
using Function = std::function<double(double)>;

/// Values of a function at equally spaced arguments.
struct Scan {
  std::vector<double> x;
  std::vector<double> value;

  [[nodiscard]] std::size_t best() const;
  /// Whether the least value is inside the range, not at an end.
  [[nodiscard]] bool is_bracketed() const;
};

[[nodiscard]] Scan scan(const Function& function, double low, double high, int steps);

struct Minimum {
  double x = 0;
  double value = 0;
};

/// Finds a minimum near the best point of a bracketed scan by GSL's Brent minimiser. The iteration
/// ends if the step after a short one, or the interval, is shorter than `tolerance` in x. Returns
/// the best point of a scan that is not bracketed, or next to whose best point the function is not
/// finite.
[[nodiscard]] Minimum minimum_near(const Function& function, const Scan& scan,
                                   double tolerance = 1e-7);

/// Finds the argument at which a function crosses `level`, to `tolerance`, by GSL's Brent root
/// finder. Returns `outside` if the function does not cross `level` between both arguments.
/// @param inside  where the function is below `level`
/// @param outside  where it is above
[[nodiscard]] double find_crossing(const Function& function, double inside, double outside,
                                   double level, double tolerance = 1e-5);

}  // namespace dlo::compare
