#pragma once

#include <Eigen/Core>
#include <vector>

#include "dlo/compare/discretise.hpp"
#include "dlo/compare/scene.hpp"
#include "dlo/compare/solution.hpp"

namespace dlo::compare {

/// Returns the part of a polygon between two segments that neighbouring clamps hold by their
/// frames, with the twist that the frames require, whole turns counted, as energy_model::Problem
/// counts it. Its compliance is not set.
/// @param problem  of the scene, whose grips are its grippers
/// @param first, last  the clamps by their places in the scene
/// @param points  any shape of the polygon whose held segments are where the clamps hold them [m]
[[nodiscard]] force_model::TwistedSpan held_span(const energy_model::Problem& problem,
                                                 std::size_t first, std::size_t last,
                                                 Eigen::Index first_segment,
                                                 Eigen::Index last_segment,
                                                 const Eigen::Matrix3Xd& points);

/// Returns a scene's clamps that hold frames, in the order of their arc lengths, by their places in
/// the scene.
[[nodiscard]] std::vector<std::size_t> framed_grippers(const Scene& scene);

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
