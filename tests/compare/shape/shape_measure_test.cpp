// Tests of the sensitivity of a check: any change of a correct shape must appear in its deviation,
// or be reported.

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "../../says.hpp"
#include "dlo/compare/alignment.hpp"
#include "dlo/compare/comparison.hpp"
#include "dlo/compare/deviation.hpp"
#include "dlo/compare/reference.hpp"
#include "dlo/compare/shape_check.hpp"
#include "dlo/compare/shape_verdict.hpp"
#include "dlo/compare/solution.hpp"
#include "measured_shapes.hpp"
#include "scenes.hpp"

namespace dlo::compare {
namespace {

/// A random rod and its right shape.
struct RandomRod {
  Scene scene;
  energy_model::Equilibrium rod;
  std::vector<double> s;

  explicit RandomRod(std::mt19937& random) {
    std::uniform_real_distribution<double> degrees(-170, 170);
    std::uniform_real_distribution<double> exponent(-0.3, 1.3);
    const double pitch = degrees(random);
    scene = heavy_scene(std::pow(10, exponent(random)), pitch);
    rod = solve_reference(scene, Model::energy);
    s = equal_arc_lengths(1, 21);
  }

  /// Returns points of the rod, which is extended straight beyond its tip.
  [[nodiscard]] Eigen::Matrix3Xd points(std::vector<double> at) const {
    std::vector<double> past;
    for (double& a : at) {
      past.push_back(std::max(0.0, a - 1));
      a = std::min(a, 1.0);
    }
    const energy_model::Samples samples = rod.sample(at);
    Eigen::Matrix3Xd result = samples.points;
    for (std::size_t i = 0; i < at.size(); ++i) {
      const auto column = static_cast<Eigen::Index>(i);
      result.col(column) += past[i] * samples.tangents.col(column);
    }
    return result;
  }

