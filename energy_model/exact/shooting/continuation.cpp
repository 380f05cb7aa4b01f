#include "shooting/continuation.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>
#include <string>
#include <utility>

#include "base/sized_samples.hpp"
#include "base/spin.hpp"
#include "dlo/energy_model/status.hpp"
#include "dlo/energy_model/turns.hpp"

namespace dlo::energy_model {
namespace {

// Largest number of shots of a step after which the next one is longer; Newton's method needs two
// per iteration.
constexpr int step_growth_integrations = 12;
constexpr double step_growth = 1.6;  // ratio of a longer step to the one before it
// Maximum number of Newton iterations; more are slower than a shorter step.
constexpr int step_iterations = 12;
constexpr double largest_tangent_change = 0.5;     // largest change of a tangent in a step
constexpr double largest_prediction_error = 0.15;  // largest error of a predicted tangent

double largest_change(const std::vector<RodState>& a, const std::vector<RodState>& b) {
  return (tangents_of(a) - tangents_of(b)).colwise().norm().maxCoeff();
}

/// Problems of a span by one parameter, from 0 to `end`.
struct Family {
  std::function<RodSpan(double)> span;
  std::function<ClampFrames(double)> frames;
  double end = 1;
  double first = 0.5, shortest = 0, longest = 1;  // steps
  bool stable = false;                            // whether unstable equilibria are left
  Motion motion = Motion::in_space;
};

/// Natural continuation of an equilibrium by the parameter of a family of problems. Newton's method
/// starts from a secant, or else from the last shape. Steps grow if it needs few shots, and are
/// halved if it does not converge or the shape jumps.
class Continuation {
 public:
  Continuation(const Family& family, const SpanEquilibrium& begin, double tolerance,
               const Deadline& deadline)
      : family_(family),
        options_{.tolerance = std::max(tolerance, coarse_tolerance),
                 .motion = family.motion,
                 .max_iterations = step_iterations,
                 .deadline = deadline},
        tolerance_(tolerance),
        now_(begin),
        integrations_(begin.integrations) {}

  /// Returns the equilibrium at the end of the family, or a failed one with the cause.
  SpanEquilibrium run() {
    double step = family_.first;
    while (reached_ < family_.end) {
      if (options_.deadline.passed()) return failure(to_string(SolveStatus::time_limit));
      const double next = std::min(family_.end, reached_ + step);
      const double factor = advance(next);
      if (factor > 0) {
        step = std::min(family_.longest, step * factor);
      } else if (!before_.nodes.empty()) {
        before_ = {};  // the secant is spoiled if the shape has moved along a nearly zero mode
      } else if (step > family_.shortest) {
        step /= 2;
      } else if (family_.stable && flow_to(next)) {
        step = family_.first / 4;
      } else {
        return failure((family_.stable ? "no stable shape was found beyond it: " : "") + cause_);
      }
    }
    options_.tolerance = tolerance_;
    const RodSpan span = family_.span(family_.end);
    SpanEquilibrium last = shoot(span, family_.end, now_.nodes);
    if (last.converged && family_.stable && !last.stable()) {
      last = leave_saddle(span, last, options_);
      integrations_ += last.integrations;
    }
    last.integrations = integrations_;
    return last;
  }

  [[nodiscard]] double reached() const { return reached_; }

 private:
  [[nodiscard]] SpanEquilibrium failure(const std::string& cause) const {
    SpanEquilibrium failed;
    failed.integrations = integrations_;
    failed.message = cause;
    return failed;
  }

  SpanEquilibrium shoot(const RodSpan& span, double at, const std::vector<RodState>& start) {
    SpanEquilibrium found =
        shoot_span(span, mesh_at(span, now_.s), start, family_.frames(at), options_);
    integrations_ += found.integrations;
    cause_ = found.message;
    return found;
  }

  [[nodiscard]] std::vector<RodState> states_at_nodes(const SpanEquilibrium& equilibrium,
                                                      const RodSpan& span) const {
    std::vector<RodState> states =
        states_at(equilibrium, span, {now_.s.begin(), now_.s.end()}, options_.tolerance);
    states.back().m.setZero();
    states.back().n.setZero();
    return states;
  }

