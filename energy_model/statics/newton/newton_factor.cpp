#include "newton/newton_factor.hpp"

#include <cstddef>

namespace dlo::energy_model {
void NewtonFactors::factor_at(SpanSolution& solution, SpanPoint& at, double load) {
  solution.factor.reset();
  solution.model->hessian(at, solution.multipliers, hessian_);
  solution.factor = make(at.jacobian, scale_of_forces(solution, load));
  solution.factor->x = solution.x;
  solution.factor->multipliers = solution.multipliers;
}

std::shared_ptr<NewtonFactor> NewtonFactors::factor(const Eigen::MatrixXd& hessian,
                                                    const Eigen::MatrixXd& jacobian, double scale) {
  hessian_ = hessian;
  return make(jacobian, scale);
}

/// Factors hessian_, in buffers of the same size if there are some.
std::shared_ptr<NewtonFactor> NewtonFactors::make(const Eigen::MatrixXd& jacobian, double scale) {
  std::shared_ptr<NewtonFactor> result = factors_.take([&](const NewtonFactor& kept) {
    return kept.system.is_of(hessian_.rows(), jacobian.rows());
  });
  result->system.compute(hessian_, jacobian);
  result->scale = scale;
  return result;
}

Eigen::MatrixXd prolonged(const Eigen::MatrixXd& hessian, const SpanEnergy& fewer,
                          const SpanEnergy& model) {
  const std::vector<Eigen::Index> places = model.unknowns().places_of(fewer.unknowns());
  Eigen::MatrixXd result = Eigen::MatrixXd::Identity(model.size(), model.size());
  for (std::size_t j = 0; j < places.size(); ++j) {
    for (std::size_t i = 0; i < places.size(); ++i) {
      result(places[i], places[j]) =
          hessian(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j));
    }
  }
  return result;
}

}  // namespace dlo::energy_model
