#include "shooting/span_twist.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <utility>

#include "base/sized_samples.hpp"
#include "base/spin.hpp"
#include "dlo/energy_model/turns.hpp"
#include "shooting/gradient_flow.hpp"

namespace dlo::energy_model {
namespace {

constexpr double first_step = 0.5;          // first step of the roll [rad]
constexpr double longest_twist_step = 3;    // largest step of the roll [rad]
constexpr double shortest_step = 1.0 / 64;  // smallest step of the roll [rad]
constexpr int few_shots = 12;  // shots of a fast step; Newton's method needs two per iteration
// Maximum number of Newton iterations; more are slower than a shorter step.
constexpr int step_iterations = 12;
constexpr double most_turn = 0.5;         // largest rotation of a tangent in a step [rad]
constexpr double most_correction = 0.15;  // largest error of a predicted tangent [rad]

double largest_change(const std::vector<RodState>& a, const std::vector<RodState>& b) {
  return (tangents_of(a) - tangents_of(b)).colwise().norm().maxCoeff();
}

/// Continuation of a span from no roll of its frames to the full roll.
class Continuation {
 public:
  Continuation(const RodSpan& span, double tolerance, const Deadline& deadline)
      : span_(span), tolerance_(tolerance), deadline_(deadline) {}

  SpanEquilibrium run(const SpanEquilibrium& without) {
    now_ = without;
    shots_ = without.shots;
    find_targets();
    // With the frames held, rotating them needs energy, so that stability has to be judged again.
    now_.frames = frames(0);
    judge_stability(span_, tolerance_, now_);
    if (now_.converged && !now_.stable()) now_ = leave_saddle(span_, now_, options());
    if (!now_.converged) return failure(now_.message);
    double step = first_step;
    while (reached_ != target_) {
      if (deadline_.passed()) return failure(to_string(SolveStatus::time_limit));
      const double next = std::min(target_, reached_ + step);
      const double factor = advance(next);
      if (factor > 0) {
        step = std::min(longest_twist_step, step * factor);
        continue;
      }
      if (!before_.nodes.empty()) {
        before_ = {};  // the secant is spoiled if the shape has moved along a nearly zero mode
        continue;
      }
      if (step > shortest_step) {
        step /= 2;
        continue;
      }
      if (!follow_flow(next))
        return failure("no stable shape was found beyond this roll: " + problem_);
      step = first_step / 4;
    }
    now_.shots = shots_;
    return std::move(now_);
  }

 private:
  /// Computes the rolls of the frames, measured from the frames of the shape that ignores them.
  void find_targets() {
    const auto sample = [this](std::span<const double> at) {
      Samples samples = sized_samples(at, span_.length);
      const auto states = states_at(now_, span_, {at.begin(), at.end()}, tolerance_);
      for (std::size_t i = 0; i < states.size(); ++i) {
        samples.points.col(static_cast<Eigen::Index>(i)) = states[i].r;
        samples.tangents.col(static_cast<Eigen::Index>(i)) = states[i].t();
      }
      return samples;
    };
    for (const RodSpan::Clamp& clamp : span_.clamps) {
      const Eigen::Matrix3d own = now_.nodes[static_cast<std::size_t>(node_at(now_.s, clamp.at))].R;
      released_.push_back(frame_along(clamp.direction, own.col(0)));
      targets_.push_back(0);
      if (!clamp.frame) continue;
      const auto& [d1, turns] = *clamp.frame;
      // The angle is measured from the frame that the rod without rolls would have there.
      const Eigen::Matrix3d ahead_of = rolled(released_.back(), -span_.first_roll);
      const double ahead = std::atan2(ahead_of.col(1).dot(d1), ahead_of.col(0).dot(d1));
      const double first = span_.clamps.front().at;
      std::optional<Writhe> before;
      if (turns.turns) before = writhe(sample, first, clamp.at);
      targets_.back() = turned_angle(turns, ahead, twist_between(first, clamp.at), before);
      target_ = std::max(target_, std::abs(targets_.back()));
    }
  }

  /// Returns the rotation of the frames about the tangents of the shape without rolls [rad].
  [[nodiscard]] double twist_between(double begin, double end) const {
    constexpr int points = 512;
    std::vector<double> at;
    for (int i = 0; i <= points; ++i) at.push_back(begin + (end - begin) * i / points);
    const auto states = states_at(now_, span_, at, tolerance_);
    double twist = 0;
    for (std::size_t i = 1; i < states.size(); ++i) {
      const Eigen::Vector3d t = states[i].t();
      const Eigen::Vector3d carried =
          Eigen::Quaterniond::FromTwoVectors(states[i - 1].t(), t) * states[i - 1].R.col(0);
      const Eigen::Vector3d d1 = states[i].R.col(0);
      twist += std::atan2(carried.cross(d1).dot(t), carried.dot(d1));
    }
    return twist;
  }

