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
/// Free spins of a frame, one per column.
using SpinBasis = Eigen::Matrix<double, 3, Eigen::Dynamic, Eigen::ColMajor, 3, 3>;
using SpinBlock = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, 3, 3>;

constexpr int most_steps = 200;  // maximum number of Newton steps; about 30 are usual
constexpr int most_shifts = 60;  // maximum number of increases of the shift, by a factor of 4 each
constexpr int most_halvings = 30;        // maximum number of halvings of a step
constexpr double at_rest = 1e-4;         // spin of a frame at which the iteration ends [rad]
constexpr double nearly_at_rest = 0.05;  // spin below which multipliers are updated [rad]
// Smallest shift, in units of b / l^2; keeps steps along zero modes small.
constexpr double least_shift = 1e-4;
constexpr double longest_turn = 0.5;  // largest spin of a frame in a step [rad]
// Share of the predicted decrease that a step has to reach (Armijo).
constexpr double sufficient = 1e-4;
constexpr double energy_rounding = 1e-13;  // relative rounding error of an energy
// The penalty of a gap grows unless a round reduces the gap to this share.
constexpr double closing = 0.25;
constexpr double penalty_growth = 4;      // increase of a penalty in a round, as a factor
constexpr double largest_penalty = 1e12;  // largest penalty divided by the initial one

/// Energy of a joint, and its derivatives by the spin w of its right frame minus that of its left
/// one. With turn = (c, v) in quaternions, the first and second derivatives of v along constant
/// spins w_l and w_r are
///     (c w + w x v) / 2,   -|w|^2 / 4 v - (c I - hat(v)) (w_l x w_r) / 2.
struct JointEnergy {
  double value;
  Eigen::Vector3d couple;  // derivative by w
  Eigen::Matrix3d second;  // second derivative by w, without the term of w_l x w_r

