// Tests of the error bounds of thirteen answers by a third method, with which no answer was
// computed: extrapolation from chains of hinges with N, 2N and 4N points.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "dlo/compare/chain.hpp"
#include "dlo/compare/shape.hpp"
#include "suite/battery.hpp"
#include "suite/committed_answer.hpp"

namespace dlo::compare {
namespace {

/// Interpolates between the chain's own points by Lagrange's polynomial through the six nearest,
/// with an error far below that of the chain.
Eigen::Matrix3Xd interpolate(const Shape& chain, const std::vector<double>& at) {
  constexpr Eigen::Index nodes = 6;
  const auto count = static_cast<Eigen::Index>(chain.arc_length.size());
  Eigen::Matrix3Xd points = Eigen::Matrix3Xd::Zero(3, static_cast<Eigen::Index>(at.size()));
  for (std::size_t k = 0; k < at.size(); ++k) {
    const auto above = std::ranges::lower_bound(chain.arc_length, at[k]);
    const Eigen::Index first =
        std::clamp<Eigen::Index>((above - chain.arc_length.begin()) - nodes / 2, 0, count - nodes);
    for (Eigen::Index i = first; i < first + nodes; ++i) {
      double weight = 1;
      for (Eigen::Index j = first; j < first + nodes; ++j) {
        const double s = chain.arc_length[static_cast<std::size_t>(j)];
        if (j != i) weight *= (at[k] - s) / (chain.arc_length[static_cast<std::size_t>(i)] - s);
      }
      points.col(static_cast<Eigen::Index>(k)) += weight * chain.points.col(i);
    }
  }
  return points;
}

/// Returns the chain without its points at clamps. The segment at a clamp is straight, so that the
/// other points are off the rod by h^2 / 8 times the curvature, but not the point at the clamp.
Shape without_clamps(Shape chain, double h) {
  std::vector<double>& s = chain.arc_length;
  constexpr double shorter = 0.75;
  Eigen::Index first = 0;
  Eigen::Index count = chain.points.cols();
  if (s[1] - s[0] < shorter * h) {
    ++first;
    --count;
  }
  if (s[s.size() - 1] - s[s.size() - 2] < shorter * h) --count;
  chain.points = Eigen::Matrix3Xd(chain.points.middleCols(first, count));
  s = std::vector<double>(s.begin() + first, s.begin() + first + count);
  return chain;
}

struct Extrapolation {
  Eigen::Matrix3Xd points;
  double error = 0;  // largest change of a point by the last extrapolation [m]
};

/// Extrapolates three chains by Neville's scheme in h^2 to h = 0.
Extrapolation extrapolate_chains(Scene scene, const std::vector<double>& at) {
  std::array<Eigen::Matrix3Xd, 3> shapes;
  std::array<double, 3> squares{};
  int points = 40;
  // c_c is a thousand times the usual value, because the stretch of segments is not part of the
  // answers.
  scene.force_model.c_c = 1e9 * scene.bending_stiffness() / (scene.length * scene.length);
  for (std::size_t i = 0; i < shapes.size(); ++i, points *= 2) {
    scene.force_model.points = points;
    const Shape chain = solve_chain(scene, scene.force_model).shape;
    const double h = chain.arc_length[2] - chain.arc_length[1];
    shapes[i] = interpolate(without_clamps(chain, h), at);
    squares[i] = h * h;
  }
  const auto to_zero = [&](const Eigen::Matrix3Xd& a, double x, const Eigen::Matrix3Xd& b,
                           double y) { return Eigen::Matrix3Xd((x * b - y * a) / (x - y)); };
  const Eigen::Matrix3Xd first = to_zero(shapes[0], squares[0], shapes[1], squares[1]);
  const Eigen::Matrix3Xd second = to_zero(shapes[1], squares[1], shapes[2], squares[2]);
  Extrapolation third{to_zero(first, squares[0], second, squares[2])};
  third.error = (third.points - second).colwise().norm().maxCoeff();
  return third;
}

/// A scene, and the largest allowed error estimate of the third method, divided by the length.
struct Row {
  const char* id;
  double own_error;
};

class ThirdMethod : public testing::TestWithParam<Row> {};

TEST_P(ThirdMethod, IsWithinTheBoundOfTheAnswerAndItsOwnError) {
  const BatteryScene scene = chosen_scenes(builtin_battery(), {GetParam().id}).front();
  const json answer = committed_answer(GetParam().id);
  const auto s = answer["arc_length_m"].get<std::vector<double>>();
  const Extrapolation third = extrapolate_chains(scene.scene, s);
  double most = 0;
  for (std::size_t i = 0; i < s.size(); ++i) {
    const Eigen::Vector3d known = vector_of(answer["points_m"][i]);
    most = std::max(most, (third.points.col(static_cast<Eigen::Index>(i)) - known).norm());
  }
  const double length = scene.scene.length;
  constexpr double decimals = 2e-12;  // rounding of the written decimals
  EXPECT_LE(most, answer["points_bound_m"].get<double>() + 2 * third.error + decimals);
  EXPECT_LT(third.error, GetParam().own_error * length);
}

INSTANTIATE_TEST_SUITE_P(Answers, ThirdMethod,
                         testing::Values(Row{"bending_small", 1e-11}, Row{"bending_large", 1e-7},
                                         Row{"weight_1", 1e-9}, Row{"weight_10", 1e-7},
                                         Row{"weight_100", 1e-5}, Row{"end_last", 1e-6},
                                         Row{"payload_tip", 1e-6}, Row{"curved_arc", 1e-9},
                                         Row{"buckling_imperfect", 1e-7}, Row{"clamps_level", 1e-5},
                                         Row{"clamps_step", 1e-6}, Row{"clamps_space", 1e-6},
                                         Row{"force_across", 1e-7}),
                         [](const auto& row) { return std::string(row.param.id); });

}  // namespace
}  // namespace dlo::compare
