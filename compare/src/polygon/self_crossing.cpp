#include "polygon/self_crossing.hpp"

#include <algorithm>
#include <cstddef>
#include <utility>
#include <vector>

namespace dlo::compare {
namespace {

/// Smallest distance along the rod between two points that can cross, in diameters.
constexpr double neighbouring = 3;
/// Rounding of a distance, divided by the largest coordinate: axes that cross may be this far
/// apart.
constexpr double coordinate_rounding = 1e-12;

/// Positions of the nearest points of two segments, as fractions of the segments (Ericson,
/// Real-Time Collision Detection, 2005, section 5.1.9).
struct Nearest {
  double along_a = 0;
  double along_b = 0;
};

Nearest nearest_of(const Eigen::Vector3d& a, const Eigen::Vector3d& along_a,
                   const Eigen::Vector3d& b, const Eigen::Vector3d& along_b) {
  const auto share = [](double value) { return std::clamp(value, 0.0, 1.0); };
  const Eigen::Vector3d from_b = a - b;
  const double aa = along_a.squaredNorm();
  const double bb = along_b.squaredNorm();
  const double ab = along_a.dot(along_b);
  const double apart_a = along_a.dot(from_b);
  const double apart_b = along_b.dot(from_b);
  const double across = aa * bb - ab * ab;
  Nearest result;
  if (across > 0) result.along_a = share((ab * apart_b - apart_a * bb) / across);
  result.along_b = share((ab * result.along_a + apart_b) / bb);
  result.along_a = share((ab * result.along_b - apart_a) / aa);
  return result;
}

/// A tree of bounding boxes of runs of segments, halved down to runs of few segments. Two boxes
/// that are farther apart than the nearest pair so far are skipped. So about n pairs of n points
/// are compared, not n^2 / 2.
class Crossings {
 public:
  Crossings(const Shape& shape, double diameter)
      : s_(shape.arc_length),
        points_(shape.points),
        apart_(neighbouring * diameter),
        slack_(coordinate_rounding * points_.cwiseAbs().maxCoeff()),
        near_(std::max(diameter, slack_)) {
    (void)add(0, points_.cols() - 1);
  }

  [[nodiscard]] std::optional<SelfCrossing> nearest() {
    within(nodes_.size() - 1);
    return found_;
  }

 private:
  static constexpr Eigen::Index most_in_leaf = 4;

  struct Node {
    Eigen::Index begin = 0, end = 0;    // segments, `end` excluded
    std::size_t first = 0, second = 0;  // indices of the halves, unless the node is a leaf
    Eigen::Vector3d low, high;

    [[nodiscard]] bool is_leaf() const { return end - begin <= most_in_leaf; }
  };

  std::size_t add(Eigen::Index begin, Eigen::Index end) {
    Node node{.begin = begin, .end = end, .low = {}, .high = {}};
    if (!node.is_leaf()) {
      const Eigen::Index middle = (begin + end) / 2;
      node.first = add(begin, middle);
      node.second = add(middle, end);
    }
    const auto own = points_.middleCols(begin, end - begin + 1);
    node.low = own.rowwise().minCoeff();
    node.high = own.rowwise().maxCoeff();
    nodes_.push_back(node);
    return nodes_.size() - 1;
  }

  void within(std::size_t at) {
    const Node& node = nodes_[at];
    if (node.is_leaf()) {
      look_at(node, node);
      return;
    }
    within(node.first);
    within(node.second);
    between(node.first, node.second);
  }

  /// Compares the segments of two nodes.
  /// @param at_a, at_b  indices of the nodes, the first one before the other along the rod
  void between(std::size_t at_a, std::size_t at_b) {
    const Node& a = nodes_[at_a];
    const Node& b = nodes_[at_b];
    // All pairs are too close along the rod.
    const double farthest =
        s_[static_cast<std::size_t>(b.end)] - s_[static_cast<std::size_t>(a.begin)];
    if (farthest < apart_ - coordinate_rounding * s_.back()) return;
    const Eigen::Vector3d gap = (a.low - b.high).cwiseMax(b.low - a.high).cwiseMax(0);
    if (gap.norm() > near_ + slack_) return;
    if (a.is_leaf() && b.is_leaf()) {
      look_at(a, b);
    } else if (b.is_leaf() || (!a.is_leaf() && a.end - a.begin >= b.end - b.begin)) {
      between(a.first, at_b);
      between(a.second, at_b);
    } else {
      between(at_a, b.first);
      between(at_a, b.second);
    }
  }

  void look_at(const Node& a, const Node& b) {
    for (Eigen::Index i = a.begin; i < a.end; ++i) {
      for (Eigen::Index j = std::max(b.begin, i + 2); j < b.end; ++j) look_at(i, j);
    }
  }

  void look_at(Eigen::Index i, Eigen::Index j) {
    const Eigen::Vector3d along_a = points_.col(i + 1) - points_.col(i);
    const Eigen::Vector3d along_b = points_.col(j + 1) - points_.col(j);
    const Nearest at = nearest_of(points_.col(i), along_a, points_.col(j), along_b);
    const auto arc_length = [&](Eigen::Index k, double share) {
      const auto index = static_cast<std::size_t>(k);
      return s_[index] + share * (s_[index + 1] - s_[index]);
    };
    const SelfCrossing here = {
        arc_length(i, at.along_a), arc_length(j, at.along_b),
        (points_.col(i) + at.along_a * along_a - points_.col(j) - at.along_b * along_b).norm()};
    if (!(here.second - here.first >= apart_) || !(here.distance <= near_)) return;
    const std::pair segments{i, j};
    // If several pairs have the same distance, the first along the rod counts.
    if (found_ && here.distance == near_ && !(segments < segments_)) return;
    found_ = here;
    segments_ = segments;
    near_ = here.distance;
  }

  const std::vector<double>& s_;
  const Eigen::Matrix3Xd& points_;
  double apart_;  // least distance along the rod [m]
  double slack_;  // rounding of a distance [m]
  double near_;   // largest distance of a pair; after a find, the smallest distance so far [m]
  std::vector<Node> nodes_;
  std::optional<SelfCrossing> found_;
  std::pair<Eigen::Index, Eigen::Index> segments_;
};

}  // namespace

std::optional<SelfCrossing> self_crossing(const Shape& shape, double diameter) {
  if (shape.points.cols() < 4) return std::nullopt;
  return Crossings(shape, diameter).nearest();
}

}  // namespace dlo::compare
