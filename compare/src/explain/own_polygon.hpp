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

/// Of the hinges of a chain.
enum class Springs {
  as_the_rod,  ///< EI/h
  fitted,      ///< that fit best
};

/// Of a file's points.
enum class LastPoint {
  there,
  /// Where the last segment ends is no body's begin, as in MuJoCo's xpos: the last point is taken
  /// for the chain's, wherever that is.
  missing,
};

/// A chain of hinges in a scene, whose points a file may have.
struct OwnPolygon {
  ChainClamp clamp = ChainClamp::hinge;
  double rms_m = 0;                                             ///< of the file's points from it
  double max_m = 0;                                             ///< the largest of those
  double stiffness = 1;                                         ///< of its springs, over EI/h
  energy_model::JointLaw law = energy_model::JointLaw::linear;  ///< of its springs
  /// Whether with the other laws the file's points are twice as far from it or more.
  bool law_shows = false;
  std::vector<double> joints;  ///< where its springs are: arc lengths [m]
  std::vector<double>
      springs;  ///< each EI over half of both its segments, times stiffness [N m/rad]
  double paper_stiffness = 0;  ///< c_b of the paper's law [N]; 0 of another law
  Shape rest;  ///< the chain's points at rest, those that the file's points are compared with
};

/// The words for a chain's clamps.
[[nodiscard]] std::string words_of(ChainClamp clamp, Eigen::Index segments);

/// The words for a chain's springs; empty if the law does not show.
[[nodiscard]] std::string law_words(const OwnPolygon& chain);

/// What a chain's springs are, to go on with after its words; empty if the law does not show.
[[nodiscard]] std::string and_springs(const OwnPolygon& chain);

/// The chains that have as many hinges as a file has points, each at rest in the scene with a
/// spring in each hinge: with a hinge at the clamp, with its first segment welded to it, and with
/// the clamp in the middle of a segment, where the file's first segment is half a one. A clamp
/// inside the rod holds a whole segment: the one whose middle it is at, or, welded, the one that
/// begins at its point; a hinge there is not computed. None where grippers are between the file's
/// points or the scene has what a plain chain has not. Obstacles push it as they push the rod.
/// @param shape  in the scene's frame, along the whole rod
/// @param law  of the springs; none: of those that are Hookean for small angles that with which a
///             chain comes nearest, springs linear in the angle if the law does not show
[[nodiscard]] std::vector<OwnPolygon> own_polygons(
    const Scene& scene, const Shape& shape, Springs springs,
    std::optional<energy_model::JointLaw> law = std::nullopt, LastPoint last = LastPoint::there);

/// Returns the points at rest of a chain with the clamps, springs and Hookean law of another one,
/// found by a local search; nothing if that search finds no equilibrium.
/// @param start  where the search starts; its arc lengths are those of the chain's points
[[nodiscard]] std::optional<Shape> chain_at_rest(const Scene& scene, const Shape& start,
                                                 const OwnPolygon& like);

}  // namespace dlo::compare
