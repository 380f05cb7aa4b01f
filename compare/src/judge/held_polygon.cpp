#include "judge/held_polygon.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace dlo::compare {
namespace {

/// Arc lengths that are nearer than this share of the length are one node.
constexpr double same_place = 1e-9;

/// Nodes where anything of the scene begins or ends, and so many segments about evenly between.
std::vector<double> cut_arc_lengths(const Scene& scene, int segments) {
  std::vector<double> cuts = {0, scene.length};
  for (const Gripper& gripper : scene.grippers) cuts.push_back(gripper.at);
  for (const PointLoad& load : scene.loads) cuts.push_back(load.at);
  for (const DistributedLoad& load : scene.distributed_loads) {
    cuts.insert(cuts.end(), {load.from, load.to});
  }
  for (const Section& section : scene.sections) {
    cuts.insert(cuts.end(), {section.from, section.to});
  }
  std::sort(cuts.begin(), cuts.end());
  std::vector<double> s = {0};
  double from = 0;
  for (const double cut : cuts) {
    if (cut - from <= same_place * scene.length) continue;
    const double share = (cut - from) / scene.length;
    const int parts = std::max(1, static_cast<int>(std::ceil(share * segments - 1e-6)));
    for (int i = 1; i <= parts; ++i) s.push_back(from + (cut - from) * i / parts);
    from = cut;
  }
  return s;
}

Eigen::Index nearest_node(const std::vector<double>& s, double at) {
  const auto nearest = std::min_element(
      s.begin(), s.end(), [at](double a, double b) { return std::abs(a - at) < std::abs(b - at); });
  return nearest - s.begin();
}

}  // namespace

HeldPolygon::HeldPolygon(const Scene& scene, int segments,
                         const std::optional<Eigen::Vector3d>& normal)
    : axes_(Eigen::Matrix3d::Identity()) {
  if (normal) {
    const Eigen::Vector3d x = normal->unitOrthogonal();
    axes_.resize(3, 2);
    axes_ << x, normal->cross(x);
  }
  s_ = cut_arc_lengths(scene, segments);
  for (std::size_t i = 0; i + 1 < s_.size(); ++i) lengths_.push_back(s_[i + 1] - s_[i]);
  t_.resize(3, count());
  hold(scene);
  for (Eigen::Index i = 0; i < count(); ++i) {
    const auto at = static_cast<std::size_t>(i);
    const Eigen::Vector3d half =
        (scene.weight_between(s_[at], s_[at + 1]) + scene.distributed_between(s_[at], s_[at + 1])) /
        2;
    dead_.push_back({i, half});
    dead_.push_back({i + 1, half});
  }
  for (const PointLoad& load : scene.loads) {
    dead_.push_back({nearest_node(s_, load.at), load.force});
  }
  pulls_.setZero(axes_.cols() * static_cast<Eigen::Index>(grips_.size()));
}

void HeldPolygon::hold(const Scene& scene) {
  const auto middle = [&](Eigen::Index i) {
    const auto at = static_cast<std::size_t>(i);
    return (s_[at] + s_[at + 1]) / 2;
  };
  std::vector<std::optional<Eigen::Vector3d>> clamps(s_.size());
  for (const Gripper& gripper : scene.grippers) {
    const Eigen::Index node = nearest_node(s_, gripper.at);
    grips_.push_back({node, gripper.position});
    clamps[static_cast<std::size_t>(node)] = gripper.direction;
  }
  for (Eigen::Index node = 0; node <= count(); ++node) {
    const double at = s_[static_cast<std::size_t>(node)];
    const std::optional<Eigen::Vector3d>& clamp = clamps[static_cast<std::size_t>(node)];
    if (!clamp) {
      if (node == 0 || node == count()) continue;
      const double B = 1 / scene.bending_compliance(middle(node - 1), middle(node));
      joints_.push_back({node - 1, node, B, Eigen::Vector3d::Zero()});
      continue;
    }
    if (node > 0) {
      joints_.push_back({node - 1, -1, 1 / scene.bending_compliance(middle(node - 1), at), *clamp});
    }
    if (node < count()) {
      joints_.push_back({node, -1, 1 / scene.bending_compliance(at, middle(node)), *clamp});
    }
  }
}

