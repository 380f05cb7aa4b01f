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

std::vector<double> masses_per_length(const Problem& problem, const Inertia& inertia,
                                      const PlacedSpan& placed, const std::vector<Piece>& pieces) {
  std::vector<double> result(pieces.size(), inertia.mass_per_length * problem.length);
  for (std::size_t i = 0; i < problem.sections.size(); ++i) {
    const double begin = placed.s_of(problem.sections[i].begin, problem.length);
    const double end = placed.s_of(problem.sections[i].end, problem.length);
    for (std::size_t e = 0; e < pieces.size(); ++e) {
      const double middle = pieces[e].begin + pieces[e].length / 2;
      if ((begin < middle) == (middle < end)) result[e] = inertia.of_sections[i] * problem.length;
    }
  }
  return result;
}

Eigen::MatrixXd mass_matrix(const SpanReach& reach, const Eigen::VectorXd& masses,
                            const Eigen::MatrixXd& tangents) {
  const Eigen::MatrixXd moved = masses.cwiseSqrt().asDiagonal() * reach.sums(tangents);
  return moved.transpose() * moved;
}

void check(const Problem& problem, const Inertia& inertia, std::string_view function) {
  const auto known = [](double mass) { return mass >= 0 && std::isfinite(mass); };
  require(known(inertia.mass_per_length), function, "mass_per_length", inertia.mass_per_length,
          ">= 0 and finite");
  require(inertia.of_sections.size() == problem.sections.size(), function, "of_sections.size()",
          static_cast<double>(inertia.of_sections.size()), "the number of sections");
  for (const double mass : inertia.of_sections) {
    require(known(mass), function, "of_sections", mass, ">= 0 and finite");
  }
  for (const PointMass& point : inertia.point_masses) {
    require(known(point.mass), function, "point_masses", point.mass, ">= 0 and finite");
    require(point.at >= 0 && point.at <= problem.length, function, "arc length of a point mass",
            point.at, "on the rod");
  }
  const double total = total_mass(problem, inertia);
  require(total > 0, function, "mass of the rod and its point masses", total, "> 0");
}

}  // namespace dlo::energy_model
