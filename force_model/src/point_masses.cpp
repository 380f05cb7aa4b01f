#include "point_masses.hpp"

#include "require.hpp"

namespace dlo::force_model {

std::vector<char> free_points(const Rod& rod) {
  std::vector<char> is_free(static_cast<std::size_t>(rod.points()), 1);
  for_each_grip_point(rod, GripHold::rigid, [&](const Grip& grip, Eigen::Index k) {
    is_free[static_cast<std::size_t>(grip.first_point + k)] = 0;
  });
  return is_free;
}

void require_masses(const Rod& rod, const std::vector<char>& is_free) {
  require(rod.masses.size() == rod.points(), "Simulation", "number of masses of the rod",
          static_cast<double>(rod.masses.size()), "the number of points, for steps in time");
  for (Eigen::Index i = 0; i < rod.points(); ++i) {
    if (is_free[static_cast<std::size_t>(i)] == 0) continue;
    require_positive("Simulation", "mass of a free point", rod.masses[i]);
  }
}

}  // namespace dlo::force_model