  JointEnergy(const FrameJoint& joint, const Quaterniond& left, const Quaterniond& right) {
    const Quaterniond turn = left.conjugate() * right;
    const Eigen::Vector3d excess = joint.excess(turn);
    const Eigen::Vector3d moment = joint.stiffness.cwiseProduct(excess);
    value = joint.h / 2 * excess.dot(moment);
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

/// A Newton step.
struct RodStep {
  Eigen::Matrix3Xd spins;  ///< by frame
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
        carried_(carried_force(span, mesh).on_interval),
        q_(start) {
    if (motion == Motion::in_plane) normal_ = span.plane->x.cross(span.plane->y);
    const std::vector<double> turns = adjacent_interval_turns(span, mesh, start);
    for (std::size_t k = 0; k < turns.size(); ++k) q_.push_back(clamp_frame(span, k, turns[k]));
    number_unknowns();
    disturb();
    for (GripGap& of : gaps) fit_multiplier(of);
  }

  [[nodiscard]] Eigen::Vector3d gap(const GripGap& of) const {
    Eigen::Vector3d gap = -of.chord;
    for (Eigen::Index i = of.first; i < of.end; ++i) gap += mesh_.width(i) * tangent(i);
    return gap;
  }

  [[nodiscard]] double energy() const {
    double energy = 0;
    for (const FrameJoint& joint : joints_) energy += energy_of(joint).value;
    for (Eigen::Index i = 0; i < mesh_.intervals(); ++i) {
      energy -= mesh_.width(i) * carried_.col(i).dot(tangent(i));
    }
    return energy;
  }

  [[nodiscard]] double augmented_energy() const {
    double energy = this->energy();
    for (const GripGap& of : gaps) {
      const Eigen::Vector3d open = gap(of);
      energy += of.multiplier.dot(open) + of.penalty / 2 * open.squaredNorm();
    }
    return energy;
  }

  [[nodiscard]] const std::vector<Quaterniond>& frames() const { return q_; }

  void turn(const std::vector<Quaterniond>& from, const Eigen::Matrix3Xd& spins) {
    for (std::size_t f = 0; f < q_.size(); ++f) {
      q_[f] =
          (from_rotation_vector(spins.col(static_cast<Eigen::Index>(f))) * from[f]).normalized();
    }
  }

  /// Returns the Newton step of the augmented energy with `shift` times the length of each interval
  /// added to the Hessian; std::nullopt unless the Hessian is then positive definite.
  [[nodiscard]] std::optional<RodStep> newton_step(double shift) const {
    const Eigen::Matrix3Xd n = force(true);
    const Eigen::Matrix3Xd g = gradient(n);
    Eigen::MatrixXd band = Eigen::MatrixXd::Zero(std::min(2 * widest_, unknowns_), unknowns_);
    Eigen::MatrixXd columns =
        Eigen::MatrixXd::Zero(unknowns_, 3 * static_cast<Eigen::Index>(gaps.size()));
    std::vector<SpinBasis> bases;
    for (Eigen::Index k = 0; k < std::ssize(q_); ++k) bases.push_back(basis(k));
    const auto basis_of = [&](Eigen::Index k) -> const SpinBasis& {
      return bases[static_cast<std::size_t>(k)];
    };
    const auto add = [&](Eigen::Index row, Eigen::Index column, const Eigen::Matrix3d& block) {
      const SpinBlock own = basis_of(row).transpose() * block * basis_of(column);
      for (Eigen::Index i = 0; i < own.rows(); ++i) {
        for (Eigen::Index j = 0; j < own.cols(); ++j) {
          const Eigen::Index below = first_of(row) + i - first_of(column) - j;
          if (below >= 0) band(below, first_of(column) + j) += own(i, j);
        }
      }
    };
    for (const FrameJoint& joint : joints_) {
      const JointEnergy of = energy_of(joint);
      add(joint.left, joint.left, of.second);
      add(joint.right, joint.right, of.second);
      add(joint.right, joint.left, -of.second - cross_matrix(of.couple) / 2);
    }
    for (Eigen::Index f = 0; f < std::ssize(q_); ++f) {
      const double h = mesh_.width(std::min(f, mesh_.intervals() - 1));
      Eigen::Matrix3d own = shift * h * Eigen::Matrix3d::Identity();
      if (f < mesh_.intervals()) own -= h * spin_curvature(tangent(f), n.col(f));
      add(f, f, own);
    }
    for (std::size_t k = 0; k < gaps.size(); ++k) {
      for (Eigen::Index i = gaps[k].first; i < gaps[k].end; ++i) {
        const SpinBasis& own = basis_of(i);
        columns.block(first_of(i), 3 * static_cast<Eigen::Index>(k), own.cols(), 3) =
            std::sqrt(gaps[k].penalty) * mesh_.width(i) * own.transpose() *
            cross_matrix(tangent(i));
      }
    }
    PolygonFactor factor;
    if (!factor.compute(band, columns, 0)) return std::nullopt;
    Eigen::VectorXd right(unknowns_);
    for (Eigen::Index f = 0; f < std::ssize(q_); ++f) {
      const SpinBasis& own = basis_of(f);
      right.segment(first_of(f), own.cols()) = -own.transpose() * g.col(f);
    }
    const Eigen::VectorXd x = factor.solve(right);
    RodStep step{Eigen::Matrix3Xd::Zero(3, std::ssize(q_)), 0, -right.dot(x)};
    for (Eigen::Index f = 0; f < std::ssize(q_); ++f) {
      const SpinBasis& own = basis_of(f);
      step.spins.col(f) = own * x.segment(first_of(f), own.cols());
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

  std::vector<GripGap> gaps;

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
  [[nodiscard]] JointEnergy energy_of(const FrameJoint& joint) const {
    return {joint, frame(joint.left), frame(joint.right)};
  }

  /// A clamp after the first one releases the rotation about its direction; the energy of a round
  /// rod does not depend on the roll.
  [[nodiscard]] SpinBasis basis(Eigen::Index f) const {
    const bool is_clamp = f >= mesh_.intervals();
    if (is_clamp && (f == mesh_.intervals() || normal_ || span_.round())) return SpinBasis(3, 0);
    if (normal_) return *normal_;
    const Eigen::Vector3d t = tangent(f);
    if (is_clamp) return t;
    if (!span_.round()) return Eigen::Matrix3d::Identity();
    SpinBasis across(3, 2);
    const Eigen::Vector3d first = t.unitOrthogonal();
    across << first, t.cross(first);
    return across;
  }

  /// Numbers the unknowns along the rod, so that joints couple neighbours.
  void number_unknowns() {
    first_.resize(q_.size());
    const auto number = [&](Eigen::Index f) {
      first_[static_cast<std::size_t>(f)] = unknowns_;
      widest_ = std::max(widest_, basis(f).cols());
      unknowns_ += basis(f).cols();
    };
    for (Eigen::Index i = 0; i <= mesh_.intervals(); ++i) {
      const RodSpan::Clamp* clamp = span_.clamp_at(mesh_.s[i]);
      if (clamp != nullptr) number(mesh_.intervals() + (clamp - span_.clamps.data()));
      if (i < mesh_.intervals()) number(i);
    }
  }

  /// Rotates the frames a little, so that no symmetry keeps the rod at a saddle.
  void disturb() {
    constexpr double amplitude = 1e-3;  // [rad]
    Eigen::Matrix3Xd spins = Eigen::Matrix3Xd::Zero(3, std::ssize(q_));
    for (Eigen::Index i = 0; i < mesh_.intervals(); ++i) {
      const double x = static_cast<double>(i) / static_cast<double>(mesh_.intervals());
      const Eigen::Vector3d turn(std::sin(3 * x + 1), std::cos(2 * x), std::sin(2 * x + 1));
      const SpinBasis own = basis(i);
      spins.col(i) = amplitude * own * turn.head(own.cols());
    }
    turn(std::vector<Quaterniond>(q_), spins);
  }

  /// Returns the carried force including the contribution of the grips.
  /// @param with_penalties  whether gaps contribute in proportion to their penalties too
  [[nodiscard]] Eigen::Matrix3Xd force(bool with_penalties) const {
    Eigen::Matrix3Xd force = carried_;
    for (const GripGap& of : gaps) {
      Eigen::Vector3d held = of.multiplier;
      if (with_penalties) held += of.penalty * gap(of);
      force.middleCols(of.first, of.end - of.first).colwise() -= held;
    }
    return force;
  }

  /// Returns the derivative of the energy by the spins of the frames under a carried force.
  [[nodiscard]] Eigen::Matrix3Xd gradient(const Eigen::Matrix3Xd& force) const {
    Eigen::Matrix3Xd gradient = Eigen::Matrix3Xd::Zero(3, std::ssize(q_));
    for (const FrameJoint& joint : joints_) {
      const Eigen::Vector3d couple = energy_of(joint).couple;
      gradient.col(joint.right) += couple;
      gradient.col(joint.left) -= couple;
    }
    for (Eigen::Index i = 0; i < mesh_.intervals(); ++i) {
      gradient.col(i) -= mesh_.width(i) * tangent(i).cross(Eigen::Vector3d(force.col(i)));
    }
    return gradient;
  }

  /// Sets the multiplier that balances the intervals between two grips best.
  void fit_multiplier(GripGap& of) const {
    const Eigen::Matrix3Xd without = gradient(carried_);
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
  Eigen::Matrix3Xd carried_;
  std::vector<Quaterniond> q_;             // frames of the intervals, then of the clamps
  std::optional<Eigen::Vector3d> normal_;  // normal of the plane to which the motion is restricted
  std::vector<Eigen::Index> first_;        // first unknown of each frame
  Eigen::Index unknowns_ = 0;
  Eigen::Index widest_ = 0;  // largest number of unknowns of a frame
};

/// Takes a Newton step with a shift for which the Hessian is positive definite, halved until the
/// augmented energy decreases, and adapts the shift.
std::optional<RodStep> descend_once(DiscreteRod& rod, double unit, double& shift) {
  std::optional<RodStep> step = rod.newton_step(shift);
  for (int k = 0; k < most_shifts && !step; ++k) {
    shift = std::max(4 * shift, unit);
    step = rod.newton_step(shift);
  }
  if (!step) return step;
  const double before = rod.augmented_energy();
  const std::vector<Quaterniond> from = rod.frames();
  double share = std::min(1.0, longest_turn / std::max(step->largest, at_rest));
  int halvings = 0;
  for (; halvings < most_halvings; ++halvings, share /= 2) {
    rod.turn(from, share * step->spins);
    const double promised = before + sufficient * share * step->slope;
    if (rod.augmented_energy() <= promised + energy_rounding * (1 + std::abs(before))) break;
  }
  constexpr int usual_halvings = 2;
  shift = halvings > usual_halvings ? std::max(4 * shift, unit)
                                    : std::max(shift / 4, least_shift * unit);
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
  for (const GripGap& of : rod.gaps) largest.push_back(largest_penalty * of.penalty);
  double shift = least_shift * unit;
  for (int k = 0; k < most_steps && !deadline.passed(); ++k) {
    const std::optional<RodStep> step = descend_once(rod, unit, shift);
    if (!step) break;
    // Steps with a shift are short, even far from the minimum.
    if (step->largest > nearly_at_rest || shift > unit) continue;
    bool closed = true;
    for (std::size_t i = 0; i < rod.gaps.size(); ++i) {
      GripGap& of = rod.gaps[i];
      const Eigen::Vector3d open = rod.gap(of);
      closed = closed && of.closed(open);
      // The gap also contains the second-order error of the step, which is no reason to change the
      // multiplier.
      const double bent = step->largest * step->largest * span.length;
      if (step->largest > at_rest && open.norm() < bent) continue;
      of.multiplier += of.penalty * open;
      if (open.norm() > closing * last_open[i]) {
        of.penalty = std::min(penalty_growth * of.penalty, largest[i]);
      }
      last_open[i] = open.norm();
    }
    if (closed && step->largest < at_rest) break;
  }
  return rod.result(motion);
}

}  // namespace dlo::energy_model
