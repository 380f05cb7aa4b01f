#include "certify/certify.hpp"

#include <Eigen/QR>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <span>

#include "certify/contact_ends.hpp"
#include "certify/rigid_body_modes.hpp"
#include "frames/position_operator.hpp"
#include "linear/free_directions.hpp"
#include "linear/newton_system.hpp"
#include "newton/newton.hpp"
#include "strain/second_derivatives.hpp"

namespace dlo::energy_model {
namespace {

/// Newton's step that a returned shape may have left; its points are then right to about as much of
/// the rod's length.
constexpr double largest_next_step = 1e-8;

/// No point of a held rod can be off by more, in lengths.
constexpr double largest_error = 2;

/// h = |dlambda| / lambda along what the coefficients may be off by, up to which there is an
/// equilibrium there. Kantorovich: Newton's method from a point with the step eta, the inverse
/// 1/lambda and second derivatives below kappa has a solution if h = eta kappa / lambda <= 1/2,
/// not further than 2 / (1 + (1 - 2h)^(1/2)) eta; half of it is kept for what is estimated in h.
constexpr double largest_h = 0.25;

/// Third derivatives of E - mu . c along a unit direction of strains are forces times angles of 1
/// or less, those of positions three times counted, over the scale of forces.
constexpr double largest_third_derivative = 4;

/// Newton's step of the coefficients from here; it has no part along near-null modes.
/// @param gradient  of E - mu . c
Eigen::VectorXd newton_step(NewtonSystem& system, const SpanPoint& point,
                            const Eigen::VectorXd& gradient) {
  Eigen::VectorXd right(gradient.size() + point.residual.size());
  right << -gradient, -point.residual;
  Eigen::VectorXd step;
  system.solve(right, step);
  if (!system.is_met(right, step, largest_next_step)) step = system.minimum_norm_step(right);
  return step.head(gradient.size());
}

/// Rounding of forces, whose scale is this.
double rounding_of(double scale) { return 8 * std::numeric_limits<double>::epsilon() * scale; }

/// By which the coefficients may be off along the mode nearest zero if the second variation stays
/// what it is: what Newton's method would still move them by, and what rounding, the modes that are
/// left out and kinks within pieces push, divided by the eigenvalue nearest to zero.
double linear_error(const SpanSolution& solution, double load) {
  const double scale = scale_of_forces(solution, load);
  // The angle that the last coefficient adds is a_K / (2K); forces feel it as little again.
  const double K = solution.terms;
  const double angle = solution.model->truncation(solution.x) / (2 * K);
  const double smallest = std::min(solution.eigenvalue_nearest_zero, 1.0);
  const double truncated = scale * angle / (2 * K) + misplaced_contact(solution);
  return solution.next_step + (rounding_of(scale) + truncated) / smallest;
}

/// What the points of a shape may be away from those of an equilibrium, of the length. The
/// coefficients of strains bound what positions move by; no point of a held rod can be off by more
/// than twice its length.
/// @param moved  by which the coefficients may be off
double error_estimate(const SpanSolution& solution, double moved) {
  const SpanEnergy& model = *solution.model;
  // The unit is the rod's smaller bending stiffness.
  double least_stiffness = 1;
  for (const Span::Part& part : model.span().parts) {
    least_stiffness = std::min(least_stiffness, part.stiffness.head<2>().minCoeff());
  }
  const double angle = model.truncation(solution.x) / (2.0 * solution.terms);
  return std::min(moved / std::sqrt(least_stiffness) + angle, largest_error);
}

/// Returns the model's points at its nodes, of a rod of length 1.
Eigen::Matrix3Xd points_at(const SpanEnergy& model, const Eigen::VectorXd& x) {
  const std::span<const double> nodes(model.nodes().data(),
                                      static_cast<std::size_t>(model.nodes().size()));
  return model.shape(x).sample(nodes).points;
}

/// Change of the coefficients, to first order, to the equilibrium with two coefficients fewer in
/// every piece and field: these become zero, and the others follow so that their gradient and the
/// constraints stay zero.
Eigen::VectorXd change_with_fewer_terms(const SpanSolution& solution, const SpanPoint& point) {
  const SpanUnknowns& unknowns = solution.model->unknowns();
  const Eigen::Index dropped = std::min<Eigen::Index>(unknowns.terms, 2);
  Eigen::VectorXd last = Eigen::VectorXd::Zero(solution.x.size());
  const auto for_each = [&](const auto& visit) {
    for (Eigen::Index field = 0; field < unknowns.fields; ++field) {
      for (Eigen::Index e = 0; e < unknowns.pieces; ++e) {
        visit(unknowns.first(field, e) + unknowns.terms - dropped);
      }
    }
  };
  for_each([&](Eigen::Index at) { last.segment(at, dropped) = solution.x.segment(at, dropped); });
  NewtonSystem& system = solution.factor->system;
  Eigen::VectorXd right(last.size() + point.residual.size());
  right << system.hessian() * last, point.jacobian * last;
  for_each([&](Eigen::Index at) { right.segment(at, dropped).setZero(); });
  Eigen::VectorXd step;
  system.solve(right, step);
  return step.head(last.size()) - last;
}

/// Error of the points as it is measured by what Newton's method and two terms fewer would move
/// them by. error_estimate() bounds what forces could do along the direction of least resistance,
/// which is far more where the rod is pulled taut or hangs as a line: forces are large there, and
/// resist as much.
double measured_error(const SpanSolution& solution, const SpanPoint& point,
                      const Eigen::VectorXd& next_step, double load) {
  // Of rounding as another step has it, and of terms whose size falls by a tenth for two more.
  constexpr double safety = 10;
  const double scale = scale_of_forces(solution, load);
  const double smallest = std::min(solution.eigenvalue_nearest_zero, 1.0);
  const double soft =
      (rounding_of(scale) * (1 - smallest) + misplaced_contact(solution)) / smallest;
  const Eigen::Matrix3Xd here = points_at(*solution.model, solution.x);
  const auto points_moved = [&](const Eigen::VectorXd& change) {
    const Eigen::Matrix3Xd there = points_at(*solution.model, solution.x + change);
    return (there - here).colwise().norm().maxCoeff();
  };
  return safety *
             (points_moved(next_step) + points_moved(change_with_fewer_terms(solution, point))) +
         soft;
}

/// Eigenvalues of the second variation in some directions, as far as they were looked at.
struct SmallEigenvalues {
  double smallest = 0;      // eigenvalue
  double nearest_zero = 0;  // size of the eigenvalue nearest to zero that is no rigid-body mode's
  int neutral_directions = 0;  // that are no rigid-body modes
  Eigen::Index zero = 0;       // those that are free, or zero whatever they are
};

/// @param bound    size up to which an eigenvalue counts as neutral
/// @param free     rigid-body modes, whose eigenvalues are zero
/// @param nothing  size up to which one is zero whatever its direction is; negative: none is
SmallEigenvalues small_eigenvalues(ReducedHessian& hessian, double bound, Eigen::Index free,
                                   double nothing) {
  const Eigen::VectorXd eigenvalues = smallest_eigenvalues(hessian, 2 * bound);
  SmallEigenvalues result;
  result.smallest = eigenvalues.size() > 0 ? eigenvalues[0] : 1;
  Eigen::VectorXd sizes = eigenvalues.cwiseAbs();
  std::sort(sizes.begin(), sizes.end());
  result.zero = std::max(std::min(free, (sizes.array() <= bound).count()),
                         (sizes.array() <= nothing).count());
  result.neutral_directions = static_cast<int>((sizes.array() <= bound).count() - result.zero);
  result.nearest_zero = result.zero < sizes.size() ? sizes[result.zero] : 1;
  return result;
}

/// The direction of the eigenvalue nearest to zero but for `free` of them, with the multipliers
/// that go with it: a vector v = (z, nu) of the system of Newton's method with |z| = 1.
struct SoftMode {
  Eigen::VectorXd direction, multipliers;
};

SoftMode soft_mode(NewtonSystem& system, const Eigen::MatrixXd& jacobian, Eigen::Index free) {
  SoftMode mode;
  mode.direction = direction_by_size(system.reduced_hessian(), free);
  mode.multipliers = Eigen::VectorXd::Zero(jacobian.rows());
  if (jacobian.rows() > 0) {
    mode.multipliers =
        jacobian.transpose().householderQr().solve(system.hessian() * mode.direction);
  }
  return mode;
}

/// First and second derivative by t of the eigenvalue of v along the curve y(t) = y + t v +
/// t^2 w / 2, y = (x, mu), on which the gradient G of the Lagrangian keeps zero in every direction
/// but v (Lyapunov and Schmidt): G' w = -(G'' v v) without its part along v. The first derivative
/// is the coefficient of a fold, zero by symmetry at a bifurcation. Without w the second one would
/// be wrong of a family of equal shapes, which is curved: a helix that slides along the rod.
struct EigenvalueDerivatives {
  double first = 0, second = 0;
};

EigenvalueDerivatives eigenvalue_derivatives(SpanSolution& solution, const SoftMode& mode) {
  constexpr double step = 1e-3;  // error step^2, rounding eps / step and eps / step^2
  const Eigen::VectorXd& v = mode.direction;
  const Eigen::Index m = mode.multipliers.size();
  // Newton's matrix at y + t v, which is G' with the constraints' sign changed, times v.
  const auto image = [&](double t) {
    const SecondDerivatives at = second_derivatives(*solution.model, solution.x + t * v,
                                                    solution.multipliers + t * mode.multipliers);
    ++solution.evaluations;
    Eigen::VectorXd result(v.size() + m);
    result << at.hessian * v - at.jacobian.transpose() * mode.multipliers, at.jacobian * v;
    return result;
  };
  const auto product = [&](const Eigen::VectorXd& a, const Eigen::VectorXd& b) {
    return a.head(v.size()).dot(b.head(v.size())) - a.tail(m).dot(b.tail(m));
  };
  Eigen::VectorXd along(v.size() + m);
  along << v, mode.multipliers;
  const Eigen::VectorXd ahead = image(step);
  const Eigen::VectorXd behind = image(-step);
  const Eigen::VectorXd change = (ahead - behind) / (2 * step);
  const double first = product(change, along);
  Eigen::VectorXd right = -change;
  right.head(v.size()) += first * v;
  NewtonSystem& system = solution.factor->system;
  Eigen::VectorXd w;
  system.solve(right, w);
  constexpr double longest = 1e3;
  if (!system.is_met(right, w, longest)) w = system.minimum_norm_step(right);
  w -= w.head(v.size()).dot(v) * along;
  return {first,
          product(ahead - 2 * image(0) + behind, along) / (step * step) + 3 * product(change, w)};
}

/// Whether the second variation might change so much within `eta` that h is above its limit; false
/// where the largest forces there are could not do it. True if the eigenvalue is not known.
bool may_be_at_fold(const SpanSolution& solution, double load, double eta) {
  return !(eta * largest_third_derivative * scale_of_forces(solution, load) <=
           largest_h * solution.eigenvalue_nearest_zero);
}

class Certification {
 public:
  Certification(SpanSolution& solution, double load, NewtonFactors& factors)
      : solution_(solution),
        model_(*solution.model),
        load_(load),
        factors_(factors),
        scale_(scale_of_forces(solution, load)),
        obstacles_(model_.has_soft_obstacles() || !model_.span().contacts.empty()) {}

