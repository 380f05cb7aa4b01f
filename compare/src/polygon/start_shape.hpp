#pragma once

#include <Eigen/Core>
#include <vector>

#include "dlo/compare/scene.hpp"
#include "dlo/force_model/rod.hpp"

namespace dlo::compare {

/// To which side of the line between two grips their slack hangs.
enum class Side {
  along_load,
  against_load,
};

/// A curve through all grips with the right length between them, to start a search or a simulation
/// from [m], 3 x M. Beyond the outermost grips it is straight. Between two it is a cubic with the
/// grips' directions (a pin's is that of the line between its neighbours) and, while that is
/// shorter than the rod, an arch with no slope at the grips towards the load across their line. Of
/// a rod without such a load the arch follows the clamps' directions, or else +x (+y if the grips
/// lie along x). Every arch
/// leaves its plane by a millionth of its length, so that what is unstable out of plane leaves it.
/// No two neighbouring points coincide.
/// @param along  the grippers in the order of their arc lengths
[[nodiscard]] Eigen::Matrix3Xd start_shape(const Scene& scene,
                                           const std::vector<std::size_t>& along,
                                           const std::vector<double>& arc_length, Side side);

/// Turns the parts of a start beyond its outermost grips out of the obstacles: where a segment
/// would enter one it lies along its face, at its own length.
/// @param rod  its grips, walls and solids count;  @param[in,out] points  [m], 3 x M
void keep_free_ends_clear(const force_model::Rod& rod, Eigen::Ref<Eigen::Matrix3Xd> points);

}  // namespace dlo::compare
