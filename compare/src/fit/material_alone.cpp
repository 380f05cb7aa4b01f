#include "fit/material_alone.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "base/gsl.hpp"
#include "fit/material_errors.hpp"
#include "fit/systematic_residuals.hpp"
#include "wire/identifiable.hpp"
#include "wire/leave_one_out.hpp"
#include "wire/wire_result.hpp"

namespace dlo::compare {
namespace {

/// Result of a profile for one number.
struct Finding {
  LogProfile::Interval interval;  // includes all of `optima`
  std::vector<Minimum> optima;    // between which the shapes do not decide
  FittedValue value;
};

/// Evaluates a profile.
/// @param number  see MaterialErrors
/// @param unit  the scene's value of the number
Finding finding(LogProfile& profile, const MaterialErrors& errors, std::size_t number, double unit,
                double identified_within) {
  Finding result{
      profile.below(errors.level(number)), profile.minima_below(errors.rival_level(number)), {}};
  LogProfile::Interval& interval = result.interval;
  if (!result.optima.empty()) {
    if (interval.low) interval.low = std::min(*interval.low, result.optima.front().x);
    if (interval.high) interval.high = std::max(*interval.high, result.optima.back().x);
  }
  result.value = fitted_value(profile.minimum().x, interval, unit, identified_within);
  return result;
}

std::string what_is_not_identified(const Finding& found, const NamedValue& of,
                                   const std::string& name, double identified_within) {
  const FittedValue& value = found.value;
  if (value.value) return {};
  const std::string so = name + " is not identifiable from these shapes: ";
  if (value.low && value.high) {
    std::string where;
    for (std::size_t i = 0; i < found.optima.size() && found.optima.size() > 1; ++i) {
      where += fmt::format("{} near {:.3g}", i == 0 ? ", best" : " and",
                           of.value * std::exp(found.optima[i].x));
    }
    return so + fmt::format("{:.4g} to {:.4g} {} fit{} (identified: within a factor of {:g})",
                            *value.low, *value.high, of.unit, where, identified_within);
  }
  if (value.low) {
    return so + fmt::format("{} > {:.4g} {}, any larger one fits", name, *value.low, of.unit);
  }
  if (value.high) {
    return so + fmt::format("{} < {:.4g} {}, any smaller one fits", name, *value.high, of.unit);
  }
  return so + fmt::format("any {} that was tried fits them within their noise", name);
}

void find_density(MaterialProfiles& material, const MaterialErrors& errors, MaterialFit& fit) {
  const double within = material.options().identified_within;
  const NamedValue heaviness = material.scenes().front().heaviness();
  LogProfile profile = material.over_density();
  const Finding found = finding(profile, errors, 1, heaviness.value, within);
  fit.density = found.value;
  if (!fit.not_identified.empty()) return;
  fit.not_identified =
      what_is_not_identified(found, heaviness, fmt::format("the {}", heaviness.name), within);
}

std::string why_weight_alone(const Scene& scene) {
  return fmt::format(
      "the {0} is not identifiable from these shapes: nothing but gravity bends the rod, so only "
      "{0} / {1} shows; {1} is for the {0} of the scene (a known load would identify both)",
      scene.heaviness().name, scene.stiffness().name);
}

void draw_profile(MaterialProfiles& material, const LogProfile::Interval& interval,
                  const MaterialPoint& best, const MaterialErrors& errors, MaterialFit& fit) {
  const double least = material.least_squares(best.log_modulus);
  const double limit = errors.level(0) - least;
  const double unit = material.scenes().front().stiffness().value;
  for (const double x : drawn_logarithms(interval.low, best.log_modulus, interval.high,
                                         material.options().profile_points)) {
    fit.profile.push_back({unit * std::exp(x), (material.least_squares(x) - least) / limit});
  }
  draw_rods(material.rods(best), material.scenes(), fit);
}

}  // namespace

std::string warning_of(const MaterialProfiles& material, double squares,
                       const std::optional<double>& noise) {
  const double nu = material.freedom();
  if (noise && nu > 0 &&
      squares > std::pow(*noise, 2) * gsl_distribution(gsl_cdf_chisq_Qinv, 1e-3, nu)) {
    return fmt::format(
        "the rod does not fit these shapes: its residuals are {:.3g} times what the given noise "
        "explains, so the interval is meaningless",
        std::sqrt(squares / nu) / *noise);
  }
  const double rms = std::sqrt(squares / material.points());
  const double length = material.scenes().front().length;
  if (rms > 0.05 * length) {
    return fmt::format(
        "the rod does not fit these shapes: residuals of {:.3g} % of its length (another unit, "
        "frame or rod?)",
        rms / length * 100);
  }
  return {};
}

MaterialFit fit_material_alone(MaterialProfiles& material, const MaterialProfiles::Search& found) {
  const std::vector<Scene>& scenes = material.scenes();
  const MaterialFitOptions& options = material.options();
  const double least = found.over_modulus.minimum().value;
  const MaterialErrors errors(material, found.best, least);
  MaterialFit fit;
  errors.tell(fit);
  const NamedValue stiffness = scenes.front().stiffness();
  LogProfile over_modulus = found.over_modulus;
  const Finding modulus =
      finding(over_modulus, errors, 0, stiffness.value, options.identified_within);
  fit.youngs_modulus = modulus.value;
  fit.not_identified =
      what_is_not_identified(modulus, stiffness, stiffness.name, options.identified_within);
  if (material.has_density()) find_density(material, errors, fit);
  if (!material.is_forced()) fit.not_identified = why_unforced(scenes.front());
  if (options.density && !material.has_density() && fit.not_identified.empty()) {
    fit.not_identified = why_weight_alone(scenes.front());
  }
  material.refuse_unverified(
      std::max(errors.level(0), material.has_density() ? errors.level(1) : 0));
  fit.rms_m = std::sqrt(least / material.points());
  fit.warning = warning_of(material, least, options.noise);
  const FittedRods::Rods rods = material.rods(found.best);
  for (std::size_t i = 0; i < rods.size() && rods[i]; ++i) {
    fit.shapes.push_back({scenes[i].name, material.measured().alignment(i, *rods[i]), {}});
  }
  const bool holds_any_wire =
      options.alternatives && look_for_alternatives(material, found.best, fit);
  // See MaterialFit::assumed.
  if (!holds_any_wire) fit.assumed = unfitted_assumptions(scenes, options);
  if (options.profile_points > 0) {
    draw_profile(material, modulus.interval, found.best, errors, fit);
  }
  return fit;
}

}  // namespace dlo::compare
