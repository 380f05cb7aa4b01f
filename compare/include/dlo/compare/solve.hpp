#pragma once

#include <string>
#include <vector>

#include "dlo/compare/scene.hpp"
#include "dlo/compare/shape_file.hpp"
#include "dlo/compare/solution.hpp"
#include "dlo/energy_model/energy.hpp"

namespace dlo::compare {

/// Solves a scene. Obstacles out of its rod's reach (see make_plan) are given to no solver; their
/// forces are zero. Continuous models are sampled at `arc_lengths` (or at 101 equal ones if empty);
/// polygons keep their points, or are resampled on straight lines when `arc_lengths` are given.
/// @throws InputError if the model does not know such a scene, ConvergenceError
[[nodiscard]] Solution solve(const Scene& scene, Model model, const SolveOptions& options = {},
                             const std::vector<double>& arc_lengths = {});

/// Finds the equilibrium of the energy model that a local search from a shape leads to, with forces
/// and contacts as solve() gives them; it need not be the lowest.
/// @param shape  in the scene's frame; its arc lengths may be missing, and the grippers then say
///               where along the rod its points are
/// @throws InputError, ConvergenceError
[[nodiscard]] Solution solve_near(const Scene& scene, const MeasuredShape& shape,
                                  const SolveOptions& options = {},
                                  const std::vector<double>& arc_lengths = {});

/// An equilibrium of `energy` or `exact` as solve() gives it.
/// @param obstacles  of the scene, those that the model was given
[[nodiscard]] Solution solution_of(const Scene& scene, Model model,
                                   const energy_model::Equilibrium& equilibrium,
                                   const std::vector<double>& arc_lengths,
                                   const std::vector<std::size_t>& obstacles);

/// What a search for all equilibria has found, and as energy_model::EnergySearch from where.
struct AllSolutions {
  std::vector<Solution> solutions;                        ///< stable ones first, by energy
  std::vector<energy_model::SearchStrategy> looked_from;  ///< each kind of start
  std::vector<std::string> not_looked;                    ///< what was cut short or not searched
};

/// Every equilibrium that the energy model finds; an unstable one has a negative
/// smallest_eigenvalue. @throws InputError, ConvergenceError
[[nodiscard]] AllSolutions solve_all(const Scene& scene, const SolveOptions& options = {},
                                     const std::vector<double>& arc_lengths = {});

}  // namespace dlo::compare
