#include <Eigen/Geometry>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

#include "base/spin.hpp"
#include "kirchhoff/frame_joints.hpp"
#include "kirchhoff/relaxed_polygon.hpp"
#include "polygon/polygon_energy.hpp"

namespace dlo::energy_model {
namespace {

using Eigen::Quaterniond;

/// Spins that a frame is free to take: the first `size` columns of `axes`; the others are 0.
struct SpinBasis {
  Eigen::Matrix3d axes = Eigen::Matrix3d::Zero();
  Eigen::Index size = 0;
};

constexpr int most_steps = 200;  // maximum number of Newton steps; about 30 are usual
constexpr int most_shifts = 60;  // maximum number of increases of the shift, by a factor of 4 each
constexpr int most_halvings = 30;        // maximum number of halvings of a step
constexpr double converged_spin = 1e-4;  // spin of a frame at which the iteration ends [rad]
constexpr double multiplier_update_spin = 0.05;  // spin below which multipliers are updated [rad]
// Smallest shift, in units of b / l^2; keeps steps along zero modes small.
constexpr double least_shift = 1e-4;
constexpr double longest_spin_step = 0.5;  // largest spin of a frame in a step [rad]
// Share of the predicted decrease that a step has to reach (Armijo).
constexpr double armijo_share = 1e-4;
constexpr double energy_rounding = 1e-13;  // relative rounding error of an energy
// The penalty of a gap grows unless a round reduces the gap to this share.
constexpr double required_gap_reduction = 0.25;
constexpr double penalty_growth = 4;      // increase of a penalty in a round, as a factor
constexpr double largest_penalty = 1e12;  // largest penalty divided by the initial one

/// Derivatives of a joint's energy by the spin w of its right frame minus that of its left one.
/// With turn = (c, v) in quaternions, the first and second derivatives of v along constant spins
/// w_l and w_r are
///     (c w + w x v) / 2,   -|w|^2 / 4 v - (c I - hat(v)) (w_l x w_r) / 2.
struct JointDerivatives {
  Eigen::Vector3d couple;  // derivative by w
  Eigen::Matrix3d second;  // second derivative by w, without the term of w_l x w_r

  JointDerivatives(const FrameJoint& joint, const Quaterniond& left, const Quaterniond& right) {
    const Quaterniond turn = left.conjugate() * right;
    const Eigen::Vector3d moment = joint.stiffness.cwiseProduct(joint.excess(turn));
    const Eigen::Matrix3d one = Eigen::Matrix3d::Identity();
    const Eigen::Matrix3d by_spin = joint.factor(turn) / 2 *
                                    (turn.w() * one - cross_matrix(turn.vec())) *
                                    left.conjugate().toRotationMatrix();
    couple = joint.h * by_spin.transpose() * moment;
    second = joint.h * (by_spin.transpose() * joint.stiffness.asDiagonal() * by_spin -
                        joint.factor(turn) / 4 * moment.dot(turn.vec()) * one);
  }
};

/// Returns frames without twist from one to the next that have these tangents.
std::vector<Quaterniond> frames_along(const Eigen::Matrix3Xd& tangents, const Quaterniond& first) {
  std::vector<Quaterniond> frames = {first};
  for (Eigen::Index i = 0; i < tangents.cols(); ++i) {
    const Eigen::Vector3d t = frames.back() * Eigen::Vector3d::UnitZ();
    const auto turn = Quaterniond::FromTwoVectors(t, tangents.col(i));
    frames.push_back((turn * frames.back()).normalized());
  }
  frames.erase(frames.begin());
  return frames;
}

/// Quadratic model of the augmented energy in the free spins of the frames.
struct RodModel {
  std::vector<SpinBasis> bases;   ///< by frame
  Eigen::MatrixXd band, columns;  ///< Hessian: band + columns columns^T (see PolygonFactor)
  Eigen::VectorXd lengths;        ///< length of the interval of each unknown, by which shifts act
  Eigen::VectorXd descent;        ///< negative gradient
};

struct RodStep {
  Eigen::Matrix3Xd spins;  ///< spins of the frames, one per column
  double largest = 0;      ///< largest spin of an interval's frame [rad]
  double slope = 0;        ///< derivative of the augmented energy along the step, <= 0
};

/// Frames of the intervals and clamps of a mesh with the energy of relaxed_polygon.hpp.
class DiscreteRod {
 public:
  DiscreteRod(const RodSpan& span, const RodMesh& mesh, const std::vector<Quaterniond>& start,
              Motion motion)
      : gaps(grip_gaps(span, mesh)),
        span_(span),
        mesh_(mesh),
        joints_(frame_joints(span, mesh)),
        carried_force_(internal_force(span, mesh).on_interval),
        q_(start) {
    if (motion == Motion::in_plane) normal_ = span.plane->x.cross(span.plane->y);
    const std::vector<double> turns = adjacent_interval_turns(span, mesh, start);
    for (std::size_t k = 0; k < turns.size(); ++k) q_.push_back(clamp_frame(span, k, turns[k]));
    number_unknowns();
    perturb_frames();
    for (ChordConstraint& of : gaps) fit_multiplier(of);
  }

