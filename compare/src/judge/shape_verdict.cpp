#include "dlo/compare/shape_verdict.hpp"

#include <fmt/format.h>

#include <cmath>
#include <stdexcept>

#include "dlo/compare/deviation.hpp"
#include "dlo/compare/reference.hpp"
#include "dlo/compare/solution.hpp"

namespace dlo::compare {
namespace {

std::string problem_of(const Shape& shape, double length) {
  const std::vector<double>& s = shape.arc_length;
  if (static_cast<Eigen::Index>(s.size()) != shape.points.cols() || s.size() < 2) {
    return fmt::format("has {} points and {} arc lengths (allowed: as many, 2 or more)",
                       shape.points.cols(), s.size());
  }
  const double rounding = 1e-9 * length;
  for (std::size_t i = 0; i < s.size(); ++i) {
    if (!shape.points.col(static_cast<Eigen::Index>(i)).allFinite()) {
      return fmt::format("is not finite at point {}, s = {:g} m", i, s[i]);
    }
    if (!(s[i] >= -rounding && s[i] <= length + rounding)) {
      return fmt::format("leaves the rod at point {}, s = {:g} m (allowed: 0 to {:g} m)", i, s[i],
                         length);
    }
    if (i > 0 && !(s[i] > s[i - 1])) {
      return fmt::format("has arc lengths that do not grow at point {}, s = {:g} m", i, s[i]);
    }
  }
  return {};
}

std::string point_text(const Eigen::Vector3d& point) {
  return fmt::format("({:.6g}, {:.6g}, {:.6g})", point.x() + 0.0, point.y() + 0.0, point.z() + 0.0);
}

}  // namespace

ShapeVerdict judge_shape(const Shape& shape, const Scene& scene, double tolerance) {
  if (!(tolerance > 0)) {
    throw std::invalid_argument(
        fmt::format("judge_shape: tolerance = {}, must be > 0, a share of the length", tolerance));
  }
  const double length = scene.length;
  if (const std::string problem = problem_of(shape, length); !problem.empty()) {
    return {false, "the shape " + problem};
  }
  const energy_model::Equilibrium energy = solve_reference(scene, Model::energy);
  const Eigen::Matrix3Xd expected = energy.sample(shape.arc_length).points;
  const Eigen::Matrix3Xd difference = shape.points - expected;
  Eigen::Index worst = 0;
  const double largest = std::sqrt(difference.colwise().squaredNorm().maxCoeff(&worst));
  return {largest <= tolerance * length,
          fmt::format("largest distance {:.4g} m = {:.4g} % of l at s = {:.4g} m (point {}): {} m "
                      "instead of {} m; RMS {:.4g} % of l; allowed {:.4g} % of l",
                      largest, largest / length * 100,
                      shape.arc_length[static_cast<std::size_t>(worst)], worst,
                      point_text(shape.points.col(worst)), point_text(expected.col(worst)),
                      rms(shape.arc_length, difference) / length * 100, tolerance * 100)};
}

}  // namespace dlo::compare