  [[nodiscard]] ShootingOptions options() const {
    return {.tolerance = tolerance_, .max_iterations = step_iterations, .deadline = deadline_};
  }

  /// Returns the frames for which the largest roll is `roll` [rad].
  [[nodiscard]] ClampFrames frames(double roll) const {
    ClampFrames held = released_frames(span_);
    for (std::size_t k = 0; k < held.size(); ++k) {
      const double own = target_ > 0 ? roll / target_ * targets_[k] : 0;
      if (span_.clamps[k].frame) held[k] = rolled(released_[k], own);
    }
    return held;
  }

  [[nodiscard]] SpanEquilibrium failure(const std::string& message) const {
    SpanEquilibrium failed;
    failed.shots = shots_;
    failed.message = "followed up to a roll of " + std::to_string(reached_) + " of " +
                     std::to_string(target_) + " rad: " + message;
    return failed;
  }

  /// Returns the secant through the last two shapes, or the last shape if there is only one.
  [[nodiscard]] std::vector<RodState> predicted(double next) const {
    std::vector<RodState> nodes = now_.nodes;
    if (before_.nodes.empty()) return nodes;
    const double part = (next - reached_) / (reached_ - reached_before_);
    const std::vector<RodState> before =
        states_at(before_, span_, {now_.s.begin(), now_.s.end()}, tolerance_);
    for (std::size_t i = 0; i < nodes.size(); ++i) {
      RodState& node = nodes[i];
      node.r += part * (node.r - before[i].r);
      node.m += part * (node.m - before[i].m);
      node.n += part * (node.n - before[i].n);
      // The frame rotates about the tangent by many times the angle of the tangents, so that it is
      // extrapolated on a circle.
      const Eigen::Vector3d t = node.t();
      const Eigen::Matrix3d old = transported(before[i].R, t);
      const double turn = std::atan2(old.col(1).dot(node.R.col(0)), old.col(0).dot(node.R.col(0)));
      const Eigen::Vector3d tangent = (t + part * (t - before[i].t())).normalized();
      node.R = rolled(transported(node.R, tangent), part * turn);
    }
    return nodes;
  }

  /// Takes one step by Newton's method.
  /// @return factor for the next step size; 0 if this step has to be shorter
  double advance(double next) {
    const std::vector<RodState> start = predicted(next);
    const RodMesh mesh = mesh_at(span_, now_.s);
    SpanEquilibrium found = shoot_span(span_, mesh, start, frames(next), options());
    shots_ += found.shots;
    problem_ = found.message;
    if (!found.converged) return 0;
    const std::vector<RodState> at_nodes =
        states_at(found, span_, {now_.s.begin(), now_.s.end()}, tolerance_);
    if (largest_change(at_nodes, now_.nodes) > most_turn) return 0;
    if (!before_.nodes.empty() && largest_change(at_nodes, start) > most_correction) return 0;
    const double factor = found.shots <= few_shots ? 1.6 : 1;
    if (found.stable()) {
      accept(next, std::move(found));
      return factor;
    }
    SpanEquilibrium left = leave_saddle(span_, found, options());
    shots_ += left.shots;
    problem_ = left.message;
    if (!left.converged) return 0;
    accept(next, std::move(left));
    before_ = {};  // a secant across a branch jump is useless
    return 1;
  }

  /// Follows the gradient flow at a roll beyond the end of the branch.
  bool follow_flow(double next) {
    const RodMesh mesh = mesh_at(span_, now_.s);
    SpanEquilibrium found =
        follow_gradient(span_, mesh, now_.nodes, frames_of(now_.nodes), frames(next), options());
    shots_ += found.shots;
    problem_ = found.message;
    if (!found.converged) return false;
    accept(next, std::move(found));
    before_ = {};
    return true;
  }

  void accept(double roll, SpanEquilibrium found) {
    before_ = std::exchange(now_, std::move(found));
    reached_before_ = std::exchange(reached_, roll);
  }

  const RodSpan& span_;
  double tolerance_;
  Deadline deadline_;
  std::vector<Eigen::Matrix3d> released_;  // frames at the clamps before their rotation
  std::vector<double> targets_;            // roll of each frame [rad]
  double target_ = 0;                      // largest roll [rad]
  double reached_ = 0;
  double reached_before_ = 0;
  SpanEquilibrium now_;
  SpanEquilibrium before_;  // last but one shape; without nodes: no secant
  std::string problem_;
  int shots_ = 0;
};

}  // namespace

SpanEquilibrium twist_span(const RodSpan& span, const SpanEquilibrium& without, double tolerance,
                           const Deadline& deadline) {
  if (!without.converged) return without;
  return Continuation(span, tolerance, deadline).run(without);
}

}  // namespace dlo::energy_model