  [[nodiscard]] Eigen::Vector3d gap(const ChordConstraint& of) const {
    Eigen::Vector3d gap = -of.chord;
    for (Eigen::Index i = of.first; i < of.end; ++i) gap += mesh_.width(i) * tangent(i);
    return gap;
  }

  [[nodiscard]] double energy() const {
    double energy = 0;
    for (const FrameJoint& joint : joints_) {
      const Eigen::Vector3d excess =
          joint.excess(frame(joint.left).conjugate() * frame(joint.right));
      energy += joint.h / 2 * excess.dot(joint.stiffness.cwiseProduct(excess));
    }
    for (Eigen::Index i = 0; i < mesh_.intervals(); ++i) {
      energy -= mesh_.width(i) * carried_force_.col(i).dot(tangent(i));
    }
    return energy;
  }

  [[nodiscard]] double augmented_energy() const {
    double energy = this->energy();
    for (const ChordConstraint& of : gaps) {
      const Eigen::Vector3d open = gap(of);
      energy += of.multiplier.dot(open) + of.penalty / 2 * open.squaredNorm();
    }
    return energy;
  }

  [[nodiscard]] const std::vector<Quaterniond>& frames() const { return q_; }

  void rotate_frames(const std::vector<Quaterniond>& from, const Eigen::Matrix3Xd& spins) {
    for (std::size_t f = 0; f < q_.size(); ++f) {
      q_[f] =
          (from_rotation_vector(spins.col(static_cast<Eigen::Index>(f))) * from[f]).normalized();
    }
  }

