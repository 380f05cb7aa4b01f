#include "dlo/compare/force_model_fit.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/progress_counter.hpp"
#include "dlo/compare/chain.hpp"
#include "dlo/compare/deviation.hpp"
#include "dlo/compare/error.hpp"
#include "dlo/compare/force.hpp"
#include "dlo/compare/reference.hpp"
#include "dlo/compare/solution.hpp"
#include "dlo/force_model/step_size.hpp"
#include "polygon/natural_plane.hpp"
#include "polygon/scalar_search.hpp"
#include "solve/polygon_solution.hpp"

namespace dlo::compare {
namespace {

constexpr int most_points = 4000;
/// Parts of the target that the errors of the polygon and of its stretch may take.
constexpr double polygon_share = 0.9;
constexpr double stretch_share = 0.1;
/// Ratio by which the fastest mode may be faster during a simulation than at its start and at rest.
constexpr double mode_margin = 1.2;
/// Largest strain of segments that count as rigid [-]: a hundredth of the default target. The
/// forces of much stiffer segments balance only to rounding.
constexpr double rigid_strain = 1e-5;

/// A scene with its reference, for comparison with many chains.
struct FittedCase {
  Scene scene;
  energy_model::Equilibrium reference;

  [[nodiscard]] double rms_over_length(const Shape& shape) const {
    return distance(shape, reference.sample) / scene.length;
  }
  /// Returns the chain with segments that stretch no more than the reference does: rigid ones, or
  /// those of A E.
  [[nodiscard]] Shape chain(ForceModelSettings settings, const SolveOptions& options) const {
    settings.c_c = scene.axial_stiffness();
    if (scene.stretch != Stretch::counted) {
      settings.c_c = std::max(*settings.c_c, tension_bound() / rigid_strain);
    }
    return solve_chain(scene, settings, options).shape;
  }
  /// Returns the RMS deviation of a chain with the given c_b, divided by the length; infinite if
  /// the chain does not converge.
  [[nodiscard]] double chain_deviation(ForceModelSettings settings, double c_b,
                                       const SolveOptions& options) const {
    settings.c_b = c_b;
    try {
      return rms_over_length(chain(settings, options));
    } catch (const ConvergenceError&) {
      return std::numeric_limits<double>::infinity();
    }
  }
  /// Returns an upper bound of the tension [N]: all weight and loads of the rod, or the largest
  /// force of a gripper.
  [[nodiscard]] double tension_bound() const {
    double sum = scene.weight_per_length().norm() * scene.length + scene.total_load_magnitude();
    for (const energy_model::Reaction& grip : reference.grips)
      sum = std::max(sum, grip.force.norm());
    return sum;
  }
};

/// Whether a stepper has step parameters; velocity Verlet and implicit Euler choose their step size
/// themselves.
bool has_step_parameters(Stepper stepper) {
  return stepper != Stepper::verlet && stepper != Stepper::implicit;
}

class ForceModelFitter {
 public:
  ForceModelFitter(const std::vector<Scene>& scenes, const std::vector<Scene>& holdouts,
                   const ForceModelFitOptions& options)
      : options_(options),
        fitted_(scenes.size()),
        counter_(options.progress, static_cast<std::int64_t>(scenes.size() + holdouts.size()) + 1) {
    for (const std::vector<Scene>* list : {&scenes, &holdouts}) {
      for (const Scene& scene : *list) {
        cases_.push_back({scene, solve_reference(scene, options.solve)});
        result_.scenes.push_back(scene.name);
        result_.gammas.push_back(scene.gamma());
      }
    }
    result_.holdouts = holdouts.size();
    result_.target = options.target;
    result_.points_were_given = options.points.has_value();
    settings_ = scenes.front().force_model;
    if (has_step_parameters(settings_.stepper)) settings_.stepper = Stepper::dynamic;
  }

