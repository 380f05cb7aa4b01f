#pragma once

#include <Eigen/Core>
#include <memory>
#include <vector>

#include "base/pool.hpp"
#include "linear/newton_system.hpp"
#include "strain/span_solution.hpp"

namespace dlo::energy_model {

/// The linear system of Newton's method, factored at a point of a span's model.
/// SpanSolution::factor hands it on to whoever goes on from there; what is shared is not factored
/// anew.
struct NewtonFactor {
  NewtonSystem system;
  Eigen::VectorXd x, multipliers;  ///< the point
  double scale = 1;                ///< of forces there, by which multipliers are measured

  /// By which unknowns, and multipliers over a scale of forces, differ from those at the point.
  [[nodiscard]] double distance(const SpanSolution& solution, double forces) const {
    return (solution.x - x).norm() + (solution.multipliers - multipliers).norm() / forces;
  }
};

/// Scale of forces: grips may pull harder than weight and loads do.
[[nodiscard]] inline double scale_of_forces(const SpanSolution& solution, double load) {
  return 1 + load + solution.multipliers.norm();
}

/// Makes factors, in buffers that are used again once nobody holds a factor any more.
class NewtonFactors {
 public:
  /// Of the second variation of E - mu . c and the constraints at the solution, into
  /// solution.factor.
  /// @param at    of the model, at solution.x
  /// @param load  sum of weight and loads
  void factor_at(SpanSolution& solution, SpanPoint& at, double load);

  /// Of a Hessian that is none of the model at a point.
  [[nodiscard]] std::shared_ptr<NewtonFactor> factor(const Eigen::MatrixXd& hessian,
                                                     const Eigen::MatrixXd& jacobian, double scale);

 private:
  [[nodiscard]] std::shared_ptr<NewtonFactor> make(const Eigen::MatrixXd& jacobian, double scale);

  Pool<NewtonFactor> factors_;
  Eigen::MatrixXd hessian_;  // of the next one
};

/// The Hessian of a model with more terms, as that of fewer makes it: in the new terms bending
/// outweighs what forces add, with the square of the order.
[[nodiscard]] Eigen::MatrixXd prolonged(const Eigen::MatrixXd& hessian, const SpanEnergy& fewer,
                                        const SpanEnergy& model);

}  // namespace dlo::energy_model
