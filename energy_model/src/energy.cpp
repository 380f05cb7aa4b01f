#include "dlo/energy_model/energy.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <string>

#include "legendre.hpp"
#include "require.hpp"
#include "span_solver.hpp"
#include "split.hpp"

namespace dlo::energy_model {
namespace {

/// Most combinations of the spans' equilibria that are put together.
constexpr std::size_t most_combinations = 64;

void check(const EnergyOptions& options) {
  require(options.terms >= 0 && options.terms <= max_terms, "solve_energy", "terms", options.terms,
          "0 to " + std::to_string(max_terms));
  require_positive("solve_energy", "tolerance", options.tolerance);
  require(options.max_evaluations >= 1, "solve_energy", "max_evaluations", options.max_evaluations,
          ">= 1");
}

/// Tangents of an equilibrium as a span sees them.
TangentField field_of(const Equilibrium& start, const PlacedSpan& placed, double length) {
  return [&start, &placed, length](const Eigen::VectorXd& s) {
    std::vector<double> arc_lengths;
    for (const double at : s) {
      const double arc = placed.start + (placed.reversed ? -at : at) * length;
      arc_lengths.push_back(std::clamp(arc, 0.0, length));
    }
    const Eigen::Matrix3Xd tangents = start.sample(arc_lengths).tangents;
    return Eigen::Matrix3Xd((placed.reversed ? -1.0 : 1.0) * (placed.frame * tangents));
  };
}

std::vector<SpanSolution> solve_placed(PlacedSpan& placed, const Problem& problem,
                                       const EnergyOptions& options, bool all) {
  SpanOptions span_options;
  span_options.terms = options.terms;
  span_options.tolerance = options.tolerance;
  span_options.max_evaluations = options.max_evaluations;
  span_options.all = all;
  if (options.start != nullptr) {
    span_options.start = field_of(*options.start, placed, problem.length);
  }
  std::vector<SpanSolution> solutions = solve_span(placed.span, span_options);
  SpanSolution& best = solutions.front();
  // The search may have left the plane.
  if (!best.model->span().planar) placed.span.planar = false;
  if (placed.span.planar || all || best.model->elevation() < largest_elevation) return solutions;
  const Eigen::VectorXd nodes = best.model->nodes();
  const Eigen::Matrix3Xd tangents =
      best.model->sample(best.x, std::vector<double>(nodes.begin(), nodes.end())).tangents;
  const Eigen::Matrix3d before = placed.frame;
  turn_axis(placed, tangents);
  const Eigen::Matrix3d turn = placed.frame * before.transpose();
  const auto old_model = best.model;
  const Eigen::VectorXd old_x = best.x;
  span_options.start = [&](const Eigen::VectorXd& s) {
    return Eigen::Matrix3Xd(
        turn * old_model->sample(old_x, std::vector<double>(s.begin(), s.end())).tangents);
  };
  span_options.least_terms = best.terms;
  std::vector<SpanSolution> turned = solve_span(placed.span, span_options);
  turned.front().evaluations += best.evaluations;
  return turned;
}

std::vector<Equilibrium> solve(const Problem& problem, const EnergyOptions& options, bool all) {
  const auto begin = std::chrono::steady_clock::now();
  check(options);
  std::vector<PlacedSpan> placed = split(problem);
  std::vector<std::vector<SpanSolution>> solutions;
  solutions.reserve(placed.size());
  for (PlacedSpan& span : placed) {
    solutions.push_back(solve_placed(span, problem, options, all));
  }
  std::vector<Equilibrium> result;
  std::vector<std::size_t> choice(placed.size(), 0);
  for (bool more = true; more && result.size() < most_combinations;) {
    std::vector<SpanSolution> chosen;
    std::vector<PlacedSpan> chosen_places = placed;
    for (std::size_t i = 0; i < placed.size(); ++i) {
      chosen.push_back(solutions[i][choice[i]]);
      chosen_places[i].span.planar = chosen.back().model->span().planar;
    }
    result.push_back(assemble(problem, chosen_places, chosen));
    more = false;
    for (std::size_t i = 0; i < choice.size() && !more; ++i) {
      more = ++choice[i] < solutions[i].size();
      if (!more) choice[i] = 0;
    }
  }
  std::stable_sort(result.begin(), result.end(), [](const Equilibrium& a, const Equilibrium& b) {
    if (succeeded(a.status) != succeeded(b.status)) return succeeded(a.status);
    return a.energy.total() < b.energy.total();
  });
  const double seconds =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  for (Equilibrium& equilibrium : result) equilibrium.seconds = seconds;
  return result;
}

}  // namespace

Equilibrium solve_energy(const Problem& problem, const EnergyOptions& options) {
  return std::move(solve(problem, options, false).front());
}

std::vector<Equilibrium> all_energy(const Problem& problem, const EnergyOptions& options) {
  return solve(problem, options, true);
}

}  // namespace dlo::energy_model
