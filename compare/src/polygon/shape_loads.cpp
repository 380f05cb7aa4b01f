#include "polygon/shape_loads.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

namespace dlo::compare {
namespace {

/// Gauss-Legendre nodes and weights on [-1, 1] (Abramowitz and Stegun, table 25.4).
constexpr std::array<double, 4> drag_nodes = {-0.861136311594052575, -0.339981043584856265,
                                              0.339981043584856265, 0.861136311594052575};
constexpr std::array<double, 4> drag_weights = {0.347854845137453857, 0.652145154862546143,
                                                0.652145154862546143, 0.347854845137453857};

void add_drag(const Scene& scene, const energy_model::Equilibrium& shape,
              const std::vector<double>& arc_lengths, std::vector<Eigen::Vector3d>& sums) {
  constexpr int interval_count = 64;  // intervals of the whole rod, in addition to the other cuts
  std::vector<double> cuts(arc_lengths);
  for (int i = 0; i <= interval_count; ++i) cuts.push_back(scene.length * i / interval_count);
  for (const Gripper& gripper : scene.grippers) cuts.push_back(gripper.at);
  for (const PointLoad& load : scene.loads) cuts.push_back(load.at);
  for (const Section& section : scene.sections) {
    cuts.insert(cuts.end(), {section.from, section.to});
  }
  std::sort(cuts.begin(), cuts.end());
  cuts.erase(std::unique(cuts.begin(), cuts.end()), cuts.end());
  std::vector<double> at;
  for (std::size_t i = 0; i + 1 < cuts.size(); ++i) {
    for (const double x : drag_nodes) {
      at.push_back(std::min(cuts[i] + (cuts[i + 1] - cuts[i]) * (1 + x) / 2, scene.length));
    }
  }
  const Eigen::Matrix3Xd tangents = shape.sample(at).tangents;
  std::vector<Eigen::Vector3d> before = {Eigen::Vector3d::Zero()};  // sum before each cut
  for (std::size_t i = 0; i + 1 < cuts.size(); ++i) {
    Eigen::Vector3d sum = before.back();
    for (std::size_t q = 0; q < drag_nodes.size(); ++q) {
      const auto column = static_cast<Eigen::Index>(drag_nodes.size() * i + q);
      sum += (cuts[i + 1] - cuts[i]) / 2 * drag_weights[q] *
             scene.drag->force(tangents.col(column).normalized());
    }
    before.push_back(sum);
  }
  for (std::size_t i = 0; i < arc_lengths.size(); ++i) {
    const auto cut = std::lower_bound(cuts.begin(), cuts.end(), arc_lengths[i]);
    sums[i] += before[static_cast<std::size_t>(cut - cuts.begin())];
  }
}

}  // namespace

std::vector<Eigen::Vector3d> shape_loads_before(const Scene& scene,
                                                const energy_model::Equilibrium& shape,
                                                const std::vector<double>& arc_lengths) {
  std::vector<Eigen::Vector3d> sums(arc_lengths.size(), Eigen::Vector3d::Zero());
  if (scene.drag) add_drag(scene, shape, arc_lengths, sums);
  for (const PointLoad& load : scene.loads) {
    if (!load.follows) continue;
    const std::vector<double> at = {load.at};
    const energy_model::Samples here = shape.sample(at);
    const Eigen::Vector3d t = here.tangents.col(0).normalized();
    Eigen::Vector3d force = load.force.z() * t;
    if (here.d1.cols() > 0) {  // without d1 the load follows the tangent alone
      const Eigen::Vector3d d1 = here.d1.col(0);
      force += load.force.x() * d1 + load.force.y() * t.cross(d1);
    }
    for (std::size_t i = 0; i < sums.size(); ++i) {
      const double s = arc_lengths[i];
      if (load.at < s || (load.at == s && s < scene.length)) sums[i] += force;
    }
  }
  return sums;
}

PointForces forces_on_points(const Scene& scene, const std::vector<double>& s) {
  const auto count = static_cast<Eigen::Index>(s.size());
  PointForces result{Eigen::Matrix3Xd::Zero(3, count), Eigen::Matrix3Xd::Zero(3, count)};
  for (Eigen::Index i = 0; i < count; ++i) {
    const auto at = static_cast<std::size_t>(i);
    const double begin = i == 0 ? 0 : (s[at - 1] + s[at]) / 2;
    const double end = i + 1 == count ? scene.length : (s[at] + s[at + 1]) / 2;
    result.weights.col(i) = scene.weight_between(begin, end);
    result.loads.col(i) = scene.distributed_between(begin, end);
  }
  for (const PointLoad& load : scene.loads) {
    const auto above = std::upper_bound(s.begin() + 1, s.end() - 1, load.at);
    const Eigen::Index right = above - s.begin();
    const double left_at = *(above - 1);
    const double share = std::clamp((load.at - left_at) / (*above - left_at), 0.0, 1.0);
    result.loads.col(right - 1) += (1 - share) * load.force;
    result.loads.col(right) += share * load.force;
  }
  return result;
}

Eigen::Matrix3Xd drag_forces(const Scene& scene, const std::vector<double>& arc_length,
                             const Eigen::Matrix3Xd& points) {
  Eigen::Matrix3Xd forces = Eigen::Matrix3Xd::Zero(3, points.cols());
  for (Eigen::Index i = 0; i + 1 < points.cols(); ++i) {
    const auto at = static_cast<std::size_t>(i);
    const double from = std::max(arc_length[at], 0.0);
    const double to = std::min(arc_length[at + 1], scene.length);
    if (!(to > from)) continue;
    const Eigen::Vector3d tangent = (points.col(i + 1) - points.col(i)).normalized();
    const Eigen::Vector3d half = (to - from) / 2 * scene.drag->force(tangent);
    forces.col(i) += half;
    forces.col(i + 1) += half;
  }
  return forces;
}

}  // namespace dlo::compare
