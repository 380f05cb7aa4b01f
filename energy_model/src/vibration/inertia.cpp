#include "vibration/inertia.hpp"

#include <cmath>

#include "base/require.hpp"

namespace dlo::energy_model {

double total_mass(const Problem& problem, const Inertia& inertia) {
  double mass = inertia.mass_per_length * problem.length;
  for (std::size_t i = 0; i < problem.sections.size(); ++i) {
    mass += (inertia.of_sections[i] - inertia.mass_per_length) *
            (problem.sections[i].end - problem.sections[i].begin);
  }
  for (const PointMass& point : inertia.point_masses) mass += point.mass;
  return mass;
}

double mass_per_length(const Problem& problem, const Inertia& inertia, double at) {
  for (std::size_t i = 0; i < problem.sections.size(); ++i) {
    if (at > problem.sections[i].begin && at < problem.sections[i].end) {
      return inertia.of_sections[i];
    }
  }
  return inertia.mass_per_length;
}

void check(const Problem& problem, const Inertia& inertia, std::string_view function) {
  const auto known = [](double mass) { return mass >= 0 && std::isfinite(mass); };
  require(known(inertia.mass_per_length), function, "mass_per_length", inertia.mass_per_length,
          ">= 0 and finite");
  require(inertia.of_sections.size() == problem.sections.size(), function, "of_sections.size()",
          static_cast<double>(inertia.of_sections.size()), "as many as sections");
  for (const double mass : inertia.of_sections) {
    require(known(mass), function, "of_sections", mass, ">= 0 and finite");
  }
  for (const PointMass& point : inertia.point_masses) {
    require(known(point.mass), function, "point_masses", point.mass, ">= 0 and finite");
    require(point.at >= 0 && point.at <= problem.length, function, "point_masses", point.at,
            "on the rod");
  }
  const double total = total_mass(problem, inertia);
  require(total > 0, function, "mass of the rod and what hangs on it", total, "> 0");
}

}  // namespace dlo::energy_model
