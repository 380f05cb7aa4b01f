#include "polygon/scalar_search.hpp"

#include <gsl/gsl_errno.h>
#include <gsl/gsl_min.h>
#include <gsl/gsl_roots.h>

#include <algorithm>
#include <cmath>
#include <exception>
#include <limits>

#include "base/gsl.hpp"

namespace dlo::compare {
namespace {

/// Arguments of the callback for GSL, which no exception may cross.
struct GslCallback {
  const Function* function;
  double level = 0;
  double last_argument = 0;
  std::exception_ptr error = nullptr;
};

double call_for_gsl(double x, void* data) {
  GslCallback& watched = *static_cast<GslCallback*>(data);
  watched.last_argument = x;
  try {
    if (!watched.error) return (*watched.function)(x)-watched.level;
  } catch (...) {
    watched.error = std::current_exception();
  }
  return std::numeric_limits<double>::infinity();
}

}  // namespace

std::size_t Scan::best() const {
  return static_cast<std::size_t>(std::min_element(value.begin(), value.end()) - value.begin());
}

bool Scan::is_bracketed() const { return best() > 0 && best() + 1 < x.size(); }

Scan scan(const Function& function, double low, double high, int steps) {
  Scan result;
  for (int i = 0; i <= steps; ++i) {
    result.x.push_back(low + (high - low) / steps * i);
    result.value.push_back(function(result.x.back()));
  }
  return result;
}

Minimum minimum_near(const Function& function, const Scan& scan, double tolerance) {
  const std::size_t best = scan.best();
  Minimum result{scan.x[best], scan.value[best]};
  // The first of several equal values is the best, and it may be an end.
  if (!scan.is_bracketed()) return result;
  silence_gsl();
  GslCallback watched{&function};
  gsl_function gsl{call_for_gsl, &watched};
  const auto minimiser =
      gsl_owned(gsl_min_fminimizer_alloc(gsl_min_fminimizer_brent), gsl_min_fminimizer_free);
  // GSL stops at a value that is not finite; the best point of the scan is then returned.
  if (gsl_min_fminimizer_set_with_values(minimiser.get(), &gsl, result.x, result.value,
                                         scan.x[best - 1], scan.value[best - 1], scan.x[best + 1],
                                         scan.value[best + 1]) != GSL_SUCCESS) {
    return result;
  }
  // One end of the interval often does not move. After a short step, the length of the next step
  // measures the remaining distance from the minimum. A step of GSL's minimum length gives no such
  // measure, since GSL substitutes it for a step that left the interval.
  constexpr double short_step = 1e-3;
  const double least_step = 2 * std::sqrt(std::numeric_limits<double>::epsilon());
  bool was_short = false;
  for (int i = 0; i < 100; ++i) {
    const double before = gsl_min_fminimizer_x_minimum(minimiser.get());
    if (gsl_min_fminimizer_iterate(minimiser.get()) != GSL_SUCCESS) break;
    const double step = std::abs(watched.last_argument - before);
    if (was_short && step < tolerance) break;
    was_short = step < short_step && step > least_step * std::abs(before);
    if (gsl_min_test_interval(gsl_min_fminimizer_x_lower(minimiser.get()),
                              gsl_min_fminimizer_x_upper(minimiser.get()), tolerance,
                              0) == GSL_SUCCESS) {
      break;
    }
  }
  if (watched.error) std::rethrow_exception(watched.error);
  return {gsl_min_fminimizer_x_minimum(minimiser.get()),
          gsl_min_fminimizer_f_minimum(minimiser.get())};
}

double find_crossing(const Function& function, double inside, double outside, double level,
                     double tolerance) {
  silence_gsl();
  // Brent's method interpolates, so infinite values are replaced by large ones.
  const Function finite = [&](double x) {
    const double value = function(x);
    return std::isfinite(value) ? value : 1e3 * level + 1e3;
  };
  GslCallback watched{&finite, level};
  gsl_function gsl{call_for_gsl, &watched};
  const auto solver =
      gsl_owned(gsl_root_fsolver_alloc(gsl_root_fsolver_brent), gsl_root_fsolver_free);
  if (gsl_root_fsolver_set(solver.get(), &gsl, std::min(inside, outside),
                           std::max(inside, outside)) != GSL_SUCCESS) {
    return outside;
  }
  for (int i = 0; i < 60; ++i) {
    if (gsl_root_fsolver_iterate(solver.get()) != GSL_SUCCESS) break;
    if (gsl_root_test_interval(gsl_root_fsolver_x_lower(solver.get()),
                               gsl_root_fsolver_x_upper(solver.get()), tolerance,
                               0) == GSL_SUCCESS) {
      break;
    }
  }
  if (watched.error) std::rethrow_exception(watched.error);
  return gsl_root_fsolver_root(solver.get());
}

}  // namespace dlo::compare