  [[nodiscard]] ForceModelFit run() {
    const bool paper = settings_.law == BendingLaw::paper;
    if (options_.points) {
      settings_.points = *options_.points;
    } else if (!paper) {
      choose_points();
    }
    if (paper) {
      apply_paper_rules();
    } else {
      RuleDeviations physical{.rule = StiffnessRule::physical};
      for (const FittedCase& entry : cases_) {
        physical.rms_over_length.push_back(
            entry.rms_over_length(entry.chain(settings_, options_.solve)));
        counter_.add_one();
      }
      result_.rules.push_back(std::move(physical));
    }
    choose_stretch();
    step_to_rest();
    counter_.add_one();
    const Scene& first = cases_.front().scene;
    result_.segment_length = discretise(first, settings_).parameters.segment_length;
    result_.bending_stiffness = first.bending_stiffness();
    result_.settings = settings_;
    return std::move(result_);
  }

 private:
  [[nodiscard]] double worst_chain(int points) const {
    ForceModelSettings settings = settings_;
    settings.points = points;
    double worst = 0;
    for (std::size_t i = 0; i < fitted_; ++i) {
      worst = std::max(worst, cases_[i].rms_over_length(cases_[i].chain(settings, options_.solve)));
    }
    return worst;
  }

  /// Returns L of the first scene [m].
  [[nodiscard]] double segment_length(int points) const {
    ForceModelSettings settings = settings_;
    settings.points = points;
    return discretise(cases_.front().scene, settings).parameters.segment_length;
  }

  void choose_points() {
    constexpr int coarse = 16;
    constexpr int fine = 32;
    const double allowed = polygon_share * options_.target;
    const double at_coarse = worst_chain(coarse);
    const double at_fine = worst_chain(fine);
    result_.order =
        std::log(at_coarse / at_fine) / std::log(segment_length(coarse) / segment_length(fine));
    // The order of a nearly straight rod is not meaningful, so it is limited.
    const double order = std::clamp(result_.order, 0.8, 2.2);
    const double finer = std::pow(at_fine / allowed, 1 / order);
    const double estimate = std::clamp((fine - 1) * finer, 1.0, most_points - 1.0);
    int points = std::max(least_points(), 1 + static_cast<int>(std::ceil(estimate)));
    while (points < most_points && !(worst_chain(points) <= allowed)) {
      points = std::min(most_points, points + 1 + points / 20);
    }
    settings_.points = points;
  }

  /// Returns the smallest number of points, at least 5, that fits the grippers of every scene;
  /// most_points if none below it does.
  [[nodiscard]] int least_points() const {
    ForceModelSettings settings = settings_;
    for (int points = 5; points < most_points; ++points) {
      settings.points = points;
      try {
        for (const FittedCase& entry : cases_) (void)discretise(entry.scene, settings);
        return points;
      } catch (const InputError&) {
        continue;
      }
    }
    return most_points;
  }

  void apply_paper_rules() {
    std::vector<double> matched;
    for (const auto& [rule, bending] :
         {std::pair{StiffnessRule::formula_21, BendingRule::formula_21},
          std::pair{StiffnessRule::moment_matched, BendingRule::moment_matched}}) {
      RuleDeviations deviations{.rule = rule};
      for (const FittedCase& entry : cases_) {
        ForceModelSettings settings = settings_;
        settings.c_b.reset();
        settings.bending_rule = bending;
        settings.design_curvature = entry.scene.force_model.design_curvature;
        try {
          deviations.c_b.push_back(discretise(entry.scene, settings).parameters.c_b);
          deviations.rms_over_length.push_back(
              entry.chain_deviation(settings, deviations.c_b.back(), options_.solve));
        } catch (const InputError&) {
          // The design curvature rotates a joint by half a turn or more, so this rule gives no c_b.
          deviations.c_b.resize(deviations.rms_over_length.size() + 1, NAN);
          deviations.rms_over_length.push_back(NAN);
        }
      }
      if (rule == StiffnessRule::moment_matched) matched = deviations.c_b;
      result_.rules.push_back(std::move(deviations));
    }
    const double centre = search_centre(matched);
    result_.c_b_was_given = settings_.c_b.has_value();
    const double together = settings_.c_b ? *settings_.c_b : fitted_c_b(centre, 0, fitted_);
    RuleDeviations fitted{.rule = StiffnessRule::fitted};
    RuleDeviations alone{.rule = StiffnessRule::fitted_per_scene};
    for (std::size_t i = 0; i < cases_.size(); ++i) {
      fitted.c_b.push_back(together);
      fitted.rms_over_length.push_back(
          cases_[i].chain_deviation(settings_, together, options_.solve));
      alone.c_b.push_back(fitted_c_b(centre, i, i + 1));
      alone.rms_over_length.push_back(
          cases_[i].chain_deviation(settings_, alone.c_b.back(), options_.solve));
      counter_.add_one();
    }
    result_.rules.push_back(std::move(fitted));
    result_.rules.push_back(std::move(alone));
    settings_.c_b = together;
    settings_.design_curvature.reset();
  }

