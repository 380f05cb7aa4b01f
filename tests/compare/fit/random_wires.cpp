// Whether calibrate predicts wires as they are, by itself: random wires between two clamps, hung
// five times each in one fixture that nobody knows well.
//
//     dlo_random_wires WIRES SEED
//     dlo_random_wires --write FOLDER SEED
//
// Of each wire: what was chosen, the prediction over how well the mountings repeat, and whether the
// interval of EI holds the truth. The shares come last. Or one wire's mountings are written, one
// more than are fitted (data/mountings is of seed 11).

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <cmath>
#include <cstdlib>
#include <exception>
#include <fstream>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "../measured_shapes.hpp"
#include "dlo/compare/error.hpp"
#include "dlo/compare/material_fit.hpp"
#include "dlo/energy_model/energy.hpp"
#include "polygon/energy_problems.hpp"

namespace {

using namespace dlo::compare;

constexpr double one_degree = std::numbers::pi / 180;
constexpr int mountings = 5;
constexpr double said_stiffness = 1e-3;            // EI of the scenes [N m^2]
constexpr double camera_tilt = 2 * one_degree;     // standard deviation, one of all mountings
constexpr double fixture_error = 20 * one_degree;  // of a clamp, one of all mountings
constexpr double own_error = 5 * one_degree;       // of a clamp, each mounting's own
constexpr double curvature = 2;                    // of a term of natural curvature [1/m]
constexpr double point_error = 0.003;              // of a coordinate, correlated [m]
constexpr double error_length = 0.2;               // of the length

Scene said_scene(double EI) {
  Scene scene;
  scene.name = scene.file = "wire";
  scene.length = 1.5;
  scene.given_bending_stiffness = EI;
  scene.given_mass_per_length = 0.0215;
  scene.gravity = {0, -9.81, 0};
  scene.grippers = {{.at = 0, .position = {0, 0, 0}, .direction = Eigen::Vector3d::UnitX()},
                    {.at = 1.5, .position = {-0.12, 0, 0}, .direction = Eigen::Vector3d::UnitX()}};
  return scene;
}

Eigen::Vector3d turned(const Eigen::Vector3d& vector, double angle) {
  return Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitZ()) * vector;
}

struct Outcome {
  bool predicted = false;
  bool held = false;
  bool chosen_as_made = false;
};

struct Wire {
  double EI = 0;
  std::vector<Scene> scenes;
  std::vector<MeasuredShape> shapes;
};

Wire wire_of(unsigned seed, int count) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  Wire wire{.EI = said_stiffness * std::exp(0.3 * normal(random))};
  Scene truth = said_scene(wire.EI);
  truth.natural_strain.y() = curvature * normal(random);
  truth.natural_variation = {{0, curvature * normal(random)}, {0, curvature * normal(random)}};
  const double tilt = camera_tilt * normal(random);
  for (Gripper& clamp : truth.grippers) {
    clamp.direction = turned(*clamp.direction, fixture_error * normal(random));
  }
  for (int i = 0; i < count; ++i) {
    Scene mounted = truth;
    for (Gripper& clamp : mounted.grippers) {
      clamp.direction = turned(*clamp.direction, own_error * normal(random));
    }
    dlo::energy_model::Problem problem = energy_problem(mounted);
    problem.confined_to_plane = true;
    const std::vector<double> s = equal_arc_lengths(mounted.length, 50);
    Eigen::Matrix3Xd points = dlo::energy_model::solve_energy(problem).sample(s).points;
    points = Eigen::AngleAxisd(tilt, Eigen::Vector3d::UnitZ()).matrix() * points;
    const double length = error_length * mounted.length;
    points += dlo::test::correlated_noise(s, point_error, length, random);
    points.row(2).setZero();
    wire.scenes.push_back(said_scene(said_stiffness));
    wire.shapes.push_back({"seen", points, {}});
  }
  return wire;
}

Outcome outcome_of(unsigned seed) {
  const Wire wire = wire_of(seed, mountings);
  const double EI = wire.EI;
  const MaterialFit fit =
      calibrate(wire.scenes, wire.shapes, {.choose_options = true, .solve = {.time_limit = 100}})
          .fit;
  const FitAlternative& chosen = fit.tried.front();
  const double ratio =
      fit.prediction ? fit.prediction->rms_m / *fit.prediction->repeatability_m : 1;
  const double low = fit.youngs_modulus.low.value_or(0);
  const double high = fit.youngs_modulus.high.value_or(INFINITY);
  const Outcome result{
      .predicted = ratio <= 1.1,
      .held = low <= EI && EI <= high,
      .chosen_as_made = chosen.shared_clamps && chosen.natural_curvature_terms > 1};
  fmt::print(
      "{:5} {} terms, clamps {}: prediction / repeatability {:.3f}, residual {:.3g} mm, EI / truth "
      "{:.3f} to {:.3f}\n",
      seed, chosen.natural_curvature_terms,
      chosen.shared_clamps             ? "alike"
      : chosen.direction_tolerance > 0 ? "own"
                                       : "as said",
      ratio, fit.rms_m * 1e3, low / EI, high / EI);
  std::fflush(stdout);
  return result;
}

/// The scene, which is one for all, is beside them.
void write(const std::string& folder, unsigned seed) {
  const Wire wire = wire_of(seed, mountings + 1);
  for (std::size_t i = 0; i < wire.shapes.size(); ++i) {
    std::ofstream file(fmt::format("{}/mounting_{}.csv", folder, i + 1));
    file << "x,y,z\n";
    for (const auto& point : wire.shapes[i].points.colwise()) {
      file << fmt::format("{:.4f},{:.4f},{:.4f}\n", point.x(), point.y(), point.z());
    }
  }
  fmt::print("EI = {:.6g} N m^2\n", wire.EI);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc > 3 && std::string(argv[1]) == "--write") {
    write(argv[2], static_cast<unsigned>(std::atoi(argv[3])));
    return 0;
  }
  const int wires = argc > 1 ? std::atoi(argv[1]) : 20;
  const unsigned first = argc > 2 ? static_cast<unsigned>(std::atoi(argv[2])) : 1;
  int predicted = 0;
  int held = 0;
  int as_made = 0;
  int failed = 0;
  for (int i = 0; i < wires; ++i) {
    try {
      const Outcome outcome = outcome_of(first + static_cast<unsigned>(i));
      predicted += outcome.predicted ? 1 : 0;
      held += outcome.held ? 1 : 0;
      as_made += outcome.chosen_as_made ? 1 : 0;
    } catch (const std::exception& error) {
      ++failed;
      fmt::print("{:5} {}\n", first + static_cast<unsigned>(i), error.what());
    }
  }
  fmt::print(
      "of {} wires: predicted within 1.1 times the repeatability {}, interval of EI holds {}, "
      "options as made {}, no fit {}\n",
      wires, predicted, held, as_made, failed);
  return 0;
}
