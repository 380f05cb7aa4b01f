#include "problem/ordered_grips.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <stdexcept>

namespace dlo::energy_model {
namespace {

// Arc lengths nearer to each other are equal, in rod lengths.
constexpr double same_arc_length_share = 1e-9;

}  // namespace

std::vector<OrderedGrip> ordered_grips(const Problem& problem) {
  std::vector<OrderedGrip> grips;
  grips.reserve(problem.grips.size());
  for (std::size_t i = 0; i < problem.grips.size(); ++i) grips.push_back({i, &problem.grips[i]});
  if (grips.size() < 2) return grips;
  std::stable_sort(grips.begin(), grips.end(), [](const OrderedGrip& a, const OrderedGrip& b) {
    return a.grip->at < b.grip->at;
  });
  for (std::size_t i = 0; i + 1 < grips.size(); ++i) {
    const double rod = grips[i + 1].grip->at - grips[i].grip->at;
    const double apart = (grips[i + 1].grip->position - grips[i].grip->position).norm();
    const bool reaches = apart < rod || problem.axial_stiffness;
    if (rod > same_arc_length_share * problem.length && reaches) continue;
    std::ostringstream message;
    message << "Problem: grips at arc lengths " << grips[i].grip->at << " m and "
            << grips[i + 1].grip->at << " m are " << apart << " m apart, must be less than the "
            << rod << " m of rod between them";
    throw std::invalid_argument(message.str());
  }
  return grips;
}

std::optional<std::size_t> clamp_under(const Problem& problem, const Load& load) {
  std::optional<std::size_t> nearest;
  double least = same_arc_length_share * problem.length;
  for (std::size_t g = 0; g < problem.grips.size(); ++g) {
    const double distance = std::abs(problem.grips[g].at - load.at);
    if (!problem.grips[g].direction || distance > least) continue;
    least = distance;
    nearest = g;
  }
  return nearest;
}

void add_loads_on_clamps(const Problem& problem, Equilibrium& result) {
  for (const Load& load : problem.loads) {
    const std::optional<std::size_t> clamp = clamp_under(problem, load);
    if (!clamp) continue;
    const Eigen::Vector3d& position = problem.grips[*clamp].position;
    result.grips[*clamp].force -= load.force;
    result.grips[*clamp].torque -= load.torque;
    result.energy.load -= load.force.dot(position - problem.grips.front().position);
  }
}

}  // namespace dlo::energy_model
