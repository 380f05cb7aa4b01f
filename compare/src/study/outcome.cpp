#include "study/outcome.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace dlo::compare {

double largest_distance(const Eigen::Matrix3Xd& points, const Eigen::Matrix3Xd& reference) {
  if (!points.allFinite()) return std::numeric_limits<double>::infinity();
  return (points - reference).colwise().norm().maxCoeff();
}

bool goes_to_and_fro(const std::vector<Eigen::Matrix3Xd>& shapes, double threshold) {
  if (shapes.size() < 3) return false;
  double path = 0;
  for (std::size_t i = 1; i < shapes.size(); ++i) path += (shapes[i] - shapes[i - 1]).norm();
  const double net = (shapes.back() - shapes.front()).norm();
  const double root_points = std::sqrt(static_cast<double>(shapes.front().cols()));
  return path > 3 * net && path > threshold * root_points;
}

Outcome classify(const SimulationEnd& trajectory, const Eigen::Matrix3Xd& reference, double length,
                 double tolerance) {
  constexpr double reach = 10;  // in lengths
  if (!trajectory.finite || trajectory.late.empty()) return Outcome::diverges;
  if (!(largest_distance(trajectory.late.back(), reference) < reach * length)) {
    return Outcome::diverges;
  }
  const auto right = [&](const Eigen::Matrix3Xd& shape) {
    return largest_distance(shape, reference) <= tolerance * length;
  };
  const bool stays =
      trajectory.at_rest || std::all_of(trajectory.late.begin(), trajectory.late.end(), right);
  if (stays && right(trajectory.late.back())) return Outcome::pass;
  const double threshold = tolerance * length;
  if (!trajectory.at_rest && (goes_to_and_fro(trajectory.late, threshold) ||
                              goes_to_and_fro(trajectory.last, threshold))) {
    return Outcome::oscillates;
  }
  return Outcome::wrong;
}

}  // namespace dlo::compare
