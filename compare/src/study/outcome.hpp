#pragma once

#include <Eigen/Core>
#include <vector>

#include "dlo/compare/choice.hpp"

namespace dlo::compare {

/// Classification of a simulation's end.
enum class Outcome {
  pass,        ///< reaches the reference shape and stays there
  wrong,       ///< ends at another shape: at rest without equilibrium, or still creeping
  oscillates,  ///< oscillates instead of coming to rest
  diverges,    ///< not finite, or farther away than the rod could reach
  refused,     ///< ends with an error message instead of a shape
};

/// Names of the outcomes in tables.
template <>
struct Choices<Outcome> {
  /// All outcomes, in the order of the enumeration.
  static constexpr Choice<Outcome> all[] = {{Outcome::pass, "pass", ""},
                                            {Outcome::wrong, "wrong", ""},
                                            {Outcome::oscillates, "oscillates", ""},
                                            {Outcome::diverges, "diverges", ""},
                                            {Outcome::refused, "refused", ""}};
};

/// Data by which the end of a simulation is classified.
struct SimulationEnd {
  bool finite = false;   ///< no step has diverged
  bool at_rest = false;  ///< proved, see force_model::Simulation::relax
  /// Shapes at equal intervals over the last half of the steps, the final one last [m], 3 x N each.
  /// The final shape alone suffices if it is at rest.
  std::vector<Eigen::Matrix3Xd> late;
  std::vector<Eigen::Matrix3Xd> last;  ///< shapes of the last consecutive steps [m]
};

/// Returns the largest distance of a point from the same point of the reference [m]; infinite if a
/// coordinate is not finite.
[[nodiscard]] double largest_distance(const Eigen::Matrix3Xd& points,
                                      const Eigen::Matrix3Xd& reference);

/// Whether a sequence of shapes oscillates. Two conditions hold: the sum of their movements exceeds
/// three times the distance from the first shape to the last, and it exceeds `threshold` [m] (RMS
/// over the points).
[[nodiscard]] bool goes_to_and_fro(const std::vector<Eigen::Matrix3Xd>& shapes, double threshold);

/// Classifies the end of a simulation by the first case that applies: `diverges` if it is farther
/// than ten lengths from the reference; `pass` if the final shape, and each late shape unless the
/// rod is at rest, is within the tolerance; `oscillates` if the rod is not at rest and its late or
/// last shapes oscillate by more than the tolerance; else `wrong`.
/// @param reference  shape to be reached [m], 3 x N
/// @param length     length of the rod [m], > 0;  @param tolerance  divided by the length [-], > 0
[[nodiscard]] Outcome classify(const SimulationEnd& trajectory, const Eigen::Matrix3Xd& reference,
                               double length, double tolerance);

}  // namespace dlo::compare