  void run() {
    // Newton's method leaves those undetermined whose terms nobody has looked at.
    const bool undetermined = solution_.status == SolveStatus::near_singular;
    if (!evaluate()) return;
    rigid_ = rigid_body_modes(model_.span(), point_->tangents());
    factorise();
    solution_.rigid_body_modes = static_cast<int>(rigid_.all());
    const bool at_fold = estimate_error();
    if (model_.span().planar && !model_.span().stays_in_plane()) look_out_of_plane();
    if (undetermined || !small_step_ || at_fold) {
      return solution_.finish(SolveStatus::near_singular);
    }
    const MiddlePassed middle = middle_passed(solution_);
    if (middle == MiddlePassed::near) {
      solution_.neutral_directions = std::max(1, solution_.neutral_directions);
      return solution_.finish(SolveStatus::near_singular);
    }
    if (solution_.smallest_eigenvalue < -neutral || middle != MiddlePassed::none) {
      return solution_.finish(SolveStatus::saddle);
    }
    solution_.finish(solution_.neutral_directions > 0 ? SolveStatus::near_singular
                                                      : SolveStatus::converged);
  }

 private:
  /// @return whether it meets the equations of equilibrium
  [[nodiscard]] bool evaluate() {
    solution_.point = point_ = solution_.at_x();
    ++solution_.evaluations;
    solution_.energy = point_->energy;
    gradient_ = point_->gradient - point_->jacobian.transpose() * solution_.multipliers;
    if (!(solution_.multipliers.norm() <= largest_pull * (1 + load_))) {
      solution_.fail("the grips would have to pull without bound");
      return false;
    }
    solution_.residual = std::hypot(gradient_.norm(), scale_ * point_->residual.norm());
    if (solution_.residual <= largest_next_step * scale_) return true;
    solution_.fail("the residual of the returned shape is not small");
    return false;
  }

