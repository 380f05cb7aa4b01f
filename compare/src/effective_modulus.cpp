#include "dlo/compare/effective_modulus.hpp"

#include <gsl/gsl_errno.h>
#include <gsl/gsl_min.h>

#include <cmath>
#include <limits>
#include <memory>
#include <vector>

#include "dlo/compare/deviation.hpp"
#include "dlo/compare/error.hpp"
#include "dlo/compare/solve.hpp"

namespace dlo::compare {
namespace {

struct Fit {
  Scene scene;
  const Shape* shape;
  double modulus;  // E of the scene [Pa]

  double rms_at(double log_ratio) {
    scene.material.youngs_modulus = modulus * std::exp(log_ratio);
    const energy_model::Equilibrium reference = solve_reference(scene, Model::energy);
    return rms(shape->arc_length, shape->points - reference.sample(shape->arc_length).points);
  }
};

/// A modulus at which the energy model finds no shape is infinitely far.
double rms_or_infinity(Fit& fit, double log_ratio) {
  try {
    return fit.rms_at(log_ratio);
  } catch (const ConvergenceError&) {
    return std::numeric_limits<double>::infinity();
  }
}

// No exception may cross GSL; what is not finite makes it stop.
double rms_for_gsl(double log_ratio, void* data) {
  return rms_or_infinity(*static_cast<Fit*>(data), log_ratio);
}

}  // namespace

const char* to_string(Optimum optimum) {
  switch (optimum) {
    case Optimum::flat:
      return "flat";
    case Optimum::one_sided:
      return "one-sided";
    case Optimum::clear:
      break;
  }
  return "clear";
}

EffectiveModulus fit_effective_modulus(const Scene& scene, const Shape& shape) {
  Fit fit{scene, &shape, scene.material.youngs_modulus};
  const double low = std::log(smallest_modulus_ratio);
  const double high = std::log(largest_modulus_ratio);
  constexpr int steps = 32;
  const double step = (high - low) / steps;
  std::vector<double> scan;
  std::size_t best = 0;
  for (int i = 0; i <= steps; ++i) {
    scan.push_back(rms_or_infinity(fit, low + step * i));
    if (scan.back() < scan[best]) best = scan.size() - 1;
  }
  // Not one shape: the scene's own modulus says why.
  if (!std::isfinite(scan[best])) scan[best] = fit.rms_at(0);
  EffectiveModulus result;
  if (best == 0 || best + 1 == scan.size()) {
    result.ratio = best == 0 ? smallest_modulus_ratio : largest_modulus_ratio;
    result.rms_m = scan[best];
    result.optimum = Optimum::one_sided;
    return result;
  }

  gsl_set_error_handler_off();
  gsl_function function{rms_for_gsl, &fit};
  const std::unique_ptr<gsl_min_fminimizer, decltype(&gsl_min_fminimizer_free)> minimiser(
      gsl_min_fminimizer_alloc(gsl_min_fminimizer_brent), gsl_min_fminimizer_free);
  const double middle = low + step * static_cast<double>(best);
  double log_ratio = middle;
  result.rms_m = scan[best];
  if (gsl_min_fminimizer_set_with_values(minimiser.get(), &function, middle, scan[best],
                                         middle - step, scan[best - 1], middle + step,
                                         scan[best + 1]) == GSL_SUCCESS) {
    for (int i = 0; i < 100; ++i) {
      if (gsl_min_fminimizer_iterate(minimiser.get()) != GSL_SUCCESS) break;
      if (gsl_min_test_interval(gsl_min_fminimizer_x_lower(minimiser.get()),
                                gsl_min_fminimizer_x_upper(minimiser.get()), 1e-7,
                                0) == GSL_SUCCESS) {
        break;
      }
    }
    log_ratio = gsl_min_fminimizer_x_minimum(minimiser.get());
    result.rms_m = gsl_min_fminimizer_f_minimum(minimiser.get());
  }
  result.ratio = std::exp(log_ratio);
  const double around = std::min(rms_or_infinity(fit, log_ratio + std::log(2.0)),
                                 rms_or_infinity(fit, log_ratio - std::log(2.0)));
  if (around < 1.1 * result.rms_m) result.optimum = Optimum::flat;
  return result;
}

}  // namespace dlo::compare