  /// Returns the secant through the last two shapes, or the last shape if there is only one.
  [[nodiscard]] std::vector<RodState> predicted(double next) const {
    std::vector<RodState> nodes = now_.nodes;
    if (before_.nodes.empty()) return nodes;
    const double part = (next - reached_) / (reached_ - reached_before_);
    const std::vector<RodState> before = states_at_nodes(before_, family_.span(reached_before_));
    for (std::size_t i = 0; i < nodes.size(); ++i) {
      RodState& node = nodes[i];
      node.r += part * (node.r - before[i].r);
      node.m += part * (node.m - before[i].m);
      node.n += part * (node.n - before[i].n);
      // If clamps twist the rod, the frame may rotate about the tangent by many times the angle of
      // the tangents, so that it is extrapolated on a circle.
      const Eigen::Vector3d t = node.t();
      const Eigen::Matrix3d old = transported(before[i].R, t);
      const double turn = std::atan2(old.col(1).dot(node.R.col(0)), old.col(0).dot(node.R.col(0)));
      const Eigen::Vector3d tangent = (t + part * (t - before[i].t())).normalized();
      node.R = rolled(transported(node.R, tangent), part * turn);
    }
    return nodes;
  }

  /// Takes one step by Newton's method.
  /// @return factor for the next step size; 0 if the step failed
  double advance(double next) {
    const RodSpan span = family_.span(next);
    const std::vector<RodState> start = predicted(next);
    SpanEquilibrium found = shoot(span, next, start);
    if (!found.converged) return 0;
    const std::vector<RodState> states = states_at_nodes(found, span);
    if (largest_change(states, now_.nodes) > largest_tangent_change) return 0;
    if (!before_.nodes.empty() && largest_change(states, start) > largest_prediction_error)
      return 0;
    const double factor = found.integrations <= step_growth_integrations ? step_growth : 1;
    if (!family_.stable || found.stable()) {
      accept(next, std::move(found));
      return factor;
    }
    return accept_after_flow(next, leave_saddle(span, found, options_)) ? 1 : 0;
  }

  /// Follows the gradient flow at a parameter beyond the end of the branch.
  bool flow_to(double next) {
    const RodSpan span = family_.span(next);
    return accept_after_flow(
        next, follow_gradient(span, mesh_at(span, now_.s), now_.nodes, frames_of(now_.nodes),
                              family_.frames(next), options_));
  }

  bool accept_after_flow(double next, SpanEquilibrium found) {
    integrations_ += found.integrations;
    cause_ = found.message;
    if (!found.converged) return false;
    accept(next, std::move(found));
    before_ = {};  // a secant across a branch jump is useless
    return true;
  }

  void accept(double next, SpanEquilibrium found) {
    before_ = std::exchange(now_, std::move(found));
    reached_before_ = std::exchange(reached_, next);
  }

