#pragma once

#include <Eigen/Core>
#include <limits>
#include <memory>
#include <string>

#include "dlo/energy_model/status.hpp"
#include "strain/span_energy.hpp"

namespace dlo::energy_model {

struct NewtonFactor;

struct [[nodiscard]] SpanSolution {
  SolveStatus status = SolveStatus::not_run;
  std::string message = "never ran";
  int evaluations = 0;
  int terms = 0;
  double residual = -1;  ///< of the gradient and the constraints
  /// Norm of Newton's step from x, which would be the next one: what x may still be wrong by.
  double next_step = std::numeric_limits<double>::infinity();
  /// Eigenvalue of the factor of Newton's last steps that is nearest to zero, or a little more: by
  /// it rounding and what the terms leave out are divided. NaN: not looked at.
  double eigenvalue_nearest_zero = std::numeric_limits<double>::quiet_NaN();
  /// What the shape may be away from an equilibrium, of the length; NaN: not known.
  double error = std::numeric_limits<double>::quiet_NaN();
  double energy = 0;      ///< in EI/l
  bool resolved = false;  ///< more terms would not change the shape, or the caller chose them
  bool followed = false;  ///< next to the known shape it came from, by Newton's method alone
  /// Smallest eigenvalue of the reduced Hessian, out of the plane included; NaN: not looked at.
  double smallest_eigenvalue = std::numeric_limits<double>::quiet_NaN();
  /// Of them, those that are zero to the tolerance and no rigid-body mode's; near_singular if any.
  int neutral_directions = 0;
  /// turns_lost() of an intrinsically curved rod whose frames are held at both ends.
  int turns_lost = 0;
  int rigid_body_modes = 0;  ///< of a shape that certify() has seen: those that are
  std::shared_ptr<SpanEnergy> model;
  Eigen::VectorXd x;
  Eigen::VectorXd multipliers;
  /// Of the model where x was found, which others may share; null: not known.
  std::shared_ptr<SpanPoint> point;
  /// Of `model` at a point on the way to x, which the last steps of Newton's method were made with
  /// or certify() has asked; null: there is none.
  std::shared_ptr<NewtonFactor> factor;

  /// Whether `point` is the model's at x, as both are now.
  [[nodiscard]] bool has_point() const {
    return point && point->revision == model->revision() && point->x == x;
  }
  /// The model's point at x, evaluated now where it is not known.
  [[nodiscard]] std::shared_ptr<SpanPoint> at_x() const {
    return has_point() ? point : std::make_shared<SpanPoint>(model->evaluated(x));
  }
  /// Evaluates the model, and counts it.
  void evaluate(const Eigen::Ref<const Eigen::VectorXd>& where, SpanPoint& at) {
    model->evaluate(where, at);
    ++evaluations;
  }
  void finish(SolveStatus how) {
    status = how;
    message = to_string(how);
  }
  void fail(std::string why) {
    status = SolveStatus::failed;
    message = std::move(why);
  }
  /// A shape that a fold or a bifurcation leaves open, as certify() has found.
  [[nodiscard]] bool is_singular_point() const {
    return status == SolveStatus::near_singular && neutral_directions > 0;
  }
  /// Why a shape that is not `resolved` is no result.
  [[nodiscard]] std::string too_few_terms() const {
    return "the curvature is not resolved by " + std::to_string(terms) + " terms";
  }
  [[nodiscard]] bool is_equilibrium() const {
    return succeeded(status) || status == SolveStatus::saddle;
  }
};

}  // namespace dlo::energy_model
