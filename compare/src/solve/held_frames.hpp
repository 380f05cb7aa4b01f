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
/// counts it. Its compliance is 1; the caller sets it.
/// @param problem  the scene's problem, whose grips are the scene's grippers in order
/// @param first, last  indices of the clamps in the scene
/// @param points  any shape of the polygon whose held segments are where the clamps hold them [m]
[[nodiscard]] force_model::TwistedSpan held_span(const energy_model::Problem& problem,
                                                 std::size_t first, std::size_t last,
                                                 Eigen::Index first_segment,
                                                 Eigen::Index last_segment,
                                                 const Eigen::Matrix3Xd& points);

/// Returns the indices of a scene's clamps that hold frames, in the order of their arc lengths.
[[nodiscard]] std::vector<std::size_t> framed_grippers(const Scene& scene);

/// Returns the rod of a discretisation with the frames of the scene's clamps. Twist::angles are the
/// twist that the frames cause in that polygon, whole turns counted as energy_model::Problem counts
/// them.
/// @param untwisted  shape of the polygon at rest without frames [m]
[[nodiscard]] force_model::Rod with_frames(const Scene& scene, const Discretisation& discretisation,
                                           const Eigen::Matrix3Xd& untwisted);

/// Returns the twist angle and moment between neighbouring frames along the rod; empty if there are
/// none.
[[nodiscard]] std::vector<energy_model::TwistedPart> twisted_parts(const Scene& scene,
                                                                   const force_model::Rod& rod,
                                                                   const Eigen::Matrix3Xd& points);

/// Adds the twisting moments to the torques of the grippers that hold frames, about the held
/// segments.
/// @param[in,out] grippers  in the scene's order
void add_twisting_torques(const force_model::Rod& rod, const Eigen::Matrix3Xd& points,
                          std::vector<GripperLoad>& grippers);

/// Returns twist, writhe and held turns of the parts between two frames for which writhe and held
/// turns can be determined. Twist and writhe add up to the turns between the frames (Calugareanu,
/// White, Fuller). No motion changes this sum unless the rod passes through itself, which changes
/// it by two.
[[nodiscard]] std::vector<Linking> linking_of(const Scene& scene,
                                              const energy_model::Equilibrium& equilibrium);

/// Returns a message if the number of turns of a shape differs from the number that the grips
/// prescribe; empty if they agree, or if the turns cannot be determined.
[[nodiscard]] std::string turns_mismatch_message(const std::vector<Linking>& parts);

/// Returns a message if turns are lost between two shapes of a motion; empty if not, or if a part
/// has no turns in one of them. Held turns refer to the shortest rotation between the directions of
/// two clamps. A change by one turn is no loss if one direction passes the opposite of the other.
[[nodiscard]] std::string turns_mismatch_message(const Scene& before,
                                                 const std::vector<Linking>& parts_before,
                                                 const Scene& after,
                                                 const std::vector<Linking>& parts_after);

}  // namespace dlo::compare
