#include "dlo/compare/material_fit.hpp"

#include <fmt/format.h>
#include <gsl/gsl_cdf.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <memory>

#include "aligner.hpp"
#include "dlo/compare/error.hpp"
#include "dlo/compare/shape_check.hpp"
#include "dlo/energy_model/energy.hpp"
#include "log_search.hpp"

namespace dlo::compare {
namespace {

constexpr int scan_steps_per_decade = 4;
/// What the energy model's own error may be, so that a perfect shape gets no interval of rounding.
constexpr double least_noise = 1e-8;

/// Points that lie in a plane to rounding: their third coordinate was not measured.
bool is_flat(const Eigen::Matrix3Xd& points) {
  const Eigen::Matrix3Xd centred = points.colwise() - points.rowwise().mean();
  const Eigen::Matrix3d moments = centred * centred.transpose();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(moments);
  return eigen.eigenvalues()[0] < 1e-15 * eigen.eigenvalues()[2];
}

/// Numbers that a shape contributes, less those of its frame.
int free_numbers(const Aligner& aligner, const MeasuredShape& shape, PoseFreedom pose) {
  constexpr int frame[] = {0, 3, 4, 6};
  constexpr int flat_frame[] = {0, 2, 2, 3};
  const bool flat = is_flat(shape.points);
  const int per_point = (aligner.arc_lengths() == ArcLengths::nearest ? 2 : 3) - (flat ? 1 : 0);
  const auto index = static_cast<std::size_t>(pose);
  return per_point * static_cast<int>(aligner.points()) - (flat ? flat_frame : frame)[index];
}

/// The measured shapes against the energy model's for any modulus and density.
class Misfit {
 public:
  Misfit(const std::vector<Scene>& scenes, const std::vector<MeasuredShape>& shapes,
         const MaterialFitOptions& options)
      : scenes_(scenes),
        solver_({.terms = options.solve.terms,
                 .max_evaluations = options.solve.max_evaluations,
                 .time_limit = options.solve.time_limit}) {
    for (std::size_t i = 0; i < scenes.size(); ++i) {
      AlignOptions align{.pose = options.pose,
                         .arc_lengths = options.arc_lengths,
                         .weights = PointWeights::equal,
                         .up = up_of(scenes[i], options.pose)};
      if (align.arc_lengths == ArcLengths::automatic) {
        align.arc_lengths = shapes[i].arc_length.empty() ? ArcLengths::nearest : ArcLengths::file;
      }
      aligners_.emplace_back(shapes[i], scenes[i].length, align);
      numbers_ += free_numbers(aligners_.back(), shapes[i], options.pose);
    }
  }

  /// Numbers measured, less those that place the shapes.
  [[nodiscard]] int numbers() const { return numbers_; }
  [[nodiscard]] Eigen::Index points() const {
    Eigen::Index sum = 0;
    for (const Aligner& aligner : aligners_) sum += aligner.points();
    return sum;
  }

  /// Sum of squared distances [m^2]; infinite where the energy model finds no shape.
  double operator()(double modulus, double density_factor) {
    alignments_.clear();
    double sum = 0;
    for (std::size_t i = 0; i < scenes_.size(); ++i) {
      Scene& scene = scenes_[i];
      const double density = scene.material.density;
      scene.material.youngs_modulus = modulus;
      scene.material.density = density * density_factor;
      const energy_model::Equilibrium energy = solver_.solve(energy_problem(scene));
      scene.material.density = density;
      if (!energy_model::succeeded(energy.status)) return std::numeric_limits<double>::infinity();
      alignments_.push_back(aligners_[i].align(Curve(energy.sample, scene.length)));
      sum += alignments_.back().mean_square * static_cast<double>(aligners_[i].points());
    }
    return sum;
  }

  /// Of the last call.
  [[nodiscard]] const std::vector<Alignment>& alignments() const { return alignments_; }