  [[nodiscard]] RodModel model() const {
    const Eigen::Index frames = std::ssize(q_);
    RodModel model{std::vector<SpinBasis>(q_.size()),
                   Eigen::MatrixXd::Zero(std::min(2 * most_frame_unknowns_, unknowns_), unknowns_),
                   Eigen::MatrixXd::Zero(unknowns_, 3 * std::ssize(gaps)),
                   Eigen::VectorXd(unknowns_), Eigen::VectorXd(unknowns_)};
    for (Eigen::Index f = 0; f < frames; ++f) model.bases[static_cast<std::size_t>(f)] = basis(f);
    const auto basis_of = [&](Eigen::Index f) -> const SpinBasis& {
      return model.bases[static_cast<std::size_t>(f)];
    };
    const auto add = [&](Eigen::Index row, Eigen::Index column, const Eigen::Matrix3d& block) {
      const Eigen::Matrix3d own = basis_of(row).axes.transpose() * block * basis_of(column).axes;
      for (Eigen::Index i = 0; i < basis_of(row).size; ++i) {
        for (Eigen::Index j = 0; j < basis_of(column).size; ++j) {
          const Eigen::Index below = first_of(row) + i - first_of(column) - j;
          if (below >= 0) model.band(below, first_of(column) + j) += own(i, j);
        }
      }
    };
    const Eigen::Matrix3Xd n = force(true);
    const std::vector<JointDerivatives> joints = derivatives();
    const Eigen::Matrix3Xd g = gradient(joints, n);
    std::vector<Eigen::Matrix3d> diagonal(q_.size(), Eigen::Matrix3d::Zero());
    for (std::size_t k = 0; k < joints_.size(); ++k) {
      diagonal[static_cast<std::size_t>(joints_[k].left)] += joints[k].second;
      diagonal[static_cast<std::size_t>(joints_[k].right)] += joints[k].second;
      add(joints_[k].right, joints_[k].left,
          -joints[k].second - cross_matrix(joints[k].couple) / 2);
    }
    for (Eigen::Index f = 0; f < frames; ++f) {
      const double h = mesh_.width(std::min(f, mesh_.intervals() - 1));
      Eigen::Matrix3d& own = diagonal[static_cast<std::size_t>(f)];
      if (f < mesh_.intervals()) own -= h * spin_hessian(tangent(f), n.col(f));
      add(f, f, own);
      const Eigen::Vector3d descent = -basis_of(f).axes.transpose() * g.col(f);
      model.descent.segment(first_of(f), basis_of(f).size) = descent.head(basis_of(f).size);
      model.lengths.segment(first_of(f), basis_of(f).size).setConstant(h);
    }
    for (std::size_t k = 0; k < gaps.size(); ++k) {
      for (Eigen::Index i = gaps[k].first; i < gaps[k].end; ++i) {
        const Eigen::Matrix3d own =
            basis_of(i).axes.transpose() * cross_matrix(mesh_.width(i) * tangent(i));
        model.columns.block(first_of(i), 3 * static_cast<Eigen::Index>(k), basis_of(i).size, 3) =
            std::sqrt(gaps[k].penalty) * own.topRows(basis_of(i).size);
      }
    }
    return model;
  }

  /// Returns the Newton step of a model with `shift` times the length of each interval added to the
  /// Hessian; std::nullopt unless the Hessian is then positive definite.
  [[nodiscard]] std::optional<RodStep> newton_step(const RodModel& model, double shift) const {
    Eigen::MatrixXd shifted = model.band;
    shifted.row(0) += shift * model.lengths.transpose();
    PolygonFactor factor;
    if (!factor.compute(shifted, model.columns, 0)) return std::nullopt;
    const Eigen::VectorXd x = factor.solve(model.descent);
    RodStep step{Eigen::Matrix3Xd::Zero(3, std::ssize(q_)), 0, -model.descent.dot(x)};
    for (Eigen::Index f = 0; f < std::ssize(q_); ++f) {
      const SpinBasis& own = model.bases[static_cast<std::size_t>(f)];
      step.spins.col(f) = own.axes.leftCols(own.size) * x.segment(first_of(f), own.size);
    }
    step.largest = step.spins.leftCols(mesh_.intervals()).colwise().norm().maxCoeff();
    return step.slope <= 0 ? std::optional(step) : std::nullopt;
  }

  [[nodiscard]] RelaxedPolygon result(Motion motion) const {
    RelaxedPolygon polygon{
        {q_.begin(), q_.begin() + mesh_.intervals()}, {}, force(false), energy(), motion};
    if (span_.round()) {
      polygon.frames = frames_along(polygon.tangents(), polygon.frames.front());
      polygon.turns = adjacent_interval_turns(span_, mesh_, polygon.frames);
      return polygon;
    }
    for (std::size_t k = 0; k < span_.clamps.size(); ++k) {
      const Quaterniond turn = clamp_frame(span_, k, 0).conjugate() * q_[polygon.frames.size() + k];
      polygon.turns.push_back(2 * std::atan2(turn.z(), turn.w()));
    }
    return polygon;
  }

  std::vector<ChordConstraint> gaps;