  [[nodiscard]] SmallEigenvalues eigenvalues_of(ReducedHessian& hessian, Eigen::Index rigid) const {
    // Obstacles leave movements free that are not looked for: those that are zero but for rounding.
    return small_eigenvalues(hessian, bound_, rigid, obstacles_ ? 128 * rounding_of(scale_) : -1);
  }

  /// Computes Newton's step and the second variation at the shape.
  void factorise() {
    factors_.factor_at(solution_, *point_, load_);
    NewtonSystem& system = solution_.factor->system;
    next_step_ = newton_step(system, *point_, gradient_);
    judge_step();
    found_ = eigenvalues_of(system.reduced_hessian(), rigid_.in_plane);
    subtract_ridges();
    if (!small_step_ || found_.neutral_directions > 0) count_sliding_mode(system);
    solution_.smallest_eigenvalue = found_.smallest;
    solution_.eigenvalue_nearest_zero = found_.nearest_zero;
    solution_.neutral_directions = found_.neutral_directions;
    eta_ = linear_error(solution_, load_);
  }

  void judge_step() {
    solution_.next_step = next_step_.norm();
    small_step_ = solution_.next_step <= largest_next_step;
    // Below it what is left of the residual makes a step that is not small.
    bound_ = std::max(neutral, small_step_ ? 0 : solution_.residual / largest_next_step);
  }

