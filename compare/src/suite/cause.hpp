#pragma once

#include <string>
#include <vector>

#include "dlo/compare/scene.hpp"
#include "dlo/compare/shape.hpp"
#include "dlo/compare/solution.hpp"
#include "dlo/energy_model/equilibrium.hpp"

namespace dlo::compare {

/// Why a simulator's shapes are not the rod's.
struct Cause {
  std::string name;    ///< the same for all scenes: "first element welded"
  double factor = 0;   ///< its size; NaN: it has none
  std::string words;   ///< a clause, with numbers
  bool defect = true;  ///< the shapes do not converge to the rod because of it
};

/// A simulator's shape of a scene with so many points.
struct CardShape {
  int points = 0;    ///< N
  Shape shape;       ///< in the scene's frame, along the whole rod
  double error = 0;  ///< RMS over length [-]
};

/// How an error falls with the number of points: p of e ~ N^-p, from the first shape to the last;
/// NaN where there are less than two or an error is below what the reference itself is off.
[[nodiscard]] double convergence_order(const std::vector<CardShape>& shapes);

/// An error that is none, as a share of the length.
inline constexpr double error_floor = 1e-7;

/// Names what is wrong with shapes that do not converge to the rod with second order, as far as it
/// can be told: a cause is named if it leaves little of the error. Of shapes that do
/// converge only springs that are linear in the angle are named, where that shows.
/// @param reference  the scene's equilibrium
/// @param shapes     by growing N, at least one
[[nodiscard]] std::vector<Cause> causes_of(const Scene& scene,
                                           const energy_model::Equilibrium& reference,
                                           const std::vector<CardShape>& shapes,
                                           const SolveOptions& options = {});

}  // namespace dlo::compare
