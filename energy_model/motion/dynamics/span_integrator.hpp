#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <Eigen/LU>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "dynamics/span_dynamics.hpp"

namespace dlo::energy_model {

/// A collocation Runge-Kutta method.
struct CollocationRule {
  Eigen::VectorXd nodes;             ///< c, in (0, 1]
  Eigen::VectorXd weights;           ///< b
  Eigen::MatrixXd inner;             ///< a_ij: integrals of the stages to c_i
  Eigen::MatrixXd double_integrals;  ///< a a: double integrals of the stages to c_i
  Eigen::MatrixXd to_legendre;       ///< stages to coefficients of Legendre's polynomials
  Eigen::RowVectorXd last;           ///< b a: stages to the double integral over the step

  /// Returns the weights of the stages in their interpolating polynomial at a time within the step,
  /// given as a fraction of the step.
  [[nodiscard]] Eigen::RowVectorXd interpolation(double at) const;
  /// Returns the matrix that extrapolates the stages of a step to those of the next one, which is
  /// `ratio` times as long.
  [[nodiscard]] Eigen::MatrixXd extrapolation(double ratio) const;
};

/// Returns Gauss's rule of four stages. Its order is eight; it is symmetric and does not damp
/// vibrations.
[[nodiscard]] CollocationRule gauss_rule();

/// Returns the Radau IIA rule of four stages. Its order is seven; it damps fast decaying components
/// within a step.
[[nodiscard]] CollocationRule radau_rule();

/// State of a span at one time, with the work done and the energy dissipated since the begin. Own
/// units.
struct SpanInstant {
  double time = 0;
  Eigen::VectorXd x, v;  ///< unknowns and their rates
  EnergyBalance done;    ///< dissipated energy, lost energy and work; energies are not included
};

struct IntegratorOptions {
  double tolerance = 1e-7;  ///< tolerance of a step, as DynamicsOptions::tolerance
  double step = 0;          ///< fixed step; 0: adapted to the tolerance
  /// Whether the rule damps fast decaying components (Radau IIA instead of Gauss).
  bool damped = false;
};

/// Integrates by collocation with four stages (Gauss's rule, or Radau's if damped)
///     x' = v,  M(x) v' = f(t, x, v) + G^T mu,  d^2 c / dt^2 = 0.
/// The unknowns are accelerations at the stages, so that only products with M are needed: Newton's
/// method may use M of an earlier step in its matrix. If a span has constraints c, x and v are
/// projected onto them after each step, with the smallest kinetic energy of the displacement; with
/// twist, with the smallest sum of that and strain energy.
class SpanIntegrator {
 public:
  SpanIntegrator(SpanDynamics& span, std::function<SpanDrive(double)> drive,
                 const IntegratorOptions& options);

  /// Projects positions and velocities onto the constraints. @return the reason of a failure; empty
  /// on success
  [[nodiscard]] std::string project(SpanInstant& at);
  /// Brings the roll of frames about points at rest, which has no mass, to its equilibrium at the
  /// begin. @return the reason of a failure; empty on success
  [[nodiscard]] std::string equilibrate_roll(SpanInstant& at);
  /// Integrates to a time. @param expired  called before each step. @return the reason of a
  /// failure; empty on success
  [[nodiscard]] std::string advance(SpanInstant& at, double until,
                                    const std::function<bool()>& expired);

  /// Whether two times differ only by rounding. The motion is then evaluated on one side of both
  /// times, because a break of the motion may lie between them.
  [[nodiscard]] static bool same_instant(double a, double b);

  /// Sets SpanDynamics to an instant with consistent accelerations. @return the grips' multipliers
  [[nodiscard]] Eigen::VectorXd consistent_accelerations(const SpanInstant& at);

  /// Applies the impulse of a break of the motion, where grips may change their velocities. The
  /// points keep their momentum except for the grips' impulses, whose work is the change of kinetic
  /// energy.
  void apply_impulse(SpanInstant& at);

  /// Sets the rates that the constraints allow and whose velocities differ from the given ones of
  /// the points (SpanDynamics::velocities()) by the smallest kinetic energy.
  void set_velocities(const Eigen::MatrixX3d& given, SpanInstant& at);

  [[nodiscard]] long steps() const { return steps_; }
  [[nodiscard]] double smallest_step() const { return smallest_step_; }
  [[nodiscard]] double error() const { return error_; }
  /// Returns the largest SpanDynamics::depth() at the ends of steps.
  [[nodiscard]] double depth() const { return depth_; }

 private:
  /// Size of the first step, and of the first one after a break of the motion.
  static constexpr double first_step = 1e-3;
  /// Factor of Newton's matrix for one step size.
  struct Factor {
    double step = 0;
    Eigen::PartialPivLU<Eigen::MatrixXd> lu;
  };
  /// Matrices from which Newton's matrix is made, by reference.
  struct PointMatrices {
    const Eigen::MatrixXd& mass;
    const Eigen::MatrixXd& damping;
    const Eigen::MatrixXd& stiffness;
    const Eigen::MatrixXd& jacobian;
  };
  /// Accelerations and multipliers at the stages of a step.
  struct Stages {
    double step = 0;
    double end = 0;  // time
    Eigen::MatrixXd values;
  };

  [[nodiscard]] Eigen::MatrixXd predicted(const SpanInstant& at, double step,
                                          const Stages& known) const;
  [[nodiscard]] Eigen::MatrixXd merge_halves(const Stages& first, const Stages& second) const;
  [[nodiscard]] bool try_step(SpanInstant& at, double step, const Eigen::MatrixXd& guess,
                              double enough, Stages& found);
  [[nodiscard]] bool take_step(SpanInstant& at, double step);
  [[nodiscard]] bool take_two_halves(SpanInstant& at, double step);
  void set_stage_rows(Eigen::Index i, double step, const PointMatrices& at,
                      Eigen::MatrixXd& matrix) const;
  [[nodiscard]] Factor& factor(const SpanInstant& at, double step, bool renew);
  [[nodiscard]] Factor& factor_at_stages(const SpanInstant& at, double step,
                                         const std::vector<SpanDrive>& drives,
                                         const Eigen::MatrixXd& guess);
  void update_mass_matrix(double time, const SpanInstant& at);
  [[nodiscard]] double update_energy_range(double time, const SpanInstant& at);
  [[nodiscard]] Eigen::VectorXd solve_accelerations(double time, const SpanInstant& at,
                                                    const Eigen::MatrixX3d* before);

  SpanDynamics& span_;
  std::function<SpanDrive(double)> drive_;
  IntegratorOptions options_;
  CollocationRule rule_;
  Eigen::MatrixXd mass_;
  Eigen::MatrixXd jacobian_;
  std::vector<Factor> factors_;
  Factor stage_factor_;  // factor of Newton's matrix with the mass matrices of the last step
  Stages last_;
  double newton_tolerance_;   // Newton correction at which a step counts as solved
  double next_ = first_step;  // size of the next step
  double energy_ = std::numeric_limits<double>::quiet_NaN();  // at the end of the last step
  double largest_energy_ = 0;
  double energy_magnitude_ = 0;  // largest sum of the magnitudes of all energies
  long steps_ = 0;
  double smallest_step_ = std::numeric_limits<double>::infinity();
  double error_ = 0;
  double depth_ = 0;
};

}  // namespace dlo::energy_model