  /// Counts a mode that shifts the shape along the rod as a rigid-body mode. The part of Newton's
  /// step along zero modes is rounding over their eigenvalues and leaves no doubt of the shape.
  void count_sliding_mode(NewtonSystem& system) {
    const auto modes =
        sliding_modes(model_, solution_.x, system.reduced_hessian(), rigid_.in_plane);
    if (!modes) return;
    next_step_ -= *modes * (modes->transpose() * next_step_);
    judge_step();
    const Eigen::VectorXd last = modes->rightCols<1>();
    constexpr double rounding = 1.01;
    bound_ = std::max(bound_, rounding * std::abs(last.dot(system.hessian() * last)));
    found_ = eigenvalues_of(system.reduced_hessian(), ++rigid_.in_plane);
  }

  /// Takes the second variation at the ridges of boxes that yield into account, which Newton's
  /// method does not need: it ends a piece there.
  void subtract_ridges() {
    const std::vector<RidgeCrossing> ridges = ridge_crossings(solution_);
    if (ridges.empty()) return;
    const Span& span = model_.span();
    const PositionOperator position(span, pieces_of(span), model_.table());
    const std::array<Eigen::MatrixXd, 3> tangents = model_.tangent_jacobian(*point_);
    Eigen::MatrixXd hessian = solution_.factor->system.hessian();
    for (const RidgeCrossing& ridge : ridges) {
      Eigen::VectorXd by_strain = Eigen::VectorXd::Zero(tangents[0].cols());
      for (Eigen::Index axis = 0; axis < 3; ++axis) {
        by_strain += ridge.direction[axis] * tangents[static_cast<std::size_t>(axis)].transpose() *
                     position.at(ridge.s);
      }
      hessian.topLeftCorner(by_strain.size(), by_strain.size()) -=
          by_strain * by_strain.transpose();
    }
    ReducedHessian reduced;
    reduced.compute(hessian, point_->jacobian);
    found_ = eigenvalues_of(reduced, rigid_.in_plane);
  }

