#include "motion/motion_misfit.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "dlo/compare/error.hpp"

namespace dlo::compare {
namespace {

/// Differences of logarithms, of angles [rad], and of angular rates times the natural time. With
/// ten times larger differences, derivatives of combinations of modes that nearly cancel are too
/// inexact for the least squares to converge.
constexpr double parameter_difference = 3e-4;
/// Tolerance of a step of the simulation: the error of a few hundred steps is then less than a
/// tenth of a millimetre per metre.
constexpr double fit_tolerance = 1e-6;
/// Smallest standard deviation of a coordinate, divided by the rod length: error of the simulation.
constexpr double least_noise = 1e-5;
/// Factor by which a number may differ from its first guess.
constexpr double widest_factor = 1e4;
/// Prior standard deviation of a logarithm.
constexpr double prior_log = 10;

/// Checks a recording. @throws InputError in the cases of MotionMisfit's constructor
void require_recording(const Scene& scene, const MarkerMotion& recorded) {
  for (const MarkerPosition& at : recorded.positions) {
    if (on_rod(at.arc_length, scene.length)) continue;
    throw InputError(fmt::format("{}: a marker at s = {:g} m (allowed: 0 to the rod's {:g} m)",
                                 recorded.file, at.arc_length, scene.length));
  }
  if (!(recorded.positions.back().time > recorded.positions.front().time)) {
    throw InputError(recorded.file + ": one time only (allowed: two or more)");
  }
}

bool holds_first_tangent(const Scene& scene) {
  return std::ranges::any_of(scene.grippers, [](const Gripper& gripper) {
    return gripper.at == 0 && gripper.direction.has_value();
  });
}

}  // namespace

MotionMisfit::MotionMisfit(const Scene& scene, const std::vector<MarkerMotion>& recordings,
                           std::vector<MotionParameter> fitted, const RodDamping& known,
                           const SolveOptions& solve, Stages stages)
    : scene_(scene),
      fitted_(std::move(fitted)),
      known_(known),
      solve_(solve),
      stages_(std::move(stages)),
      natural_time_(
          std::sqrt(scene.mass() * std::pow(scene.length, 3) / scene.softer_bending_stiffness())) {
  const double drag = scene.mass() / scene.length / natural_time_;
  // With this damping, a vibration with the natural time loses a few percent in each period.
  constexpr double damping_ratio = 0.02;
  const auto value_or = [](double given, double otherwise) {
    return given > 0 ? given : otherwise;
  };
  for (const MotionParameter what : fitted_) {
    switch (what) {
      case MotionParameter::stiffness:
        first_.push_back(1);
        break;
      case MotionParameter::material:
        first_.push_back(value_or(known.material, damping_ratio * natural_time_));
        break;
      case MotionParameter::air:
        first_.push_back(value_or(known.air, damping_ratio * drag));
        break;
      case MotionParameter::quadratic:
        first_.push_back(
            value_or(known.quadratic, damping_ratio * drag * natural_time_ / scene.length));
        break;
    }
  }
  Eigen::Index next = physical_parameters();
  for (const MarkerMotion& motion : recordings) {
    require_recording(scene, motion);
    Recorded recorded{
        .motion = &motion, .frames = {}, .used_frames = 0, .deviation = {}, .first_mode = next};
    for (std::size_t i = 0; i < motion.positions.size(); ++i) {
      const double time = motion.positions[i].time;
      if (recorded.frames.empty() || time > recorded.frames.back().time) {
        recorded.frames.push_back({time, i, i});
      }
      recorded.frames.back().end = i + 1;
    }
    duration_ = std::max(duration_, recorded.frames.back().time - recorded.frames.front().time);
    if (const auto start = smooth_start(scene, motion, recorded.frames.front().time)) {
      recorded.deviation.emplace(*start, scene.length, holds_first_tangent(scene));
      next += StartDeviation::size();
    }
    recorded_.push_back(std::move(recorded));
  }
  restrict_to(duration_);
}

void MotionMisfit::restrict_to(double seconds) {
  for (Recorded& recorded : recorded_) {
    const double last = recorded.frames.front().time + seconds * (1 + 1e-12);
    const auto is_used = [&](const Frame& frame) { return frame.time <= last; };
    recorded.used_frames = std::max<std::size_t>(
        2, static_cast<std::size_t>(std::ranges::count_if(recorded.frames, is_used)));
  }
}

Eigen::Index MotionMisfit::parameters() const {
  Eigen::Index count = physical_parameters();
  for (const Recorded& recorded : recorded_) {
    count += recorded.deviation ? StartDeviation::size() : 0;
  }
  return count;
}

Eigen::Index MotionMisfit::coordinates() const {
  Eigen::Index count = 0;
  for (const Recorded& recorded : recorded_) count += recorded.coordinates();
  return count;
}

double MotionMisfit::value(std::size_t number, double log) const {
  return first_[number] * std::exp(within_bounds(log));
}

double MotionMisfit::within_bounds(double log) {
  const double most = std::log(widest_factor);
  return std::clamp(log, -most, most);
}

bool MotionMisfit::at_bound(double log) {
  constexpr double last = 0.99;
  return std::abs(log) >= last * std::log(widest_factor);
}

RodDamping MotionMisfit::damping(const Eigen::VectorXd& parameters) const {
  RodDamping result = known_;
  for (std::size_t i = 0; i < fitted_.size(); ++i) {
    const double at = value(i, parameters[static_cast<Eigen::Index>(i)]);
    if (fitted_[i] == MotionParameter::material) result.material = at;
    if (fitted_[i] == MotionParameter::air) result.air = at;
    if (fitted_[i] == MotionParameter::quadratic) result.quadratic = at;
  }
  return result;
}

Scene MotionMisfit::scene_with(const Eigen::VectorXd& parameters) const {
  Scene scene = scene_;
  for (std::size_t i = 0; i < fitted_.size(); ++i) {
    if (fitted_[i] != MotionParameter::stiffness) continue;
    scene.scale_modulus(value(i, parameters[static_cast<Eigen::Index>(i)]));
  }
  return scene;
}

std::optional<MotionStart> MotionMisfit::start(const Eigen::VectorXd& parameters,
                                               std::size_t recording) const {
  const Recorded& recorded = recorded_[recording];
  if (!recorded.deviation) return std::nullopt;
  Eigen::VectorXd modes = parameters.segment(recorded.first_mode, StartDeviation::size());
  // A parameter of an angular rate is the rate times the natural time.
  modes.tail(StartDeviation::size() / 2) /= natural_time_;
  return recorded.deviation->with(modes);
}

Eigen::VectorXd MotionMisfit::simulated(const Scene& scene, const RodDamping& damping,
                                        const Eigen::VectorXd& parameters, std::size_t recording) {
  const Recorded& recorded = recorded_[recording];
  ++simulations_;
  std::vector<double> times;
  for (std::size_t k = 0; k < recorded.used_frames; ++k) times.push_back(recorded.frames[k].time);
  if (stages_) {
    stages_(fmt::format("simulation {}, {:.3g} s", simulations_, times.back() - times.front()));
  }
  const FrameClock clock(scene, {times.front(), times.back()},
                         {.frame_rate = static_cast<double>(recorded.used_frames - 1) /
                                        (times.back() - times.front())});
  const MovingScene moving(scene, clock, damping, solve_, start(parameters, recording));
  const SimulatedMotion run =
      moving.run(times, terms_, recorded.deviation ? fit_tolerance : usual_step_tolerance);
  Eigen::VectorXd result = Eigen::VectorXd::Constant(recorded.coordinates(), scene.length);
  if (run.moved.frames.size() < times.size()) {
    stop_reason_ =
        fmt::format("{}: the moving rod stopped: {}", recorded.motion->file, run.stop_reason());
    return result;
  }
  terms_ = run.moved.terms;
  const std::vector<MarkerPosition>& positions = recorded.motion->positions;
  for (std::size_t k = 0; k < recorded.used_frames; ++k) {
    std::vector<double> s;
    for (std::size_t i = recorded.frames[k].begin; i < recorded.frames[k].end; ++i) {
      s.push_back(*on_rod(positions[i].arc_length, scene.length));
    }
    const Eigen::Matrix3Xd points = run.moved.frames[k].sample(s).points;
    const Eigen::Matrix3Xd moved = points - run.moved.frames.front().sample(s).points;
    largest_displacement_ = std::max(largest_displacement_, moved.colwise().norm().maxCoeff());
    for (std::size_t i = 0; i < s.size(); ++i) {
      const std::size_t row = recorded.frames[k].begin + i;
      result.segment<3>(static_cast<Eigen::Index>(3 * row)) =
          points.col(static_cast<Eigen::Index>(i)) - positions[row].position;
    }
  }
  return result;
}

Eigen::VectorXd MotionMisfit::residuals(const Eigen::VectorXd& parameters) {
  stop_reason_.clear();
  largest_displacement_ = 0;
  const Scene scene = scene_with(parameters);
  const RodDamping damped = damping(parameters);
  Eigen::VectorXd result(coordinates());
  Eigen::Index row = 0;
  for (std::size_t i = 0; i < recorded_.size(); ++i) {
    const Eigen::VectorXd part = simulated(scene, damped, parameters, i);
    result.segment(row, part.size()) = part;
    row += part.size();
  }
  return result;
}

Eigen::MatrixXd MotionMisfit::derivatives(const Eigen::VectorXd& parameters,
                                          const Eigen::VectorXd& here, Eigen::Index first) {
  Eigen::MatrixXd result = Eigen::MatrixXd::Zero(here.size(), parameters.size());
  const auto perturbed = [&](Eigen::Index i, double difference) {
    Eigen::VectorXd moved = parameters;
    moved[i] += difference;
    return moved;
  };
  for (Eigen::Index i = first; i < physical_parameters(); ++i) {
    // A small damping changes little, so the difference is a fraction of the first guess.
    const double relative =
        parameter_difference * (is_damping(i) ? std::max(1.0, std::exp(-parameters[i])) : 1);
    result.col(i) = (residuals(perturbed(i, std::log1p(relative))) - here) / relative;
  }
  const Scene scene = scene_with(parameters);
  const RodDamping damped = damping(parameters);
  Eigen::Index row = 0;
  for (std::size_t r = 0; r < recorded_.size(); ++r) {
    const Eigen::Index rows = recorded_[r].coordinates();
    const Eigen::Index modes = recorded_[r].deviation ? StartDeviation::size() : 0;
    for (Eigen::Index k = 0; k < modes; ++k) {
      const Eigen::Index i = recorded_[r].first_mode + k;
      result.col(i).segment(row, rows) =
          (simulated(scene, damped, perturbed(i, parameter_difference), r) -
           here.segment(row, rows)) /
          parameter_difference;
    }
    row += rows;
  }
  return result;
}

double MotionMisfit::least_variance() const { return std::pow(least_noise * scene_.length, 2); }

Eigen::VectorXd MotionMisfit::prior() const {
  Eigen::VectorXd result = Eigen::VectorXd::Constant(parameters(), 1 / (prior_log * prior_log));
  for (const Recorded& recorded : recorded_) {
    if (!recorded.deviation) continue;
    Eigen::VectorXd deviations = recorded.deviation->deviations();
    deviations.tail(deviations.size() / 2) *= natural_time_;
    result.segment(recorded.first_mode, deviations.size()) = deviations.cwiseAbs2().cwiseInverse();
  }
  return result;
}

namespace {

/// Stores the parameters and residuals of a step. The derivatives by logarithms of dampings change
/// in proportion to the dampings.
void accept_step(LeastSquares& at, const MotionMisfit& misfit, Eigen::Index free,
                 const Eigen::VectorXd& parameters, const Eigen::VectorXd& residuals) {
  for (Eigen::Index i = free; i < misfit.physical_parameters(); ++i) {
    if (!misfit.is_damping(i)) continue;
    at.derivatives.col(i) *= std::exp(parameters[i] - at.parameters[i]);
  }
  at.parameters = parameters;
  at.residuals = residuals;
}

}  // namespace

LeastSquares least_squares(MotionMisfit& misfit, const Eigen::VectorXd& start, int most_steps,
                           Eigen::Index free) {
  LeastSquares at{.parameters = start, .residuals = misfit.residuals(start), .derivatives = {}};
  if (!misfit.stop_reason().empty()) throw ConvergenceError(misfit.stop_reason());
  const auto freedom =
      std::max<double>(1, static_cast<double>(at.residuals.size() - start.size() + free));
  // Predicted decrease of a step that changes no parameter by more than a seventh of its standard
  // deviation.
  constexpr double negligible_decrease = 0.02;
  // Derivatives are kept as long as the predicted decrease falls by this factor in a step.
  constexpr double least_reduction = 0.25;
  constexpr int most_tries = 8;
  // Marquardt's damping. It starts at zero, because shapes and velocities that no marker determines
  // are damped by the prior alone.
  double damping = 0;
  constexpr double first_damping = 1e-4;
  double before = 0;
  bool renew = true;
  for (int step = 0;; ++step) {
    at.variance = std::max(at.residuals.squaredNorm() / freedom, misfit.least_variance());
    if (renew) at.derivatives = misfit.derivatives(at.parameters, at.residuals, free);
    const NormalEquations equations(at, misfit, free);
    const double decrease = equations.decrease();
    at.converged = decrease < negligible_decrease;
    if (at.converged || step == most_steps) return at;
    const bool stale = !renew;
    renew = stale && !(decrease < least_reduction * before);
    if (renew) {
      before = 0;
      continue;
    }
    before = decrease;
    const double sum = equations.sum(at.residuals, at.parameters);
    bool improved = false;
    for (int attempt = 0; attempt < most_tries && !improved; ++attempt) {
      const Eigen::VectorXd parameters = equations.after(equations.step(damping), at.parameters);
      const Eigen::VectorXd residuals = misfit.residuals(parameters);
      improved = misfit.stop_reason().empty() && equations.sum(residuals, parameters) < sum;
      if (improved) {
        accept_step(at, misfit, free, parameters, residuals);
      } else if (stale) {
        break;
      }
      damping = improved ? 0 : std::max(first_damping, 10 * damping);
    }
    if (!improved && !stale) return at;
    renew = !improved;
  }
}

std::optional<MotionStart> recorded_start(const Scene& scene, const MarkerMotion& recording,
                                          const RodDamping& damping, const SolveOptions& solve) {
  const std::vector<MarkerMotion> recordings{recording};
  MotionMisfit misfit(scene, recordings, {}, damping, solve);
  if (misfit.parameters() == 0) return std::nullopt;
  constexpr double shortest_stage_duration = 1;  // [s]
  constexpr int most_steps = 6;
  misfit.restrict_to(std::max(shortest_stage_duration, misfit.natural_time()));
  const LeastSquares found =
      least_squares(misfit, Eigen::VectorXd::Zero(misfit.parameters()), most_steps);
  return misfit.start(found.parameters, 0);
}

std::optional<MotionStart> given_start(const Scene& scene, double begin, const RodDamping& damping,
                                       const SolveOptions& solve) {
  if (!scene.start) return std::nullopt;
  std::optional<MotionStart> start = recorded_start_time(scene)
                                         ? recorded_start(scene, *scene.start, damping, solve)
                                         : smooth_start(scene, *scene.start, begin);
  if (start) return start;
  throw InputError(fmt::format(
      "{}: track.start = {}: too few points for a shape (allowed: four or more with those that "
      "grippers hold, in each half of the rod)",
      scene.file, scene.start->file));
}

}  // namespace dlo::compare
