// Stiffness and damping from recordings that are made by the simulation, with noise: each is of
// another rod that two grippers, or one, carry another way, and begins in motion.

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

namespace dlo::compare {
namespace {

constexpr double marker_noise = 1e-3;  // of a coordinate [m]

/// A recording, and what it was made with.
struct Recording {
  Scene scene;  // of which the fit knows no EI
  double stiffness = 0;
  RodDamping damping;
  MarkerMotion motion;
};

Recording recording(unsigned seed) {
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
    for (const int pose : {0, 1, 2, 3, 4}) {
      text +=
          fmt::format("[[gripper.pose]]\ntime = {}\nposition = [{}, {}, {}]\n", 0.4 * pose,
                      0.75 * length * g + between(-0.03, 0.03), 0.15 * pose, between(-0.06, 0.06));
    }
  }
  result.scene = parse_scene(text, fmt::format("recorded_{}.toml", seed));
  std::vector<double> times;
  for (int k = 0; k <= 100; ++k) times.push_back(0.4 + 0.02 * k);
  const FrameClock clock(result.scene, {times.front(), times.back()}, {.frames = 50});
  const SimulatedMotion run = MovingScene(result.scene, clock, result.damping, {}).run(times, 14);
  EXPECT_EQ(run.moved.frames.size(), times.size());
  std::normal_distribution<double> noise(0, marker_noise);
  result.motion.file = fmt::format("recorded_{}.csv", seed);
  for (std::size_t k = 0; k < times.size(); ++k) {
    for (const double s : {0.1, 0.2, 0.3, 0.4, 0.5}) {
      Eigen::Vector3d at = run.moved.frames[k].sample(std::vector<double>{s}).points.col(0);
      for (double& coordinate : at) coordinate += noise(random);
      result.motion.positions.push_back({times[k], s, at});
    }
  }
  result.scene.scale_modulus(between(0.4, 2.5));
  return result;
}

/// What the fit is off, over what is right.
struct FitError {
  double stiffness = 0, material = 0, quadratic = 0;
  double misfit = 0;  // residual over the noise
  bool in_interval = false;
};

FitError error_of(const Recording& made, const MotionFit& fit) {
  const auto off = [](double value, double right) { return std::abs(value / right - 1); };
  return {off(fit.stiffness.value, made.stiffness),
          fit.material ? off(fit.material->value, made.damping.material) : 0,
          fit.quadratic ? off(fit.quadratic->value, made.damping.quadratic) : 0,
          fit.rms / (marker_noise * std::sqrt(3)),
          made.stiffness > fit.stiffness.low && made.stiffness < fit.stiffness.high};
}

TEST(MotionFit, FindsStiffnessAndDampingOfARecordedMotion) {
  for (const unsigned seed : {1U, 2U}) {
    if (test::sanitized && seed > 1) break;
    const Recording made = recording(seed);
    const MotionFit fit = fit_motion(made.scene, made.motion, {.air = false});
    EXPECT_TRUE(fit.in_motion);
    const FitError error = error_of(made, fit);
    EXPECT_LT(error.stiffness, 0.1) << seed;
    EXPECT_LT(error.material, 0.3) << seed;
    EXPECT_LT(error.quadratic, 0.3) << seed;
    EXPECT_LT(error.misfit, 1.1) << seed;
    EXPECT_NEAR(fit.noise, marker_noise, 0.1 * marker_noise) << seed;
    EXPECT_GT(fit.effective_coordinates, 0.3 * static_cast<double>(fit.coordinates)) << seed;
    EXPECT_GT(fit.given_rms, 2 * fit.rms) << seed;
  }
}

TEST(MotionFit, RefusesWhatIsNoRecordingOfTheRod) {
  const Recording made = recording(1);
  MarkerMotion beyond = made.motion;
  beyond.positions.front().arc_length = 0.7;
  EXPECT_THROW((void)fit_motion(made.scene, beyond, {}), InputError);
  MarkerMotion once = made.motion;
  once.positions.resize(2);
  EXPECT_THROW((void)fit_motion(made.scene, once, {}), InputError);
}

// All of them, for the page: --gtest_also_run_disabled_tests --gtest_filter=*AllRecordings
TEST(MotionFit, DISABLED_AllRecordings) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    const Recording made = recording(seed);
    const MotionFit fit = fit_motion(made.scene, made.motion, {.air = false});
    const FitError error = error_of(made, fit);
    fmt::print(
        "{:2} EI/m {:6.2f} % in {} tau {:6.1f} % q {:6.1f} % misfit {:.3f} eff {:.0f}/{} sims {}\n",
        seed, 100 * error.stiffness, error.in_interval, 100 * error.material, 100 * error.quadratic,
        error.misfit, fit.effective_coordinates, fit.coordinates, fit.simulations);
    std::fflush(stdout);
    EXPECT_LT(std::max({error.stiffness / 0.1, error.material / 0.3, error.quadratic / 0.3,
                        error.misfit / 1.1}),
              1);
  }
}

}  // namespace
}  // namespace dlo::compare
