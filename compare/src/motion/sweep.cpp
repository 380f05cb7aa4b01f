#include "motion/sweep.hpp"

#include <algorithm>
#include <limits>

namespace dlo::compare {
namespace {

/// Surface swept by a segment of the polyline, or by a part of it: bilinear between its corners.
struct Patch {
  Eigen::Vector3d begin_before, end_before, begin_after, end_after;

  [[nodiscard]] Eigen::Vector3d centre() const {
    return (begin_before + end_before + begin_after + end_after) / 4;
  }
  [[nodiscard]] double length() const {
    return std::max((end_before - begin_before).norm(), (end_after - begin_after).norm());
  }
  [[nodiscard]] double way() const {
    return std::max((begin_after - begin_before).norm(), (end_after - end_before).norm());
  }
};

/// Whether a point of a patch is deeper in a body than `depth`. Clearances of two points differ by
/// no more than the distance of the points, so patches far from the body are skipped.
bool goes_through(const obstacle::Body& body, const Patch& patch, double depth, int halvings) {
  const double clearance = body.clearance(patch.centre());
  if (clearance < -depth) return true;
  const double length = patch.length();
  const double way = patch.way();
  if (halvings == 0 || clearance - (length + way) / 2 > -depth) return false;
  if (length > way) {
    const Eigen::Vector3d before = (patch.begin_before + patch.end_before) / 2;
    const Eigen::Vector3d after = (patch.begin_after + patch.end_after) / 2;
    return goes_through(body, {patch.begin_before, before, patch.begin_after, after}, depth,
                        halvings - 1) ||
           goes_through(body, {before, patch.end_before, after, patch.end_after}, depth,
                        halvings - 1);
  }
  const Eigen::Vector3d begin = (patch.begin_before + patch.begin_after) / 2;
  const Eigen::Vector3d end = (patch.end_before + patch.end_after) / 2;
  return goes_through(body, {patch.begin_before, patch.end_before, begin, end}, depth,
                      halvings - 1) ||
         goes_through(body, {begin, end, patch.begin_after, patch.end_after}, depth, halvings - 1);
}

}  // namespace

double inner_radius(const obstacle::Body& body) {
  if (body.is_half_space()) return std::numeric_limits<double>::infinity();
  return body.radius() + body.upper().minCoeff();
}

bool sweeps_through(const obstacle::Body& body, const Eigen::Matrix3Xd& before,
                    const Eigen::Matrix3Xd& after, double depth) {
  constexpr int most_halvings = 24;
  for (Eigen::Index i = 0; i + 1 < before.cols(); ++i) {
    const Patch patch{before.col(i), before.col(i + 1), after.col(i), after.col(i + 1)};
    if (goes_through(body, patch, depth, most_halvings)) return true;
  }
  return false;
}

}  // namespace dlo::compare