void HeldPolygon::lay_along(const Eigen::Matrix3Xd& points) {
  const Eigen::Matrix3d plane = axes_ * axes_.transpose();
  // In the plane of the grips.
  const Eigen::Vector3d grip = grips_.front().force;
  origin_ = grip + plane * (points.col(0) - grip);
  for (Eigen::Index i = 0; i < count(); ++i) {
    t_.col(i) = (plane * (points.col(i + 1) - points.col(i))).normalized();
  }
}

Eigen::Matrix3Xd HeldPolygon::nodes() const {
  Eigen::Matrix3Xd result(3, count() + 1);
  result.col(0) = origin_;
  for (Eigen::Index i = 0; i < count(); ++i) {
    result.col(i + 1) = result.col(i) + lengths_[static_cast<std::size_t>(i)] * t_.col(i);
  }
  return result;
}

Eigen::Vector3d HeldPolygon::tangent(Eigen::Index node) const {
  const Eigen::Index before = std::max<Eigen::Index>(node - 1, 0);
  const Eigen::Index after = std::min(node, count() - 1);
  return (t_.col(before) + t_.col(after)).normalized();
}

/// Directions in which a segment may turn, columns.
Eigen::Matrix3Xd HeldPolygon::basis(Eigen::Index segment) const {
  const Eigen::Vector3d t = t_.col(segment);
  Eigen::Matrix3Xd result(3, turns());
  if (turns() == 1) {
    result.col(0) = axes_.col(0).cross(axes_.col(1)).cross(t);
    return result;
  }
  result.col(0) = t.unitOrthogonal();
  result.col(1) = t.cross(result.col(0));
  return result;
}

void HeldPolygon::pull(const NodeForce& force, Eigen::Ref<Eigen::VectorXd> result) const {
  for (Eigen::Index i = 0; i < force.node; ++i) {
    result.segment(i * turns(), turns()) +=
        lengths_[static_cast<std::size_t>(i)] * (basis(i).transpose() * force.force);
  }
  result.segment(count() * turns(), axes_.cols()) += axes_.transpose() * force.force;
}

void HeldPolygon::linearise(const std::vector<NodeForce>& forces) {
  const Eigen::Index d = axes_.cols();
  const Eigen::Index n = unknowns();
  const auto held = static_cast<Eigen::Index>(grips_.size());
  // What each node is pulled by, then each segment by all that is beyond it.
  Eigen::Matrix3Xd carried = Eigen::Matrix3Xd::Zero(3, count() + 1);
  for (const NodeForce& dead : dead_) carried.col(dead.node) += dead.force;
  for (const NodeForce& force : forces) carried.col(force.node) += force.force;
  for (Eigen::Index j = 0; j < held; ++j) {
    carried.col(grips_[static_cast<std::size_t>(j)].node) += axes_ * pulls_.segment(j * d, d);
  }
  for (Eigen::Index i = count() - 1; i > 0; --i) carried.col(i) += carried.col(i + 1);
  Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(n + held * d, n + held * d);
  const auto add_diagonal = [&](Eigen::Index segment, double value) {
    for (Eigen::Index k = 0; k < turns(); ++k) {
      matrix(segment * turns() + k, segment * turns() + k) += value;
    }
  };
  for (Eigen::Index i = 0; i < count(); ++i) {
    const double h = lengths_[static_cast<std::size_t>(i)];
    add_diagonal(i, h * carried.col(i + 1).dot(t_.col(i)));
  }
  for (const Joint& joint : joints_) {
    const bool fixed = joint.second < 0;
    const Eigen::Vector3d other = fixed ? joint.direction : Eigen::Vector3d(t_.col(joint.second));
    const double along = joint.stiffness * other.dot(t_.col(joint.first));
    add_diagonal(joint.first, along);
    if (fixed) continue;
    add_diagonal(joint.second, along);
    const Eigen::MatrixXd block =
        joint.stiffness * basis(joint.first).transpose() * basis(joint.second);
    const Eigen::Index at = joint.first * turns();
    const Eigen::Index beside = joint.second * turns();
    matrix.block(at, beside, turns(), turns()) -= block;
    matrix.block(beside, at, turns(), turns()) -= block.transpose();
  }
  for (Eigen::Index j = 0; j < held; ++j) {
    for (Eigen::Index axis = 0; axis < d; ++axis) {
      Eigen::VectorXd row = Eigen::VectorXd::Zero(n);
      pull({grips_[static_cast<std::size_t>(j)].node, axes_.col(axis)}, row);
      matrix.row(n + j * d + axis).head(n) = row.transpose();
      matrix.col(n + j * d + axis).head(n) = -row;
    }
  }
  system_.compute(matrix);
}

