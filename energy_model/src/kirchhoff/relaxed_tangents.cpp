#include "kirchhoff/relaxed_tangents.hpp"

#include <Eigen/Geometry>
#include <Eigen/QR>
#include <algorithm>
#include <utility>
#include <vector>

#include "kirchhoff/grip_gaps.hpp"

namespace dlo::energy_model {
namespace {

constexpr int most_rounds = 200;  // of the augmented Lagrangian
constexpr int sweeps = 20;        // over the rod in a round
constexpr double at_rest = 1e-4;  // change of a tangent in a round

/// Tangents between those of clamps at the ends, and what joins them.
class TangentChain {
 public:
  TangentChain(const RodSpan& span, const RodMesh& mesh, const Eigen::Matrix3Xd& tangents,
               Motion motion)
      : gaps(grip_gaps(span, mesh)),
        h_(mesh.s.tail(mesh.intervals()) - mesh.s.head(mesh.intervals())),
        t_(Eigen::Matrix3Xd::Zero(3, tangents.cols() + 2)),
        stiffness_(Eigen::VectorXd::Zero(tangents.cols() + 1)),
        carried_(carried_force(span, mesh).on_interval) {
    if (motion == Motion::in_plane) normal_ = span.plane->x.cross(span.plane->y);
    const Eigen::Index count = tangents.cols();
    t_.middleCols(1, count) = tangents;
    const auto compliance = [&](Eigen::Index i) { return h_[i] / mesh.section_of(i).bending; };
    for (Eigen::Index i = 1; i < count; ++i) {
      stiffness_[i] = 2 / (compliance(i - 1) + compliance(i));
    }
    if (const RodSpan::Clamp* clamp = span.clamp_at(0)) {
      t_.col(0) = clamp->direction;
      stiffness_[0] = 2 / compliance(0);
    }
    if (const RodSpan::Clamp* clamp = span.clamp_at(span.length)) {
      t_.col(count + 1) = clamp->direction;
      stiffness_[count] = 2 / compliance(count - 1);
    }
    for (GripGap& of : gaps) fit_multiplier(of);
  }

  [[nodiscard]] Eigen::Index size() const { return h_.size(); }
  [[nodiscard]] Eigen::Matrix3Xd tangents() const { return t_.middleCols(1, size()); }
  [[nodiscard]] Eigen::Vector3d gap(const GripGap& of) const {
    const Eigen::Index count = of.end - of.first;
    return t_.middleCols(1 + of.first, count) * h_.segment(of.first, count) - of.chord;
  }

  void sweep() {
    Eigen::Index i = 0;
    for (const GripGap& of : gaps) {
      for (; i < of.first; ++i) lay(i, Eigen::Vector3d::Zero());
      Eigen::Vector3d open = gap(of);
      for (; i < of.end; ++i) {
        open -= h_[i] * t_.col(i + 1);
        lay(i, -h_[i] * (of.multiplier + of.penalty * open));
        open += h_[i] * t_.col(i + 1);
      }
    }
    for (; i < size(); ++i) lay(i, Eigen::Vector3d::Zero());
  }

  [[nodiscard]] RelaxedTangents result() const {
    RelaxedTangents result{tangents(), carried_, 0};
    for (const GripGap& of : gaps) {
      result.force.middleCols(of.first, of.end - of.first).colwise() -= of.multiplier;
    }
    for (Eigen::Index i = 0; i <= size(); ++i) {
      result.energy += stiffness_[i] * (1 - t_.col(i).dot(t_.col(i + 1)));
      if (i < size()) result.energy -= h_[i] * carried_.col(i).dot(t_.col(i + 1));
    }
    return result;
  }

  std::vector<GripGap> gaps;

 private:
  /// What neighbours and what the interval carries pull it along.
  [[nodiscard]] Eigen::Vector3d pull_on(Eigen::Index i) const {
    return stiffness_[i] * t_.col(i) + stiffness_[i + 1] * t_.col(i + 2) + h_[i] * carried_.col(i);
  }

  void lay(Eigen::Index i, const Eigen::Vector3d& of_grips) {
    Eigen::Vector3d pull = pull_on(i) + of_grips;
    pull -= pull.dot(normal_) * normal_;
    if (pull.norm() > 0) t_.col(i + 1) = pull.normalized();
  }

  /// The multiplier with which a shape is as near to equilibrium as it can be, by least squares. A
  /// flat arch would otherwise be straight before its thrust has grown.
  void fit_multiplier(GripGap& of) const {
    Eigen::Matrix3d matrix = Eigen::Matrix3d::Zero();
    Eigen::Vector3d right = Eigen::Vector3d::Zero();
    for (Eigen::Index i = of.first; i < of.end; ++i) {
      const Eigen::Vector3d t = t_.col(i + 1);
      const Eigen::Matrix3d across = Eigen::Matrix3d::Identity() - t * t.transpose();
      matrix += h_[i] * h_[i] * across;
      right += h_[i] * across * pull_on(i);
    }
    of.multiplier = matrix.completeOrthogonalDecomposition().solve(right);
  }

  Eigen::VectorXd h_;
  Eigen::Matrix3Xd t_;         // of the intervals, between the clamps'
  Eigen::VectorXd stiffness_;  // between neighbours; zero: no clamp
  Eigen::Matrix3Xd carried_;
  Eigen::Vector3d normal_ = Eigen::Vector3d::Zero();  // of the plane; zero: none
};

}  // namespace

RelaxedTangents relax_tangents(const RodSpan& span, const RodMesh& mesh,
                               const Eigen::Matrix3Xd& tangents, Motion motion,
                               const Deadline& deadline) {
  TangentChain chain(span, mesh, tangents, motion);
  for (int round = 0; round < most_rounds && !deadline.passed(); ++round) {
    const Eigen::Matrix3Xd before = chain.tangents();
    for (int sweep = 0; sweep < sweeps; ++sweep) chain.sweep();
    bool closed = true;
    for (GripGap& of : chain.gaps) {
      const Eigen::Vector3d open = chain.gap(of);
      of.multiplier += of.penalty * open;
      closed = closed && of.closed(open);
    }
    if (closed && (chain.tangents() - before).colwise().norm().maxCoeff() < at_rest) break;
  }
  return chain.result();
}

}  // namespace dlo::energy_model
