#pragma once

#include <Eigen/Core>

namespace dlo::energy_model {

/// The two segments that meet at a point of a polygon.
struct SegmentPair {
  Eigen::Vector3d u, v;  ///< unit vectors of the segment before and the segment after the point
  double a, b;           ///< lengths of the segments

  SegmentPair(const Eigen::Ref<const Eigen::Matrix3Xd>& points, Eigen::Index i)
      : u(points.col(i) - points.col(i - 1)),
        v(points.col(i + 1) - points.col(i)),
        a(u.norm()),
        b(v.norm()) {
    u /= a;
    v /= b;
  }
};

}  // namespace dlo::energy_model
