#include "dlo/energy_model/vibrations.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "base/deadline.hpp"
#include "base/require.hpp"
#include "problem/rod_law.hpp"
#include "problem/split.hpp"
#include "search/known_shape.hpp"
#include "strain/span_energy.hpp"
#include "vibration/inertia.hpp"
#include "vibration/resolved_vibrations.hpp"

namespace dlo::energy_model {
namespace {

void check_options(const VibrationOptions& options) {
  const char* where = "vibrations";
  require(options.count > 0, where, "count", options.count, "> 0");
  require(options.tolerance > 0, where, "tolerance", options.tolerance, "> 0");
  require(options.time_limit > 0, where, "time_limit", options.time_limit, "> 0");
}

/// Largest deviation of a straight rod's grips, by rounding.
constexpr double straight_rounding = 1e-9;

/// Returns the problem with a small slack between its grips, which is required of problems. A
/// straight rod does not depend on it.
Problem with_slack(const Problem& problem) {
  constexpr double slack = 1e-8;
  Problem result = problem;
  for (Grip& grip : result.grips) {
    grip.position = problem.grips.front().position +
                    (1 - slack) * (grip.position - problem.grips.front().position);
  }
  return result;
}

void require_energy_in_space(const Problem& problem) {
  require(!problem.confined_to_plane, "vibrations", "confined_to_plane", 1,
          "false: only solve_energy() confines a rod to a plane");
  require(!has_couples(problem), "vibrations", "torque of a load", 1,
          "0: a couple has no potential out of the plane of the rod");
}

/// Checks that nothing bends or twists the rod. @throws std::invalid_argument otherwise
void require_nothing_bends(const Problem& problem) {
  const char* where = "taut_vibrations";
  double weight = problem.weight_per_length.norm();
  for (const Section& section : problem.sections) {
    weight = std::max(weight, section.weight_per_length.norm());
  }
  for (const LineLoad& load : problem.line_loads) {
    weight = std::max({weight, load.at_begin.norm(), load.at_end.norm()});
  }
  require(weight == 0, where, "weight_per_length", weight,
          "0: a rod with weight is not straight under a finite uniform tension");
  for (const Load& load : problem.loads) {
    require(load.force.norm() == 0, where, "load", load.force.norm(), "0 for a rod held straight");
  }
  require(problem.obstacles.empty(), where, "number of obstacles",
          static_cast<double>(problem.obstacles.size()), "0 for a rod held straight");
  require(problem.natural_strains.empty(), where, "number of natural_strains",
          static_cast<double>(problem.natural_strains.size()), "0 for a rod held straight");
}

}  // namespace

double VibrationMode::omega() const { return std::sqrt(omega_squared); }

Vibrations vibrations(const Problem& problem, const Inertia& inertia, const Equilibrium& known,
                      const VibrationOptions& options) {
  check(problem);
  require_energy_in_space(problem);
  check(problem, inertia, "vibrations");
  check_options(options);
  Vibrations result;
  result.status = SolveStatus::failed;
  if (!known.sample) {
    result.message = "there is no equilibrium to vibrate about: " + known.message;
    return result;
  }
  if (!known.contacts.empty()) {
    result.message = "the rod touches a rigid obstacle and would lift off while it vibrates";
    return result;
  }
  const Deadline deadline(options.time_limit);
  return resolved_vibrations(
      problem, inertia,
      [&](int terms, SpanWorkspace& workspace) {
        return spans_in_space(problem, known, terms, deadline, workspace);
      },
      &known, options);
}

bool is_held_straight(const Problem& problem) {
  std::vector<Grip> grips = problem.grips;
  std::sort(grips.begin(), grips.end(), [](const Grip& a, const Grip& b) { return a.at < b.at; });
  for (std::size_t i = 0; i < grips.size(); ++i) {
    if (!grips[i].direction) return false;
    const Eigen::Vector3d along = grips[0].direction->normalized();
    const double rod = grips[i].at - grips[0].at;
    const Eigen::Vector3d offset = grips[i].position - grips[0].position - rod * along;
    if (!(offset.norm() <= straight_rounding * rod)) return false;
    if (!((grips[i].direction->normalized() - along).norm() <= straight_rounding)) return false;
  }
  return grips.size() > 1;
}

Vibrations taut_vibrations(const Problem& problem, const Inertia& inertia, double tension,
                           const VibrationOptions& options) {
  const char* where = "taut_vibrations";
  const Problem slack = with_slack(problem);
  check(slack);
  check(slack, inertia, where);
  check_options(options);
  require(std::isfinite(tension), where, "tension", tension, "finite");
  require_energy_in_space(problem);
  require_nothing_bends(problem);
  if (!is_held_straight(problem)) {
    throw std::invalid_argument(std::string(where) +
                                ": clamps do not hold the rod straight along its whole length");
  }
  const double force_unit = bending_unit(problem) / (problem.length * problem.length);
  return resolved_vibrations(
      slack, inertia,
      [&](int terms, SpanWorkspace& workspace) {
        std::vector<PlacedSolution> spans;
        for (PlacedSpan& placed : split(slack)) {
          if (placed.frames) {
            throw std::invalid_argument(std::string(where) + ": clamps hold the rod's frame");
          }
          placed.span.planar = false;
          SpanSolution solution;
          solution.model = workspace.model(placed.span, terms);
          solution.terms = terms;
          solution.x = Eigen::VectorXd::Zero(solution.model->size());
          solution.multipliers = Eigen::VectorXd::Zero(solution.model->constraints());
          if (!placed.span.holds.empty()) {
            solution.multipliers.head<3>() = tension / force_unit * *placed.span.start_direction;
          }
          solution.finish(SolveStatus::converged);
          spans.push_back({std::move(placed), std::move(solution)});
        }
        return spans;
      },
      nullptr, options);
}

}  // namespace dlo::energy_model
