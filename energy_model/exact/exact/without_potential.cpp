#include "exact/without_potential.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "base/require.hpp"
#include "base/spin.hpp"
#include "dlo/energy_model/natural_frame.hpp"
#include "exact/follow_loads.hpp"
#include "kirchhoff/rod_span.hpp"
#include "problem/ordered_grips.hpp"
#include "problem/rod_law.hpp"
#include "shooting/refine_span.hpp"
#include "shooting/solved_rod.hpp"

namespace dlo::energy_model {
namespace {

void require_followable(const Problem& problem) {
  check(problem);
  require(problem.obstacles.empty(), "solve_exact", "number of obstacles",
          static_cast<double>(problem.obstacles.size()),
          "0 if a load has no potential (drag, a follower load, a couple in space)");
  for (const Load& load : problem.loads) {
    require(!load.follows || !clamp_under(problem, load), "solve_exact",
            "arc length of a follower load", load.at, "different from those of the clamps");
  }
  const int held = clamps_with_frames(problem);
  require(held <= 2 || has_material_directors(problem), "solve_exact",
          "number of clamps with frames", held, "<= 2 if a load has no potential");
}

/// Returns the problem without drag, couples and loads that follow the rod. Material directors keep
/// their direction, which a plane of the remaining forces might otherwise change.
Problem without_nonpotential_loads(Problem problem, const RodSpan& span) {
  const std::optional<std::size_t> first = first_clamp(problem);
  if (has_material_directors(problem) && first) {
    Grip& clamp = problem.grips[*first];
    if (!clamp.frame) clamp.frame = FrameHold{};
    clamp.frame->d1 = rolled(span.first_frame, -clamp.frame->roll).col(0);
  }
  problem.drag.reset();
  for (Load& load : problem.loads) {
    load.torque.setZero();
    if (load.follows) load.force.setZero();
    load.follows = false;
  }
  return problem;
}

/// Returns the problem with its loads replaced by dead ones that are equal to them on a given
/// shape.
Problem frozen_on(const Problem& problem, const RodSpan& span, const Equilibrium& shape) {
  constexpr Eigen::Index pieces = 64;
  Problem dead = problem;
  if (problem.drag) {
    const std::vector<double> s = equal_arc_lengths(problem.length, pieces + 1);
    const Eigen::Matrix3Xd tangents = shape.sample(s).tangents;
    for (std::size_t i = 1; i < s.size(); ++i) {
      const auto column = static_cast<Eigen::Index>(i);
      dead.line_loads.push_back({s[i - 1], s[i],
                                 problem.drag->force(tangents.col(column - 1).normalized()),
                                 problem.drag->force(tangents.col(column).normalized())});
    }
    dead.drag.reset();
  }
  for (Load& load : dead.loads) {
    if (!load.follows) continue;
    const std::vector<double> at = {load.at};
    const Samples here = shape.sample(at);
    const Eigen::Vector3d t = here.tangents.col(0).normalized();
    const Eigen::Matrix3d R =
        here.d1.cols() > 0 ? frame_along(t, here.d1.col(0)) : transported(span.first_frame, t);
    load.force = R * load.force;
    load.torque = R * load.torque;
    load.follows = false;
  }
  return dead;
}

Equilibrium failed_start(const Equilibrium& dead) {
  Equilibrium result;
  result.status = SolveStatus::failed;
  result.message = "start under only the loads that have a potential: " + dead.message;
  result.evaluations = dead.evaluations;
  return result;
}

}  // namespace

Equilibrium solve_without_potential(const Problem& problem, const ExactOptions& options,
                                    const Deadline& deadline) {
  require_followable(problem);
  const RodSpan span = with_own_axes(problem);
  if (options.start != nullptr) {
    SpanEquilibrium found = refine_span(span, frozen_on(problem, span, *options.start),
                                        *options.start, options.tolerance, deadline);
    return assemble(problem, {{span}, {std::move(found)}}, options.tolerance);
  }
  const Problem base = without_nonpotential_loads(problem, span);
  const Equilibrium dead = solve_exact(
      base, {.tolerance = options.tolerance,
             .time_limit = std::max(deadline.remaining(), std::numeric_limits<double>::min())});
  if (!dead.sample) return failed_start(dead);
  SpanEquilibrium found = refine_span(loaded_by(span, 0), base, dead, options.tolerance, deadline);
  if (found.converged) {
    found.shots += dead.evaluations;
    found = follow_loads(span, found, options.tolerance, deadline);
  }
  return assemble(problem, {{span}, {std::move(found)}}, options.tolerance);
}

}  // namespace dlo::energy_model
