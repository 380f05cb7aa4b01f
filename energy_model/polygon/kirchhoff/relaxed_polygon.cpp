#include "kirchhoff/relaxed_polygon.hpp"

#include <algorithm>
#include <utility>

#include "kirchhoff/frame_joints.hpp"

namespace dlo::energy_model {
namespace {

using Eigen::Quaterniond;

// Difference of tangents, or of frames [rad], below which two polygons are the same.
constexpr double same_polygon = 0.02;

double distance(const RodSpan& span, const RelaxedPolygon& a, const RelaxedPolygon& b) {
  if (span.round()) return (a.tangents() - b.tangents()).colwise().norm().maxCoeff();
  double distance = 0;
  for (std::size_t i = 0; i < a.frames.size(); ++i) {
    distance = std::max(distance, a.frames[i].angularDistance(b.frames[i]));
  }
  return distance;
}

}  // namespace

Eigen::Matrix3Xd RelaxedPolygon::tangents() const {
  Eigen::Matrix3Xd result(3, static_cast<Eigen::Index>(frames.size()));
  for (Eigen::Index i = 0; i < result.cols(); ++i) {
    result.col(i) = frames[static_cast<std::size_t>(i)] * Eigen::Vector3d::UnitZ();
  }
  return result;
}

RelaxedPolygon relax_on_mesh(const RodSpan& span, const RodMesh& finer, const RodMesh& mesh,
                             const RelaxedPolygon& polygon, const Deadline& deadline) {
  std::vector<Quaterniond> frames;
  for (Eigen::Index i = 0; i < finer.intervals(); ++i) {
    const double middle = (finer.s[i] + finer.s[i + 1]) / 2;
    const Eigen::Index own = node_at(mesh.s, middle) - 1;
    frames.push_back(polygon.frames[static_cast<std::size_t>(
        std::clamp<Eigen::Index>(own, 0, mesh.intervals() - 1))]);
  }
  return relax_polygon(span, finer, frames, polygon.motion, deadline);
}

PolygonMinima polygon_minima(const RodSpan& span, const RodMesh& mesh, const Deadline& deadline) {
  PolygonMinima minima;
  std::vector<RelaxedPolygon>& found = minima.found;
  for (const Motion motion : {Motion::in_plane, Motion::in_space}) {
    if (motion == Motion::in_plane && !span.plane) continue;
    for (const std::vector<Quaterniond>& start : polygon_starts(span, mesh, motion)) {
      if (deadline.passed() && !found.empty()) break;
      RelaxedPolygon polygon = relax_polygon(span, mesh, start, motion, deadline);
      const bool known = std::any_of(found.begin(), found.end(), [&](const auto& other) {
        return distance(span, other, polygon) < same_polygon;
      });
      if (!known) found.push_back(std::move(polygon));
    }
  }
  minima.complete = !deadline.passed();
  std::ranges::stable_sort(found, {}, &RelaxedPolygon::energy);
  return minima;
}

std::vector<RodState> states_of(const RodSpan& span, const RodMesh& mesh,
                                const RelaxedPolygon& polygon) {
  const Eigen::Index last = mesh.intervals();
  const ForceField carried = internal_force(span, mesh);
  std::vector<RodState> states(static_cast<std::size_t>(last + 1));
  std::vector<Quaterniond> q = polygon.frames;
  for (std::size_t k = 0; k < span.clamps.size(); ++k) {
    q.push_back(clamp_frame(span, k, polygon.turns[k]));
  }
  // The moment after a node is that of the joint there; at a clamp, which has two joints, that of
  // the later one.
  for (const FrameJoint& joint : frame_joints(span, mesh)) {
    const Quaterniond& a = q[static_cast<std::size_t>(joint.left)];
    const Quaterniond& b = q[static_cast<std::size_t>(joint.right)];
    states[static_cast<std::size_t>(joint.node)].m =
        a.slerp(0.5, b) *
        Eigen::Vector3d(joint.stiffness.cwiseProduct(joint.excess(a.conjugate() * b)));
  }
  Eigen::Vector3d r = Eigen::Vector3d::Zero();
  Eigen::Vector3d shift = Eigen::Vector3d::Zero();
  for (Eigen::Index i = 0; i <= last; ++i) {
    RodState& state = states[static_cast<std::size_t>(i)];
    const auto before = static_cast<std::size_t>(std::max<Eigen::Index>(i - 1, 0));
    const auto after = static_cast<std::size_t>(std::min(i, last - 1));
    state.R = q[before].slerp(0.5, q[after]).toRotationMatrix();
    if (const RodSpan::Clamp* clamp = span.clamp_at(mesh.s[i])) {
      state.R = q[static_cast<std::size_t>(last + (clamp - span.clamps.data()))].toRotationMatrix();
    }
    state.r = r;
    if (mesh.hold[static_cast<std::size_t>(i)] == &span.holds.front()) {
      shift = span.holds.front().position - r;
    }
    if (i == last) {
      state.m.setZero();
      break;
    }
    // The contribution of the grips to the force is constant between them.
    state.n = carried.after_node.col(i) + polygon.force.col(i) - carried.on_interval.col(i);
    r += mesh.width(i) * (polygon.frames[static_cast<std::size_t>(i)] * Eigen::Vector3d::UnitZ());
  }
  for (RodState& state : states) state.r += shift;
  return states;
}

bool ChordConstraint::closed(const Eigen::Vector3d& gap) const {
  return gap.norm() < std::min(1e-4, slack / 100);
}

std::vector<ChordConstraint> grip_gaps(const RodSpan& span, const RodMesh& mesh) {
  std::vector<ChordConstraint> gaps;
  for (std::size_t k = 1; k < span.holds.size(); ++k) {
    const RodSpan::Hold& from = span.holds[k - 1];
    const RodSpan::Hold& to = span.holds[k];
    const double length = to.at - from.at;
    const Eigen::Vector3d chord = to.position - from.position;
    const double penalty =
        (100 * least_bending_stiffness(span) / (length * length) + 4 * total_load(span)) / length;
    gaps.push_back(
        {node_at(mesh.s, from.at), node_at(mesh.s, to.at), chord, length - chord.norm(), penalty});
  }
  return gaps;
}

}  // namespace dlo::energy_model
