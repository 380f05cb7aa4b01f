#pragma once

#include <string>
#include <vector>

#include "dlo/compare/scene.hpp"
#include "dlo/compare/shape_file.hpp"
#include "dlo/compare/solution.hpp"
#include "dlo/energy_model/energy.hpp"

namespace dlo::compare {

/// Solves a scene. Obstacles out of the rod's reach (see make_plan) are given to no solver; their
/// forces are zero. Continuous models are sampled at `arc_lengths` (or at 101 equally spaced ones
/// if empty); polygons keep their points, or are resampled on straight lines if `arc_lengths` are
/// given.
/// @throws InputError if the model cannot solve such a scene, or if an arc length is not on the
/// rod; ConvergenceError
[[nodiscard]] Solution solve(const Scene& scene, Model model, const SolveOptions& options = {},
                             const std::vector<double>& arc_lengths = {});

/// Finds the equilibrium of the energy model to which a local search from a shape converges, with
/// forces and contacts as solve() gives them; it need not be the lowest.
/// @param shape  in the scene's frame; if it has no arc lengths, the grippers determine where along
/// the rod its points are
/// @throws InputError, ConvergenceError
[[nodiscard]] Solution solve_near(const Scene& scene, const MeasuredShape& shape,
                                  const SolveOptions& options = {},
                                  const std::vector<double>& arc_lengths = {});

/// Converts an equilibrium of `energy` or `exact` to a Solution as solve() returns it, without
/// Solution::stretch and the decision on stretch.
/// @param obstacles  indices of the scene's obstacles that the model was given
[[nodiscard]] Solution solution_of(const Scene& scene, Model model,
                                   const energy_model::Equilibrium& equilibrium,
                                   const std::vector<double>& arc_lengths,
                                   const std::vector<std::size_t>& obstacles);

/// Results of a search for all equilibria, and its start shapes, as in energy_model::EnergySearch.
struct AllSolutions {
  std::vector<Solution> solutions;                       ///< stable ones first, by energy
  std::vector<energy_model::SearchStrategy> strategies;  ///< kinds of start shapes
  std::vector<std::string> omitted;  ///< searches that were incomplete or not made
};

/// Finds all equilibria of the energy model that a search can find; an unstable one has a negative
/// smallest_eigenvalue.
/// @throws InputError, ConvergenceError
[[nodiscard]] AllSolutions solve_all(const Scene& scene, const SolveOptions& options = {},
                                     const std::vector<double>& arc_lengths = {});

}  // namespace dlo::compare