Eigen::VectorXd HeldPolygon::free_step() const {
  const Eigen::Index d = axes_.cols();
  const Eigen::Index n = unknowns();
  Eigen::VectorXd right = Eigen::VectorXd::Zero(system_.rows());
  for (const NodeForce& dead : dead_) pull(dead, right.head(n));
  for (const Joint& joint : joints_) {
    const bool fixed = joint.second < 0;
    const Eigen::Vector3d other = fixed ? joint.direction : Eigen::Vector3d(t_.col(joint.second));
    right.segment(joint.first * turns(), turns()) +=
        joint.stiffness * (basis(joint.first).transpose() * other);
    if (fixed) continue;
    right.segment(joint.second * turns(), turns()) +=
        joint.stiffness * (basis(joint.second).transpose() * t_.col(joint.first));
  }
  const Eigen::Matrix3Xd points = nodes();
  for (std::size_t j = 0; j < grips_.size(); ++j) {
    right.segment(n + static_cast<Eigen::Index>(j) * d, d) =
        axes_.transpose() * (grips_[j].force - points.col(grips_[j].node));
  }
  return system_.solve(right);
}

Eigen::VectorXd HeldPolygon::response(const NodeForce& force) const {
  Eigen::VectorXd right = Eigen::VectorXd::Zero(system_.rows());
  pull(force, right.head(unknowns()));
  return system_.solve(right);
}

Eigen::VectorXd HeldPolygon::along(
    const std::vector<double>& arc_lengths, const Eigen::Vector3d& origin,
    const std::function<Eigen::Vector3d(Eigen::Index)>& segment) const {
  Eigen::VectorXd result(3 * static_cast<Eigen::Index>(arc_lengths.size()));
  Eigen::Index i = 0;
  Eigen::Vector3d start = origin;
  for (std::size_t m = 0; m < arc_lengths.size(); ++m) {
    while (i + 1 < count() && arc_lengths[m] > s_[static_cast<std::size_t>(i) + 1]) {
      start += lengths_[static_cast<std::size_t>(i)] * segment(i);
      ++i;
    }
    result.segment<3>(3 * static_cast<Eigen::Index>(m)) =
        start + (arc_lengths[m] - s_[static_cast<std::size_t>(i)]) * segment(i);
  }
  return result;
}

Eigen::VectorXd HeldPolygon::motion(const std::vector<double>& arc_lengths,
                                    const Eigen::VectorXd& step) const {
  const Eigen::Vector3d origin = axes_ * step.segment(count() * turns(), axes_.cols());
  return along(arc_lengths, origin, [&](Eigen::Index i) {
    return Eigen::Vector3d(basis(i) * step.segment(i * turns(), turns()));
  });
}

Eigen::VectorXd HeldPolygon::points(const std::vector<double>& arc_lengths) const {
  return along(arc_lengths, origin_, [&](Eigen::Index i) { return Eigen::Vector3d(t_.col(i)); });
}

double HeldPolygon::move(const Eigen::VectorXd& step) {
  constexpr double most = 1.0 / 3;
  double largest = 0;
  for (Eigen::Index i = 0; i < count(); ++i) {
    largest = std::max(largest, step.segment(i * turns(), turns()).norm());
  }
  const double part = std::min(1.0, most / std::max(largest, 1e-300));
  for (Eigen::Index i = 0; i < count(); ++i) {
    const Eigen::Vector3d turn = part * (basis(i) * step.segment(i * turns(), turns()));
    const double angle = turn.norm();
    if (angle == 0) continue;
    t_.col(i) = (std::cos(angle) * t_.col(i) + std::sin(angle) / angle * turn).normalized();
  }
  origin_ += part * (axes_ * step.segment(count() * turns(), axes_.cols()));
  take_pulls(step);
  return largest;
}

}  // namespace dlo::compare
