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
  solution.factor.reset();
  solution.model->hessian(solution.multipliers, hessian_);
  solution.factor = make(jacobian, scale_of_forces(solution, load));
  solution.factor->x = solution.x;
  solution.factor->multipliers = solution.multipliers;
}

std::shared_ptr<NewtonFactor> NewtonFactors::factor(const Eigen::MatrixXd& hessian,
                                                    const Eigen::MatrixXd& jacobian, double scale) {
  hessian_ = hessian;
  return make(jacobian, scale);
}

/// Of hessian_, in buffers that fit if there are some.
std::shared_ptr<NewtonFactor> NewtonFactors::make(const Eigen::MatrixXd& jacobian, double scale) {
  const auto is_unused = [](const auto& factor) { return factor.use_count() == 1; };
  auto unused = std::find_if(factors_.begin(), factors_.end(), [&](const auto& factor) {
    return is_unused(factor) && factor->system.is_of(hessian_.rows(), jacobian.rows());
  });
  if (unused == factors_.end()) unused = std::find_if(factors_.begin(), factors_.end(), is_unused);
  const bool any = unused != factors_.end();
  std::shared_ptr<NewtonFactor> result = any ? *unused : std::make_shared<NewtonFactor>();
  if (!any && factors_.size() < most_kept_factors) factors_.push_back(result);
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
