#include "base/integrate.hpp"

#include <gsl/gsl_errno.h>
#include <gsl/gsl_odeiv2.h>

#include <cmath>
#include <memory>

#include "base/silence_gsl.hpp"

namespace dlo::energy_model {
namespace {

constexpr int most_integrator_steps = 20000;

template <class T, void (*release)(T*)>
struct Release {
  void operator()(T* pointer) const { release(pointer); }
};
template <class T, void (*release)(T*)>
using Owned = std::unique_ptr<T, Release<T, release>>;

}  // namespace

bool integrate(int (*rates)(double, const double*, double*, void*), void* data, double length,
               double tolerance, std::vector<double>& y) {
  silence_gsl();
  const std::size_t size = y.size();
  gsl_odeiv2_system system{rates, nullptr, size, data};
  const Owned<gsl_odeiv2_step, gsl_odeiv2_step_free> step(
      gsl_odeiv2_step_alloc(gsl_odeiv2_step_rk8pd, size));
  const Owned<gsl_odeiv2_control, gsl_odeiv2_control_free> control(
      gsl_odeiv2_control_y_new(tolerance, tolerance));
  const Owned<gsl_odeiv2_evolve, gsl_odeiv2_evolve_free> evolve(gsl_odeiv2_evolve_alloc(size));
  double s = 0;
  double h = length / 4;
  for (int i = 0; i < most_integrator_steps && s < length; ++i) {
    if (gsl_odeiv2_evolve_apply(evolve.get(), control.get(), step.get(), &system, &s, length, &h,
                                y.data()) != GSL_SUCCESS) {
      return false;
    }
  }
  if (s < length) return false;
  double sum = 0;
  for (const double component : y) sum += component;
  return std::isfinite(sum);
}

}  // namespace dlo::energy_model