  /// @return whether it is next to a fold, so that there may be no equilibrium
  [[nodiscard]] bool estimate_error() {
    double moved = eta_;
    bool at_fold = false;
    // As many terms as constraints leave no direction that a fold could be in.
    const bool can_move = found_.zero < model_.size() - model_.constraints();
    if (can_move && may_be_at_fold(solution_, load_, eta_)) {
      const SoftMode mode = soft_mode(solution_.factor->system, point_->jacobian, found_.zero);
      const EigenvalueDerivatives change = eigenvalue_derivatives(solution_, mode);
      const double kappa = std::abs(change.first) + std::abs(change.second) * eta_;
      const double h = eta_ * kappa / solution_.eigenvalue_nearest_zero;
      moved = h <= 0.5 ? 2 * eta_ / (1 + std::sqrt(1 - 2 * h)) : largest_error;
      at_fold = h > largest_h;
      if (at_fold) solution_.neutral_directions = std::max(1, solution_.neutral_directions);
    }
    solution_.error = error_estimate(solution_, moved);
    if (!at_fold) {
      const double measured = measured_error(solution_, *point_, next_step_, load_);
      solution_.error = std::min(solution_.error, moved / eta_ * measured);
    }
    return at_fold;
  }

  void look_out_of_plane() {
    const SecondDerivatives across =
        second_derivatives_out_of_plane(model_, *point_, solution_.multipliers);
    ReducedHessian beside;
    beside.compute(across.hessian, across.jacobian);
    const SmallEigenvalues found = eigenvalues_of(beside, rigid_.out_of_plane);
    solution_.smallest_eigenvalue = std::min(solution_.smallest_eigenvalue, found.smallest);
    solution_.neutral_directions += found.neutral_directions;
  }

  SpanSolution& solution_;
  const SpanEnergy& model_;
  const double load_;
  NewtonFactors& factors_;
  const double scale_;  // of forces
  const bool obstacles_;
  std::shared_ptr<SpanPoint> point_;
  Eigen::VectorXd gradient_;  // of E - mu . c
  Eigen::VectorXd next_step_;
  RigidBodyModes rigid_;
  double bound_ = neutral;  // size up to which an eigenvalue counts as neutral
  double eta_ = 0;          // by which the coefficients may be off, without a fold
  bool small_step_ = false;
  SmallEigenvalues found_;
};

}  // namespace

void certify(SpanSolution& solution, double load, NewtonFactors& factors) {
  if (!solution.is_equilibrium() && solution.status != SolveStatus::near_singular) return;
  Certification(solution, load, factors).run();
}

void certify_out_of_plane(SpanSolution& solution, double load, NewtonFactors& factors) {
  const Span& span = solution.model->span();
  // Only a rod that is pulled along its clamp turns freely, about that; few are.
  const auto is_along = [&](const Eigen::Vector3d& force) {
    return force.cross(*span.start_direction).norm() <= 1e-6 * force.norm();
  };
  if (is_along(span.weight) && std::all_of(span.loads.begin(), span.loads.end(),
                                           [&](const auto& l) { return is_along(l.force); })) {
    solution.rigid_body_modes =
        static_cast<int>(rigid_body_modes(span, solution.at_x()->tangents()).all());
  }
  const double eta = linear_error(solution, load);
  // Newton's method knows no eigenvalue of a saddle in the plane. An eigenvalue up to `neutral` may
  // be at a fold by rounding alone.
  if (solution.status == SolveStatus::near_singular || may_be_at_fold(solution, load, eta)) {
    return certify(solution, load, factors);
  }
  if (!solution.is_equilibrium()) return;
  solution.error = error_estimate(solution, eta);
  if (solution.status != SolveStatus::converged) return;
  if (!solution.model->resists_out_of_plane(*solution.at_x())) solution.finish(SolveStatus::saddle);
}

}  // namespace dlo::energy_model
