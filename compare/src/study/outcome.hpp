#pragma once

#include <Eigen/Core>
#include <vector>

#include "dlo/compare/choice.hpp"

namespace dlo::compare {

/// What became of a simulation.
enum class Outcome {
  pass,        ///< at the right shape, and staying there
  wrong,       ///< elsewhere: at rest in a shape that is no equilibrium, or still creeping
  oscillates,  ///< going to and fro instead of coming to rest
  diverges,    ///< not finite, or far beyond the rod's reach
  refused,     ///< a clear error instead of a shape
};

/// In words, for tables.
template <>
struct Choices<Outcome> {
  /// In the enumeration's order.
  static constexpr Choice<Outcome> all[] = {{Outcome::pass, "pass", ""},
                                            {Outcome::wrong, "wrong", ""},
                                            {Outcome::oscillates, "oscillates", ""},
                                            {Outcome::diverges, "diverges", ""},
                                            {Outcome::refused, "refused", ""}};
};

/// What is known of a simulation's end.
struct SimulationEnd {
  bool finite = false;   ///< no step diverged
  bool at_rest = false;  ///< proved, see force_model::Simulation::relax
  /// Shapes at equal distances over the last half of the steps, the end last [m], 3 x N each; the
  /// end alone is enough where it is at rest.
  std::vector<Eigen::Matrix3Xd> late;
  std::vector<Eigen::Matrix3Xd> last;  ///< shapes of consecutive last steps [m]
};

/// Largest distance of a point from the reference's [m]; infinite if one is not finite.
[[nodiscard]] double largest_distance(const Eigen::Matrix3Xd& points,
                                      const Eigen::Matrix3Xd& reference);

/// Whether shapes go to and fro: together they move more than three times as far as from the first
/// to the last, and more than `threshold` [m] (RMS over the points).
[[nodiscard]] bool goes_to_and_fro(const std::vector<Eigen::Matrix3Xd>& shapes, double threshold);

/// In this order: `diverges` beyond ten lengths from the reference; `pass` if the end, and every
/// late shape unless it is at rest, is within the tolerance; `oscillates` if it is not at rest and
/// late or last shapes go to and fro by more than the tolerance; else `wrong`.
/// @param reference  the right shape [m], 3 x N
/// @param length     of the rod [m], > 0;  @param tolerance  share of the length [-], > 0
[[nodiscard]] Outcome classify(const SimulationEnd& trajectory, const Eigen::Matrix3Xd& reference,
                               double length, double tolerance);

}  // namespace dlo::compare
