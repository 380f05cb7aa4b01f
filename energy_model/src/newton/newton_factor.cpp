#include "newton/newton_factor.hpp"

#include <algorithm>
#include <cstddef>

namespace dlo::energy_model {
namespace {

/// Factors that are kept at the same time.
constexpr std::size_t most_kept_factors = 8;

}  // namespace

void NewtonFactors::factor_at(SpanSolution& solution, const Eigen::MatrixXd& jacobian,
                              double load) {
  solution.model->hessian(solution.multipliers, hessian_);
  solution.factor.reset();
  solution.factor = factor(hessian_, jacobian, scale_of_forces(solution, load));
  solution.factor->x = solution.x;
  solution.factor->multipliers = solution.multipliers;
}

std::shared_ptr<NewtonFactor> NewtonFactors::factor(const Eigen::MatrixXd& hessian,
                                                    const Eigen::MatrixXd& jacobian, double scale) {
  std::shared_ptr<NewtonFactor> result = take();
  result->system.compute(hessian, jacobian);
  result->scale = scale;
  return result;
}

std::shared_ptr<NewtonFactor> NewtonFactors::take() {
  const auto unused = std::find_if(factors_.begin(), factors_.end(),
                                   [](const auto& factor) { return factor.use_count() == 1; });
  if (unused != factors_.end()) return *unused;
  std::shared_ptr<NewtonFactor> another = std::make_shared<NewtonFactor>();
  if (factors_.size() < most_kept_factors) factors_.push_back(another);
  return another;
}

Eigen::MatrixXd prolonged(const Eigen::MatrixXd& hessian, const SpanEnergy& fewer,
                          const SpanEnergy& model) {
  const std::vector<Eigen::Index> places = model.places_of(fewer);
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
