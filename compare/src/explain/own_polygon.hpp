#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "dlo/compare/discretise.hpp"
#include "dlo/compare/scene.hpp"
#include "dlo/compare/shape.hpp"
#include "dlo/energy_model/chain.hpp"

namespace dlo::compare {

/// Stiffness of the springs in the hinges of a chain.
enum class Springs {
  rod_stiffness,  ///< stiffness EI/h
  fitted,         ///< the stiffness that fits best
};

/// Meaning of the last point of a file.
enum class LastPoint {
  there,
  /// The file has no end point of the last segment, as in MuJoCo's xpos, where no body begins
  /// there. The last point follows the chain and is not compared.
  missing,
};

/// A chain of hinges in a scene, whose points may be those of a file.
struct CandidateChain {
  ChainClamp clamp = ChainClamp::hinge;
  double rms_m = 0;      ///< RMS distance of the file's points from the chain [m]
  double max_m = 0;      ///< largest of these distances [m]
  double stiffness = 1;  ///< stiffness of the springs, divided by EI/h
  energy_model::JointLaw law = energy_model::JointLaw::linear;  ///< joint law of the springs
  /// Whether the law is identified: with the other laws the points are more than twice as far away,
  /// and more than 1e-5 of the length.
  bool is_law_identified = false;
  std::vector<double> joints;  ///< arc lengths of the springs [m]; empty for the paper's law
  /// Stiffness factor times EI, divided by half of both adjacent segments, of which those that a
  /// clamp holds in the middle count as whole [N m/rad]
  std::vector<double> springs;
  double paper_stiffness = 0;  ///< c_b of the paper's law [N]; 0 for other laws
  Shape rest;  ///< the chain's points at rest, with which the file's points are compared
};

/// Describes a chain with its clamps.
[[nodiscard]] std::string words_of(ChainClamp clamp, Eigen::Index segments);

/// Describes the law of a chain's springs; empty if the law is not identified.
[[nodiscard]] std::string law_words(const CandidateChain& chain);

/// Returns the clause about the springs that follows words_of(); empty if the law is not
/// identified.
[[nodiscard]] std::string springs_clause(const CandidateChain& chain);

/// Returns the chains that may have a file's points as their own, each at rest in the scene with a
/// spring in each hinge. There are three kinds: with a hinge at the clamp, with the first segment
/// welded to the clamp, and with the clamp in the middle of a segment, of which the file has half.
/// A clamp inside the rod holds a whole segment: the one whose middle it is at, or, if welded, the
/// one that begins at its point; a hinge there is not computed. There is no chain if a gripper is
/// neither at a point of the file nor, as a clamp, in the middle between two, if there are fewer
/// than 4 or more than 200 segments, if the scene has properties that a plain chain lacks (with the
/// paper's law also twist), or if the chain does not come to rest. Chains that are held by pins
/// only are equal for all kinds, so that there is only the first kind. Obstacles act on the chain
/// as on the rod.
/// @param shape  in the scene's frame, along the whole rod
/// @param law  joint law of the springs; empty: the one of the Hookean laws that fits best, or
/// springs linear in the angle if the law is not identified
[[nodiscard]] std::vector<CandidateChain> candidate_chains(
    const Scene& scene, const Shape& shape, Springs springs,
    std::optional<energy_model::JointLaw> law = std::nullopt, LastPoint last = LastPoint::there);

/// Returns the points at rest of a chain with the clamps, springs and Hookean law of another one,
/// found by a local search; std::nullopt if the grippers cannot hold the chain or the search finds
/// no equilibrium.
/// @param start  initial guess; its arc lengths are those of the chain's points
[[nodiscard]] std::optional<Shape> chain_at_rest(const Scene& scene, const Shape& start,
                                                 const CandidateChain& candidate);

}  // namespace dlo::compare
