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
  double residual = -1;  ///< norm of the residual of gradient and constraints; -1: unknown
  /// Norm of the Newton step from x that would come next: an estimate of the error of x.
  double next_step = std::numeric_limits<double>::infinity();
  /// Magnitude of the eigenvalue of the last Newton factor nearest to zero, or an overestimate
  /// (after certify() by about 1 % at most, and without rigid-body modes). Directions out of a
  /// span's plane are ignored. Rounding and truncation errors are divided by it. NaN: not computed.
  double eigenvalue_nearest_zero = std::numeric_limits<double>::quiet_NaN();
  /// Estimated distance of the shape from an equilibrium, divided by the length; NaN: unknown.
  double error = std::numeric_limits<double>::quiet_NaN();
  double energy = 0;  ///< energy of the shape [EI/l]
  /// Whether more terms would not change the shape, or the caller chose their number.
  bool resolved = false;
  bool followed = false;  ///< whether it was found near the known shape by Newton's method alone
  /// Smallest eigenvalue of the reduced Hessian, including directions out of the plane unless
  /// Span::stays_in_plane(); NaN: not computed.
  double smallest_eigenvalue = std::numeric_limits<double>::quiet_NaN();
  /// Number of eigenvalues that are zero to the tolerance, without rigid-body modes; at least 1 if
  /// the shape may be at a fold or passes very near to a soft obstacle's middle. An equilibrium
  /// becomes near_singular if it is > 0, unless it is a saddle.
  int neutral_directions = 0;
  /// Result of missing_turns() for a rod with material directors and both end frames prescribed.
  int missing_turns = 0;
  int rigid_body_modes = 0;  ///< number of rigid-body modes, if certify() has processed the shape
  std::shared_ptr<SpanEnergy> model;
  Eigen::VectorXd x;
  Eigen::VectorXd multipliers;
  /// Point of the model where x was found, possibly shared with other solutions; null: unknown.
  std::shared_ptr<SpanPoint> point;
  /// Newton factor of `model` at a point near x, from the last Newton steps or from certify();
  /// null: there is none.
  std::shared_ptr<NewtonFactor> factor;

  /// Whether `point` is the model's point at the present x and revision.
  [[nodiscard]] bool has_point() const {
    return point && point->revision == model->revision() && point->x == x;
  }
  /// Returns the model's point at x; evaluates it if it is not known.
  [[nodiscard]] std::shared_ptr<SpanPoint> at_x() const {
    return has_point() ? point : std::make_shared<SpanPoint>(model->evaluated(x));
  }
  /// Evaluates the model and counts the evaluation.
  void evaluate(const Eigen::Ref<const Eigen::VectorXd>& where, SpanPoint& at) {
    model->evaluate(where, at);
    ++evaluations;
  }
  /// Returns the scale of forces. It includes the multipliers, as grips may pull harder than weight
  /// and loads.
  [[nodiscard]] double scale_of_forces() const { return 1 + model->load() + multipliers.norm(); }
  void finish(SolveStatus how) {
    status = how;
    message = to_string(how);
  }
  void fail(std::string why) {
    status = SolveStatus::failed;
    message = std::move(why);
  }
  /// Whether certify() has found the shape to be at a fold or bifurcation, undetermined in some
  /// directions.
  [[nodiscard]] bool is_singular_point() const {
    return status == SolveStatus::near_singular && neutral_directions > 0;
  }
  [[nodiscard]] bool is_equilibrium() const {
    return succeeded(status) || status == SolveStatus::saddle;
  }
  /// Whether the shape may be followed: an equilibrium, or a singular point.
  [[nodiscard]] bool is_known() const { return is_equilibrium() || is_singular_point(); }
};

}  // namespace dlo::energy_model
