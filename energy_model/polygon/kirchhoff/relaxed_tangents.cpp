#include "kirchhoff/relaxed_tangents.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <Eigen/LU>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

#include "kirchhoff/grip_gaps.hpp"

namespace dlo::energy_model {
namespace {

/// Two orthogonal directions across a tangent in which it may move; in the plane the second one is
/// zero.
using Across = Eigen::Matrix<double, 3, 2>;

constexpr int most_steps = 200;  // maximum number of Newton steps; about 30 are usual
constexpr int most_shifts = 60;  // maximum number of increases of the shift, by a factor of 4 each
constexpr int most_halvings = 30;        // maximum number of halvings of a step
constexpr double at_rest = 1e-4;         // step of a tangent at which the iteration ends [rad]
constexpr double nearly_at_rest = 0.05;  // step below which multipliers are updated [rad]
// Smallest shift, in units of b / l^2; keeps steps along zero modes small.
constexpr double least_shift = 1e-4;
constexpr double longest_turn = 0.5;  // largest rotation of a tangent in a step [rad]
// Share of the predicted decrease that a step has to reach (Armijo).
constexpr double sufficient = 1e-4;
constexpr double energy_rounding = 1e-13;  // relative rounding error of an energy
// The penalty of a gap grows unless a round reduces the gap to this share.
constexpr double closing = 0.25;
constexpr double penalty_growth = 4;      // increase of a penalty in a round, as a factor
constexpr double largest_penalty = 1e12;  // largest penalty divided by the initial one

/// Chain of the intervals' tangents between those of clamps at the ends, with its joints.
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
    disturb();
    for (GripGap& of : gaps) fit_multiplier(of);
  }

  [[nodiscard]] Eigen::Index size() const { return h_.size(); }
  [[nodiscard]] double width(Eigen::Index i) const { return h_[i]; }
  [[nodiscard]] Eigen::Vector3d tangent(Eigen::Index i) const { return t_.col(i + 1); }
  [[nodiscard]] Eigen::Matrix3Xd tangents() const { return t_.middleCols(1, size()); }
  /// Returns the stiffness of the joint between interval i, or the end, and the interval before it.
  [[nodiscard]] double stiffness(Eigen::Index i) const { return stiffness_[i]; }

  [[nodiscard]] Eigen::Vector3d gap(const GripGap& of) const {
    const Eigen::Index count = of.end - of.first;
    return t_.middleCols(1 + of.first, count) * h_.segment(of.first, count) - of.chord;
  }

