#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "dlo/compare/discretise.hpp"
#include "dlo/compare/scene.hpp"
#include "dlo/compare/solution.hpp"
#include "dlo/energy_model/equilibrium.hpp"

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

/// Of each part that is held at both ends by frames. The twist and the writhe add up to the turns
/// between the frames (Calugareanu, White, Fuller), which no movement changes unless the rod
/// passes through itself; that takes or gives two.
[[nodiscard]] std::vector<Linking> linking_of(const Scene& scene,
                                              const energy_model::Equilibrium& equilibrium);

/// What is wrong with the turns of a shape, for a message; empty: nothing, or it cannot be told.
[[nodiscard]] std::string lost_turns(const std::vector<Linking>& parts);

/// The same of turns that are lost between two shapes of a motion. Where a clamp's direction passes
/// the opposite of another's, held turns, which refer to the shortest rotation between the two, and
/// the writhe change by one turn against each other. That is none that is lost.
[[nodiscard]] std::string lost_turns(const Scene& before, const std::vector<Linking>& parts_before,
                                     const Scene& after, const std::vector<Linking>& parts_after);

}  // namespace dlo::compare
