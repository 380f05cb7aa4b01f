#include "certify/certify.hpp"

#include <Eigen/QR>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <span>

#include "certify/piece_cuts.hpp"
#include "certify/rigid_body_modes.hpp"
#include "frames/position_operator.hpp"
#include "linear/reduced_hessian.hpp"
#include "newton/newton.hpp"
#include "strain/second_derivatives.hpp"

namespace dlo::energy_model {
namespace {

/// Upper bound of the error of any point of a held rod, divided by its length.
constexpr double largest_error = 2;

/// Limit of h = |dlambda| / lambda within the error of the coefficients, up to which an equilibrium
/// exists there. Kantorovich: Newton's method from a point with the step eta, the inverse 1/lambda
/// and second derivatives below kappa has a solution if h = eta kappa / lambda <= 1/2, at a
/// distance of at most 2 / (1 + (1 - 2h)^(1/2)) eta. Half of the limit is a margin, as h is
/// estimated.
constexpr double kantorovich_limit = 0.25;

/// Bound of the third derivatives of E - mu . c along a unit direction of strains, divided by the
/// scale of forces: forces times angles of at most 1, those of positions counted three times.
constexpr double largest_third_derivative = 4;

/// Returns Newton's step of the coefficients; if it is inaccurate or longer than
/// `largest_stagnation_step`, the step of minimum norm, which has no component along near-null
/// modes.
/// @param gradient  gradient of E - mu . c
Eigen::VectorXd newton_step(NewtonSystem& system, const SpanPoint& point,
                            const Eigen::VectorXd& gradient) {
  Eigen::VectorXd right(gradient.size() + point.residual.size());
  right << -gradient, -point.residual;
  Eigen::VectorXd step;
  system.solve(right, step);
  if (!system.is_solved_by(right, step, largest_stagnation_step))
    step = system.minimum_norm_step(right);
  return step.head(gradient.size());
}

/// Returns the rounding error of forces with this scale.
double rounding_of(double scale) { return 8 * std::numeric_limits<double>::epsilon() * scale; }

/// Estimates the error of the coefficients along the mode nearest zero for a constant second
/// variation: the remaining Newton step, plus rounding, truncation and kinks within elements,
/// divided by the eigenvalue nearest to zero.
double linear_error(const SpanSolution& solution) {
  const double scale = solution.scale_of_forces();
  // The last coefficient contributes an angle of a_K / (2K); its effect on forces is smaller by
  // this factor again.
  const double K = solution.terms;
  const double angle = solution.model->truncation(solution.x) / (2 * K);
  const double smallest = std::min(solution.eigenvalue_nearest_zero, 1.0);
  const double truncated = scale * angle / (2 * K) + misplaced_contact_error(solution);
  return solution.next_step + (rounding_of(scale) + truncated) / smallest;
}

/// Estimates the distance of a shape's points from those of an equilibrium, divided by the length.
/// The coefficients of strains bound the displacement; no point of a held rod can be displaced by
/// more than twice its length.
/// @param moved  error of the coefficients
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

/// Returns the model's points at its nodes, in rod lengths.
Eigen::Matrix3Xd points_at(const SpanEnergy& model, const Eigen::VectorXd& x) {
  const std::span<const double> nodes(model.nodes().data(),
                                      static_cast<std::size_t>(model.nodes().size()));
  return model.shape(x).sample(nodes).points;
}

/// Returns, to first order, the change of the coefficients to the equilibrium with two coefficients
/// fewer in every element and field: these become zero, and the others change so that their
/// gradient and the constraints stay zero.
Eigen::VectorXd change_with_fewer_terms(const SpanSolution& solution, const SpanPoint& point) {
  const SpanUnknowns& unknowns = solution.model->unknowns();
  const Eigen::Index dropped = std::min<Eigen::Index>(unknowns.terms, 2);
  Eigen::VectorXd last = Eigen::VectorXd::Zero(solution.x.size());
  const auto for_each = [&](const auto& visit) {
    for (Eigen::Index field = 0; field < unknowns.fields; ++field) {
      for (Eigen::Index e = 0; e < unknowns.elements; ++e) {
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

/// Estimates the error of the points from their displacement by Newton's step and by two
/// coefficients fewer. error_estimate() bounds the effect of forces along the direction of least
/// resistance. That bound is far too large for a rod that is pulled taut or hangs as a line, where
/// forces are large but also stiffen the rod.
double measured_error(const SpanSolution& solution, const SpanPoint& point,
                      const Eigen::VectorXd& next_step) {
  // Covers the rounding of another step, and coefficients that decrease by a tenth per two more.
  constexpr double safety_factor = 10;
  const double scale = solution.scale_of_forces();
  const double smallest = std::min(solution.eigenvalue_nearest_zero, 1.0);
  const double soft =
      (rounding_of(scale) * (1 - smallest) + misplaced_contact_error(solution)) / smallest;
  const Eigen::Matrix3Xd here = points_at(*solution.model, solution.x);
  const auto points_moved = [&](const Eigen::VectorXd& change) {
    const Eigen::Matrix3Xd moved_points = points_at(*solution.model, solution.x + change);
    return (moved_points - here).colwise().norm().maxCoeff();
  };
  return safety_factor *
             (points_moved(next_step) + points_moved(change_with_fewer_terms(solution, point))) +
         soft;
}

/// Small eigenvalues of the second variation in some set of directions.
struct SmallEigenvalues {
  double smallest = 0;  // smallest eigenvalue; 1 if there is none
  // Magnitude of the eigenvalue nearest to zero without rigid-body modes; 1 if there is none.
  double nearest_zero = 0;
  int neutral_directions = 0;  // number of neutral directions that are no rigid-body modes
  Eigen::Index zero = 0;       // number of rigid-body modes, or of zeros by rounding if larger
};

/// Direction of the eigenvalue nearest to zero without the first `free` ones, with the multipliers
/// that belong to it: a vector v = (z, nu) of Newton's system with |z| = 1.
struct SoftMode {
  Eigen::VectorXd direction, multipliers;
};

SoftMode soft_mode(NewtonSystem& system, const Eigen::MatrixXd& jacobian, Eigen::Index free) {
  SoftMode mode;
  mode.direction = eigenvector_by_magnitude(system.reduced_hessian(), free);
  mode.multipliers = Eigen::VectorXd::Zero(jacobian.rows());
  if (jacobian.rows() > 0) {
    mode.multipliers =
        jacobian.transpose().householderQr().solve(system.hessian() * mode.direction);
  }
  return mode;
}

/// First and second derivative by t of the eigenvalue of v along the curve y(t) = y + t v + t^2 w /
/// 2, y = (x, mu). On this curve the gradient G of the Lagrangian stays zero in every direction but
/// v (Lyapunov and Schmidt): G' w = -(G'' v v) without its component along v. The first derivative
/// is the coefficient of a fold, and zero by symmetry at a bifurcation. Without w the second
/// derivative would be wrong for a curved family of equal shapes, such as a helix that slides along
/// the rod.
struct EigenvalueDerivatives {
  double first = 0, second = 0;
};

EigenvalueDerivatives eigenvalue_derivatives(SpanSolution& solution, const SoftMode& mode) {
  constexpr double step = 1e-3;  // error step^2, rounding eps / step and eps / step^2
  const Eigen::VectorXd& v = mode.direction;
  const Eigen::Index m = mode.multipliers.size();
  // Newton's matrix at y + t v, which is G' with the sign of the constraints changed, times v.
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
  const Eigen::VectorXd forward = image(step);
  const Eigen::VectorXd behind = image(-step);
  const Eigen::VectorXd change = (forward - behind) / (2 * step);
  const double first = product(change, along);
  Eigen::VectorXd right = -change;
  right.head(v.size()) += first * v;
  NewtonSystem& system = solution.factor->system;
  Eigen::VectorXd w;
  system.solve(right, w);
  if (!system.is_solved_by(right, w)) w = system.minimum_norm_step(right);
  w -= w.head(v.size()).dot(v) * along;
  return {first,
          product(forward - 2 * image(0) + behind, along) / (step * step) + 3 * product(change, w)};
}

/// Whether the second variation might change within `eta` so much that h exceeds its limit. False
/// if a bound by the largest forces excludes it; true if the eigenvalue is unknown.
bool may_be_at_fold(const SpanSolution& solution, double eta) {
  return !(eta * largest_third_derivative * solution.scale_of_forces() <=
           kantorovich_limit * solution.eigenvalue_nearest_zero);
}

class Certification {
 public:
  Certification(SpanSolution& solution, NewtonBuffers& buffers)
      : solution_(solution),
        model_(*solution.model),
        buffers_(buffers),
        scale_(solution.scale_of_forces()),
        obstacles_(model_.has_soft_obstacles() || !model_.span().contacts.empty()) {}

  void run() {
    // Newton's method has not determined this shape, and its truncation error is unknown.
    const bool undetermined = solution_.status == SolveStatus::near_singular;
    if (!evaluate()) return;
    rigid_ = rigid_body_modes(model_.span(), point_->tangents());
    factorise();
    solution_.rigid_body_modes = static_cast<int>(rigid_.all());
    estimate_error();
    if (model_.span().planar && !model_.span().stays_in_plane()) check_out_of_plane();
    if (undetermined || !small_step_) return solution_.finish(SolveStatus::near_singular);
    const MiddlePassage middle = classify_middle_passage(solution_);
    if (middle == MiddlePassage::near) {
      solution_.neutral_directions = std::max(1, solution_.neutral_directions);
      return solution_.finish(SolveStatus::near_singular);
    }
    if (solution_.smallest_eigenvalue < -zero_eigenvalue_limit || middle != MiddlePassage::none) {
      return solution_.finish(SolveStatus::saddle);
    }
    solution_.finish(solution_.neutral_directions > 0 ? SolveStatus::near_singular
                                                      : SolveStatus::converged);
  }

 private:
  /// Evaluates the residual of the solution. @return whether the shape satisfies the equations of
  /// equilibrium with bounded reactions; if not, the solution fails
  [[nodiscard]] bool evaluate() {
    solution_.point = point_ = solution_.at_x();
    ++solution_.evaluations;
    solution_.energy = point_->energy;
    gradient_ = point_->gradient - point_->jacobian.transpose() * solution_.multipliers;
    if (!(solution_.multipliers.norm() <= largest_grip_force * (1 + model_.load()))) {
      solution_.fail("the reactions of the grips are unbounded");
      return false;
    }
    solution_.residual = std::hypot(gradient_.norm(), scale_ * point_->residual.norm());
    if (solution_.residual <= largest_stagnation_step * scale_) return true;
    solution_.fail("the residual of the returned shape is not small");
    return false;
  }

  /// Classifies the small eigenvalues of a reduced Hessian.
  /// @param rigid  number of rigid-body modes, whose eigenvalues are zero
  [[nodiscard]] SmallEigenvalues eigenvalues_of(ReducedHessian& hessian, Eigen::Index rigid) const {
    const Eigen::VectorXd eigenvalues = smallest_eigenvalues(hessian, 2 * bound_);
    SmallEigenvalues result;
    result.smallest = eigenvalues.size() > 0 ? eigenvalues[0] : 1;
    Eigen::VectorXd sizes = eigenvalues.cwiseAbs();
    std::sort(sizes.begin(), sizes.end());
    const Eigen::Index neutral = (sizes.array() <= bound_).count();
    // Obstacles may leave rigid-body motions free that rigid_body_modes() does not count; these
    // have zero eigenvalues up to rounding.
    const double rounding = obstacles_ ? 128 * rounding_of(scale_) : -1;
    result.zero = std::max(std::min(rigid, neutral), (sizes.array() <= rounding).count());
    result.neutral_directions = static_cast<int>(neutral - result.zero);
    result.nearest_zero = result.zero < sizes.size() ? sizes[result.zero] : 1;
    return result;
  }

  /// Computes Newton's step and the second variation at the shape.
  void factorise() {
    buffers_.factor_at(solution_, *point_);
    NewtonSystem& system = solution_.factor->system;
    next_step_ = newton_step(system, *point_, gradient_);
    check_newton_step();
    found_ = eigenvalues_of(system.reduced_hessian(), rigid_.in_plane);
    include_ridge_terms();
    if (!small_step_ || found_.neutral_directions > 0) count_sliding_mode(system);
    solution_.smallest_eigenvalue = found_.smallest;
    solution_.eigenvalue_nearest_zero = found_.nearest_zero;
    solution_.neutral_directions = found_.neutral_directions;
    eta_ = linear_error(solution_);
  }

  void check_newton_step() {
    solution_.next_step = next_step_.norm();
    small_step_ = solution_.next_step <= largest_stagnation_step;
    // With a smaller eigenvalue the remaining residual causes a step that is not small.
    bound_ = std::max(zero_eigenvalue_limit,
                      small_step_ ? 0 : solution_.residual / largest_stagnation_step);
  }

  /// Counts a mode that shifts the shape along the rod as a rigid-body mode. The component of
  /// Newton's step along zero modes is rounding divided by their eigenvalues, and is removed: it
  /// is unrelated to the error of the shape.
  void count_sliding_mode(NewtonSystem& system) {
    const auto modes =
        sliding_modes(model_, solution_.x, system.reduced_hessian(), rigid_.in_plane);
    if (!modes) return;
    next_step_ -= *modes * (modes->transpose() * next_step_);
    check_newton_step();
    const Eigen::VectorXd last = modes->rightCols<1>();
    constexpr double rounding = 1.01;
    bound_ = std::max(bound_, rounding * std::abs(last.dot(system.hessian() * last)));
    found_ = eigenvalues_of(system.reduced_hessian(), ++rigid_.in_plane);
  }

  /// Includes the second variation at the ridges of soft boxes. Newton's method does not need it,
  /// as an element ends there.
  void include_ridge_terms() {
    const std::vector<RidgeCrossing> ridges = ridge_crossings(solution_);
    if (ridges.empty()) return;
    const Span& span = model_.span();
    const PositionOperator position(span, elements_of(span), model_.table());
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

  /// Estimates solution_.error, and counts a neutral direction if the shape is so close to a fold
  /// that there may be no equilibrium.
  void estimate_error() {
    double moved = eta_;
    bool at_fold = false;
    // If there are as many coefficients as constraints, no direction is left for a fold.
    const bool can_move = found_.zero < model_.size() - model_.constraints();
    if (can_move && may_be_at_fold(solution_, eta_)) {
      const SoftMode mode = soft_mode(solution_.factor->system, point_->jacobian, found_.zero);
      const EigenvalueDerivatives change = eigenvalue_derivatives(solution_, mode);
      const double kappa = std::abs(change.first) + std::abs(change.second) * eta_;
      const double h = eta_ * kappa / solution_.eigenvalue_nearest_zero;
      moved = h <= 0.5 ? 2 * eta_ / (1 + std::sqrt(1 - 2 * h)) : largest_error;
      at_fold = h > kantorovich_limit;
      if (at_fold) solution_.neutral_directions = std::max(1, solution_.neutral_directions);
    }
    solution_.error = error_estimate(solution_, moved);
    if (!at_fold) {
      const double measured = measured_error(solution_, *point_, next_step_);
      solution_.error = std::min(solution_.error, moved / eta_ * measured);
    }
  }

  void check_out_of_plane() {
    ReducedHessian reduced =
        reduced_hessian(second_derivatives_out_of_plane(model_, *point_, solution_.multipliers));
    const SmallEigenvalues found = eigenvalues_of(reduced, rigid_.out_of_plane);
    solution_.smallest_eigenvalue = std::min(solution_.smallest_eigenvalue, found.smallest);
    solution_.neutral_directions += found.neutral_directions;
  }

  SpanSolution& solution_;
  const SpanEnergy& model_;
  NewtonBuffers& buffers_;
  const double scale_;  // scale of forces
  const bool obstacles_;
  std::shared_ptr<SpanPoint> point_;
  Eigen::VectorXd gradient_;  // gradient of E - mu . c
  Eigen::VectorXd next_step_;
  RigidBodyModes rigid_;
  double bound_ = zero_eigenvalue_limit;  // magnitude up to which an eigenvalue counts as neutral
  double eta_ = 0;                        // error of the coefficients without a fold
  bool small_step_ = false;
  SmallEigenvalues found_;
};

}  // namespace

void certify(SpanSolution& solution, NewtonBuffers& buffers) {
  if (!solution.is_equilibrium() && solution.status != SolveStatus::near_singular) return;
  Certification(solution, buffers).run();
}

void certify_plain_cantilever(SpanSolution& solution, NewtonBuffers& buffers) {
  const Span& span = solution.model->span();
  // Only a rod that is pulled along its clamp can rotate freely, about that direction; such
  // problems are rare.
  const auto is_along = [&](const Eigen::Vector3d& force) {
    return force.cross(*span.start_direction).norm() <= 1e-6 * force.norm();
  };
  if (is_along(span.weight) && std::ranges::all_of(span.loads, is_along, &Span::Load::force)) {
    solution.rigid_body_modes =
        static_cast<int>(rigid_body_modes(span, solution.at_x()->tangents()).all());
  }
  const double eta = linear_error(solution);
  // Newton's method determines no eigenvalue of a saddle in the plane. An eigenvalue up to
  // `zero_eigenvalue_limit` may belong to a fold by rounding alone.
  if (solution.status == SolveStatus::near_singular || may_be_at_fold(solution, eta)) {
    return certify(solution, buffers);
  }
  if (!solution.is_equilibrium()) return;
  solution.error = error_estimate(solution, eta);
  if (solution.status != SolveStatus::converged || span.stays_in_plane()) return;
  if (!solution.model->resists_out_of_plane(*solution.at_x())) solution.finish(SolveStatus::saddle);
}

}  // namespace dlo::energy_model
