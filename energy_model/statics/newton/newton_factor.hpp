#pragma once

#include <Eigen/Core>
#include <memory>
#include <vector>

#include "base/pool.hpp"
#include "linear/newton_system.hpp"
#include "strain/span_solution.hpp"

namespace dlo::energy_model {

/// Newton's linear system, factored at a point of a span's model. SpanSolution::factor passes it on
/// to later steps, which need no new factorisation.
struct NewtonFactor {
  NewtonSystem system;
  Eigen::VectorXd x, multipliers;  ///< the point
  double scale = 1;                ///< scale of forces there, by which multipliers are divided

  /// Distance of a solution from the point: unknowns, and multipliers divided by a scale of forces.
  [[nodiscard]] double distance(const SpanSolution& solution, double forces) const {
    return (solution.x - x).norm() + (solution.multipliers - multipliers).norm() / forces;
  }
};

/// Scale of forces. It includes the multipliers, as grips may pull harder than weight and loads.
[[nodiscard]] inline double scale_of_forces(const SpanSolution& solution, double load) {
  return 1 + load + solution.multipliers.norm();
}

/// Makes factors. Buffers are reused once nobody holds their factor any more.
class NewtonFactors {
 public:
  /// Factors the second variation of E - mu . c with the constraints at the solution, and stores
  /// the result in solution.factor.
  /// @param at    point of the model at solution.x
  /// @param load  weight plus loads
  void factor_at(SpanSolution& solution, SpanPoint& at, double load);

  /// Factors a Hessian that does not belong to a point of the model.
  [[nodiscard]] std::shared_ptr<NewtonFactor> factor(const Eigen::MatrixXd& hessian,
                                                     const Eigen::MatrixXd& jacobian, double scale);

 private:
  [[nodiscard]] std::shared_ptr<NewtonFactor> make(const Eigen::MatrixXd& jacobian, double scale);

  Pool<NewtonFactor> factors_;
  Eigen::MatrixXd hessian_;  // Hessian of the next factor
};

/// Returns an approximate Hessian of a model with more coefficients: the Hessian of the model with
/// fewer, and the identity for the new ones, where bending exceeds the effect of forces by the
/// square of the order.
[[nodiscard]] Eigen::MatrixXd prolonged(const Eigen::MatrixXd& hessian, const SpanEnergy& fewer,
                                        const SpanEnergy& model);

}  // namespace dlo::energy_model
