#include "dlo/compare/effective_modulus.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "dlo/compare/deviation.hpp"
#include "dlo/compare/error.hpp"
#include "dlo/compare/solve.hpp"
#include "log_search.hpp"

namespace dlo::compare {
namespace {

constexpr int scan_steps = 32;

/// RMS against the logarithm of E*/E: of the lowest shape at each modulus, or of one followed.
class Fit {
 public:
  Fit(const Scene& scene, const ShapeDistance& distance)
      : scene_(scene), distance_(distance), modulus_(scene.material.youngs_modulus) {}

  void follow(const energy_model::Equilibrium& state) { followed_ = state; }

  double rms_at(double log_ratio) {
    scene_.material.youngs_modulus = modulus_ * std::exp(log_ratio);
    const bool follows = followed_.has_value();
    energy_model::Equilibrium shape =
        solve_reference(scene_, Model::energy, {.start = follows ? &*followed_ : nullptr});
    const double rms = distance_(shape);
    if (follows) followed_ = std::move(shape);
    return rms;
  }

  /// A modulus at which the energy model finds no shape is infinitely far.
  double rms_or_infinity(double log_ratio) {
    try {
      return rms_at(log_ratio);
    } catch (const ConvergenceError&) {
      return std::numeric_limits<double>::infinity();
    }
  }

 private:
  Scene scene_;
  const ShapeDistance& distance_;
  double modulus_;  // E of the scene [Pa]
  std::optional<energy_model::Equilibrium> followed_;
};

/// The scan by following a state from E*/E = 1 both ways, each until the distance has not got less
/// for a factor of ten: far from its modulus a state is slow to solve, if it still exists.
Scan scan_state(Fit& fit, const energy_model::Equilibrium& state) {
  constexpr int most_worse = scan_steps / 8;
  Scan values = scan([](double) { return std::numeric_limits<double>::infinity(); },
                     std::log(smallest_modulus_ratio), std::log(largest_modulus_ratio), scan_steps);
  for (const int way : {-1, 1}) {
    fit.follow(state);
    double least = std::numeric_limits<double>::infinity();
    int worse = 0;
    for (int i = scan_steps / 2; i >= 0 && i <= scan_steps && worse < most_worse; i += way) {
      const auto at = static_cast<std::size_t>(i);
      values.value[at] = fit.rms_or_infinity(values.x[at]);
      worse = values.value[at] < least ? 0 : worse + 1;
      least = std::min(least, values.value[at]);
    }
  }
  fit.follow(state);
  return values;
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

ShapeDistance distance_from(const Shape& shape) {
  return [shape](const energy_model::Equilibrium& reference) {
    return rms(shape.arc_length, shape.points - reference.sample(shape.arc_length).points);
  };
}

EffectiveModulus fit_effective_modulus(const Scene& scene, const Shape& shape) {
  return fit_effective_modulus(scene, distance_from(shape));
}

EffectiveModulus fit_effective_modulus(const Scene& scene, const ShapeDistance& distance,
                                       const energy_model::Equilibrium* state) {
  Fit fit(scene, distance);
  const Function rms_at = [&fit](double log_ratio) { return fit.rms_or_infinity(log_ratio); };
  Scan values = state != nullptr ? scan_state(fit, *state)
                                 : scan(rms_at, std::log(smallest_modulus_ratio),
                                        std::log(largest_modulus_ratio), scan_steps);
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
