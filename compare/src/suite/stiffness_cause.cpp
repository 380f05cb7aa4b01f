#include <fmt/format.h>

#include <cmath>
#include <limits>

#include "suite/cause.hpp"

namespace dlo::compare {
namespace {

bool has_weight_only(const Scene& scene) {
  return scene.loads.empty() && scene.distributed_loads.empty() &&
         scene.weight_per_length().norm() > 0;
}

/// Whether the excess of the apparent weight over the scene's is proportional to the number of
/// elements. Above twice the weight the cause is rather springs whose stiffness depends on N and
/// tends to zero.
bool grows_with_elements(const StiffnessFactor& coarse, const StiffnessFactor& fine) {
  constexpr double least = 0.01;
  constexpr double most = 1;
  constexpr double near = 0.15;
  const double more = 1 / coarse.factor - 1;
  const double elements = static_cast<double>(fine.points - 1) / (coarse.points - 1);
  return more > least && more < most &&
         std::abs((1 / fine.factor - 1) / (more * elements) - 1) < near;
}

}  // namespace

Cause cause_of_factors(const Scene& scene, const StiffnessFactor& coarse,
                       const StiffnessFactor& fine) {
  const double power = fine.points > coarse.points
                           ? std::log(fine.factor / coarse.factor) /
                                 std::log(static_cast<double>(fine.points) / coarse.points)
                           : 0;
  constexpr double near_power = 0.35;
  const std::string both =
      fmt::format("bending stiffness is {:.3g} times EI with N = {} and {:.3g} times with N = {}",
                  coarse.factor, coarse.points, fine.factor, fine.points);
  if (has_weight_only(scene) && grows_with_elements(coarse, fine)) {
    // A ball of the caps' radius r on each element of length h adds 4 r / (3 h) of its weight.
    const double h = scene.length / (fine.points - 1);
    return {"weight with caps", 1 / fine.factor,
            fmt::format("the weight is {:.3g} times the scene's with N = {} and {:.3g} times with "
                        "N = {}: each element has more, as caps of radius {:.3g} mm have",
                        1 / coarse.factor, coarse.points, 1 / fine.factor, fine.points,
                        0.75e3 * h * (1 / fine.factor - 1))};
  }
  if (std::abs(power + 1) < near_power) {
    return {"springs without 1/h", fine.factor,
            both + ": it is not divided by the element's length"};
  }
  if (std::abs(power - 1) < near_power) {
    return {"springs with 1/h^2", fine.factor,
            both + ": it is divided by the element's length twice"};
  }
  // Below it the rod is a rope, and how far below does not show.
  constexpr double next_to_none = 1e-3;
  if (coarse.factor < next_to_none && fine.factor < next_to_none) {
    return {"bending stiffness ignored", std::numeric_limits<double>::quiet_NaN(),
            fmt::format("the bending stiffness is less than {:g} of the scene's", next_to_none)};
  }
  if (std::abs(power) < near_power) {
    return {"bending stiffness wrong", fine.factor,
            fmt::format("the bending stiffness is {:.3g} times the scene's{}", fine.factor,
                        has_weight_only(scene)
                            ? fmt::format(", or the weight {:.3g} times", 1 / fine.factor)
                            : "")};
  }
  return {"bending stiffness depends on N", fine.factor, both};
}

}  // namespace dlo::compare
