#include "kirchhoff/relaxed_frames.hpp"

#include <algorithm>
#include <functional>
#include <optional>

#include "base/minimise.hpp"
#include "kirchhoff/frame_joints.hpp"
#include "kirchhoff/grip_gaps.hpp"

namespace dlo::energy_model {
namespace {

using Eigen::Quaterniond;

constexpr int augmented_rounds = 12;
constexpr int round_evaluations = 400;
constexpr int remembered = 15;  // number of steps that L-BFGS stores; an evaluation is cheap
// Norm of the gradient over 1 + load at which the polygon counts as an equilibrium.
constexpr double polygon_at_rest = 1e-5;

Eigen::Vector4d vector_of(const Quaterniond& q) { return {q.w(), q.x(), q.y(), q.z()}; }

/// Energy of the polygon as a function of the quaternions of the intervals and the rotations at
/// clamps.
class PolygonEnergy {
 public:
  PolygonEnergy(const RodSpan& span, const RodMesh& mesh, Motion motion)
      : gaps(grip_gaps(span, mesh)),
        span_(span),
        mesh_(mesh),
        joints_(frame_joints(span, mesh)),
        carried_(carried_force(span, mesh).on_interval) {
    if (motion == Motion::in_plane) normal_ = span.plane->x.cross(span.plane->y);
  }

  [[nodiscard]] Eigen::VectorXd unknowns(const std::vector<Quaterniond>& frames) const {
    const Eigen::Index count = mesh_.intervals();
    const std::vector<double> turns = adjacent_interval_turns(span_, mesh_, frames);
    Eigen::VectorXd x(4 * count + static_cast<Eigen::Index>(turns.size()));
    for (Eigen::Index i = 0; i < count; ++i) {
      x.segment<4>(4 * i) = vector_of(frames[static_cast<std::size_t>(i)]);
    }
    std::copy(turns.begin(), turns.end(), x.begin() + 4 * count);
    return x;
  }

  [[nodiscard]] Quaterniond frame(const Eigen::Ref<const Eigen::VectorXd>& x,
                                  Eigen::Index i) const {
    if (i < mesh_.intervals()) {
      return Quaterniond(x[4 * i], x[4 * i + 1], x[4 * i + 2], x[4 * i + 3]).normalized();
    }
    const auto clamp = static_cast<std::size_t>(i - mesh_.intervals());
    return clamp_frame(span_, clamp, x[3 * mesh_.intervals() + i]);
  }

  [[nodiscard]] Eigen::Vector3d gap(const Eigen::Ref<const Eigen::VectorXd>& x,
                                    const GripGap& of) const {
    Eigen::Vector3d gap = -of.chord;
    for (Eigen::Index i = of.first; i < of.end; ++i) {
      gap += mesh_.width(i) * (frame(x, i) * Eigen::Vector3d::UnitZ());
    }
    return gap;
  }

  /// Returns the force n_i in each interval, including the multipliers' part.
  [[nodiscard]] Eigen::Matrix3Xd force(const Eigen::Ref<const Eigen::VectorXd>& x) const {
    Eigen::Matrix3Xd force = carried_;
    for (const GripGap& of : gaps) {
      force.middleCols(of.first, of.end - of.first).colwise() -=
          of.multiplier + of.penalty * gap(x, of);
    }
    return force;
  }

  double operator()(const Eigen::Ref<const Eigen::VectorXd>& x,
                    Eigen::Ref<Eigen::VectorXd> gradient) const {
    std::vector<Quaterniond> q;
    const Eigen::Index frames = mesh_.intervals() + static_cast<Eigen::Index>(span_.clamps.size());
    q.reserve(static_cast<std::size_t>(frames));
    for (Eigen::Index i = 0; i < frames; ++i) q.push_back(frame(x, i));
    Eigen::Matrix4Xd by_frame = Eigen::Matrix4Xd::Zero(4, frames);
    double energy = add_joints(q, by_frame);
    const Eigen::Matrix3Xd n = force(x);
    for (const GripGap& of : gaps) {
      const Eigen::Vector3d open = gap(x, of);
      energy += of.multiplier.dot(open) + of.penalty / 2 * open.squaredNorm();
    }
    for (Eigen::Index i = 0; i < mesh_.intervals(); ++i) {
      const Quaterniond& p = q[static_cast<std::size_t>(i)];
      energy -= mesh_.width(i) * carried_.col(i).dot(p * Eigen::Vector3d::UnitZ());
      const Eigen::Vector3d f = -2 * mesh_.width(i) * n.col(i);
      by_frame.col(i) += Eigen::Vector4d(
          f[0] * p.y() - f[1] * p.x(), f[0] * p.z() - f[1] * p.w() - 2 * f[2] * p.x(),
          f[0] * p.w() + f[1] * p.z() - 2 * f[2] * p.y(), f[0] * p.x() + f[1] * p.y());
    }
    by_unknowns(x, q, by_frame, gradient);
    return energy;
  }

