#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <Eigen/LU>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "dynamics/collocation_rule.hpp"
#include "dynamics/span_dynamics.hpp"

namespace dlo::energy_model {

/// A span at one time, with what has been done to it since the begin. Own units.
struct SpanInstant {
  double time = 0;
  Eigen::VectorXd x, v;  ///< unknowns and their rates
  EnergyBalance done;    ///< what has been dissipated, lost and done, without energies
};

struct IntegratorOptions {
  double tolerance = 1e-7;  ///< of a step, as DynamicsOptions::tolerance
  double step = 0;          ///< fixed; 0: by the tolerance
  bool damped = false;      ///< what decays fast
};

/// Collocation by Gauss' rule of four points of
///     x' = v,  M(x) v' = f(t, x, v) + G^T mu,  d^2 c / dt^2 = 0,
/// by accelerations at the rule's points, so that of M only products are needed: Newton's method
/// has M of an earlier step in its matrix. Where a span has constraints c, x and v are moved to
/// them after each step by the least kinetic energy; with twist, by the least of that and of strain
/// energy.
class SpanIntegrator {
 public:
  SpanIntegrator(SpanDynamics& span, std::function<SpanDrive(double)> drive,
                 const IntegratorOptions& options);

  /// Moves positions and velocities to the constraints. @return why not; empty: done
  [[nodiscard]] std::string project(SpanInstant& at);
  /// Brings what has no mass, the roll of frames about points that stay, to its equilibrium at the
  /// begin. @return why not; empty: done
  [[nodiscard]] std::string settle_twist(SpanInstant& at);
  /// Goes on to a time. @param expired  asked after each step. @return why not; empty: done
  [[nodiscard]] std::string advance(SpanInstant& at, double until,
                                    const std::function<bool()>& expired);

  /// Whether two times differ by rounding only: a break between them is asked for on either side of
  /// both.
  [[nodiscard]] static bool same_instant(double a, double b);

  /// Brings SpanDynamics to an instant, with its accelerations. @return the grips' multipliers
  [[nodiscard]] Eigen::VectorXd consistent_accelerations(const SpanInstant& at);

  /// What comes is not smooth after what was: grips may have other velocities, which strikes the
  /// span. Its points keep their momentum but for the grips' impulses, whose work is what the
  /// kinetic energy changes by.
  void apply_impulse(SpanInstant& at);

  /// Sets the rates to those whose velocities differ from the given ones of the points
  /// (SpanDynamics::velocities()) by the least kinetic energy among those that the grips allow.
  void set_velocities(const Eigen::MatrixX3d& given, SpanInstant& at);

  [[nodiscard]] long steps() const { return steps_; }
  [[nodiscard]] double smallest_step() const { return smallest_step_; }
  [[nodiscard]] double error() const { return error_; }
  /// SpanDynamics::depth() at the ends of steps, where it has been largest.
  [[nodiscard]] double depth() const { return depth_; }

 private:
  /// Where nothing is known yet.
  static constexpr double first_step = 1e-3;
  /// Newton's matrix for one size of step.
  struct Factor {
    double step = 0;
    Eigen::PartialPivLU<Eigen::MatrixXd> lu;
  };
  /// What Newton's matrix is made of; references, as long as a call.
  struct PointMatrices {
    const Eigen::MatrixXd& mass;
    const Eigen::MatrixXd& damping;
    const Eigen::MatrixXd& stiffness;
    const Eigen::MatrixXd& jacobian;
  };
  /// Accelerations and multipliers at the rule's points of a step.
  struct Stages {
    double step = 0;
    double end = 0;  // time
    Eigen::MatrixXd values;
  };

  [[nodiscard]] Eigen::MatrixXd predicted(const SpanInstant& at, double step,
                                          const Stages& known) const;
  [[nodiscard]] Eigen::MatrixXd joined(const Stages& first, const Stages& second) const;
  [[nodiscard]] bool try_step(SpanInstant& at, double step, const Eigen::MatrixXd& guess,
                              double enough, Stages& found);
  [[nodiscard]] bool take_step(SpanInstant& at, double step);
  [[nodiscard]] bool take_two_halves(SpanInstant& at, double step);
  void place_point(Eigen::Index i, double step, const PointMatrices& at,
                   Eigen::MatrixXd& matrix) const;
  [[nodiscard]] Factor& factor(const SpanInstant& at, double step, bool renew);
  [[nodiscard]] Factor& factor_of_points(const SpanInstant& at, double step,
                                         const std::vector<SpanDrive>& drives,
                                         const Eigen::MatrixXd& guess);
  void take_mass(double time, const SpanInstant& at);
  [[nodiscard]] double take_energy(double time, const SpanInstant& at);
  [[nodiscard]] Eigen::VectorXd accelerated(double time, const SpanInstant& at,
                                            const Eigen::MatrixX3d* before);

  SpanDynamics& span_;
  std::function<SpanDrive(double)> drive_;
  IntegratorOptions options_;
  CollocationRule rule_;
  Eigen::MatrixXd mass_;
  Eigen::MatrixXd jacobian_;
  std::vector<Factor> factors_;
  Factor of_points_;  // of the last step with matrices of its own
  Stages last_;
  double newton_enough_;      // what a correction of a step may still move
  double next_ = first_step;  // its size
  double energy_ = std::numeric_limits<double>::quiet_NaN();  // where the last step ended
  double largest_energy_ = 0;
  double energy_magnitude_ = 0;  // largest sum of the magnitudes of all energies
  long steps_ = 0;
  double smallest_step_ = std::numeric_limits<double>::infinity();
  double error_ = 0;
  double depth_ = 0;
};

}  // namespace dlo::energy_model