  [[nodiscard]] ShapeCheck check(const Eigen::Matrix3Xd& shape, bool column_s) const {
    return check_shape(scene, {"f", shape, column_s ? s : std::vector<double>()},
                       {.modulus = ModulusSearch::no});
  }
};

/// Difference in length between 20 chords and their arcs: the sum of k^2 h^3 / 24, for Gamma = 20
/// with its boundary layer of length Gamma^(-1/2) and curvature Gamma^(1/2) at the clamp.
constexpr double arc_chord_difference = 20.0 / 24 * 0.05 * 0.05 * 0.25;

/// Whether it passes as the whole rod, with RMS and largest deviation compared with the same
/// length.
bool passes(const ShapeCheck& check, double allowed_m) {
  return judge(check, {.allowed_m = allowed_m}).passes() &&
         judge(check, {.allowed_m = allowed_m, .largest = true}).passes();
}

class AnyRightShape : public testing::TestWithParam<bool> {
 protected:
  void for_each(const std::function<void(const RandomRod&)>& claim) {
    for (int draw = 0; draw < 4; ++draw) {
      const RandomRod right(random_);
      SCOPED_TRACE(testing::Message() << "Gamma = " << right.scene.gamma());
      claim(right);
    }
  }
  [[nodiscard]] static bool column_s() { return GetParam(); }
  std::mt19937 random_{7};
};

INSTANTIATE_TEST_SUITE_P(ArcLengths, AnyRightShape, testing::Bool(), [](const auto& instance) {
  return std::string(instance.param ? "given" : "nearest");
});

TEST_P(AnyRightShape, Passes) {
  for_each([](const RandomRod& right) {
    const ShapeCheck check = right.check(right.points(right.s), column_s());
    EXPECT_LT(check.whole_rod_max_m, 1e-7);
    EXPECT_TRUE(passes(check, 1e-4)) << judge(check, {.allowed_m = 1e-4}).reason;
    EXPECT_EQ(check.hint, "");
  });
}

TEST_P(AnyRightShape, NoPointMovesUnseen) {
  constexpr double d = 0.02;
  for_each([=](const RandomRod& right) {
    const Eigen::Matrix3Xd tangents = right.rod.sample(right.s).tangents;
    for (Eigen::Index i = 0; i < 21; ++i) {
      const Eigen::Vector3d t = tangents.col(i);
      for (const Eigen::Vector3d& way :
           {Eigen::Vector3d(-t.y(), t.x(), 0), Eigen::Vector3d(0, 0, 1)}) {
        Eigen::Matrix3Xd points = right.points(right.s);
        points.col(i) += d * way;
        const ShapeCheck check = right.check(points, column_s());
        // The weight of the point: half of each adjacent segment.
        const double share = (i == 0 || i == 20 ? 0.5 : 1) / 20;
        EXPECT_GT(check.deviation.rms_m, 0.8 * d * std::sqrt(share)) << i;
        EXPECT_LT(check.deviation.rms_m, 1.5 * d * std::sqrt(share)) << i;
        EXPECT_GT(check.deviation.max_m, 0.8 * d) << i;
        EXPECT_EQ(check.worst_point, i + 1);
      }
    }
  });
}

TEST_P(AnyRightShape, DoublePointsDiluteNothing) {
  for_each([](const RandomRod& right) {
    Eigen::Matrix3Xd points = right.points(right.s);
    points.col(11).z() += 0.02;
    const double before = right.check(points, column_s()).deviation.rms_m;
    // Each of the first ten points is given a hundred times, 1e-8 apart.
    RandomRod many = right;
    std::vector<double> s;
    for (std::size_t i = 0; i < right.s.size(); ++i) {
      for (int k = 0; k < (i < 10 ? 100 : 1); ++k) s.push_back(right.s[i] + 1e-8 * k);
    }
    many.s = s;
    Eigen::Matrix3Xd crowded = many.points(s);
    crowded.col(crowded.cols() - 10).z() += 0.02;
    EXPECT_NEAR(many.check(crowded, column_s()).deviation.rms_m, before, 0.02 * before);
  });
}

// A spike at one point of the rod counts, however many points form it.
TEST_P(AnyRightShape, ASpikeCounts) {
  for_each([](const RandomRod& right) {
    RandomRod spiked = right;
    std::vector<double> s;
    for (std::size_t i = 0; i < right.s.size(); ++i) {
      for (int k = 0; k < (i == 10 ? 9 : 1); ++k) s.push_back(right.s[i] + 1e-7 * k);
    }
    spiked.s = s;
    Eigen::Matrix3Xd points = spiked.points(s);
    for (Eigen::Index k = 0; k < 9; ++k) points.col(10 + k).z() += 0.05 * (4 - std::abs(k - 4.0));
    const ShapeCheck check = spiked.check(points, column_s());
    EXPECT_NEAR(check.deviation.max_m, 0.2, 0.01);
    // 0.4 of 1.4 m, on average a third of the square of 0.2 m
    EXPECT_GT(check.deviation.rms_m, 0.9 * 0.2 * std::sqrt(0.4 / 1.4 / 3));
  });
}

TEST_P(AnyRightShape, AStretchedPartShows) {
  std::uniform_real_distribution<double> from(0, 0.6);
  for_each([&](const RandomRod& right) {
    const double a = from(random_);
    const double b = a + 0.3;
    std::vector<double> at = right.s;
    for (double& s : at) s += 0.1 * (std::clamp(s, a, b) - a);
    const ShapeCheck check = right.check(right.points(at), column_s());
    EXPECT_NEAR(check.deviation.max_m, 0.03, 0.003);
    EXPECT_NEAR(check.deviation.tip_m, 0.03, 1e-6);
    // With given arc lengths the displacement grows over the stretched part and remains constant
    // beyond it. Without them it is spread over the rod.
    const double share = column_s() ? 1 - b + (b - a) / 3 : 1.0 / 3;
    EXPECT_NEAR(check.deviation.rms_m, 0.03 * std::sqrt(share), column_s() ? 5e-4 : 4e-3);
    EXPECT_FALSE(passes(check, 0.01));
    if (!column_s()) {
      EXPECT_NEAR(check.length_beyond_ends_m, 0.03, arc_chord_difference);
      EXPECT_TRUE(has_all(check.hint, {"stretched by 3"}));
    }
  });
}

TEST_P(AnyRightShape, ACutFileIsNamed) {
  for_each([](const RandomRod& right) {
    for (const Eigen::Index kept : {20, 18, 15, 11, 6}) {
      RandomRod cut = right;
      cut.s.resize(static_cast<std::size_t>(kept));
      const ShapeCheck check = cut.check(right.points(right.s).leftCols(kept), column_s());
      const double seen = static_cast<double>(kept - 1) / 20;
      const Eigen::Matrix3Xd ends = right.points({seen, 1});
      EXPECT_LT(check.deviation.max_m, 1e-7);
      EXPECT_NEAR(check.whole_rod_max_m, (ends.col(1) - ends.col(0)).norm(), 1e-3);
      // The distance of the rod from the outermost point is at most the length of the missing part,
      // and close to it.
      EXPECT_LE(check.whole_rod_rms_m, (1 + 1e-4) * std::sqrt(std::pow(1 - seen, 3) / 3));
      EXPECT_GT(check.whole_rod_rms_m, 0.5 * std::sqrt(std::pow(1 - seen, 3) / 3));
      const ShapeJudgement whole = judge(check, {.allowed_m = 0.0015});
      EXPECT_FALSE(whole.passes()) << kept;
      EXPECT_TRUE(has_all(whole.reason, {"to 1 m, which the file does not have"}));
      const ShapeJudgement part =
          judge(check, {.allowed_m = 0.0015, .least_observed_share = 0.2, .part = true});
      EXPECT_TRUE(part.passes()) << part.reason;
      EXPECT_TRUE(has_all(part.reason, {"not judged: s = "}));
    }
  });
}

TEST_P(AnyRightShape, PartsThatThePointsDoNotDetermineAreNamed) {
  RandomRod right(random_);
  right.scene = heavy_scene(10, 0);
  right.rod = solve_reference(right.scene, Model::energy);
  right.s = {0, 0.01, 0.02, 1};
  const ShapeCheck check = right.check(right.points(right.s), column_s());
  EXPECT_LT(check.whole_rod_max_m, 1e-7);
  const ShapeJudgement judgement = judge(check, {.allowed_m = 0.01});
  EXPECT_EQ(judgement.verdict, ShapeVerdict::undetermined);
  EXPECT_TRUE(has_all(judgement.reason, {"do not determine the rod at s = 0.02 to 1 m",
                                         "only 2 % of the rod is observed"}));
  EXPECT_FALSE(
      judge(check, {.allowed_m = 0.01, .least_observed_share = 0.1, .part = true}).passes());
  EXPECT_TRUE(
      judge(check, {.allowed_m = 0.01, .least_observed_share = 0.01, .part = true}).passes());
}

TEST(ShapeMeasure, PointsPastTheTipCount) {
  std::mt19937 random(3);
  for (int draw = 0; draw < 4; ++draw) {
    const RandomRod right(random);
    const energy_model::Samples tip = right.rod.sample(std::vector<double>{1});
    const Eigen::Vector3d t = tip.tangents.col(0);
    for (const Eigen::Vector3d& way :
         {t, Eigen::Vector3d(-t.y(), t.x(), 0), Eigen::Vector3d(0, 0, 1)}) {
      Eigen::Matrix3Xd points = right.points(right.s);
      points.conservativeResize(3, 22);
      points.col(21) = points.col(20) + 0.1 * way;
      const ShapeCheck check = right.check(points, false);
      EXPECT_NEAR(check.length_beyond_ends_m, 0.1, arc_chord_difference);
      EXPECT_NEAR(check.deviation.max_m, 0.1, 1e-6);
      EXPECT_NEAR(check.deviation.tip_m, 0.1, 1e-6);
      EXPECT_EQ(check.worst_point, 22);
      // If the excess length is spread evenly, the deviation at s is 0.1 s.
      EXPECT_GT(check.deviation.rms_m, 0.05);
      EXPECT_TRUE(has_all(check.hint, {way == t ? "stretched by 10 %" : "do not continue"}));
    }
  }
}

// A polyline several times as long as the rod is noise, not excess.
TEST(ShapeMeasure, DenseNoiseIsNoExcess) {
  std::mt19937 random(5);
  RandomRod right(random);
  right.s = equal_arc_lengths(1, 1001);
  const ShapeCheck check =
      right.check(test::with_noise(right.points(right.s), 2e-3, random), false);
  EXPECT_GT(check.polyline_length_m, 3);
  EXPECT_LT(check.length_beyond_ends_m, 0.015);
  EXPECT_LT(check.deviation.rms_m, 2e-3 * std::sqrt(3.0) * 1.5);
  EXPECT_TRUE(judge(check, {.allowed_m = 0.01}).passes())
      << judge(check, {.allowed_m = 0.01}).reason;
}

/// Returns a check without any deviation, of which only the observed fraction varies.
ShapeCheck check_with_observed_share(double share) {
  ShapeCheck check;
  check.length_m = 1;
  check.observed_share = share;
  check.reference.arc_length = {0, share};
  return check;
}

TEST(ShapeJudgement, LessThanHalfOfTheRodIsNeverAPass) {
  EXPECT_TRUE(judge(check_with_observed_share(0.501), {.allowed_m = 0.01}).passes());
  EXPECT_FALSE(judge(check_with_observed_share(0.499), {.allowed_m = 0.01}).passes());
  EXPECT_TRUE(judge(check_with_observed_share(0.501), {.allowed_m = 0.01, .part = true}).passes());
  const ShapeJudgement less =
      judge(check_with_observed_share(0.499), {.allowed_m = 0.01, .part = true});
  EXPECT_EQ(less.verdict, ShapeVerdict::undetermined);
  EXPECT_TRUE(has_all(less.reason, {"only 49.9 % of the rod is observed, 50 % is required"}));
}

TEST(ShapeJudgement, HoldsWhatIsMissingAgainstTheWholeRodOnly) {
  ShapeCheck check = check_with_observed_share(0.9);
  check.deviation.rms_m = 0.001;
  check.deviation.max_m = 0.002;
  check.whole_rod_rms_m = 0.02;
  check.whole_rod_max_m = 0.1;
  EXPECT_EQ(judge(check, {.allowed_m = 0.01}).judged_m, 0.02);
  EXPECT_EQ(judge(check, {.allowed_m = 0.01}).verdict, ShapeVerdict::fail);
  EXPECT_TRUE(judge(check, {.allowed_m = 0.03}).passes());
  EXPECT_FALSE(judge(check, {.allowed_m = 0.03, .largest = true}).passes());
  EXPECT_EQ(judge(check, {.allowed_m = 0.01, .part = true}).judged_m, 0.001);
  EXPECT_TRUE(judge(check, {.allowed_m = 0.01, .part = true}).passes());
  EXPECT_FALSE(judge(check, {.allowed_m = 0.001, .largest = true, .part = true}).passes());
}

}  // namespace
}  // namespace dlo::compare
