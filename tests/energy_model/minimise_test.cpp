#include "base/minimise.hpp"

#include <gtest/gtest.h>
#include <nlopt.h>

#include <functional>
#include <stdexcept>
#include <string>

#include "../says.hpp"
#include "solved.hpp"

namespace dlo::energy_model {
namespace {

/// A sum of fourth powers of the distances from 1 that throws at its third evaluation.
struct ThrowsAtThird {
  int calls = 0;

  double operator()(const Eigen::Ref<const Eigen::VectorXd>& x,
                    Eigen::Ref<Eigen::VectorXd> gradient) {
    if (++calls == 3) throw std::runtime_error("third evaluation");
    const Eigen::VectorXd off = x - Eigen::VectorXd::Ones(x.size());
    gradient = 4 * off.array().cube();
    return off.array().pow(4).sum();
  }
};

TEST(Minimise, ThrowsWhatTheObjectiveThrowsAndStops) {
  ThrowsAtThird objective;
  Eigen::VectorXd x = Eigen::VectorXd::Zero(3);
  EXPECT_EQ(test::error_of<std::runtime_error>([&] {
              return minimise_lbfgs(std::ref(objective), x, {1e-12, 100});
            }),
            "third evaluation");
  EXPECT_EQ(objective.calls, 3);
}

// Storing as many steps as there are unknowns would need more numbers than NLopt can count.
TEST(Minimise, OfManyUnknownsStoresAsManyStepsAsFit) {
  constexpr Eigen::Index unknowns = 50'000;
  const Eigen::VectorXd weights = Eigen::VectorXd::LinSpaced(unknowns, 1, 100);
  const auto parabola = [&](const Eigen::Ref<const Eigen::VectorXd>& x,
                            Eigen::Ref<Eigen::VectorXd> gradient) {
    gradient = weights.cwiseProduct(x);
    return x.dot(gradient) / 2;
  };
  Eigen::VectorXd x = Eigen::VectorXd::Ones(unknowns);
  (void)test::require_usable(minimise_lbfgs(parabola, x, {1e-6, 1000}));
  // The gradient's norm at the begin is 1.3e4.
  EXPECT_LT(weights.cwiseProduct(x).norm(), 1e-3);
}

TEST(Minimise, CallsNothingASuccessThatNLoptDoesNot) {
  for (const int code : {static_cast<int>(NLOPT_FAILURE), static_cast<int>(NLOPT_INVALID_ARGS),
                         static_cast<int>(NLOPT_OUT_OF_MEMORY), static_cast<int>(NLOPT_FORCED_STOP),
                         static_cast<int>(NLOPT_MAXEVAL_REACHED),
                         static_cast<int>(NLOPT_MAXTIME_REACHED), 0, -17, 99}) {
    const MinimiseResult result = translate_nlopt(code);
    EXPECT_FALSE(succeeded(result.status)) << code;
    EXPECT_NE(result.status, SolveStatus::not_run) << code;
  }
  EXPECT_EQ(translate_nlopt(NLOPT_MAXTIME_REACHED).status, SolveStatus::time_limit);
  EXPECT_EQ(translate_nlopt(NLOPT_MAXEVAL_REACHED).status, SolveStatus::evaluation_limit);
  EXPECT_NE(translate_nlopt(99).message.find("99"), std::string::npos);
  // After a failed line search the result may only be used as an initial guess for a method that
  // proves its result.
  EXPECT_TRUE(translate_nlopt(NLOPT_FAILURE).is_usable_start());
  EXPECT_FALSE(translate_nlopt(NLOPT_OUT_OF_MEMORY).is_usable_start());
  EXPECT_FALSE(translate_nlopt(99).is_usable_start());
}

}  // namespace
}  // namespace dlo::energy_model
