#include "shape/curve.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

namespace dlo::compare {
namespace {

constexpr Eigen::Index curve_pieces = 200;

}  // namespace

Curve::Curve(const Reference& reference, double length)
    : length_(length), step_(length / static_cast<double>(curve_pieces)) {
  std::vector<double> s(static_cast<std::size_t>(curve_pieces) + 1);
  for (std::size_t i = 0; i < s.size(); ++i) s[i] = static_cast<double>(i) * step_;
  s.back() = length;
  energy_model::Samples samples = reference(s);
  nodes_ = std::move(samples.points);
  tangents_ = std::move(samples.tangents);
}

Curve::Local Curve::at(double s) const {
  const auto piece =
      std::clamp(static_cast<Eigen::Index>(s / step_), Eigen::Index{0}, curve_pieces - 1);
  const double u = s / step_ - static_cast<double>(piece);
  const Eigen::Vector3d a = nodes_.col(piece);
  const Eigen::Vector3d ta = step_ * tangents_.col(piece);
  const Eigen::Vector3d tb = step_ * tangents_.col(piece + 1);
  const Eigen::Vector3d chord = nodes_.col(piece + 1) - a;
  const Eigen::Vector3d c2 = 3 * chord - 2 * ta - tb;
  const Eigen::Vector3d c3 = ta + tb - 2 * chord;
  return {a + u * (ta + u * (c2 + u * c3)), (ta + u * (2 * c2 + u * 3 * c3)) / step_,
          (2 * c2 + u * 6 * c3) / (step_ * step_)};
}

Eigen::Matrix3Xd Curve::points(const std::vector<double>& s) const {
  Eigen::Matrix3Xd result(3, static_cast<Eigen::Index>(s.size()));
  for (std::size_t i = 0; i < s.size(); ++i) result.col(static_cast<Eigen::Index>(i)) = point(s[i]);
  return result;
}

double Curve::nearest(const Eigen::Vector3d& position, double s) const {
  // Newton's method for (position - r) . r' = 0, with descent, limited to four intervals per step.
  constexpr int most_steps = 30;
  Local local = at(s);
  double distance = (position - local.point).squaredNorm();
  for (int i = 0; i < most_steps; ++i) {
    const Eigen::Vector3d gap = position - local.point;
    const double slope = gap.dot(local.tangent);
    const double curvature = std::max(local.tangent.squaredNorm() - gap.dot(local.second), 0.2);
    double move = std::clamp(slope / curvature, -4 * step_, 4 * step_);
    bool moved = false;
    for (int halving = 0; halving < 8 && !moved; ++halving, move /= 2) {
      const double next = std::clamp(s + move, 0.0, length_);
      if (std::abs(next - s) < 1e-13 * length_) return s;
      const Local there = at(next);
      const double there_distance = (position - there.point).squaredNorm();
      if (!(there_distance < distance)) continue;
      s = next;
      local = there;
      distance = there_distance;
      moved = true;
    }
    if (!moved) return s;
  }
  return s;
}

std::vector<double> Curve::nearest_in_order(const Eigen::Matrix3Xd& positions) const {
  const Eigen::Index count = positions.cols();
  constexpr Eigen::Index nodes = curve_pieces + 1;
  // sums[g]: least sum of squares with the last point so far at node g; from: node of its
  // predecessor
  Eigen::VectorXd sums = Eigen::VectorXd::Zero(nodes);
  std::vector<std::uint16_t> from(static_cast<std::size_t>(count * nodes));
  for (Eigen::Index i = 0; i < count; ++i) {
    const Eigen::RowVectorXd distance =
        (nodes_.colwise() - positions.col(i)).colwise().squaredNorm();
    double best = std::numeric_limits<double>::infinity();
    std::uint16_t best_node = 0;
    std::uint16_t* row = from.data() + i * nodes;
    for (Eigen::Index g = 0; g < nodes; ++g) {
      if (sums[g] < best) {
        best = sums[g];
        best_node = static_cast<std::uint16_t>(g);
      }
      row[g] = best_node;
      sums[g] = best + distance[g];
    }
  }
  std::vector<double> result(static_cast<std::size_t>(count));
  Eigen::Index node = 0;
  sums.minCoeff(&node);
  for (Eigen::Index i = count - 1; i >= 0; --i) {
    const double s = std::min(static_cast<double>(node) * step_, length_);
    const double moved = nearest(positions.col(i), s);
    result[static_cast<std::size_t>(i)] = std::clamp(moved, s - step_, s + step_);
    node = from[static_cast<std::size_t>(i * nodes + node)];
  }
  return result;
}

}  // namespace dlo::compare