  /// Returns the middle of the search range of ln c_b: the mean of the moment-matched ones, or
  /// ln(EI / l^2) of the first scene if there are none.
  [[nodiscard]] double search_centre(const std::vector<double>& matched) const {
    double sum = 0;
    int count = 0;
    for (std::size_t i = 0; i < fitted_; ++i) {
      if (!std::isfinite(matched[i])) continue;
      sum += std::log(matched[i]);
      ++count;
    }
    if (count > 0) return sum / count;
    const Scene& first = cases_.front().scene;
    return std::log(first.bending_stiffness() / std::pow(first.length, 2));
  }

  /// Returns the c_b with the least deviation of the cases [begin, end).
  [[nodiscard]] double fitted_c_b(double centre, std::size_t begin, std::size_t end) const {
    constexpr double undefined_value_replacement = 1e3;
    const Function misfit = [&](double log_c_b) {
      double sum = 0;
      for (std::size_t i = begin; i < end; ++i) {
        sum += std::pow(cases_[i].chain_deviation(settings_, std::exp(log_c_b), options_.solve), 2);
      }
      // Brent's method interpolates, so an undefined value is replaced by a large one.
      return std::min(sum / static_cast<double>(end - begin), undefined_value_replacement);
    };
    constexpr int steps_per_decade = 4;
    Scan values;
    for (const int decades : {4, 8, 16}) {
      const double reach = decades * std::log(10.0);
      values = scan(misfit, centre - reach, centre + reach, 2 * decades * steps_per_decade);
      // If no c_b gives a shape, a wider range does not help.
      if (values.is_bracketed() || !(values.value[values.best()] < undefined_value_replacement))
        break;
    }
    return std::exp(minimum_near(misfit, values, 1e-6).x);
  }

  void choose_stretch() {
    result_.c_c_was_given = settings_.c_c.has_value();
    if (result_.c_c_was_given) return;
    double stiffness = 0;
    double axial = std::numeric_limits<double>::infinity();
    for (const FittedCase& entry : cases_) {
      stiffness = std::max(stiffness, entry.tension_bound() / (stretch_share * options_.target));
      axial = std::min(axial, entry.scene.axial_stiffness());
    }
    settings_.c_c = stiffness > 0 ? std::min(stiffness, axial) : axial;
    result_.c_c_is_physical = !(stiffness > 0 && stiffness <= axial);
  }

  /// Returns the bounds of the modes of all scenes at their starts and at rest.
  [[nodiscard]] force_model::ModeBounds modes() const {
    force_model::ModeBounds result{0, std::numeric_limits<double>::infinity()};
    for (const FittedCase& entry : cases_) {
      const Discretisation discretisation = discretise(entry.scene, settings_);
      std::vector<Eigen::Matrix3Xd> shapes = discretisation.starts;
      shapes.push_back(solve_chain(entry.scene, settings_, options_.solve).shape.points);
      const force_model::Rod rod =
          models_twist(entry.scene, settings_)
              ? lowest_polygon(entry.scene, settings_, discretisation, options_.solve).rod
              : discretisation.rod;
      for (const Eigen::Matrix3Xd& points : shapes) {
        const force_model::ModeBounds bounds = force_model::mode_bounds(rod, points);
        result.fastest = std::max(result.fastest, bounds.fastest);
        result.slowest = std::min(result.slowest, bounds.slowest);
      }
    }
    return result;
  }

