
#include <gsl/gsl_errno.h>
#include <gsl/gsl_odeiv2.h>

#include <cmath>
#include <numeric>

#include "base/gsl.hpp"

namespace dlo::energy_model {

bool integrate(int (*rates)(double, const double*, double*, void*), void* data, double length,
               double tolerance, std::vector<double>& y) {
  constexpr int most_steps = 20000;
  silence_gsl();
  const std::size_t size = y.size();
  gsl_odeiv2_system system{rates, nullptr, size, data};
  const auto step =
      gsl_owned(gsl_odeiv2_step_alloc(gsl_odeiv2_step_rk8pd, size), gsl_odeiv2_step_free);
  const auto control =
      gsl_owned(gsl_odeiv2_control_y_new(tolerance, tolerance), gsl_odeiv2_control_free);
  const auto evolve = gsl_owned(gsl_odeiv2_evolve_alloc(size), gsl_odeiv2_evolve_free);
  double s = 0;
  double h = length / 4;
  for (int i = 0; i < most_steps && s < length; ++i) {
    if (gsl_odeiv2_evolve_apply(evolve.get(), control.get(), step.get(), &system, &s, length, &h,
                                y.data()) != GSL_SUCCESS) {
      return false;
    }
  }
  return s >= length && std::isfinite(std::accumulate(y.begin(), y.end(), 0.0));
}

}  // namespace dlo::energy_model
