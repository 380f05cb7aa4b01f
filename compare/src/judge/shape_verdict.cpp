#include "dlo/compare/shape_verdict.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>
#include <vector>

#include "base/number.hpp"
#include "dlo/compare/deviation.hpp"
#include "dlo/compare/reference.hpp"
#include "dlo/compare/solution.hpp"

namespace dlo::compare {
namespace {

std::string arc_range(double from, double to) {
  return fmt::format("s = {:.4g} to {:.4g} m", from, to);
}

/// What of the rod a file does not have, in words; empty if nothing.
std::string missing_parts(const ShapeCheck& check, double least) {
  const std::vector<double>& s = check.reference.arc_length;
  std::vector<std::string> parts;
  if (s.front() > least) parts.push_back(arc_range(0, s.front()));
  if (s.back() < check.length_m - least) parts.push_back(arc_range(s.back(), check.length_m));
  return fmt::format("{}", fmt::join(parts, " and "));
}

/// What a sum of arc lengths may leave the rod by, as a share of its length: single precision
/// rounds each of some segments by 6e-8.
constexpr double arc_rounding = 1e-6;

/// Points are counted from 1, as `dlo check` does.
std::string problem_of(const Shape& shape, double length) {
  const std::vector<double>& s = shape.arc_length;
  if (static_cast<Eigen::Index>(s.size()) != shape.points.cols() || s.size() < 2) {
    return fmt::format("has {} points and {} arc lengths (allowed: as many, 2 or more)",
                       shape.points.cols(), s.size());
  }
  for (std::size_t i = 0; i < s.size(); ++i) {
    if (!shape.points.col(static_cast<Eigen::Index>(i)).allFinite()) {
      return fmt::format("is not finite at point {}, s = {:g} m", i + 1, s[i]);
    }
    const double rounding = arc_rounding * length;
    if (!(s[i] >= -rounding && s[i] <= length + rounding)) {
      return fmt::format("leaves the rod at point {}, s = {:.9g} m (allowed: 0 to {:.9g} m)", i + 1,
                         s[i], length);
    }
    if (i > 0 && !(s[i] > s[i - 1])) {
      return fmt::format("has arc lengths that do not grow at point {}, s = {:g} m", i + 1, s[i]);
    }
  }
  return {};
}

std::string point_text(const Eigen::Vector3d& point) {
  const double large = point.norm();
  return fmt::format("({:.6g}, {:.6g}, {:.6g})", shown(point.x(), large), shown(point.y(), large),
                     shown(point.z(), large));
}

}  // namespace

ShapeJudgement judge(const ShapeCheck& check, const ShapeTolerance& tolerance) {
  ShapeJudgement result;
  const double rms = tolerance.part ? check.deviation.rms_m : check.whole_rms_m;
  const double largest = tolerance.part ? check.deviation.max_m : check.whole_max_m;
  result.judged_m = tolerance.largest ? largest : rms;
  const bool near = result.judged_m <= tolerance.allowed_m;
  double seen = check.seen_share;
  std::vector<std::string> untold;
  for (const RodPart& part : check.between) {
    if (part.untold_m <= tolerance.allowed_m) continue;
    seen -= (part.to_m - part.from_m) / check.length_m;
    untold.push_back(arc_range(part.from_m, part.to_m));
  }
  const bool enough = seen >= tolerance.least_seen_share;
  result.pass = near && enough && (tolerance.part || untold.empty());

  std::vector<std::string> reasons;
  if (!enough) {
    reasons.push_back(fmt::format("only {:.4g} % of the rod is seen, needed {:.4g} %",
                                  std::max(0.0, seen) * 100, tolerance.least_seen_share * 100));
  }
  if (!untold.empty()) {
    reasons.push_back(
        fmt::format("the points do not determine the rod at {}", fmt::join(untold, ", ")));
  }
  constexpr double rounding = 1e-6;
  const std::string missing = missing_parts(check, rounding * check.length_m);
  std::string deviation = fmt::format(
      "{} {:.4g} mm, allowed {:.4g} mm = {:.4g} % of l", tolerance.largest ? "largest" : "RMS",
      result.judged_m * 1e3, tolerance.allowed_m * 1e3, tolerance.allowed_m / check.length_m * 100);
  if (!missing.empty()) {
    deviation += tolerance.part ? "; not judged: " : ", with ";
    deviation += missing + ", which the file does not have";
  }
  reasons.push_back(std::move(deviation));
  result.reason = fmt::format("{}", fmt::join(reasons, "; "));
  return result;
}

ShapeNear shape_near(const Shape& shape, const Scene& scene, double tolerance) {
  if (!(tolerance > 0)) {
    throw std::invalid_argument(
        fmt::format("shape_near: tolerance = {}, must be > 0, a share of the length", tolerance));
  }
  const double length = scene.length;
  if (const std::string problem = problem_of(shape, length); !problem.empty()) {
    return {false, "the shape " + problem};
  }
  const energy_model::Equilibrium energy = solve_reference(scene, Model::energy);
  std::vector<double> s = shape.arc_length;
  for (double& at : s) at = std::clamp(at, 0.0, length);
  const Eigen::Matrix3Xd expected = energy.sample(s).points;
  const Eigen::Matrix3Xd difference = shape.points - expected;
  Eigen::Index worst = 0;
  const double largest = std::sqrt(difference.colwise().squaredNorm().maxCoeff(&worst));
  return {largest <= tolerance * length,
          fmt::format("largest distance {:.4g} m = {:.4g} % of l at s = {:.4g} m (point {}): {} m "
                      "instead of {} m; RMS {:.4g} % of l; allowed {:.4g} % of l",
                      largest, largest / length * 100,
                      shape.arc_length[static_cast<std::size_t>(worst)], worst + 1,
                      point_text(shape.points.col(worst)), point_text(expected.col(worst)),
                      rms(shape.arc_length, difference) / length * 100, tolerance * 100)};
}

}  // namespace dlo::compare
