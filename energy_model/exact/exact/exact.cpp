#include "dlo/energy_model/exact.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/deadline.hpp"
#include "base/found_equilibria.hpp"
#include "base/require.hpp"
#include "base/spin.hpp"
#include "dlo/energy_model/balance.hpp"
#include "dlo/energy_model/natural_frame.hpp"
#include "dlo/energy_model/soft_line.hpp"
#include "kirchhoff/rod_span.hpp"
#include "problem/rod_law.hpp"
#include "shooting/continuation.hpp"
#include "shooting/span_search.hpp"
#include "touching/contacts.hpp"

namespace dlo::energy_model {
namespace {

constexpr std::size_t most_results = 64;  // largest number of combinations of the spans' equilibria

/// Result of a search: equilibria, stable ones first, by energy; and the omitted parts of the
/// search.
struct Found {
  std::vector<Equilibrium> equilibria;
  bool out_of_time = false;
  std::vector<std::string> not_searched;  // descriptions of the omitted parts
};

/// Finds equilibria of a span: near the start, by the scan of the tip if tip_can_be_scanned() for
/// the whole rod, or by the search.
SpanSearchResult search_one(const Problem& problem, const RodSpan& span,
                            const ExactOptions& options, const Deadline& deadline) {
  if (options.start != nullptr) {
    SpanSearchResult result;
    result.found = {refine_span(span, problem, *options.start, options.tolerance, deadline)};
    result.complete = !deadline.passed();
    return result;
  }
  const bool scans = span.length == 1 && tip_can_be_scanned(span);
  return scans ? scan_tip(span, options.tolerance, deadline)
               : search_span(span, options.tolerance, deadline);
}

/// Returns the lowest combinations of the equilibria that are found for the spans. A rod with
/// material directors is one span.
Found solve_spans(const Problem& problem, const ExactOptions& options, const Deadline& deadline) {
  SolvedRod rod;
  rod.spans = has_material_directors(problem) ? std::vector<RodSpan>{whole_directed_span(problem)}
                                              : cut_at_clamps(problem);
  Found result;
  std::vector<std::vector<SpanEquilibrium>> found;
  std::vector<std::vector<SpanCandidate>> candidates;
  for (const RodSpan& span : rod.spans) {
    SpanSearchResult search = search_one(problem, span, options, deadline);
    result.out_of_time = result.out_of_time || !search.complete;
    if (!search.not_searched.empty()) result.not_searched.push_back(search.not_searched);
    found.push_back(std::move(search.found));
    std::vector<SpanCandidate> own;
    for (const SpanEquilibrium& equilibrium : found.back()) {
      own.push_back({equilibrium.stable(), equilibrium.energy.total()});
      // They are sorted up to rounding, and energies that are equal up to rounding keep this order.
      if (own.size() < 2 || own.rbegin()[1].stable != own.back().stable) continue;
      own.back().energy = std::max(own.back().energy, own.rbegin()[1].energy);
    }
    candidates.push_back(std::move(own));
  }
  const Combinations combinations = lowest_combinations(candidates, most_results);
  for (const std::vector<std::size_t>& choice : combinations.choices) {
    rod.equilibria.clear();
    for (std::size_t i = 0; i < found.size(); ++i) rod.equilibria.push_back(found[i][choice[i]]);
    result.equilibria.push_back(assemble(problem, rod, options.tolerance));
  }
  if (combinations.truncated) {
    result.not_searched.push_back("only the lowest " + std::to_string(most_results) +
                                  " combinations of spans are listed");
  }
  return result;
}

/// Refuses clamps that transmit a torque, because the spans of a round, intrinsically straight rod
/// are twisted independently.
void require_no_transmitted_torque(const Problem& problem) {
  const std::vector<OrderedGrip> grips = ordered_grips(problem);
  const auto holds = [](const OrderedGrip& g) { return g.grip->frame.has_value(); };
  const auto first = std::find_if(grips.begin(), grips.end(), holds);
  const auto last = std::find_if(grips.rbegin(), grips.rend(), holds).base();
  for (auto g = first; g < last; ++g) {
    require(!g->grip->direction || holds(*g), "solve_exact",
            "arc length of a clamp without a frame between two clamps with frames", g->grip->at,
            "the arc length of a clamp with a frame or of a pin");
  }
}

void require_followable(const Problem& problem) {
  check(problem);
  require(problem.obstacles.empty(), "solve_exact", "number of obstacles",
          static_cast<double>(problem.obstacles.size()),
          "0 if a load has no potential (drag, a follower load, a couple in space)");
  for (const Load& load : problem.loads) {
    require(!load.follows || !clamp_at_load(problem, load), "solve_exact",
            "arc length of a follower load", load.at, "different from those of the clamps");
  }
  const int clamp_count = clamps_with_frames(problem);
  require(clamp_count <= 2 || has_material_directors(problem), "solve_exact",
          "number of clamps with frames", clamp_count, "<= 2 if a load has no potential");
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
Problem with_frozen_loads(const Problem& problem, const RodSpan& span, const Equilibrium& shape) {
  Problem dead = problem;
  if (problem.drag) {
    const std::vector<double> s = equal_arc_lengths(problem.length, 65);
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

/// Returns an equilibrium of a rod with loads that have no potential. It is the continuation of the
/// lowest equilibrium under the other loads as these loads grow from zero, or the one to which
/// Newton's method converges from the options' start. It is `not_verified`, because without an
/// energy its stability is undetermined.
/// @throws std::invalid_argument as solve_exact(), or if there are obstacles, a load follows the
/// rod at a clamp, or more than two clamps hold frames of a round straight rod
Equilibrium solve_without_potential(const Problem& problem, const ExactOptions& options,
                                    const Deadline& deadline) {
  require_followable(problem);
  const RodSpan span = whole_span_with_axes(problem);
  if (options.start != nullptr) {
    SpanEquilibrium found = refine_span(span, with_frozen_loads(problem, span, *options.start),
                                        *options.start, options.tolerance, deadline);
    return assemble(problem, {{span}, {std::move(found)}}, options.tolerance);
  }
  const Problem base = without_nonpotential_loads(problem, span);
  const Equilibrium dead = solve_exact(
      base, {.tolerance = options.tolerance,
             .time_limit = std::max(deadline.remaining(), std::numeric_limits<double>::min())});
  if (!dead.sample) {
    Equilibrium failed;
    failed.status = SolveStatus::failed;
    failed.message = "start under only the loads that have a potential: " + dead.message;
    failed.evaluations = dead.evaluations;
    return failed;
  }
  SpanEquilibrium found =
      refine_span(scale_nonpotential_loads(span, 0), base, dead, options.tolerance, deadline);
  if (found.converged) {
    found.integrations += dead.evaluations;
    found = follow_loads(span, found, options.tolerance, deadline);
  }
  return assemble(problem, {{span}, {std::move(found)}}, options.tolerance);
}

/// Returns the equilibrium whose contacts are those of the start.
Equilibrium confirm_start(const Problem& problem, const ExactOptions& options,
                          const Deadline& deadline) {
  require(!problem.axial_stiffness, "solve_exact", "axial_stiffness",
          problem.axial_stiffness.value_or(0), "omitted if there are obstacles");
  require(!has_couples(problem), "solve_exact", "torque of a load", 1, "0 if there are obstacles");
  for (const LineLoad& load : problem.line_loads) {
    require(load.at_begin == load.at_end, "solve_exact", "force per length of a line load",
            load.at_end.norm(), "constant if there are obstacles");
  }
  const auto obstacles = static_cast<double>(problem.obstacles.size());
  require(options.start != nullptr, "solve_exact", "number of obstacles", obstacles,
          "0 unless a start with its contacts is given, such as a result of solve_energy()");
  std::optional<Equilibrium> found =
      confirm_contacts(problem, *options.start, options.tolerance, deadline);
  require(found.has_value(), "solve_exact", "number of obstacles", obstacles,
          "0 unless they are rigid, the rod has no natural strains, and its contacts are between "
          "grips");
  return *std::move(found);
}

/// Solves the problem. The result is never empty. After the time limit the equilibria found so far
/// have the status `time_limit`: they are equilibria, but the search for others is incomplete.
std::vector<Equilibrium> solve(const Problem& problem, const ExactOptions& options) {
  const Deadline deadline(options.time_limit);
  require_positive("solve_exact", "tolerance", options.tolerance);
  require(options.time_limit > 0, "solve_exact", "time_limit", options.time_limit, "> 0");
  require(!problem.confined_to_plane, "solve_exact", "confined_to_plane", 1,
          "false: only solve_energy() confines a rod to a plane");
  const bool judged = has_potential(problem);
  require(judged || !problem.axial_stiffness, "solve_exact", "axial_stiffness",
          problem.axial_stiffness.value_or(0),
          "omitted for a rod with drag, follower loads, or couples out of its plane");
  if (judged && !problem.axial_stiffness) {
    if (std::optional<Equilibrium> line = shape_without_search(problem)) return {*std::move(line)};
  }
  Found found;
  if (!judged) {
    found.equilibria = {solve_without_potential(problem, options, deadline)};
    found.out_of_time = deadline.passed();
  } else if (problem.obstacles.empty()) {
    if (!has_material_directors(problem)) require_no_transmitted_torque(problem);
    found = solve_spans(problem, options, deadline);
  } else {
    found.equilibria = {confirm_start(problem, options, deadline)};
  }
  const double seconds = deadline.spent();
  for (Equilibrium& equilibrium : found.equilibria) {
    equilibrium.seconds = seconds;
    separate_line_loads(problem, equilibrium);
    judge_balance(problem, equilibrium);
    for (const std::string& part : found.not_searched) equilibrium.message += "; " + part;
    if (!found.out_of_time) continue;
    const bool holds = static_cast<bool>(equilibrium.sample);
    const std::string reached = equilibrium.message;
    equilibrium.status = SolveStatus::time_limit;
    equilibrium.message = std::string(to_string(equilibrium.status)) + " after " +
                          std::to_string(options.time_limit) + " s: " + reached +
                          (holds ? "; other equilibria may have less energy" : "");
  }
  return std::move(found.equilibria);
}

}  // namespace

std::vector<Equilibrium> all_exact(const Problem& problem, const ExactOptions& options) {
  std::vector<Equilibrium> equilibria = solve(problem, options);
  std::erase_if(equilibria, [&](const Equilibrium& equilibrium) {
    if (succeeded(equilibrium.status) || equilibrium.status == SolveStatus::saddle) return false;
    if (!equilibrium.sample) return true;
    // A shape that was found before the time limit is an equilibrium; only the list may be
    // incomplete. Without a potential balance alone is checked.
    return equilibrium.status != SolveStatus::time_limit &&
           (has_potential(problem) ||
            !(imbalance_of(problem, equilibrium).share() <= allowed_imbalance));
  });
  return equilibria;
}

Equilibrium solve_exact(const Problem& problem, const ExactOptions& options) {
  return std::move(solve(problem, options).front());
}

}  // namespace dlo::energy_model
