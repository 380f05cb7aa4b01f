#include "dlo/energy_model/exact.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <optional>
#include <string>
#include <utility>

#include "base/deadline.hpp"
#include "base/lowest_combinations.hpp"
#include "base/require.hpp"
#include "dlo/energy_model/balance.hpp"
#include "dlo/energy_model/soft_line.hpp"
#include "exact/planar_shooting.hpp"
#include "exact/without_potential.hpp"
#include "kirchhoff/rod_span.hpp"
#include "problem/ordered_grips.hpp"
#include "problem/reduction.hpp"
#include "problem/rod_law.hpp"
#include "shooting/refine_span.hpp"
#include "shooting/solved_rod.hpp"
#include "shooting/span_shooting.hpp"
#include "touching/confirm_contacts.hpp"

namespace dlo::energy_model {
namespace {

constexpr std::size_t most_results = 64;  // largest number of combinations of the spans' equilibria

/// Result of a search: equilibria, stable ones first, by energy; and the omitted parts of the
/// search.
struct Found {
  std::vector<Equilibrium> equilibria;
  bool out_of_time = false;
  std::string not_searched;  // description of an omitted part; empty: none
};

/// Returns the lowest combinations of the equilibria that are found for the spans. A rod with
/// material directors is one span.
Found solve_spans(const Problem& problem, const ExactOptions& options, const Deadline& deadline) {
  SolvedRod rod;
  rod.spans = has_material_directors(problem) ? std::vector<RodSpan>{uncut(problem)}
                                              : cut_at_clamps(problem);
  Found result;
  std::vector<std::vector<SpanEquilibrium>> found;
  std::vector<std::vector<SpanCandidate>> candidates;
  for (const RodSpan& span : rod.spans) {
    if (options.start == nullptr) {
      SpanSearchResult search = search_span(span, options.tolerance, deadline);
      result.out_of_time = result.out_of_time || !search.complete;
      found.push_back(std::move(search.found));
    } else {
      found.push_back({refine_span(span, problem, *options.start, options.tolerance, deadline)});
      result.out_of_time = result.out_of_time || deadline.passed();
    }
    candidates.emplace_back();
    for (const SpanEquilibrium& equilibrium : found.back()) {
      candidates.back().push_back({equilibrium.stable(), equilibrium.energy.total()});
    }
  }
  const Combinations combinations = lowest_combinations(candidates, most_results);
  for (const std::vector<std::size_t>& choice : combinations.choices) {
    rod.equilibria.clear();
    for (std::size_t i = 0; i < found.size(); ++i) rod.equilibria.push_back(found[i][choice[i]]);
    result.equilibria.push_back(assemble(problem, rod, options.tolerance));
  }
  if (combinations.truncated) {
    result.not_searched =
        "only the lowest " + std::to_string(most_results) + " combinations of spans are listed";
  }
  return result;
}

Found scan_tip(const Problem& problem, const ReducedCantilever& cantilever,
               const ExactOptions& options, const Deadline& deadline) {
  TipShots shots = shoot_from_tip(problem, cantilever, options.tolerance, deadline);
  Found result{std::move(shots.equilibria), shots.out_of_time, ""};
  if (!shots.complete) result.not_searched = "shooting failed from some angles of the tip";
  if (result.equilibria.empty()) {
    result.equilibria.emplace_back();
    result.equilibria.front().status = SolveStatus::failed;
    result.equilibria.front().message = "no shot from the tip meets the direction of the clamp";
    result.equilibria.front().evaluations = shots.shots;
  }
  return result;
}

/// Refuses clamps that transmit a torque, because the spans of a round, intrinsically straight rod
/// are twisted independently.
void refuse_passed_torque(const Problem& problem) {
  const std::vector<OrderedGrip> grips = ordered_grips(problem);
  const auto holds = [](const OrderedGrip& g) { return g.grip->frame.has_value(); };
  const auto first = std::find_if(grips.begin(), grips.end(), holds);
  const auto last = std::find_if(grips.rbegin(), grips.rend(), holds).base();
  for (auto g = first; g < last; ++g) {
    require(!g->grip->direction || holds(*g), "solve_exact",
            "arc length of a clamp without a frame between two clamps with frames", g->grip->at,
            "that of a clamp with a frame or of a pin");
  }
}

Found search(const Problem& problem, const ExactOptions& options, const Deadline& deadline) {
  if (has_material_directors(problem)) return solve_spans(problem, options, deadline);
  refuse_passed_torque(problem);
  const bool same_everywhere =
      std::all_of(problem.line_loads.begin(), problem.line_loads.end(),
                  [&](const LineLoad& load) { return acts_everywhere(load, problem); });
  // The scan supports a single section.
  const std::optional<ReducedCantilever> cantilever =
      problem.sections.empty() && same_everywhere && !problem.axial_stiffness
          ? reduce_cantilever(problem)
          : std::nullopt;
  const bool from_tip =
      options.start == nullptr && cantilever && planar_shots_are_well_posed(cantilever->rod);
  return from_tip ? scan_tip(problem, *cantilever, options, deadline)
                  : solve_spans(problem, options, deadline);
}

Found search_without_potential(const Problem& problem, const ExactOptions& options,
                               const Deadline& deadline) {
  Found found;
  found.equilibria.push_back(solve_without_potential(problem, options, deadline));
  found.out_of_time = deadline.passed();
  return found;
}

Found search_touching(const Problem& problem, const ExactOptions& options,
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
  return {{*std::move(found)}, false, ""};
}

/// Solves the problem. The result is never empty. After the time limit the equilibria found so far
/// have the status `time_limit`: they are equilibria, but the search for others is incomplete.
std::vector<Equilibrium> solve(const Problem& problem, const ExactOptions& options) {
  const Deadline deadline(options.time_limit);
  const auto begin = std::chrono::steady_clock::now();
  require_positive("solve_exact", "tolerance", options.tolerance);
  require(options.time_limit > 0, "solve_exact", "time_limit", options.time_limit, "> 0");
  require(!problem.confined_to_plane, "solve_exact", "confined_to_plane", 1,
          "false: only solve_energy() confines a rod to a plane");
  const bool judged = has_potential(problem);
  require(judged || !problem.axial_stiffness, "solve_exact", "axial_stiffness",
          problem.axial_stiffness.value_or(0),
          "omitted for a rod with drag, follower loads, or couples out of its plane");
  if (judged && !problem.axial_stiffness) {
    if (std::optional<Equilibrium> line = line_without_search(problem)) return {*std::move(line)};
  }
  Found found = !judged                     ? search_without_potential(problem, options, deadline)
                : problem.obstacles.empty() ? search(problem, options, deadline)
                                            : search_touching(problem, options, deadline);
  const double seconds =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  for (Equilibrium& equilibrium : found.equilibria) {
    equilibrium.seconds = seconds;
    separate_line_loads(problem, equilibrium);
    judge_balance(problem, equilibrium);
    if (!found.not_searched.empty()) equilibrium.message += "; " + found.not_searched;
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
