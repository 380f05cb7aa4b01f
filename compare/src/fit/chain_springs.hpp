#pragma once

#include <Eigen/Core>
#include <vector>

#include "dlo/compare/material_fit.hpp"
#include "dlo/compare/scene.hpp"

namespace dlo::compare {

/// Springs of chains of equal segments that come nearest to a scene's rod, for each way to hold
/// them that is one of this scene.
/// @param segments  4 to 200
/// @throws ConvergenceError if the rod has no shape
[[nodiscard]] std::vector<ChainSprings> chain_springs(const Scene& scene, int segments,
                                                      const SolveOptions& options);

/// The same of a chain of unequal segments. Held in the middle of segments only where the lengths
/// have halves at the clamps.
/// @param lengths  along the rod, 4 to 200, which are scaled to its length [m]
/// @throws InputError if their number or sum is another one, or one is not > 0; ConvergenceError as
///         above
[[nodiscard]] std::vector<ChainSprings> chain_springs(const Scene& scene,
                                                      const std::vector<double>& lengths,
                                                      const SolveOptions& options);

/// Lengths of the segments between the joints that a file has, as straight ones.
[[nodiscard]] std::vector<double> segment_lengths(const Eigen::Matrix3Xd& points);

}  // namespace dlo::compare