  const Family& family_;
  ShootingOptions options_;
  double tolerance_;
  double reached_ = 0;
  double reached_before_ = 0;
  SpanEquilibrium now_;
  SpanEquilibrium before_;  // last but one shape; without nodes: no secant
  std::string cause_;       // why the last step failed
  int integrations_ = 0;
};

/// Frames at the clamps of a span before their rotation, and the roll of each [rad].
struct Rolls {
  std::vector<Eigen::Matrix3d> released;
  std::vector<double> targets;
  double largest = 0;
};

/// Computes the rolls of the frames, measured from the frames of the shape that ignores them.
Rolls rolls_of(const RodSpan& span, const SpanEquilibrium& without, double tolerance) {
  const auto sample = [&](std::span<const double> at) {
    Samples samples = sized_samples(at, span.length);
    const auto states = states_at(without, span, {at.begin(), at.end()}, tolerance);
    for (std::size_t i = 0; i < states.size(); ++i) {
      samples.points.col(static_cast<Eigen::Index>(i)) = states[i].r;
      samples.tangents.col(static_cast<Eigen::Index>(i)) = states[i].t();
    }
    return samples;
  };
  Rolls rolls;
  for (const RodSpan::Clamp& clamp : span.clamps) {
    const auto node = static_cast<std::size_t>(node_at(without.s, clamp.at));
    rolls.released.push_back(frame_along(clamp.direction, without.nodes[node].R.col(0)));
    rolls.targets.push_back(0);
    if (!clamp.frame) continue;
    const auto& [d1, turns] = *clamp.frame;
    // The angle is measured from the frame that the rod without rolls would have there.
    const Eigen::Matrix3d ahead_of = rolled(rolls.released.back(), -span.first_roll);
    const double frame_angle = std::atan2(ahead_of.col(1).dot(d1), ahead_of.col(0).dot(d1));
    const double first = span.clamps.front().at;
    std::optional<Writhe> before;
    if (turns.turns) before = writhe(sample, first, clamp.at);
    // Rotation of the frames about the tangents of the shape without rolls
    double twist = 0;
    for (auto i = node_at(without.s, first); i < node_at(without.s, clamp.at); ++i) {
      twist += without.turns[static_cast<std::size_t>(i)];
    }
    rolls.targets.back() = end_rotation(turns, frame_angle, twist, before);
    rolls.largest = std::max(rolls.largest, std::abs(rolls.targets.back()));
  }
  return rolls;
}

}  // namespace

SpanEquilibrium twist_span(const RodSpan& span, const SpanEquilibrium& without, double tolerance,
                           const Deadline& deadline) {
  if (!without.converged) return without;
  const Rolls rolls = rolls_of(span, without, tolerance);
  const auto frames = [&](double roll) {
    ClampFrames rolled_frames = released_frames(span);
    for (std::size_t k = 0; k < rolled_frames.size(); ++k) {
      const double own = rolls.largest > 0 ? roll / rolls.largest * rolls.targets[k] : 0;
      if (span.clamps[k].frame) rolled_frames[k] = rolled(rolls.released[k], own);
    }
    return rolled_frames;
  };
  const Family family{.span = [&](double) { return span; },
                      .frames = frames,
                      .end = rolls.largest,
                      .first = 0.5,  // [rad]
                      .shortest = 1.0 / 64,
                      .longest = 3,
                      .stable = true};
  // With the frames held, rotating them needs energy, so that stability has to be judged again.
  SpanEquilibrium begin = without;
  begin.frames = frames(0);
  judge_stability(span, tolerance, begin);
  if (begin.converged && !begin.stable()) {
    begin = leave_saddle(
        span, begin,
        {.tolerance = tolerance, .max_iterations = step_iterations, .deadline = deadline});
    begin.integrations += without.integrations;
  }
  Continuation continuation(family, begin, tolerance, deadline);
  SpanEquilibrium result = begin.converged ? continuation.run() : std::move(begin);
  if (!result.converged) {
    result.message = "twisted by a roll of " + std::to_string(continuation.reached()) + " of " +
                     std::to_string(rolls.largest) + " rad: " + result.message;
  }
  return result;
}

SpanEquilibrium follow_loads(const RodSpan& span, const SpanEquilibrium& unloaded, double tolerance,
                             const Deadline& deadline) {
  const bool flat = span.round() && out_of_plane(span, unloaded.nodes) < 1e-9;
  const Family family{.span = [&](double share) { return scale_nonpotential_loads(span, share); },
                      .frames = [&](double) { return unloaded.frames; },
                      .first = 0.125,
                      .shortest = 1e-4,
                      .longest = 0.5,  // at least two steps are taken
                      .motion = flat ? Motion::in_plane : Motion::in_space};
  Continuation continuation(family, unloaded, tolerance, deadline);
  SpanEquilibrium result = continuation.run();
  if (!result.converged && !deadline.passed()) {
    result.message = "the continuation from the equilibrium under the dead loads ends at " +
                     std::to_string(continuation.reached()) +
                     " of the loads without a potential: no other equilibrium is searched for";
  }
  return result;
}

RodSpan with_stretch_share(RodSpan span, double share) {
  for (RodSpan::Part& part : span.parts) part.section.stretch *= share;
  return span;
}

SpanEquilibrium stretch_span(const RodSpan& span, const SpanEquilibrium& rigid, double tolerance,
                             const Deadline& deadline) {
  if (!rigid.converged) return rigid;
  const Family family{.span = [&](double share) { return with_stretch_share(span, share); },
                      .frames = [&](double) { return rigid.frames; },
                      .first = 1,
                      .shortest = 1.0 / 256};
  return Continuation(family, rigid, tolerance, deadline).run();
}

}  // namespace dlo::energy_model
