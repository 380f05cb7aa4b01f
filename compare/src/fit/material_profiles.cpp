#include "fit/material_profiles.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/gsl.hpp"
#include "base/timer.hpp"
#include "dlo/compare/error.hpp"
#include "dlo/compare/shape_check.hpp"
#include "wire/between_shapes.hpp"
#include "wire/identifiable.hpp"
#include "wire/wire_numbers.hpp"

namespace dlo::compare {
namespace {

/// Largest number of searches per scene with several grippers; each may take as long as all solves
/// that follow an equilibrium.
constexpr int most_searches = 4;
/// Number of equilibria kept as starts, per scene; a scan over the modulus has some thirty.
constexpr std::size_t most_kept = 64;

/// Returns how deep a shape enters the rigid obstacles of a scene [m].
double depth_in_obstacles(const Scene& scene, const energy_model::Equilibrium& equilibrium) {
  constexpr int samples = 401;
  const Eigen::Matrix3Xd points =
      equilibrium.sample(equal_arc_lengths(scene.length, samples)).points;
  double depth = 0;
  for (const Obstacle& obstacle : scene.obstacles) {
    if (std::isfinite(obstacle.stiffness)) continue;
    depth = std::max(depth, -obstacle.body.clearances(points).minCoeff());
  }
  return depth;
}

/// Returns a scene without names, positions in files, and force model, for comparison.
Scene comparable_scene(Scene scene) {
  scene.name.clear();
  scene.file.clear();
  scene.material.name.clear();
  scene.material.source.clear();
  scene.force_model = {};
  for (Gripper& gripper : scene.grippers) gripper.where.clear();
  return scene;
}

/// Largest number of searches for nearer equilibria at the best material, after each of which the
/// profile is computed anew.
constexpr int most_other_states = 2;
/// Step in the logarithm of a material for derivatives; shapes are accurate to 1e-10 l.
constexpr double derivative_step = 1e-3;

}  // namespace

MaterialErrors::MaterialErrors(MaterialProfiles& material, const MaterialPoint& best, double least)
    : options_(material.options()),
      least_(least),
      freedom_(material.freedom()),
      fitted_(material.measured().frame_numbers() + material.unknowns()),
      effects_(static_cast<std::size_t>(material.unknowns()), {.degrees_of_freedom = freedom_}) {
  const double floor = std::pow(least_noise(material.scenes().front()), 2);
  variance_ = options_.noise ? std::pow(*options_.noise, 2) : std::max(least / freedom_, floor);
  noise_m_ = std::sqrt(variance_);
  if (!(least / std::max(1.0, freedom_) > floor)) return;
  const std::vector<ResidualSeries> series = material.residuals(best);
  if (series.empty()) return;
  const CorrelationEstimate estimate = correlation_of(series);
  tested_ = estimate.tested;
  const Eigen::Index frames = material.measured().frame_columns();
  const ErrorCovariance covariance = estimate.significant ? estimate.covariance : ErrorCovariance();
  if (estimate.significant) set_correlation_effects(covariance, series, frames);
  std::vector<Nuisance> nuisances;
  if (material.has_density()) nuisances.push_back({frames + 1, 0, INFINITY});
  scatter_ = scatter_between(estimates_of_shapes(series, covariance, std::pow(noise_m_, 2), frames,
                                                 std::vector(material.scenes().size(), nuisances)),
                             quantile(0));
}

void MaterialErrors::set_correlation_effects(const ErrorCovariance& covariance,
                                             const std::vector<ResidualSeries>& series,
                                             Eigen::Index frames) {
  for (std::size_t k = 0; k < effects_.size(); ++k) {
    effects_[k] = correlation_effect(series, frames + static_cast<Eigen::Index>(k), covariance);
  }
  if (!options_.noise) noise_m_ /= std::sqrt(effects_[0].residual_factor);
  correlation_ = CorrelatedErrors{
      .length_m = covariance.length,
      .share = covariance.share,
      .widening = std::sqrt(excess(0)) * quantile(0) / interval_quantile(options_.noise, freedom_),
      .degrees_of_freedom = effects_[0].degrees_of_freedom};
}

void MaterialErrors::write_to(MaterialFit& fit) const {
  fit.noise_m = noise_m_;
  fit.noise_is_estimated = !options_.noise;
  fit.degrees_of_freedom = static_cast<int>(freedom_);
  fit.correlation_was_tested = tested_;
  fit.correlation = correlation_;
  fit.scatter = scatter_;
}

/// Returns half the width of a number's interval, in standard deviations.
double MaterialErrors::quantile(std::size_t number) const {
  return interval_quantile(options_.noise, effects_[number].degrees_of_freedom);
}

/// Returns the variance of a fitted number, divided by that which follows from the sum of squares
/// (or the given noise) under the assumption of independent errors.
double MaterialErrors::excess(std::size_t number) const {
  const CorrelationEffect& effect = effects_[number];
  const double between = scatter_ ? std::pow(scatter_->widening, 2) : 1;
  return between *
         std::max(1.0, effect.variance_factor / (options_.noise ? 1 : effect.residual_factor));
}

double MaterialErrors::level(std::size_t number) const {
  return least_ + std::pow(quantile(number), 2) * excess(number) * variance_;
}

double MaterialErrors::rival_minimum_level(std::size_t number) const {
  const double nu = std::max(1.0, effects_[number].degrees_of_freedom);
  const double excess_of_all =
      options_.noise ? gsl_distribution(gsl_cdf_chisq_Qinv, 1e-3, fitted_)
                     : fitted_ * gsl_distribution(gsl_cdf_fdist_Qinv, 1e-3, fitted_, nu);
  return std::max(level(number), least_ + variance_ * excess(number) * excess_of_all);
}

ShapeMisfit::ShapeMisfit(const std::vector<Scene>& scenes, MeasuredShapes& measured)
    : scenes_(scenes), measured_(measured), searches_(scenes.size(), 0) {
  for (const Scene& scene : scenes) {
    const auto has_same_rod = [rod = comparable_scene(scene)](const Scene& other) {
      return comparable_scene(other) == rod;
    };
    const auto first = std::find_if(scenes.begin(), scenes.end(), has_same_rod);
    first_equal_scene_.push_back(static_cast<std::size_t>(first - scenes.begin()));
    is_followed_.push_back(scene.grippers.size() > 1);
  }
}

std::shared_ptr<ShapeMisfit::Solved> ShapeMisfit::solve(std::size_t i,
                                                        const MaterialPoint& material,
                                                        const energy_model::Equilibrium* start) {
  const Scene scene = scene_with_material(scenes_[i], material);
  auto result = std::make_shared<Solved>();
  result->material = material;
  result->scene = i;
  result->equilibrium = measured_.solve(i, scene, start);
  if (result->equilibrium.status == energy_model::SolveStatus::not_verified) {
    result->penetration = depth_in_obstacles(scene, result->equilibrium);
  }
  return result;
}

std::shared_ptr<const ShapeMisfit::Solved> ShapeMisfit::nearest(
    std::size_t i, const MaterialPoint& material) const {
  std::shared_ptr<const Solved> best;
  double least = std::numeric_limits<double>::infinity();
  for (const std::shared_ptr<const Solved>& entry : kept_) {
    const double distance = std::abs(entry->material.log_modulus - material.log_modulus) +
                            std::abs(entry->material.log_density - material.log_density);
    if (entry->scene != i || !(distance < least)) continue;
    least = distance;
    best = entry;
  }
  return best;
}

std::shared_ptr<const ShapeMisfit::Solved> ShapeMisfit::solved(std::size_t i,
                                                               const MaterialPoint& material) {
  const bool follows = is_followed_[i];
  if (!follows) {
    // Another shape of the same scene needs the same equilibria.
    const auto shared =
        std::find_if(shared_solutions_.begin(), shared_solutions_.end(), [&](const auto& entry) {
          return entry->scene == first_equal_scene_[i] && entry->material == material;
        });
    if (shared != shared_solutions_.end()) return *shared;
  }
  const std::shared_ptr<const Solved> start = follows ? nearest(i, material) : nullptr;
  if (start && start->material == material) return start;
  const auto has_shape = [](const Solved& shape) {
    return energy_model::succeeded(shape.equilibrium.status) ||
           (shape.equilibrium.status == energy_model::SolveStatus::not_verified &&
            shape.penetration > 0);
  };
  std::shared_ptr<Solved> result;
  if (start) result = solve(i, material, &start->equilibrium);
  if (!result || !has_shape(*result)) {
    if (follows && searches_[i]++ >= most_searches) return nullptr;
    result = solve(i, material, nullptr);
  }
  if (!has_shape(*result)) return nullptr;
  if (follows) {
    kept_.push_back(result);
    if (kept_.size() > most_kept * scenes_.size()) kept_.pop_front();
  } else {
    result->scene = first_equal_scene_[i];
    shared_solutions_.push_back(result);
    if (shared_solutions_.size() > most_kept * scenes_.size()) shared_solutions_.pop_front();
  }
  return result;
}

double ShapeMisfit::operator()(const MaterialPoint& material) {
  if (const auto known = values_.find(material); known != values_.end()) return known->second;
  double sum = 0;
  const std::size_t unverified_before = unverified_.size();
  for (std::size_t i = 0; i < scenes_.size() && std::isfinite(sum); ++i) {
    const std::shared_ptr<const Solved> shape = solved(i, material);
    if (!shape) {
      sum = std::numeric_limits<double>::infinity();
      break;
    }
    sum += measured_.sum_of_squares(i, shape->equilibrium);
    if (shape->penetration > 0) {
      unverified_.emplace_back(
          Unverified{material, i, shape->penetration, shape->equilibrium.message}, 0);
    }
  }
  for (std::size_t k = unverified_before; k < unverified_.size(); ++k) unverified_[k].second = sum;
  values_[material] = sum;
  return sum;
}

std::shared_ptr<const ShapeMisfit::Solved> ShapeMisfit::nearer_equilibrium(
    std::size_t i, const MaterialPoint& material, const std::shared_ptr<const Solved>& now) {
  std::vector<std::shared_ptr<Solved>> others;
  if (scenes_[i].grippers.size() > 1 && searches_[i]++ < most_searches) {
    others.push_back(solve(i, material, nullptr));
  }
  if (now) {
    others.push_back(std::make_shared<Solved>(*now));
    Solved& near = *others.back();
    near.scene = i;
    near.equilibrium =
        measured_.solve_near(i, scene_with_material(scenes_[i], material), now->equilibrium);
  }
  double least =
      now ? measured_.sum_of_squares(i, now->equilibrium) : std::numeric_limits<double>::infinity();
  std::shared_ptr<const Solved> result;
  for (const std::shared_ptr<Solved>& other : others) {
    if (!energy_model::succeeded(other->equilibrium.status)) continue;
    const double sum_of_squares = measured_.sum_of_squares(i, other->equilibrium);
    if (!(sum_of_squares < 0.99 * least - std::pow(1e-6 * scenes_[i].length, 2))) continue;
    least = sum_of_squares;
    result = other;
  }
  return result;
}

bool ShapeMisfit::find_nearer_equilibria(const MaterialPoint& material) {
  bool better = false;
  std::vector<std::shared_ptr<const Solved>> next;
  for (std::size_t i = 0; i < scenes_.size(); ++i) {
    const std::shared_ptr<const Solved> now = solved(i, material);
    const std::shared_ptr<const Solved> other = nearer_equilibrium(i, material, now);
    if (other) {
      better = is_followed_[i] = true;
      next.push_back(other);
    } else if (now && is_followed_[i]) {
      next.push_back(now);
    }
  }
  if (!better) return false;
  kept_.assign(next.begin(), next.end());
  values_.clear();
  unverified_.clear();
  return true;
}

FittedRods::Rods ShapeMisfit::rods(const MaterialPoint& material) {
  FittedRods::Rods result;
  for (std::size_t i = 0; i < scenes_.size(); ++i) {
    const std::shared_ptr<const Solved> shape = solved(i, material);
    result.push_back(shape ? std::optional(shape->equilibrium) : std::nullopt);
  }
  return result;
}

const ShapeMisfit::Unverified* ShapeMisfit::unverified_below(double level) const {
  for (const auto& [unverified, sum] : unverified_) {
    // Moving every point of the shape by the depth changes the root of the sum by no more than
    // this.
    const double largest_change =
        std::sqrt(static_cast<double>(measured_.points())) * unverified.penetration;
    if (std::sqrt(sum) - largest_change <= std::sqrt(level)) return &unverified;
  }
  return nullptr;
}

MaterialProfiles::MaterialProfiles(const std::vector<Scene>& scenes,
                                   const std::vector<MeasuredShape>& shapes,
                                   const MaterialFitOptions& options)
    : scenes_(scenes),
      shapes_(shapes),
      options_(options),
      measured_(scenes, shapes, measured_options(options), Timer()),
      misfit_(scenes, measured_),
      has_external_force_(std::any_of(scenes.begin(), scenes.end(), compare::has_external_force)),
      fits_density_(options.density &&
                    std::any_of(scenes.begin(), scenes.end(), has_forces_beside_weight)),
      // If every E has the same shapes, differences between them are rounding.
      low_(has_external_force_ ? std::log(options.smallest_ratio) : 0),
      high_(has_external_force_ ? std::log(options.largest_ratio) : 0) {
  const int required_freedom = options.noise ? 0 : 1;
  if (freedom() >= required_freedom) return;
  throw InputError(
      fmt::format("calibrate: {} measured numbers in addition to the frames for {} unknown "
                  "parameters (allowed: {} or more, so more points{})",
                  measured_.numbers(), unknowns(), unknowns() + required_freedom,
                  options.noise ? "" : ", or a given noise"));
}

/// Returns the best logarithm of the density at an E, and the sum of squares there.
Minimum MaterialProfiles::density_at(double log_modulus) {
  if (!fits_density_) return {0, misfit_({log_modulus, 0})};
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
  return {std::move(over_modulus), {x, fits_density_ ? density_at(x).x : 0}};
}

MaterialProfiles::Search MaterialProfiles::search() {
  Search found = profile();
  for (int i = 0; i < most_other_states && misfit_.find_nearer_equilibria(found.best); ++i)
    found = profile();
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
        return scene_with_material(scenes_[shape], {values[0], fits_density_ ? values[1] : 0});
      },
      std::vector<Unknown>(static_cast<std::size_t>(unknowns()),
                           Unknown{.difference_step = derivative_step}));
  rods.set_initial_rods(misfit_.rods(material));
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
