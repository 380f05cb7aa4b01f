#include "dlo/energy_model/problem.hpp"

#include <string>

#include "require.hpp"

namespace dlo::energy_model {
namespace {

void require_on_rod(const char* argument, double at, double length) {
  // Asked first, because the text costs more than a solve's other checks together.
  if (at >= 0 && at <= length) return;
  require(false, "Problem", argument, at, "in [0, " + std::to_string(length) + "]");
}

}  // namespace

void check(const Problem& problem) {
  require_positive("Problem", "length", problem.length);
  require_positive("Problem", "bending_stiffness", problem.bending_stiffness);
  require(problem.weight_per_length.allFinite(), "Problem", "weight_per_length",
          problem.weight_per_length.norm(), "finite");
  require(!problem.grips.empty(), "Problem", "number of grips", 0, ">= 1");
  for (const Grip& grip : problem.grips) {
    require_on_rod("arc length of a grip", grip.at, problem.length);
    require(grip.position.allFinite(), "Problem", "position of a grip", grip.position.norm(),
            "finite");
    if (grip.direction) {
      require_positive("Problem", "|direction| of a clamp", grip.direction->norm());
    }
  }
  for (const Wall& wall : problem.walls) {
    require(wall.point.allFinite(), "Problem", "point of a wall", wall.point.norm(), "finite");
    require_positive("Problem", "|normal| of a wall", wall.normal.norm());
    require(wall.stiffness > 0, "Problem", "stiffness of a wall", wall.stiffness, "> 0");
  }
  for (const Load& load : problem.loads) {
    require_on_rod("arc length of a load", load.at, problem.length);
    require(load.force.allFinite(), "Problem", "force of a load", load.force.norm(), "finite");
  }
}

std::vector<double> equal_arc_lengths(double length, Eigen::Index count) {
  require_positive("equal_arc_lengths", "length", length);
  require(count >= 2, "equal_arc_lengths", "count", static_cast<double>(count), ">= 2");
  std::vector<double> arc_lengths(static_cast<std::size_t>(count));
  for (Eigen::Index i = 0; i < count; ++i) {
    arc_lengths[static_cast<std::size_t>(i)] =
        length * static_cast<double>(i) / static_cast<double>(count - 1);
  }
  return arc_lengths;
}

}  // namespace dlo::energy_model
