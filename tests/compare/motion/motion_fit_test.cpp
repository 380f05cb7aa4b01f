// Tests of stiffness and damping fitted to recordings, which are simulations with added noise. Each
// recording has another rod, one or two grippers and another path. The rod moves at its beginning,
// so that its first shape is no equilibrium.

#include "recording/motion_fit.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "../../sanitized.hpp"
#include "dlo/compare/error.hpp"
#include "dlo/compare/scene_file.hpp"
#include "motion/moving_scene.hpp"

namespace dlo::compare {
namespace {

constexpr double marker_noise = 1e-3;  // standard deviation of a coordinate [m]

/// Recording with the parameters of its simulation.
struct Recording {
  Scene scene;           // scene whose EI the fit does not know
  double stiffness = 0;  // EI divided by the mass per length [m^4/s^2]
  RodDamping damping;
  MarkerMotion motion;
};

/// Returns a recording of `seconds` seconds, in which one or two grippers swing the rod from the
/// time 0. The recording begins at 0.8 s.
Recording recording(unsigned seed, double seconds, double rate) {
  std::mt19937 random(seed);
  const auto between = [&](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
  };
  constexpr double length = 0.6;
  constexpr double mass_per_length = 0.05;
  const double gamma = std::exp(between(std::log(2), std::log(20)));
  const double stiffness = mass_per_length * 9.81 * std::pow(length, 3) / gamma;
  const double time = std::sqrt(gamma * length / 9.81);
  Recording result;
  result.stiffness = stiffness / mass_per_length;
  result.damping = {.material = time * between(0.01, 0.03), .quadratic = between(0.02, 0.08)};
  std::string text = fmt::format(
      "gravity = [0, 0, -9.81]\n[rod]\nlength = {}\nbending_stiffness = {}\nmass_per_length = {}\n",
      length, stiffness, mass_per_length);
  const int grippers = seed % 2 == 0 ? 2 : 1;
  for (int g = 0; g < grippers; ++g) {
    text += fmt::format("[[gripper]]\nat = {}\ndirection = [1, 0, 0]\n", g * length);
    for (int pose = 0; 0.4 * pose < seconds + 1.2; ++pose) {
      text += fmt::format("[[gripper.pose]]\ntime = {}\nposition = [{}, {}, {}]\n", 0.4 * pose,
                          0.75 * length * g + between(-0.05, 0.05), 0.12 * (pose % 2),
                          between(-0.1, 0.1));
    }
  }
  result.scene = parse_scene(text, fmt::format("recorded_{}.toml", seed));

  constexpr double begin = 0.8;
  std::vector<double> times{0};
  for (int k = 0; k <= seconds * rate + 0.5; ++k) times.push_back(begin + k / rate);
  const FrameClock clock(result.scene, {times.front(), times.back()}, {.frame_rate = rate});
  const SimulatedMotion run = MovingScene(result.scene, clock, result.damping, {}).run(times, 14);
  EXPECT_EQ(run.moved.frames.size(), times.size());
  std::normal_distribution<double> noise(0, marker_noise);
  result.motion.file = fmt::format("recorded_{}.csv", seed);
  std::vector<double> s;
  for (int marker = 1; marker <= 12; ++marker) s.push_back(length * marker / 12.5);

  for (std::size_t k = 1; k < times.size(); ++k) {
    Eigen::Matrix3Xd at = run.moved.frames[k].sample(s).points;
    for (double& coordinate : at.reshaped()) coordinate += noise(random);
    for (std::size_t i = 0; i < s.size(); ++i) {
      result.motion.positions.push_back({times[k], s[i], at.col(static_cast<Eigen::Index>(i))});
    }
  }
  result.scene.scale_modulus(between(0.4, 2.5));
  return result;
}

TEST(MotionFit, FindsStiffnessAndDampingOfARodThatMovesAtFirst) {
  for (const unsigned seed : {1U, 2U}) {
    if (test::sanitized && seed > 1) break;
    const Recording made = recording(seed, 1.5, 50);
    const MotionFit fit = fit_motion(made.scene, {made.motion}, {.air = false});
    EXPECT_TRUE(fit.recordings.front().starts_as_recorded);
    EXPECT_EQ(fit.not_identified, "");
    const auto off = [](double value, double right) { return std::abs(value / right - 1); };
    EXPECT_LT(off(fit.stiffness.value, made.stiffness), 0.1) << seed;
    ASSERT_TRUE(fit.material && fit.quadratic) << seed;
    EXPECT_LT(off(fit.material->value, made.damping.material), 0.3) << seed;
    EXPECT_LT(off(fit.quadratic->value, made.damping.quadratic), 0.3) << seed;
    EXPECT_LT(fit.rms / (marker_noise * std::sqrt(3)), 1.1) << seed;
    EXPECT_NEAR(fit.noise, marker_noise, 0.1 * marker_noise) << seed;
    // With the stiffness as given in the scene the misfit exceeds its limit.
    EXPECT_GT(fit.given_rms, 1.1 * std::sqrt(3) * marker_noise) << seed;
  }
}

TEST(MotionFit, RefusesWhatIsNoRecordingOfTheRod) {
  const Recording made = recording(1, 0.2, 50);
  MarkerMotion beyond = made.motion;
  beyond.positions.front().arc_length = 0.7;
  EXPECT_THROW((void)fit_motion(made.scene, {beyond}, {}), InputError);
  MarkerMotion once = made.motion;
  once.positions.resize(2);
  EXPECT_THROW((void)fit_motion(made.scene, {once}, {}), InputError);
}

}  // namespace
}  // namespace dlo::compare