  void step_to_rest() {
    settings_.c_F.reset();
    settings_.c_h.reset();
    settings_.l_s.reset();
    if (!has_step_parameters(settings_.stepper)) return step_all();
    force_model::ModeBounds bounds = modes();
    bounds.fastest *= mode_margin;
    settings_.l_s = segment_length(settings_.points) / 4;
    constexpr int most_attempts = 5;
    for (int attempt = 1;; ++attempt) {
      const force_model::HeavyBall ball = force_model::heavy_ball(bounds);
      settings_.c_F = ball.c_F;
      settings_.c_h = ball.c_h;
      try {
        return step_all();
      } catch (const ConvergenceError&) {
        if (attempt == most_attempts) throw;
        bounds.fastest *= 2;
      }
    }
  }

  void step_all() {
    result_.steps.clear();
    result_.stepped_rms_over_length.clear();
    result_.stretch_rms_over_length.clear();
    for (const FittedCase& entry : cases_) {
      const Solution force = solve_force(entry.scene, settings_, options_.solve);
      result_.steps.push_back(force.steps);
      result_.stepped_rms_over_length.push_back(entry.rms_over_length(force.shape));
      const Shape rigid = entry.chain(settings_, options_.solve);
      result_.stretch_rms_over_length.push_back(
          rms(rigid.arc_length, force.shape.points - rigid.points) / entry.scene.length);
    }
  }

  ForceModelFitOptions options_;
  std::size_t fitted_;
  std::vector<FittedCase> cases_;
  ForceModelSettings settings_;
  ForceModelFit result_;
  ProgressCounter counter_;  // counts scenes, then the simulations to rest
};

double largest_of(const std::vector<double>& values, std::size_t begin, std::size_t end) {
  double result = 0;
  for (std::size_t i = begin; i < end; ++i) result = std::max(result, values[i]);
  return result;
}

}  // namespace

ForceModelFit fit_force_model(const std::vector<Scene>& scenes, const std::vector<Scene>& holdouts,
                              const ForceModelFitOptions& options) {
  if (scenes.empty()) throw InputError("calibrate: no scenes (allowed: one or more)");
  if (!(options.target > 0 && options.target < 1)) {
    throw InputError(fmt::format("calibrate: target = {:g} of the length (allowed: > 0 and < 1)",
                                 options.target));
  }
  const ForceModelSettings& first = scenes.front().force_model;
  for (const std::vector<Scene>* list : {&scenes, &holdouts}) {
    for (const Scene& scene : *list) {
      const ForceModelSettings& other = scene.force_model;
      if (other.law == first.law && other.bookkeeping == first.bookkeeping) continue;
      throw InputError(fmt::format(
          "{}: force_model: law {}, bookkeeping {} after {}, {} (allowed: the same in all scenes; "
          "--law and --bookkeeping set them)",
          scene.file, to_string(other.law), to_string(other.bookkeeping), to_string(first.law),
          to_string(first.bookkeeping)));
    }
  }
  return ForceModelFitter(scenes, holdouts, options).run();
}

bool ForceModelFit::reaches_target() const {
  return std::max(largest_deviation(), largest_holdout_deviation()) <= target;
}

double ForceModelFit::largest_deviation() const {
  return largest_of(stepped_rms_over_length, 0, stepped_rms_over_length.size() - holdouts);
}

double ForceModelFit::largest_holdout_deviation() const {
  const std::size_t all = stepped_rms_over_length.size();
  return largest_of(stepped_rms_over_length, all - holdouts, all);
}

}  // namespace dlo::compare
