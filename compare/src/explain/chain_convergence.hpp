#pragma once

#include <string>

#include "dlo/compare/scene.hpp"
#include "dlo/energy_model/equilibrium.hpp"
#include "explain/own_polygon.hpp"

namespace dlo::compare {

/// Classification of the distance between a chain and a rod.
enum class ChainError {
  /// The distance decreases with the order of the chain's clamps, or is within the plan's bound.
  discretisation,
  too_coarse,  ///< the distance decreases with shorter segments, but not yet with that order
  /// Up to eight times as many segments do not halve the distance, or the chain with twice as many
  /// segments does not come to rest: another shape than the rod.
  different_shape,
};

/// Distances of a chain and of the chain with twice as many segments from a rod, both at rest.
struct ChainConvergence {
  ChainError error = ChainError::different_shape;
  double coarse_m = 0;  ///< d(N): distance of the chain [m]
  double fine_m = 0;    ///< d(2N): with twice as many segments [m]; NaN if it is not at rest
  int order = 0;        ///< p: d(N) / d(2N) tends to 2^p for short segments
};

/// Compares a chain with an equilibrium of the continuous rod, at equal arc lengths. A chain whose
/// clamp holds the middle of a segment, or that has pins only, has p = 2. A hinge at a clamp makes
/// half a segment too soft there, a welded segment makes half a one too stiff: p = 1. The error is
/// one of discretisation if d(N) / d(2N) is 2^p within 30 %, or, if clamps hold the middles of
/// segments and the rod touches nothing, if d(N) is within the bound of make_plan for a polygon
/// with the chain's points.
/// @param largest  whether distances are the largest of a point, not the RMS along the rod
[[nodiscard]] ChainConvergence chain_convergence(const Scene& scene, const CandidateChain& chain,
                                                 const energy_model::Equilibrium& rod,
                                                 bool largest);

}  // namespace dlo::compare
