#include "fit/material_profiles.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/timer.hpp"
#include "dlo/compare/error.hpp"
#include "wire/identifiable.hpp"
#include "wire/wire_numbers.hpp"

namespace dlo::compare {
namespace {

/// Largest number of searches for another equilibrium of a rod between several grippers, at the
/// optimum of the followed one.
constexpr int most_other_states = 2;
/// Step in the logarithm of a material for derivatives; shapes are accurate to 1e-10 l.
constexpr double derivative_step = 1e-3;

}  // namespace

MaterialProfiles::MaterialProfiles(const std::vector<Scene>& scenes,
                                   const std::vector<MeasuredShape>& shapes,
                                   const MaterialFitOptions& options)
    : scenes_(scenes),
      shapes_(shapes),
      options_(options),
      measured_(scenes, shapes, measured_options(options), Timer()),
      misfit_(scenes, measured_),
      forced_(std::any_of(scenes.begin(), scenes.end(), compare::is_forced)),
      both_(options.density && std::any_of(scenes.begin(), scenes.end(), has_forces_beside_weight)),
      // If every E has the same shapes, differences between them are rounding.
      low_(forced_ ? std::log(options.smallest_ratio) : 0),
      high_(forced_ ? std::log(options.largest_ratio) : 0) {
  const int fewest = options.noise ? 0 : 1;
  if (freedom() >= fewest) return;
  throw InputError(fmt::format(
      "calibrate: {} numbers measured beside the frames, {} to be found (allowed: {} or more, so "
      "more points{})",
      measured_.numbers(), unknowns(), unknowns() + fewest,
      options.noise ? "" : ", or a given noise"));
}

/// Returns the best logarithm of the density at an E, and the sum of squares there.
Minimum MaterialProfiles::density_at(double log_modulus) {
  if (!both_) return {0, misfit_({log_modulus, 0})};
  return LogProfile(
             [&](double y) {
               return misfit_({log_modulus, y});
             },
             low_ / 2, high_ / 2)
      .minimum();
}

MaterialProfiles::Search MaterialProfiles::profile() {
  LogProfile over_modulus([this](double x) { return density_at(x).value; }, low_, high_);
  const double x = over_modulus.minimum().x;
  return {std::move(over_modulus), {x, both_ ? density_at(x).x : 0}};
}

MaterialProfiles::Search MaterialProfiles::search() {
  Search found = profile();
  for (int i = 0; i < most_other_states && misfit_.search_at(found.best); ++i) found = profile();
  if (!std::isfinite(found.over_modulus.minimum().value)) {
    throw ConvergenceError(
        fmt::format("{}: the energy model found no equilibrium at any of the moduli tried",
                    scenes_.front().file));
  }
  return found;
}

LogProfile MaterialProfiles::over_density() {
  const auto least = [this](double y) {
    return LogProfile([&](double x) { return misfit_({x, y}); }, low_, high_).minimum().value;
  };
  return {least, low_ / 2, high_ / 2};
}

std::vector<ResidualSeries> MaterialProfiles::residuals(const MaterialPoint& material) {
  FittedRods rods(
      measured_,
      [this](std::size_t shape, const Eigen::VectorXd& values) {
        return of_material(scenes_[shape], {values[0], both_ ? values[1] : 0});
      },
      std::vector<Unknown>(static_cast<std::size_t>(unknowns()),
                           Unknown{.stride = derivative_step}));
  rods.go_on_from(misfit_.rods(material));
  const Eigen::Vector2d values(material.log_modulus, material.log_density);
  return rods.residuals(values.head(unknowns()), FittedRods::Columns::all)
      .value_or(std::vector<ResidualSeries>());
}

void MaterialProfiles::refuse_unverified(double highest) const {
  const ShapeMisfit::Unverified* unverified = misfit_.unverified_below(highest);
  if (unverified == nullptr) return;
  const Scene& scene = scenes_[unverified->scene];
  const NamedValue stiffness = scene.stiffness();
  throw ConvergenceError(fmt::format(
      "{}: at {} = {:.4g} {}, which may fit, the equilibrium is not verified: the rod penetrates "
      "its obstacles by {:.3g} m ({}), so {} is not identifiable from the shapes",
      scene.file, stiffness.name, stiffness.value * std::exp(unverified->material.log_modulus),
      stiffness.unit, unverified->penetration, unverified->message, stiffness.name));
}

}  // namespace dlo::compare
