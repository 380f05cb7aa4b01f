#pragma once

#include <Eigen/Core>

#include "base/deadline.hpp"
#include "linear/dense_factor.hpp"
#include "linear/newton_system.hpp"
#include "newton/broyden.hpp"
#include "strain/span_solution.hpp"

namespace dlo::energy_model {

/// Forces of grips over 1 + weight and loads beyond which nothing is taken for a shape: residuals
/// are measured against them.
inline constexpr double largest_pull = 1e10;

/// Newton's next step above which a residual that does not fall any more is not
/// taken for a solution [rad].
inline constexpr double coarsest_step = 1e-8;

/// Newton's next step from what is only roughly polished [rad]: its energy, of
/// which the square is a part, is right to rounding in what tells shapes apart.
inline constexpr double rough_step = 1e-5;

/// Newton's method on the gradient of E - mu . c and on the constraints, with
/// its buffers. Without constraints and obstacles it allocates nothing once
/// they have their size.
class Newton {
 public:
  /// From now on: what has not come to its end by then ends as `time_limit`.
  void limit(const Deadline& deadline) { deadline_ = deadline; }
  /// From solution.x to where the residual is at rounding and Newton's next step, evaluated there,
  /// is below 1e-8; steps are cut while the next one, with the same factor, is no shorter. Without
  /// constraints the Hessian then tells a minimum (`converged`) from a `saddle`; with them the
  /// caller has to look. Ends as `near_singular` where the residual is at rounding and the step is
  /// not, and as `failed` where the residual does not fall; between grips it tries once more as
  /// polish_along_branch().
  /// @param load  sum of weight and loads, the scale of the residuals
  void polish(SpanSolution& solution, double load);
  /// The same between grips, the first steps with the factor of the last polish(), if it was of as
  /// many unknowns: for a shape next to that one. Where there is none within a few steps it ends as
  /// `failed`, without a second try and without least squares.
  void polish_nearby(SpanSolution& solution, double load);
  /// polish(), the first steps with the factor of the last one and the last ones with a factor of
  /// its own, which has_factor_near() then finds.
  void polish_from_neighbour(SpanSolution& solution, double load);
  /// The same to where Newton's next step is below `rough_step`, for a shape
  /// that is given more terms anyway.
  void polish_roughly(SpanSolution& solution, double load);
  /// The same, standing still in directions in which the rod moves for next to
  /// nothing, where rounding would make any step: for one of many steps along a
  /// branch.
  void polish_along_branch(SpanSolution& solution, double load);
  /// The same between grips for the solution of the last polish() with more
  /// terms: the first steps with its Hessian and, in the new terms, that of
  /// bending alone.
  /// @param fewer  that solution
  void polish_with_more_terms(SpanSolution& solution, const SpanSolution& fewer, double load);

  /// Factors the second variation of E - mu . c and the constraints at solution.x, where the
  /// model's last value() was: what the next steps nearby begin with.
  /// @param jacobian  of the constraints there
  void factor_at(const SpanSolution& solution, const Eigen::MatrixXd& jacobian);
  /// The last factor, and the Hessian that it is of.
  [[nodiscard]] NewtonSystem& system();
  [[nodiscard]] const Eigen::MatrixXd& hessian() const { return hessian_; }
  /// Whether the last factor is of this model, at whatever point.
  [[nodiscard]] bool has_factor_of(const SpanEnergy* model) const {
    return model != nullptr && model == factored_.model;
  }
  /// By which unknowns, and multipliers over the scale of forces, differ from those that the last
  /// factor is of; infinite if it is another model's.
  [[nodiscard]] double distance_of_factor(const SpanSolution& solution) const;

 private:
  void run(SpanSolution& solution, double load);
  void begin(SpanSolution& solution);
  [[nodiscard]] double evaluate(SpanSolution& solution);
  void factor(SpanSolution& solution);
  void factor_system();
  void prolong(const SpanEnergy& model, const SpanEnergy& fewer);
  void find_neutral();
  void stand_still();
  void solve();
  void stand_still_where_neutral();
  void move(SpanSolution& solution, double length);
  [[nodiscard]] double step_length(SpanSolution& solution, double size);
  [[nodiscard]] double step_length_by_energy(SpanSolution& solution);
  [[nodiscard]] double length_of(const SpanSolution& solution) const;
  /// Of forces, with which residuals are compared.
  [[nodiscard]] double scale_of(const SpanSolution& solution) const;
  /// Whether rounding may be what is left of a residual of this size.
  [[nodiscard]] bool is_at_rounding(const SpanSolution& solution, double size) const;
  [[nodiscard]] double softest_of_factor();
  void remember_factor(const SpanSolution& solution);
  [[nodiscard]] bool has_factor_for(const SpanEnergy& model) const;
  [[nodiscard]] bool natural_move(SpanSolution& solution, double& size);
  void update_step();

  Deadline deadline_;
  double load_ = 0;
  bool stands_still_ = false;
  bool rough_ = false;
  bool nearby_ = false;
  bool borrows_ = false;  // the factor of the last polish()
  bool ends_on_own_factor_ = false;
  double pull_ = 1;  // scale of forces
  Eigen::VectorXd gradient_, residual_, right_, step_, first_step_;
  Eigen::MatrixXd jacobian_, hessian_, neutral_;
  DenseFactor definite_factor_;
  NewtonSystem system_;   // where the Hessian has no definite_factor_
  BroydenSteps broyden_;  // with system_, multipliers over pull_
  /// What system_ is of; no model where it is none of a single point.
  struct {
    const SpanEnergy* model = nullptr;
    Eigen::VectorXd x, multipliers;
  } factored_;
  bool prolonged_ = false;     // hessian_ is that of fewer terms
  bool prolong_next_ = false;  // and what the next step begins with
  bool definite_ = false;      // definite_factor_ is what the system is solved with
  bool system_known_ = true;   // system_ is of hessian_, too
  Eigen::VectorXd trial_x_, trial_multipliers_, trial_gradient_, soft_;
};

}  // namespace dlo::energy_model
