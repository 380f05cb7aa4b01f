#pragma once

#include <Eigen/Core>
#include <vector>

#include "dlo/compare/discretise.hpp"
#include "dlo/compare/scene.hpp"
#include "dlo/compare/solution.hpp"

namespace dlo::compare {

/// The rod of a discretisation, held by the frames of the scene's clamps; the twist (Twist::angles)
/// is what the frames put into that polygon, whole turns counted, as energy_model::Problem counts
/// it.
/// @param untwisted  where the polygon rests without frames [m]
[[nodiscard]] force_model::Rod with_frames(const Scene& scene, const Discretisation& discretisation,
                                           const Eigen::Matrix3Xd& untwisted);

/// Angle and moment between each two frames along the rod; empty where there are none.
[[nodiscard]] std::vector<energy_model::TwistedPart> twisted_parts(const Scene& scene,
                                                                   const force_model::Rod& rod,
                                                                   const Eigen::Matrix3Xd& points);

/// What holds the frames exerts the twisting moment too, about the held segments.
/// @param[in,out] grippers  in the scene's order, added to
void add_twisting_torques(const force_model::Rod& rod, const Eigen::Matrix3Xd& points,
                          std::vector<GripperLoad>& grippers);

}  // namespace dlo::compare
