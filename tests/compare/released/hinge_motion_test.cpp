// Tests of released rods, by the energy model and as a chain of hinges, against closed forms.

#include "released/hinge_motion.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "../../says.hpp"
#include "dlo/compare/error.hpp"
#include "dlo/compare/scene_file.hpp"
#include "dlo/compare/shape.hpp"

namespace dlo::compare {
namespace {

ReleasedRod released(const std::string& id) {
  const std::string stem = std::string(DLO_DATA) + "/suite/scenes/" + id;
  return {load_scene(stem + ".toml"), load_scene(stem + "_begin.toml")};
}

/// First root of cos x cosh x = -1. Its mode, which is 1 at the tip, is first_mode().
constexpr double lambda = 1.8751040687119611;
double first_mode(double x) {
  const double ratio =
      (std::cosh(lambda) + std::cos(lambda)) / (std::sinh(lambda) + std::sin(lambda));
  return (std::cosh(lambda * x) - std::cos(lambda * x) -
          ratio * (std::sinh(lambda * x) - std::sin(lambda * x))) /
         2;
}

// w = a phi(s / l) cos(omega t), omega = lambda^2 (EI / m)^(1/2) / l^2. For a = 0.01 l nonlinear
// terms are of the relative order (a / l)^2, in the phase of two periods too.
TEST(ReleasedRod, VibratesInItsFirstModeAsTheClosedFormSays) {
  const ReleasedRod rod = released("motion_vibration");
  const double l = rod.scene.length;
  const double omega = lambda * lambda *
                       std::sqrt(rod.scene.bending_stiffness() / rod.scene.mass_per_length()) / l /
                       l;
  const std::vector<double> times = equal_arc_lengths(0.8, 17);
  const std::vector<double> s = equal_arc_lengths(l, 13);
  const ReleasedMotion moved = release_rod(rod, times, s, 10);
  const HingeLimit hinges = hinge_limit(rod, 12, times);
  const double amplitude = 0.01 * l;
  for (std::size_t k = 0; k < times.size(); ++k) {
    for (std::size_t i = 0; i < s.size(); ++i) {
      const double w = amplitude * first_mode(s[i] / l) * std::cos(omega * times[k]);
      const auto point = static_cast<Eigen::Index>(i);
      EXPECT_NEAR(moved.frames[k](1, point), w, 2e-3 * amplitude);
      EXPECT_NEAR(hinges.frames[k](1, point), w, 2e-3 * amplitude);
    }
  }
}

// Steps grow as N^2 and cost as N: of 4000 segments one frame would take hours.
TEST(HingeMotion, EndsAtItsTimeLimit) {
  EXPECT_TRUE(
      has_all(error_of<ConvergenceError>([] {
                return hinge_motion(released("motion_vibration"), 4000, {0, 1}, {.time_limit = 1});
              }),
              {"time limit of 1 s reached after 0 s of motion"}));
}

// Up to 0.3 s, in which the waves of the chain are those of the rod.
TEST(HingeMotion, ComesToTheRodAtSecondOrderInTheSegments) {
  const ReleasedRod rod = released("motion_release");
  const std::vector<double> times = equal_arc_lengths(0.3, 4);
  const ReleasedMotion moved = release_rod(rod, times, equal_arc_lengths(rod.scene.length, 17), 14);
  const auto error = [&](int factor) {
    std::vector<Eigen::Matrix3Xd> frames = hinge_motion(rod, 16 * factor, times);
    for (Eigen::Matrix3Xd& points : frames) {
      points = Eigen::Matrix3Xd(points(Eigen::all, Eigen::seqN(0, 17, factor)));
    }
    return largest_distance(frames, moved.frames);
  };
  const double coarse = error(1);
  EXPECT_NEAR(std::log2(coarse / error(2)), 2, 0.25);
  EXPECT_LT(coarse, 1e-2 * rod.scene.length);
}

TEST(HingeMotion, RefusesWhatItIsNotMadeFor) {
  ReleasedRod rod = released("motion_release");
  rod.scene.grippers.front().at = 0.1;
  EXPECT_THROW((void)hinge_motion(rod, 8, {0, 0.1}), InputError);
  rod = released("motion_release");
  rod.begin.length = 1;
  EXPECT_THROW((void)release_rod(rod, {0, 0.1}, {0, 0.5}, 8), InputError);
  rod = released("motion_release");
  rod.scene.obstacles.emplace_back();
  EXPECT_THROW((void)release_rod(rod, {0, 0.1}, {0, 0.5}, 8), InputError);
}

}  // namespace
}  // namespace dlo::compare