  [[nodiscard]] double energy() const {
    double energy = 0;
    for (Eigen::Index i = 0; i <= size(); ++i) {
      energy += stiffness_[i] / 2 * (t_.col(i) - t_.col(i + 1)).squaredNorm();
      if (i < size()) energy -= h_[i] * carried_.col(i).dot(t_.col(i + 1));
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

  /// Returns minus the derivatives of the augmented energy by the tangents t_i.
  [[nodiscard]] Eigen::Matrix3Xd pulls() const {
    Eigen::Matrix3Xd pulls(3, size());
    for (Eigen::Index i = 0; i < size(); ++i) pulls.col(i) = pull_without_grips(i);
    for (const GripGap& of : gaps) {
      const Eigen::Vector3d force = of.multiplier + of.penalty * gap(of);
      for (Eigen::Index i = of.first; i < of.end; ++i) pulls.col(i) -= h_[i] * force;
    }
    return pulls;
  }

  [[nodiscard]] Across across(Eigen::Index i) const {
    const Eigen::Vector3d t = tangent(i);
    Across across = Across::Zero();
    across.col(0) = normal_.isZero() ? t.unitOrthogonal().eval() : normal_.cross(t).eval();
    if (normal_.isZero()) across.col(1) = t.cross(across.col(0));
    return across;
  }

  void turn(const Eigen::Matrix3Xd& from, const Eigen::Matrix3Xd& step) {
    t_.middleCols(1, size()) = (from + step).colwise().normalized();
  }

  [[nodiscard]] RelaxedTangents result() const {
    RelaxedTangents result{tangents(), carried_, energy()};
    for (const GripGap& of : gaps) {
      result.force.middleCols(of.first, of.end - of.first).colwise() -= of.multiplier;
    }
    return result;
  }

  std::vector<GripGap> gaps;

 private:
  /// Disturbs the tangents. A symmetric shape would converge to a saddle by symmetric steps.
  void disturb() {
    constexpr double amplitude = 1e-3;  // [rad]
    for (Eigen::Index i = 0; i < size(); ++i) {
      const double x = static_cast<double>(i) / static_cast<double>(size());
      const Eigen::Vector2d turn(std::sin(3 * x + 1), std::cos(2 * x));
      t_.col(i + 1) = (tangent(i) + amplitude * across(i) * turn).normalized();
    }
  }

  /// Returns minus the derivative of the energy by t_i without the augmented Lagrangian.
  [[nodiscard]] Eigen::Vector3d pull_without_grips(Eigen::Index i) const {
    return stiffness_[i] * t_.col(i) + stiffness_[i + 1] * t_.col(i + 2) + h_[i] * carried_.col(i);
  }

  /// Sets the multiplier with which the shape is nearest to equilibrium, by least squares.
  /// Otherwise a flat arch would become straight before its thrust has grown.
  void fit_multiplier(GripGap& of) const {
    Eigen::Matrix3d matrix = Eigen::Matrix3d::Zero();
    Eigen::Vector3d right = Eigen::Vector3d::Zero();
    for (Eigen::Index i = of.first; i < of.end; ++i) {
      const Eigen::Vector3d t = tangent(i);
      const Eigen::Matrix3d projection = Eigen::Matrix3d::Identity() - t * t.transpose();
      matrix += h_[i] * h_[i] * projection;
      right += h_[i] * projection * pull_without_grips(i);
    }
    of.multiplier = matrix.completeOrthogonalDecomposition().solve(right);
  }

  Eigen::VectorXd h_;
  Eigen::Matrix3Xd t_;  // tangents of the intervals, between those of the clamps
  // Stiffness of joints between neighbours; zero at an end without a clamp.
  Eigen::VectorXd stiffness_;
  Eigen::Matrix3Xd carried_;
  Eigen::Vector3d normal_ = Eigen::Vector3d::Zero();  // normal of the plane; zero: motion in space
};

/// Hessian of the energy in directions across the tangents, with the forces of the gaps held
/// constant. Its diagonal blocks are p_i.t_i + shift h_i, those beside them minus the stiffness of
/// the joints. It is factorised as L D L^T with blocks of two.
class ChainFactor {
 public:
  ChainFactor(const TangentChain& chain, const std::vector<Across>& across,
              const Eigen::Matrix3Xd& pulls, double shift) {
    const Eigen::Index count = chain.size();
    below_.resize(static_cast<std::size_t>(count), Eigen::Matrix2d::Zero());
    for (Eigen::Index i = 0; i < count; ++i) {
      const auto at = static_cast<std::size_t>(i);
      Eigen::Matrix2d block = Eigen::Matrix2d::Identity();
      const double own = pulls.col(i).dot(chain.tangent(i)) + shift * chain.width(i);
      block(0, 0) = own;
      if (!across[at].col(1).isZero()) block(1, 1) = own;
      if (i > 0) {
        below_[at] = -chain.stiffness(i) * across[at].transpose() * across[at - 1];
        block -= below_[at] * inverse_[at - 1] * below_[at].transpose();
      }
      const double determinant = block.determinant();
      negative_ += determinant < 0 ? 1 : block.trace() < 0 ? 2 : 0;
      inverse_.emplace_back(block.inverse());
    }
  }

  /// Returns the number of negative eigenvalues.
  [[nodiscard]] int negative() const { return negative_; }

  [[nodiscard]] Eigen::MatrixXd solve(Eigen::MatrixXd x) const {
    const auto count = static_cast<Eigen::Index>(inverse_.size());
    for (Eigen::Index i = 1; i < count; ++i) {
      const auto at = static_cast<std::size_t>(i);
      x.middleRows<2>(2 * i) -= below_[at] * inverse_[at - 1] * x.middleRows<2>(2 * i - 2);
    }
    Eigen::MatrixXd rows;
    for (Eigen::Index i = count; i-- > 0;) {
      const auto at = static_cast<std::size_t>(i);
      rows = x.middleRows<2>(2 * i);
      if (i + 1 < count) rows -= below_[at + 1].transpose() * x.middleRows<2>(2 * i + 2);
      x.middleRows<2>(2 * i).noalias() = inverse_[at] * rows;
    }
    return x;
  }

 private:
  std::vector<Eigen::Matrix2d> inverse_;  // inverses of the blocks of D
  std::vector<Eigen::Matrix2d> below_;    // blocks below the diagonal
  int negative_ = 0;
};

struct ChainStep {
  Eigen::Matrix3Xd turn;  ///< displacement of each tangent
  double largest = 0;     ///< largest displacement of a tangent [rad]
  double slope = 0;       ///< derivative of the augmented energy along the step, <= 0
};

/// Computes Newton's step H x = -g of the augmented energy, H = T + J^T P J + shift, with T of
/// ChainFactor, the derivatives J of the gaps and their penalties P. It uses Woodbury's formula
/// with S = P^-1 + J T^-1 J^T. H is positive definite if T has as many negative eigenvalues as S
/// (Haynsworth 1968).
/// @return std::nullopt if H is not positive definite because the shift is too small
std::optional<ChainStep> newton_step(const TangentChain& chain, double shift) {
  const Eigen::Index count = chain.size();
  const auto gaps = static_cast<Eigen::Index>(chain.gaps.size());
  const Eigen::Matrix3Xd pulls = chain.pulls();
  std::vector<Across> across;
  Eigen::MatrixXd right = Eigen::MatrixXd::Zero(2 * count, 1 + 3 * gaps);  // columns: -g, then J^T
  for (Eigen::Index i = 0; i < count; ++i) {
    across.push_back(chain.across(i));
    right.col(0).segment<2>(2 * i) = across.back().transpose() * pulls.col(i);
  }
  Eigen::VectorXd inverse_penalties(3 * gaps);
  for (Eigen::Index k = 0; k < gaps; ++k) {
    const GripGap& of = chain.gaps[static_cast<std::size_t>(k)];
    inverse_penalties.segment<3>(3 * k).setConstant(1 / of.penalty);
    for (Eigen::Index i = of.first; i < of.end; ++i) {
      right.block<2, 3>(2 * i, 1 + 3 * k) =
          chain.width(i) * across[static_cast<std::size_t>(i)].transpose();
    }
  }
  const ChainFactor factor(chain, across, pulls, shift);
  const Eigen::MatrixXd solved = factor.solve(right);
  Eigen::VectorXd x = solved.col(0);
  Eigen::Index negative = 0;
  if (gaps > 0) {
    Eigen::MatrixXd S = right.rightCols(3 * gaps).transpose() * solved.rightCols(3 * gaps);
    S.diagonal() += inverse_penalties;
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> of_S(S);
    negative = (of_S.eigenvalues().array() < 0).count();
    const Eigen::VectorXd open =
        of_S.eigenvectors().transpose() * (right.rightCols(3 * gaps).transpose() * x);
    x -=
        solved.rightCols(3 * gaps) * (of_S.eigenvectors() * open.cwiseQuotient(of_S.eigenvalues()));
  }
  ChainStep step;
  step.slope = -right.col(0).dot(x);
  if (negative != factor.negative() || !(step.slope <= 0)) return std::nullopt;
  step.turn.resize(3, count);
  for (Eigen::Index i = 0; i < count; ++i) {
    step.turn.col(i) = across[static_cast<std::size_t>(i)] * x.segment<2>(2 * i);
  }
  step.largest = step.turn.colwise().norm().maxCoeff();
  return step;
}

/// Takes one damped step of Newton's method that decreases the energy.
/// @param shift  in: shift of the previous step; out: shift with which the next step begins
std::optional<ChainStep> descend_once(TangentChain& chain, double unit, double& shift) {
  std::optional<ChainStep> step = newton_step(chain, shift);
  for (int k = 0; k < most_shifts && !step; ++k) {
    shift = std::max(4 * shift, unit);
    step = newton_step(chain, shift);
  }
  if (!step) return step;
  const double before = chain.augmented_energy();
  const Eigen::Matrix3Xd from = chain.tangents();
  double share = std::min(1.0, longest_turn / std::max(step->largest, at_rest));
  int halvings = 0;
  for (; halvings < most_halvings; ++halvings, share /= 2) {
    chain.turn(from, share * step->turn);
    const double promised = before + sufficient * share * step->slope;
    if (chain.augmented_energy() <= promised + energy_rounding * (1 + std::abs(before))) break;
  }
  constexpr int usual_halvings = 2;
  if (halvings > usual_halvings) {
    shift = std::max(4 * shift, unit);
  } else {
    shift = std::max(shift / 4, least_shift * unit);
  }
  return step;
}

}  // namespace

RelaxedTangents relax_tangents(const RodSpan& span, const RodMesh& mesh,
                               const Eigen::Matrix3Xd& tangents, Motion motion,
                               const Deadline& deadline) {
  TangentChain chain(span, mesh, tangents, motion);
  const double unit = least_bending_stiffness(span) / (span.length * span.length);
  std::vector<double> last_open(chain.gaps.size(), std::numeric_limits<double>::infinity());
  std::vector<double> largest;
  for (const GripGap& of : chain.gaps) largest.push_back(largest_penalty * of.penalty);
  double shift = least_shift * unit;
  for (int k = 0; k < most_steps && !deadline.passed(); ++k) {
    const std::optional<ChainStep> step = descend_once(chain, unit, shift);
    if (!step) break;
    // Steps with a shift are short, even far from the minimum.
    if (step->largest > nearly_at_rest || shift > unit) continue;
    bool closed = true;
    for (std::size_t i = 0; i < chain.gaps.size(); ++i) {
      GripGap& of = chain.gaps[i];
      const Eigen::Vector3d open = chain.gap(of);
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
  return chain.result();
}

}  // namespace dlo::energy_model