 private:
  [[nodiscard]] const Quaterniond& frame(Eigen::Index f) const {
    return q_[static_cast<std::size_t>(f)];
  }
  [[nodiscard]] Eigen::Vector3d tangent(Eigen::Index f) const {
    return frame(f) * Eigen::Vector3d::UnitZ();
  }
  [[nodiscard]] Eigen::Index first_of(Eigen::Index f) const {
    return first_[static_cast<std::size_t>(f)];
  }
  /// A clamp after the first one releases the rotation about its direction; the energy of a round
  /// rod does not depend on the roll.
  [[nodiscard]] SpinBasis basis(Eigen::Index f) const {
    const bool is_clamp = f >= mesh_.intervals();
    SpinBasis basis;
    if (is_clamp && (f == mesh_.intervals() || normal_ || span_.round())) return basis;
    basis.size = normal_ || is_clamp ? 1 : span_.round() ? 2 : 3;
    if (basis.size == 3) {
      basis.axes.setIdentity();
    } else if (basis.size == 2) {
      basis.axes.col(0) = tangent(f).unitOrthogonal();
      basis.axes.col(1) = tangent(f).cross(basis.axes.col(0));
    } else {
      basis.axes.col(0) = normal_ ? *normal_ : tangent(f);
    }
    return basis;
  }

  /// Numbers the unknowns along the rod, so that joints couple neighbours.
  void number_unknowns() {
    first_.resize(q_.size());
    const auto number = [&](Eigen::Index f) {
      first_[static_cast<std::size_t>(f)] = unknowns_;
      most_frame_unknowns_ = std::max(most_frame_unknowns_, basis(f).size);
      unknowns_ += basis(f).size;
    };
    for (Eigen::Index i = 0; i <= mesh_.intervals(); ++i) {
      const RodSpan::Clamp* clamp = span_.clamp_at(mesh_.s[i]);
      if (clamp != nullptr) number(mesh_.intervals() + (clamp - span_.clamps.data()));
      if (i < mesh_.intervals()) number(i);
    }
  }

  /// Rotates the frames a little, so that no symmetry keeps the rod at a saddle.
  void perturb_frames() {
    Eigen::Matrix3Xd spins = Eigen::Matrix3Xd::Zero(3, std::ssize(q_));
    for (Eigen::Index i = 0; i < mesh_.intervals(); ++i) {
      const double x = static_cast<double>(i) / static_cast<double>(mesh_.intervals());
      const Eigen::Vector3d turn(std::sin(3 * x + 1), std::cos(2 * x), std::sin(2 * x + 1));
      spins.col(i) = 1e-3 * basis(i).axes * turn;
    }
    rotate_frames(std::vector<Quaterniond>(q_), spins);
  }

  /// Returns the carried force including the contribution of the grips.
  /// @param with_penalties  whether gaps contribute in proportion to their penalties too
  [[nodiscard]] Eigen::Matrix3Xd force(bool with_penalties) const {
    Eigen::Matrix3Xd force = carried_force_;
    for (const ChordConstraint& of : gaps) {
      Eigen::Vector3d multiplier = of.multiplier;
      if (with_penalties) multiplier += of.penalty * gap(of);
      force.middleCols(of.first, of.end - of.first).colwise() -= multiplier;
    }
    return force;
  }

  [[nodiscard]] std::vector<JointDerivatives> derivatives() const {
    std::vector<JointDerivatives> joints;
    joints.reserve(joints_.size());
    for (const FrameJoint& joint : joints_) {
      joints.emplace_back(joint, frame(joint.left), frame(joint.right));
    }
    return joints;
  }

  /// Returns the derivative of the energy by the spins of the frames under a carried force.
  [[nodiscard]] Eigen::Matrix3Xd gradient(const std::vector<JointDerivatives>& joints,
                                          const Eigen::Matrix3Xd& force) const {
    Eigen::Matrix3Xd gradient = Eigen::Matrix3Xd::Zero(3, std::ssize(q_));
    for (std::size_t k = 0; k < joints.size(); ++k) {
      gradient.col(joints_[k].right) += joints[k].couple;
      gradient.col(joints_[k].left) -= joints[k].couple;
    }
    for (Eigen::Index i = 0; i < mesh_.intervals(); ++i) {
      gradient.col(i) -= mesh_.width(i) * tangent(i).cross(Eigen::Vector3d(force.col(i)));
    }
    return gradient;
  }