  std::vector<GripGap> gaps;

 private:
  double add_joints(const std::vector<Quaterniond>& q, Eigen::Matrix4Xd& by_frame) const {
    double energy = 0;
    for (const FrameJoint& joint : joints_) {
      const Quaterniond& a = q[static_cast<std::size_t>(joint.left)];
      const Quaterniond& b = q[static_cast<std::size_t>(joint.right)];
      const Quaterniond turn = a.conjugate() * b;
      const Eigen::Vector3d excess = joint.excess(turn);
      const Eigen::Vector3d moment = joint.stiffness.cwiseProduct(excess);
      energy += joint.h / 2 * excess.dot(moment);
      const Eigen::Vector3d by_turn = joint.h * joint.factor(turn) * moment;
      const Quaterniond pure(0, by_turn.x(), by_turn.y(), by_turn.z());
      by_frame.col(joint.right) += vector_of(a * pure);
      by_frame.col(joint.left) -= vector_of(b * pure);
    }
    return energy;
  }

  void by_unknowns(const Eigen::Ref<const Eigen::VectorXd>& x, const std::vector<Quaterniond>& q,
                   const Eigen::Matrix4Xd& by_frame, Eigen::Ref<Eigen::VectorXd> gradient) const {
    const Eigen::Index count = mesh_.intervals();
    gradient.setZero();
    for (Eigen::Index i = 0; i < count; ++i) {
      const Quaterniond& p = q[static_cast<std::size_t>(i)];
      const Eigen::Vector4d slope = by_frame.col(i);
      Eigen::Vector4d along = slope - vector_of(p) * vector_of(p).dot(slope);
      if (normal_) {
        const Eigen::Vector4d spin =
            vector_of(Quaterniond(0, normal_->x(), normal_->y(), normal_->z()) * p);
        along = spin * spin.dot(slope);
      }
      gradient.segment<4>(4 * i) = along / x.segment<4>(4 * i).norm();
    }
    if (normal_) return;  // the rotations at clamps would leave the plane
    for (Eigen::Index i = count + 1; i < by_frame.cols(); ++i) {
      const Quaterniond rate = q[static_cast<std::size_t>(i)] * Quaterniond(0, 0, 0, 0.5);
      gradient[3 * count + i] = by_frame.col(i).dot(vector_of(rate));
    }
  }

  const RodSpan& span_;
  const RodMesh& mesh_;
  std::vector<FrameJoint> joints_;
  Eigen::Matrix3Xd carried_;
  std::optional<Eigen::Vector3d> normal_;  // normal of the plane to which the motion is restricted
};

}  // namespace

RelaxedPolygon relax_frames(const RodSpan& span, const RodMesh& mesh,
                            const std::vector<Quaterniond>& start, Motion motion,
                            const Deadline& deadline) {
  PolygonEnergy energy(span, mesh, motion);
  const Eigen::Index count = mesh.intervals();
  Eigen::VectorXd x = energy.unknowns(start);
  const double unit = 1 + total_load(span);
  const int rounds = energy.gaps.empty() ? 2 : augmented_rounds;
  for (int round = 0; round < rounds && !deadline.passed(); ++round) {
    const MinimiseResult rest = minimise_lbfgs(std::cref(energy), x,
                                               {.gradient_tolerance = polygon_at_rest * unit,
                                                .max_evaluations = round_evaluations,
                                                .remembered_steps = remembered,
                                                .deadline = deadline});
    bool closed = true;
    for (GripGap& gap : energy.gaps) {
      const Eigen::Vector3d open = energy.gap(x, gap);
      gap.multiplier += gap.penalty * open;
      closed = closed && gap.closed(open);
    }
    for (Eigen::Index i = 0; i < count; ++i) x.segment<4>(4 * i).normalize();
    if (closed && succeeded(rest.status)) break;
  }
  RelaxedPolygon polygon;
  Eigen::VectorXd gradient(x.size());
  polygon.energy = energy(x, gradient);
  polygon.force = energy.force(x);
  polygon.motion = motion;
  for (Eigen::Index i = 0; i < count; ++i) polygon.frames.push_back(energy.frame(x, i));
  polygon.turns.assign(x.begin() + 4 * count, x.end());
  return polygon;
}

}  // namespace dlo::energy_model
