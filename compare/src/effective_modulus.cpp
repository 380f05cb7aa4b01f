#include "dlo/compare/effective_modulus.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "dlo/compare/deviation.hpp"
#include "dlo/compare/error.hpp"
#include "dlo/compare/solve.hpp"
#include "log_search.hpp"

namespace dlo::compare {
namespace {

struct Fit {
  Scene scene;
  const ShapeDistance* distance;
  double modulus;  // E of the scene [Pa]

  double rms_at(double log_ratio) {
    scene.material.youngs_modulus = modulus * std::exp(log_ratio);
    return (*distance)(solve_reference(scene, Model::energy));
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
  return fit_effective_modulus(scene, [&shape](const energy_model::Equilibrium& reference) {
    return rms(shape.arc_length, shape.points - reference.sample(shape.arc_length).points);
  });
}

EffectiveModulus fit_effective_modulus(const Scene& scene, const ShapeDistance& distance) {
  Fit fit{scene, &distance, scene.material.youngs_modulus};
  const Function rms_at = [&fit](double log_ratio) { return rms_or_infinity(fit, log_ratio); };
  constexpr int steps = 32;
  Scan values =
      scan(rms_at, std::log(smallest_modulus_ratio), std::log(largest_modulus_ratio), steps);
  // Not one shape: the scene's own modulus says why.
  if (!std::isfinite(values.value[values.best()])) values.value[values.best()] = fit.rms_at(0);
  EffectiveModulus result;
  if (!values.is_bracketed()) {
    result.ratio = values.best() == 0 ? smallest_modulus_ratio : largest_modulus_ratio;
    result.rms_m = values.value[values.best()];
    result.optimum = Optimum::one_sided;
    return result;
  }
  const Minimum minimum = minimum_near(rms_at, values);
  const double log_ratio = minimum.x;
  result.rms_m = minimum.value;
  result.ratio = std::exp(log_ratio);
  const double around =
      std::min(rms_at(log_ratio + std::log(2.0)), rms_at(log_ratio - std::log(2.0)));
  if (around < 1.1 * result.rms_m) result.optimum = Optimum::flat;
  return result;
}

}  // namespace dlo::compare
