#pragma once

#include <Eigen/Core>
#include <vector>

#include "dlo/compare/material_fit.hpp"
#include "dlo/compare/scene.hpp"

namespace dlo::compare {

/// Returns the springs of chains of equal segments that are nearest to a scene's rod, one chain for
/// each kind of clamp that is possible in the scene.
/// @param segments  4 to 200; for others the result is empty
/// @throws InputError, ConvergenceError as solve_reference()
[[nodiscard]] std::vector<ChainSprings> chain_springs(const Scene& scene, int segments,
                                                      const SolveOptions& options);

/// Returns the springs of chains of unequal segments that are nearest to a scene's rod. A chain is
/// held in the middle of segments only if the segments at clamped ends of the rod are half as long
/// as their neighbours.
/// @param lengths  along the rod, 4 to 200, scaled to the rod's length [m]
/// @throws InputError if there are not 4 to 200, if one is not > 0, or if their sum differs from
/// the rod's length by more than 5 %; InputError, ConvergenceError as solve_reference()
[[nodiscard]] std::vector<ChainSprings> chain_springs(const Scene& scene,
                                                      const std::vector<double>& lengths,
                                                      const SolveOptions& options);

/// Returns the lengths of straight segments between the joints of a file.
[[nodiscard]] std::vector<double> segment_lengths(const Eigen::Matrix3Xd& points);

}  // namespace dlo::compare
