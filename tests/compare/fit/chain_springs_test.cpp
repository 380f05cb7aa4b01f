#include "fit/chain_springs.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <numeric>
#include <vector>

#include "dlo/compare/error.hpp"
#include "dlo/compare/reference.hpp"
#include "rolled_chain.hpp"
#include "scenes.hpp"

namespace dlo::compare {
namespace {

std::map<ChainClamp, ChainSprings> springs_of(const Scene& scene, int segments) {
  std::map<ChainClamp, ChainSprings> result;
  for (const ChainSprings& chain : chain_springs(scene, segments, {})) result[chain.clamp] = chain;
  return result;
}

// Small deflection under a load F at the tip. A point of the rod moves down by F (3 l s^2 - s^3) /
// (6 EI). Point j of a chain moves down by the sum over the joints i before it of F (n - i) h / k
// times (j - i) h.
TEST(ChainSprings, OfAStiffRodWithALoadAtItsTipTheyAreThoseOfBeamTheory) {
  Scene scene = test::heavy_scene(1e-9, 0);
  scene.loads = {{.at = 1, .force = {0, -0.001 * scene.bending_stiffness(), 0}}};
  for (const int n : {10, 20, 40}) {
    double product = 0;
    double square = 0;
    for (int j = 0; j <= n; ++j) {
      const double s = static_cast<double>(j) / n;
      const double rod = (3 * s * s - s * s * s) / 6;
      double chain = 0;
      for (int i = 0; i < j; ++i) chain += (n - i) * (j - i) / std::pow(n, 3);
      product += rod * chain;
      square += chain * chain;
    }
    const ChainSprings hinge = springs_of(scene, n).at(ChainClamp::hinge);
    // The search ends at steps of 1e-4.
    EXPECT_NEAR(hinge.stiffness_ratio, square / product, 1e-4) << n;
    EXPECT_NEAR(hinge.segment_length, 1.0 / n, 1e-15);
    EXPECT_NEAR(hinge.stiffness, hinge.stiffness_ratio * scene.bending_stiffness() * n, 1e-12);
  }
}

// A hinge at the clamp is too soft and a welded segment is too stiff, both with first order in h. A
// clamp in the middle of a segment has second order.
TEST(ChainSprings, TheOrderInTheSegmentIsThatOfTheClamp) {
  const Scene scene = test::heavy_scene(8, 20);
  const auto coarse = springs_of(scene, 16);
  const auto fine = springs_of(scene, 64);
  ASSERT_EQ(coarse.size(), 3);
  const auto excess = [](const auto& chains, ChainClamp clamp) {
    return chains.at(clamp).stiffness_ratio - 1;
  };
  EXPECT_GT(excess(fine, ChainClamp::hinge), 0);
  EXPECT_LT(excess(fine, ChainClamp::welded), 0);
  for (const ChainClamp clamp : {ChainClamp::hinge, ChainClamp::welded}) {
    const double ratio = excess(coarse, clamp) / excess(fine, clamp);
    EXPECT_NEAR(std::log2(ratio) / 2, 1, 0.2) << to_string(clamp);
    EXPECT_NEAR(std::log2(coarse.at(clamp).rms_m / fine.at(clamp).rms_m) / 2, 1, 0.3);
  }
  EXPECT_NEAR(
      std::log2(std::abs(excess(coarse, ChainClamp::middle) / excess(fine, ChainClamp::middle))) /
          2,
      2, 0.4);
  EXPECT_LT(fine.at(ChainClamp::middle).rms_m, 0.1 * fine.at(ChainClamp::hinge).rms_m);
}

const std::vector<double>& unequal_lengths() {
  static const std::vector<double> lengths = {0.08, 0.11, 0.05, 0.09, 0.12, 0.04,
                                              0.13, 0.1,  0.07, 0.06, 0.15};
  return lengths;
}

// In another solver of chains the printed springs leave the reported error within 20 %. With 0.9
// and 1.1 times these springs the error is more than 1.2 times as large.
TEST(ChainSprings, OfUnequalSegmentsTheyBringAnotherSolversChainToTheRod) {
  const Scene scene = test::heavy_scene(12, 0);
  const std::vector<double>& lengths = unequal_lengths();
  const auto n = static_cast<Eigen::Index>(lengths.size());
  const Eigen::VectorXd h = Eigen::Map<const Eigen::VectorXd>(lengths.data(), n);
  const double w = scene.weight_per_length().norm();
  Eigen::Matrix2Xd forces = Eigen::Matrix2Xd::Zero(2, n + 1);
  forces.row(1).head(n) -= w * h.transpose() / 2;
  forces.row(1).tail(n) -= w * h.transpose() / 2;
  const std::vector<ChainSprings> chains = chain_springs(scene, lengths, {});
  ASSERT_EQ(chains[1].clamp, ChainClamp::welded);
  const auto far = [&](auto spring, const auto& moment, double factor) {
    Eigen::VectorXd springs(n - 1);
    for (Eigen::Index i = 0; i + 1 < n; ++i) {
      springs[i] = factor * spring(chains[1].joints[static_cast<std::size_t>(i)]);
    }
    const Eigen::Matrix3Xd points = test::chain_at_rest(h, springs, forces, moment);
    std::vector<double> s(lengths.size() + 1, 0.0);
    std::partial_sum(lengths.begin(), lengths.end(), s.begin() + 1);
    // The rod is sampled at the arc lengths of the chain's points; chord and arc differ by the
    // curvature only.
    const Eigen::Matrix3Xd rod = solve_reference(scene, Model::energy).sample(s).points;
    return (points - rod).norm() / std::sqrt(static_cast<double>(n + 1));
  };
  const auto linear = [](const ChainJoint& joint) { return joint.stiffness; };
  const auto binormal = [](const ChainJoint& joint) { return joint.binormal_stiffness; };
  const double own = far(linear, test::linear_moment, 1);
  EXPECT_NEAR(own / chains[1].rms_m, 1, 0.2);
  EXPECT_NEAR(far(binormal, test::binormal_moment, 1) / own, 1, 0.2);
  for (const double factor : {0.9, 1.1}) {
    EXPECT_GT(far(linear, test::linear_moment, factor), 1.2 * own) << factor;
  }
}

// A first segment of half length is treated as the half of a segment that a clamp holds in its
// middle.
TEST(ChainSprings, OfUnequalSegmentsAHalfAtTheClampIsHeldInTheMiddle) {
  const Scene scene = test::heavy_scene(2, 0);
  std::vector<double> lengths = unequal_lengths();
  lengths[0] = lengths[1] / 2;
  lengths[10] += 0.025;
  const std::vector<ChainSprings> chains = chain_springs(scene, lengths, {});
  ASSERT_EQ(chains.size(), 3);
  const ChainSprings& middle = chains[2];
  ASSERT_EQ(middle.clamp, ChainClamp::middle);
  ASSERT_EQ(middle.joints.size(), 10);
  const double EI = middle.stiffness_ratio * scene.bending_stiffness();
  EXPECT_NEAR(middle.joints[0].stiffness * lengths[1] / EI, 1, 1e-3);
  EXPECT_NEAR(middle.joints[1].stiffness * (lengths[1] + lengths[2]) / 2 / EI, 1, 1e-3);
}

TEST(ChainSprings, OfSegmentsOfAnotherRodThereAreNone) {
  const Scene scene = test::heavy_scene(5, 0);
  for (const std::vector<double>& wrong :
       {std::vector<double>(3, 1.0 / 3), std::vector<double>(201, 1.0 / 201),
        std::vector<double>(10, 0.2), std::vector<double>{0.5, 0, 0.25, 0.25},
        std::vector<double>{}}) {
    EXPECT_THROW((void)chain_springs(scene, wrong, {}), InputError) << wrong.size();
  }
}

// For a rope with large angles each law needs another stiffness. It is smaller the faster the
// moment grows: that of discrete elastic rods is a (1 + a^2/3), compared with a.
TEST(ChainSprings, OfASoftRopeEachLawHasItsOwnStiffness) {
  const Scene rope = test::heavy_scene(200, 0);
  const auto chains = springs_of(rope, 20);
  for (const auto& [clamp, chain] : chains) {
    EXPECT_LT(chain.binormal_stiffness, 0.97 * chain.stiffness) << to_string(clamp);
  }
  const auto stiff = springs_of(test::heavy_scene(0.1, 0), 20);
  for (const auto& [clamp, chain] : stiff) {
    EXPECT_NEAR(chain.binormal_stiffness / chain.stiffness, 1, 1e-3) << to_string(clamp);
  }
}

// A plain chain does not model natural curvature.
TEST(ChainSprings, ARodThatIsNoPlainChainHasNone) {
  Scene scene = test::heavy_scene(5, 0);
  scene.natural_strain.y() = 1;
  EXPECT_TRUE(chain_springs(scene, 20, {}).empty());
}

}  // namespace
}  // namespace dlo::compare