  /// Sets the multiplier that balances the intervals between two grips best.
  void fit_multiplier(ChordConstraint& of) const {
    const Eigen::Matrix3Xd without = gradient(derivatives(), carried_force_);
    Eigen::Matrix3d matrix = Eigen::Matrix3d::Zero();
    Eigen::Vector3d right = Eigen::Vector3d::Zero();
    for (Eigen::Index i = of.first; i < of.end; ++i) {
      const Eigen::Vector3d arm = mesh_.width(i) * tangent(i);
      matrix -= cross_matrix(arm) * cross_matrix(arm);
      right += arm.cross(Eigen::Vector3d(without.col(i)));
    }
    of.multiplier = matrix.completeOrthogonalDecomposition().solve(right);
  }

  const RodSpan& span_;
  const RodMesh& mesh_;
  std::vector<FrameJoint> joints_;
  Eigen::Matrix3Xd carried_force_;
  std::vector<Quaterniond> q_;             // frames of the intervals, then of the clamps
  std::optional<Eigen::Vector3d> normal_;  // normal of the plane to which the motion is restricted
  std::vector<Eigen::Index> first_;        // first unknown of each frame
  Eigen::Index unknowns_ = 0;
  Eigen::Index most_frame_unknowns_ = 0;  // largest number of unknowns of a frame
};

/// Takes a Newton step with a shift for which the Hessian is positive definite, halved until the
/// augmented energy decreases, and adapts the shift. Returns std::nullopt if no shift suffices.
std::optional<RodStep> damped_newton_step(DiscreteRod& rod, double unit, double& shift) {
  const RodModel model = rod.model();
  std::optional<RodStep> step = rod.newton_step(model, shift);
  for (int k = 0; k < most_shifts && !step; ++k) {
    shift = std::max(4 * shift, unit);
    step = rod.newton_step(model, shift);
  }
  if (!step) return step;
  const double before = rod.augmented_energy();
  const std::vector<Quaterniond> from = rod.frames();
  double share = std::min(1.0, longest_spin_step / std::max(step->largest, converged_spin));
  int halvings = 0;
  for (; halvings < most_halvings; ++halvings, share /= 2) {
    rod.rotate_frames(from, share * step->spins);
    const double allowed_energy = before + armijo_share * share * step->slope;
    if (rod.augmented_energy() <= allowed_energy + energy_rounding * (1 + std::abs(before))) break;
  }
  shift = halvings > 2 ? std::max(4 * shift, unit) : std::max(shift / 4, least_shift * unit);
  return step;
}

}  // namespace

RelaxedPolygon relax_polygon(const RodSpan& span, const RodMesh& mesh,
                             const std::vector<Quaterniond>& start, Motion motion,
                             const Deadline& deadline) {
  DiscreteRod rod(span, mesh, start, motion);
  const double unit = least_bending_stiffness(span) / (span.length * span.length);
  std::vector<double> last_open(rod.gaps.size(), std::numeric_limits<double>::infinity());
  std::vector<double> largest;
  for (const ChordConstraint& of : rod.gaps) largest.push_back(largest_penalty * of.penalty);
  double shift = least_shift * unit;
  for (int k = 0; k < most_steps && !deadline.passed(); ++k) {
    const std::optional<RodStep> step = damped_newton_step(rod, unit, shift);
    if (!step) break;
    // Steps with a shift are short, even far from the minimum.
    if (step->largest > multiplier_update_spin || shift > unit) continue;
    bool closed = true;
    for (std::size_t i = 0; i < rod.gaps.size(); ++i) {
      ChordConstraint& of = rod.gaps[i];
      const Eigen::Vector3d open = rod.gap(of);
      closed = closed && of.closed(open);
      // The gap also contains the second-order error of the step, which is no reason to change the
      // multiplier.
      const double bent = step->largest * step->largest * span.length;
      if (step->largest > converged_spin && open.norm() < bent) continue;
      of.multiplier += of.penalty * open;
      if (open.norm() > required_gap_reduction * last_open[i]) {
        of.penalty = std::min(penalty_growth * of.penalty, largest[i]);
      }
      last_open[i] = open.norm();
    }
    if (closed && step->largest < converged_spin) break;
  }
  return rod.result(motion);
}

}  // namespace dlo::energy_model