 private:
  std::vector<Scene> scenes_;
  std::vector<Aligner> aligners_;
  std::vector<Alignment> alignments_;
  energy_model::EnergySolver solver_;
  int numbers_ = 0;
};

/// A minimum, and how far the function stays below a level to both sides of it.
struct Profile {
  Scan values;
  Minimum minimum;
  std::optional<double> low, high;
};

/// @param level  of the minimum
Profile profile(const Function& function, double low, double high,
                const std::function<double(double)>& level) {
  const int steps =
      static_cast<int>(std::ceil(scan_steps_per_decade * (high - low) / std::log(10)));
  Profile result;
  result.values = scan(function, low, high, steps);
  const Scan& values = result.values;
  const std::size_t best = values.best();
  result.minimum = {values.x[best], values.value[best]};
  if (!std::isfinite(result.minimum.value)) return result;
  if (values.is_bracketed()) result.minimum = minimum_near(function, values);
  const double limit = level(result.minimum.value);
  const auto inside = [limit](double value) { return value <= limit; };
  const auto first = std::find_if(values.value.begin(), values.value.end(), inside);
  const auto last = std::find_if(values.value.rbegin(), values.value.rend(), inside);
  // A narrow minimum lies between two points of the scan.
  const double none = std::numeric_limits<double>::infinity();
  const double leftmost = std::min(
      result.minimum.x, first == values.value.end()
                            ? none
                            : values.x[static_cast<std::size_t>(first - values.value.begin())]);
  const double rightmost = std::max(
      result.minimum.x, last == values.value.rend()
                            ? -none
                            : values.x[static_cast<std::size_t>(values.value.rend() - last - 1)]);
  const auto outside_left = std::lower_bound(values.x.begin(), values.x.end(), leftmost);
  if (outside_left != values.x.begin()) {
    result.low = crossing(function, leftmost, *(outside_left - 1), limit);
  }
  const auto outside_right = std::upper_bound(values.x.begin(), values.x.end(), rightmost);
  if (outside_right != values.x.end()) {
    result.high = crossing(function, rightmost, *outside_right, limit);
  }
  return result;
}

FittedValue fitted(const Profile& profile, double unit) {
  FittedValue result;
  if (profile.low) result.low = unit * std::exp(*profile.low);
  if (profile.high) result.high = unit * std::exp(*profile.high);
  if (profile.low && profile.high) result.value = unit * std::exp(profile.minimum.x);
  return result;
}

std::string what_is_not_told(const FittedValue& value, const char* name, const char* unit) {
  if (value.value) return {};
  if (value.low) {
    return fmt::format("these shapes do not tell {0}: {0} > {1:.4g} {2}, any larger one fits", name,
                       *value.low, unit);
  }
  if (value.high) {
    return fmt::format("these shapes do not tell {0}: {0} < {1:.4g} {2}, any smaller one fits",
                       name, *value.high, unit);
  }
  return fmt::format(
      "these shapes do not tell {0}: any {0} that was tried fits them within their "
      "noise",
      name);
}

std::string warning_of(double least_squares, double points, double nu, double length,
                       const std::optional<double>& noise) {
  const double rms = std::sqrt(least_squares / points);
  if (noise && nu > 0 && least_squares > std::pow(*noise, 2) * gsl_cdf_chisq_Qinv(1e-3, nu)) {
    return fmt::format(
        "the rod does not fit these shapes: its residuals are {:.3g} times what the given noise "
        "explains, so the interval means nothing",
        std::sqrt(least_squares / nu) / *noise);
  }
  if (rms > 0.05 * length) {
    return fmt::format(
        "the rod does not fit these shapes: residuals of {:.3g} % of its length (another unit, "
        "frame or rod?)",
        rms / length * 100);
  }
  return {};
}

bool has_forces_beside_weight(const std::vector<Scene>& scenes) {
  return std::any_of(scenes.begin(), scenes.end(), [](const Scene& scene) {
    const bool loaded = std::any_of(scene.loads.begin(), scene.loads.end(),
                                    [](const PointLoad& l) { return l.force.norm() > 0; });
    const bool yields = std::any_of(scene.obstacles.begin(), scene.obstacles.end(),
                                    [](const Obstacle& o) { return std::isfinite(o.stiffness); });
    return loaded || yields;
  });
}

void require_pairs(const std::vector<Scene>& scenes, const std::vector<MeasuredShape>& shapes,
                   const MaterialFitOptions& options) {
  if (scenes.empty() || scenes.size() != shapes.size()) {
    throw InputError(
        fmt::format("calibrate: {} scenes and {} shapes (allowed: one shape per scene)",
                    scenes.size(), shapes.size()));
  }
  if (options.arc_lengths == ArcLengths::chord) {
    throw InputError(
        "calibrate: arc lengths by chord are not exact enough (allowed: auto, file, nearest)");
  }
  if (options.noise && !(*options.noise > 0)) {
    throw InputError(fmt::format("calibrate: noise = {:g} m (allowed: > 0)", *options.noise));
  }
}

}  // namespace

MaterialFit fit_material(const std::vector<Scene>& scenes, const std::vector<MeasuredShape>& shapes,
                         const MaterialFitOptions& options) {
  require_pairs(scenes, shapes, options);
  Misfit misfit(scenes, shapes, options);
  MaterialFit result;
  const bool both = options.density && has_forces_beside_weight(scenes);
  const int unknowns = both ? 2 : 1;
  result.degrees_of_freedom = misfit.numbers() - unknowns;
  const int fewest = options.noise ? 0 : 1;
  if (result.degrees_of_freedom < fewest) {
    throw InputError(fmt::format(
        "calibrate: {} numbers measured beside the frames, {} to be found (allowed: {} or more, so "
        "more points{})",
        misfit.numbers(), unknowns, unknowns + fewest, options.noise ? "" : ", or a given noise"));
  }
  const double length = scenes.front().length;
  const double nu = result.degrees_of_freedom;
  const double floor = std::pow(least_noise * length, 2);
  result.noise_is_estimated = !options.noise;
  const auto variance = [&](double least_squares) {
    return options.noise ? std::pow(*options.noise, 2) : std::max(least_squares / nu, floor);
  };
  const double quantile =
      options.noise ? gsl_cdf_ugaussian_Pinv(0.975) : gsl_cdf_tdist_Pinv(0.975, nu);
  const auto level = [&](double least) { return least + quantile * quantile * variance(least); };

  const double modulus = scenes.front().material.youngs_modulus;
  const double low = std::log(options.smallest_ratio);
  const double high = std::log(options.largest_ratio);
  const auto at = [&](double log_modulus, double log_density) {
    return misfit(modulus * std::exp(log_modulus), std::exp(log_density));
  };
  // With both unknown each is profiled with the other at its own best.
  const auto best_over = [&](const Function& function) {
    const Scan values = scan(function, low / 2, high / 2, scan_steps_per_decade * 4);
    return values.is_bracketed() ? minimum_near(function, values)
                                 : Minimum{values.x[values.best()], values.value[values.best()]};
  };
  const auto density_at = [&](double x) { return best_over([&](double y) { return at(x, y); }); };
  const Profile over_modulus =
      profile([&](double x) { return both ? density_at(x).value : at(x, 0); }, low, high, level);
  if (!std::isfinite(over_modulus.minimum.value)) {
    throw ConvergenceError(fmt::format(
        "{}: the energy model has a shape at no modulus that was tried", scenes.front().file));
  }
  result.youngs_modulus = fitted(over_modulus, modulus);
  result.not_told = what_is_not_told(result.youngs_modulus, "E", "Pa");
  if (both) {
    const Profile over_density =
        profile([&](double y) { return best_over([&](double x) { return at(x, y); }).value; },
                low / 2, high / 2, level);
    result.density = fitted(over_density, scenes.front().material.density);
    if (result.not_told.empty()) {
      result.not_told = what_is_not_told(*result.density, "the density", "kg/m^3");
    }
  } else if (options.density && result.not_told.empty()) {
    result.not_told =
        "these shapes do not tell the density: nothing but gravity bends the rod, so only density "
        "/ "
        "E shows; E is for the density of the scene (a known load would tell both)";
  }

  const double best_density = both ? density_at(over_modulus.minimum.x).x : 0;
  const double least = at(over_modulus.minimum.x, best_density);
  result.noise_m = std::sqrt(variance(least));
  result.rms_m = std::sqrt(least / static_cast<double>(misfit.points()));
  result.warning =
      warning_of(least, static_cast<double>(misfit.points()), nu, length, options.noise);
  for (std::size_t i = 0; i < scenes.size(); ++i) {
    result.shapes.push_back({scenes[i].name, misfit.alignments()[i]});
  }
  return result;
}

}  // namespace dlo::compare
