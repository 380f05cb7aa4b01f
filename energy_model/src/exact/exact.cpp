#include "dlo/energy_model/exact.hpp"

#include <gsl/gsl_errno.h>
#include <gsl/gsl_roots.h>
#include <gsl/gsl_sf_airy.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "base/deadline.hpp"
#include "base/lowest_combinations.hpp"
#include "base/require.hpp"
#include "base/silence_gsl.hpp"
#include "base/sized_samples.hpp"
#include "curved/curved_solution.hpp"
#include "kirchhoff/rod_span.hpp"
#include "problem/ordered_grips.hpp"
#include "problem/reduction.hpp"
#include "shooting/planar_shooting.hpp"
#include "shooting/second_variation.hpp"
#include "shooting/span_shooting.hpp"
#include "touching/confirm_contacts.hpp"
#include "touching/raise_weight.hpp"

namespace dlo::energy_model {
namespace {

constexpr std::size_t most_results = 64;  // of the spans' equilibria

/// The spans of a rod and an equilibrium of each.
struct Pieces {
  std::vector<RodSpan> spans;
  std::vector<SpanEquilibrium> equilibria;
};

/// What the grips of a span feel from it: the force that makes up for the jump of n, the torque
/// that bends and twists the rod as it is at its clamps.
void add_reactions(const RodSpan& span, const SpanEquilibrium& equilibrium, double force_unit,
                   double torque_unit, std::vector<Reaction>& reactions) {
  const auto nodes = static_cast<std::ptrdiff_t>(equilibrium.nodes.size());
  for (const RodSpan::Hold& hold : span.holds) {
    const std::ptrdiff_t i = std::lower_bound(equilibrium.s.begin(), equilibrium.s.end(), hold.at) -
                             equilibrium.s.begin();
    const RodState& node = equilibrium.nodes[static_cast<std::size_t>(i)];
    Eigen::Vector3d force = -node.n;
    if (i > 0) {
      const double h = equilibrium.s[i] - equilibrium.s[i - 1];
      const Eigen::Vector3d& weight = section_at(span, equilibrium.s[i - 1] + h / 2).weight;
      force += equilibrium.nodes[static_cast<std::size_t>(i - 1)].n - h * weight;
    }
    for (const RodSpan::Load& load : span.loads) {
      if (load.at == hold.at) force -= load.force;
    }
    Reaction& reaction = reactions[hold.grip];
    reaction.force += force_unit * force;
    const double bending = section_at(span, hold.at).bending;
    Eigen::Vector3d moment = torque_unit * bending * node.t.cross(node.v);
    if (span.twist) moment += torque_unit * node.torque * node.t;
    if (i == 0 && span.start_direction) reaction.torque -= moment;
    if (i + 1 == nodes && span.end_direction) reaction.torque += moment;
  }
}

TwistedPart twisted_part(const Problem& problem, const RodSpan& span, double torque) {
  return {.begin = span.begin * problem.length,
          .end = (span.begin + span.length) * problem.length,
          .angle = torque * span.twist->compliance,
          .torque = torque * problem.bending_stiffness / problem.length};
}

/// Loads on clamps belong to no span.
void add_loads_on_clamps(const Problem& problem, Equilibrium& result) {
  for (const Load& load : problem.loads) {
    const std::optional<std::size_t> clamp = clamp_under(problem, load);
    if (!clamp) continue;
    const Eigen::Vector3d& position = problem.grips[*clamp].position;
    result.grips[*clamp].force -= load.force;
    result.energy.load -= load.force.dot(position - problem.grips.front().position);
  }
}

Samples sample(const Problem& problem, const Pieces& pieces, double tolerance,
               std::span<const double> arc_lengths) {
  const double l = problem.length;
  const auto count = static_cast<Eigen::Index>(arc_lengths.size());
  Samples samples = sized_samples(arc_lengths, l);
  for (Eigen::Index i = 0; i < count; ++i) {
    const double at = arc_lengths[static_cast<std::size_t>(i)];
    std::size_t p = 0;
    while (p + 1 < pieces.spans.size() && at / l > pieces.spans[p + 1].begin) ++p;
    const RodSpan& span = pieces.spans[p];
    const RodState state = state_at(pieces.equilibria[p], span, at / l - span.begin, tolerance);
    samples.points.col(i) = problem.grips.front().position + l * state.r;
    samples.tangents.col(i) = state.t;
    samples.curvature.col(i) = state.v / l;
  }
  return samples;
}

Equilibrium assemble(const Problem& problem, const Pieces& pieces, double tolerance) {
  Equilibrium result;
  result.grips.resize(problem.grips.size());
  const double torque_unit = problem.bending_stiffness / problem.length;
  const double force_unit = torque_unit / problem.length;
  SecondVariation stability{
      .negative = 0, .neutral = 0, .smallest = INFINITY, .s = {}, .direction = {}};
  for (std::size_t i = 0; i < pieces.spans.size(); ++i) {
    const RodSpan& span = pieces.spans[i];
    const SpanEquilibrium& equilibrium = pieces.equilibria[i];
    result.evaluations += equilibrium.shots;
    result.residual = std::max(result.residual, equilibrium.residual);
    if (!equilibrium.converged) {
      result.status = SolveStatus::failed;
      result.message = "the rod from " + std::to_string(span.begin * problem.length) +
                       " m on: " + equilibrium.message;
      continue;
    }
    const Energies energy = restore(problem, equilibrium.energy);
    result.energy.bending += energy.bending;
    result.energy.twisting += energy.twisting;
    result.energy.gravity += energy.gravity;
    result.energy.load += energy.load;
    add_reactions(span, equilibrium, force_unit, torque_unit, result.grips);
    if (span.twist) {
      result.twists.push_back(twisted_part(problem, span, equilibrium.nodes.front().torque));
    }
    stability.negative += equilibrium.stability.negative;
    stability.neutral += equilibrium.stability.neutral;
    stability.smallest = std::min(stability.smallest, equilibrium.stability.smallest);
  }
  if (result.status == SolveStatus::failed) {
    result.energy = {NAN, NAN, NAN, NAN};
    result.grips.clear();
    result.twists.clear();
    return result;
  }
  add_loads_on_clamps(problem, result);
  judge(stability, result);
  result.sample = [problem, pieces, tolerance](std::span<const double> arc_lengths) {
    return sample(problem, pieces, tolerance, arc_lengths);
  };
  return result;
}

/// What a search has found: equilibria, stable ones first, by energy; and what it has not done.
struct Found {
  std::vector<Equilibrium> equilibria;
  bool out_of_time = false;
  std::string left_out;  // empty: nothing
};

/// The lowest combinations of what is found for the spans.
Found solve_spans(const Problem& problem, const ExactOptions& options, const Deadline& deadline) {
  Pieces pieces;
  pieces.spans = cut_at_clamps(problem);
  Found result;
  std::vector<std::vector<SpanEquilibrium>> found;
  std::vector<std::vector<SpanCandidate>> candidates;
  for (const RodSpan& span : pieces.spans) {
    if (options.start == nullptr) {
      SpanSearchResult search = span.twist ? search_twisted_span(span, options.tolerance, deadline)
                                           : search_span(span, options.tolerance, deadline);
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
    pieces.equilibria.clear();
    for (std::size_t i = 0; i < found.size(); ++i) pieces.equilibria.push_back(found[i][choice[i]]);
    result.equilibria.push_back(assemble(problem, pieces, options.tolerance));
  }
  if (combinations.truncated) {
    result.left_out =
        "only the lowest " + std::to_string(most_results) + " combinations of spans are listed";
  }
  return result;
}

Found scan_tip(const Problem& problem, const ReducedCantilever& cantilever,
               const ExactOptions& options, const Deadline& deadline) {
  TipShots shots = shoot_from_tip(problem, cantilever, options.tolerance, deadline);
  Found result{std::move(shots.equilibria), shots.out_of_time, ""};
  if (!shots.complete) result.left_out = "some of the tip's angles could not be shot from";
  if (result.equilibria.empty()) {
    result.equilibria.emplace_back();
    result.equilibria.front().status = SolveStatus::failed;
    result.equilibria.front().message = "no shot from the tip met the clamp's direction";
    result.equilibria.front().evaluations = shots.shots;
  }
  return result;
}

/// The spans of a round rod that is straight by nature are twisted each on its own.
void refuse_passed_torque(const Problem& problem) {
  const std::vector<OrderedGrip> grips = ordered_grips(problem);
  const auto holds = [](const OrderedGrip& g) { return g.grip->frame.has_value(); };
  const auto first = std::find_if(grips.begin(), grips.end(), holds);
  const auto last = std::find_if(grips.rbegin(), grips.rend(), holds).base();
  for (auto g = first; g < last; ++g) {
    require(!g->grip->direction || holds(*g), "solve_exact",
            "arc length of a clamp without frame between two that hold it", g->grip->at,
            "that of a clamp with a frame, or of a pin");
  }
}

Found search(const Problem& problem, const ExactOptions& options, const Deadline& deadline) {
  if (has_material_directors(problem)) {
    CurvedSolutions curved = solve_curved(problem, options, deadline);
    return {std::move(curved.equilibria), curved.out_of_time, ""};
  }
  refuse_passed_torque(problem);
  // The scan knows of one section.
  const std::optional<ReducedCantilever> cantilever =
      problem.sections.empty() ? reduce_cantilever(problem) : std::nullopt;
  const bool from_tip =
      options.start == nullptr && cantilever && planar_shots_are_well_posed(cantilever->rod);
  return from_tip ? scan_tip(problem, *cantilever, options, deadline)
                  : solve_spans(problem, options, deadline);
}

Found search_touching(const Problem& problem, const ExactOptions& options,
                      const Deadline& deadline) {
  std::optional<Equilibrium> found = options.start == nullptr
                                         ? raise_weight(problem, deadline)
                                         : confirm_contacts(problem, *options.start, deadline);
  require(found.has_value(), "solve_exact", "number of obstacles",
          static_cast<double>(problem.obstacles.size()),
          options.start == nullptr
              ? "0, or rigid half-spaces across the plane of a heavy round rod with one clamp at "
                "its begin, or a start has to say what touches"
              : "0, or rigid ones that a round rod without twist touches between its grips");
  return {{*std::move(found)}, false, ""};
}

/// Never empty. Out of time, what is found is marked: it is an equilibrium, but others were not
/// looked for to the end.
std::vector<Equilibrium> solve(const Problem& problem, const ExactOptions& options) {
  const Deadline deadline(options.time_limit);
  const auto begin = std::chrono::steady_clock::now();
  require_positive("solve_exact", "tolerance", options.tolerance);
  require(options.time_limit > 0, "solve_exact", "time_limit", options.time_limit, "> 0");
  Found found = problem.obstacles.empty() ? search(problem, options, deadline)
                                          : search_touching(problem, options, deadline);
  const double seconds =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  for (Equilibrium& equilibrium : found.equilibria) {
    equilibrium.seconds = seconds;
    if (!found.left_out.empty()) equilibrium.message += "; " + found.left_out;
    if (!found.out_of_time) continue;
    const bool holds = static_cast<bool>(equilibrium.sample);
    const std::string reached = equilibrium.message;
    equilibrium.status = SolveStatus::time_limit;
    equilibrium.message = std::string(to_string(equilibrium.status)) + " after " +
                          std::to_string(options.time_limit) + " s: " + reached +
                          (holds ? ", others may be lower" : "");
  }
  return std::move(found.equilibria);
}

}  // namespace

std::vector<Equilibrium> all_exact(const Problem& problem, const ExactOptions& options) {
  std::vector<Equilibrium> equilibria = solve(problem, options);
  std::erase_if(equilibria, [](const Equilibrium& equilibrium) {
    // What is found before the time is up is an equilibrium, of a list that may lack others.
    const bool cut_short =
        equilibrium.status == SolveStatus::time_limit && static_cast<bool>(equilibrium.sample);
    return !succeeded(equilibrium.status) && equilibrium.status != SolveStatus::saddle &&
           !cut_short;
  });
  return equilibria;
}

Equilibrium solve_exact(const Problem& problem, const ExactOptions& options) {
  return std::move(solve(problem, options).front());
}

double self_buckling_gamma() {
  silence_gsl();
  const auto miss = [](double z, void*) {
    return std::sqrt(3.0) * gsl_sf_airy_Ai(-z, GSL_PREC_DOUBLE) +
           gsl_sf_airy_Bi(-z, GSL_PREC_DOUBLE);
  };
  gsl_function function{miss, nullptr};
  const std::unique_ptr<gsl_root_fsolver, decltype(&gsl_root_fsolver_free)> solver(
      gsl_root_fsolver_alloc(gsl_root_fsolver_brent), gsl_root_fsolver_free);
  gsl_root_fsolver_set(solver.get(), &function, 1.5, 2.5);
  int status = GSL_CONTINUE;
  while (status == GSL_CONTINUE) {
    gsl_root_fsolver_iterate(solver.get());
    status = gsl_root_test_interval(gsl_root_fsolver_x_lower(solver.get()),
                                    gsl_root_fsolver_x_upper(solver.get()), 0, 1e-15);
  }
  const double z = gsl_root_fsolver_root(solver.get());
  return z * z * z;
}

}  // namespace dlo::energy_model
