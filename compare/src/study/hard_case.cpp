#include "study/hard_case.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <utility>

#include "dlo/compare/error.hpp"
#include "dlo/compare/force_model_settings.hpp"
#include "polygon/energy_problems.hpp"
#include "polygon/point_layout.hpp"

namespace dlo::compare {
namespace {

using std::numbers::pi;

/// Load at which an upright clamped rod buckles under its own weight (a zero of a Bessel function).
constexpr double self_buckling = 7.8373474389;

/// Returns the paper's rod (Table 5), with gravity scaled to the given Gamma.
Scene steel_rod(double gamma, const Eigen::Vector3d& direction) {
  Scene scene;
  scene.name = "hard case";
  scene.file = "hard case";
  scene.length = 0.5;
  scene.diameter = 0.002;
  scene.material = *std::find_if(materials().begin(), materials().end(),
                                 [](const Material& m) { return m.name == "spring_steel"; });
  scene.gravity = {0, -1, 0};
  scene.gravity *= gamma / scene.gamma();
  scene.grippers = {{.at = 0, .position = {0, 0, 0}, .direction = direction, .where = "hard case"}};
  return scene;
}

Scene horizontal(double gamma) { return steel_rod(gamma, {1, 0, 0}); }

/// Returns c_c by the rule that hard_cases() states.
double soft_stretch_stiffness(const Scene& scene) {
  const double load = scene.weight_per_length().norm() * scene.length;
  return std::max(scene.axial_stiffness() / 1000, 1000 * load);
}

ForceModelSettings settings_for(const Scene& scene, int points = 16) {
  ForceModelSettings settings;
  settings.points = points;
  settings.c_c = soft_stretch_stiffness(scene);
  return settings;
}

HardCase make(std::string name, std::string what, const Scene& scene,
              const ForceModelSettings& settings) {
  HardCase result;
  result.name = std::move(name);
  result.difficulty = std::move(what);
  result.discretisation = discretise(scene, settings);
  ForceModelSettings with_masses = settings;
  with_masses.stepper = Stepper::verlet;
  set_masses(scene, with_masses, result.discretisation);
  result.start = result.discretisation.starts.front();
  return result;
}

HardCase make(std::string name, std::string what, const Scene& scene, int points = 16) {
  return make(std::move(name), std::move(what), scene, settings_for(scene, points));
}

Eigen::Matrix3Xd rest_shape(const HardCase& hard) {
  return polygon_at_rest(hard.name, hard.rod(0), hard.discretisation.starts.front()).points;
}

/// Places the free points on a circular arc that rotates the tangent by `angle` in all [rad].
Eigen::Matrix3Xd arc(const HardCase& hard, double angle) {
  Eigen::Matrix3Xd points = hard.discretisation.starts.front();
  const Eigen::Vector3d along = (points.col(1) - points.col(0)).normalized();
  const Eigen::Vector3d across(-along.y(), along.x(), 0);
  const Eigen::VectorXd& L = hard.discretisation.rod.rest_lengths;
  for (Eigen::Index i = 1; i < L.size(); ++i) {
    const double tangent = angle * static_cast<double>(i) / static_cast<double>(L.size());
    points.col(i + 1) =
        points.col(i) + L[i] * (std::cos(tangent) * along + std::sin(tangent) * across);
  }
  return points;
}

std::vector<HardCase> hard_start_cases() {
  const auto make_start = [](std::string name, std::string what) {
    return make(std::move(name), std::move(what), horizontal(2));
  };
  std::vector<HardCase> cases;
  cases.push_back(make_start("folded", "starts folded back by 180 degrees in the middle"));
  Eigen::Matrix3Xd& folded = cases.back().start;
  for (Eigen::Index i = 9; i < folded.cols(); ++i) folded.col(i) = folded.col(16 - i);

  cases.push_back(make_start("two points coincide", "a segment of zero length has no direction"));
  cases.back().start.col(8) = cases.back().start.col(7);

  cases.push_back(make_start("all points coincide", "the rod starts in one point"));
  Eigen::Matrix3Xd& one_point = cases.back().start;
  one_point.rightCols(14).colwise() = Eigen::Vector3d(one_point.col(1));

  cases.push_back(make_start("points crossed", "two neighbours have changed places (Fig. 4)"));
  cases.back().start.col(8).swap(cases.back().start.col(9));

  cases.push_back(make_start("points reversed", "the free points lie in reversed order"));
  Eigen::Matrix3Xd& reversed = cases.back().start;
  reversed.rightCols(14) = reversed.rightCols(14).rowwise().reverse().eval();

  for (const unsigned seed : {1U, 2U, 3U}) {
    cases.push_back(make_start(fmt::format("crumpled {}", seed),
                               "free points anywhere in a cube of half the rod's length"));
    std::mt19937 engine(seed);
    Eigen::Matrix3Xd& random_case = cases.back().start;
    for (Eigen::Index k = 6; k < random_case.size(); ++k) {
      // uniform_real_distribution is not used because its numbers depend on the standard library.
      const double share = static_cast<double>(engine()) / 4294967296.0;
      random_case.data()[k] = 0.5 * (share - 0.5);
    }
  }
  return cases;
}

HardCase unequal_segments() {
  const Scene scene = horizontal(2);
  HardCase result = make("unequal segments", "lengths from a third of L to twice L", scene);
  Discretisation& unequal = result.discretisation;
  Eigen::VectorXd& lengths = unequal.rod.rest_lengths;
  constexpr double factors[] = {1. / 3, 2, 0.5, 1.5, 0.8, 1.2, 0.7};
  for (Eigen::Index i = 1; i < lengths.size(); ++i) lengths[i] *= factors[(i - 1) % 7];
  for (Eigen::Index i = 1; i < lengths.size(); ++i) {
    // A point carries half of each of its segments; the held one is inside the gripper.
    const double before = i > 1 ? lengths[i - 1] : 0;
    unequal.rod.loads.col(i) = (before + lengths[i]) / 2 * scene.weight_per_length();
    result.start.col(i + 1) = result.start.col(i) + lengths[i] * Eigen::Vector3d::UnitX();
  }
  unequal.rod.loads.rightCols<1>() = lengths.tail<1>()[0] / 2 * scene.weight_per_length();
  unequal.rod.masses = unequal.rod.loads.colwise().norm() / scene.gravity.norm();
  unequal.starts = {result.start};
  return result;
}

/// Returns the rod of Table 5 with the paper's own law and convention, under its own weight.
HardCase paper_rod_case() {
  constexpr double clamp_angle = -175 * pi / 180;
  Scene scene = steel_rod(1, {std::cos(clamp_angle), std::sin(clamp_angle), 0});
  scene.gravity = {0, -9.81, 0};
  ForceModelSettings settings = settings_for(scene);
  settings.law = BendingLaw::paper;
  settings.bookkeeping = Bookkeeping::paper;
  return make("the paper's rod", "Table 5 at -175 deg, law and bookkeeping paper", scene, settings);
}

std::vector<HardCase> hard_rod_cases() {
  std::vector<HardCase> cases;
  cases.push_back(make("c_c = AE", "physical stretch stiffness: the stiffest segments for the rod",
                       horizontal(2), ForceModelSettings{.points = 16}));
  cases.push_back(
      make("Gamma = 1e-6", "almost no load; starts as a half circle", horizontal(1e-6)));
  cases.back().start = arc(cases.back(), pi);
  cases.push_back(
      make("Gamma = 1e3", "a rope: bending matters at the clamp only", horizontal(1e3)));
  cases.push_back(make("Gamma = 1e5", "all bending in one joint", horizontal(1e5)));
  const Eigen::Vector3d up(0, 1, 0);
  cases.push_back(make("upright, 3 % below buckling", "upright shape just stable; starts bent",
                       steel_rod(0.97 * self_buckling, up)));
  cases.back().start = arc(cases.back(), pi / 8);
  cases.push_back(make("upright, 3 % above buckling", "upright shape just unstable; starts there",
                       steel_rod(1.03 * self_buckling, up)));
  cases.push_back(make("N = 5", "as few points as the paper allows", horizontal(2), 5));
  cases.push_back(make("N = 200", "condition number of the stiffness: 1e9", horizontal(2), 200));
  cases.push_back(make("N = 1000", "condition number of the stiffness: 1e12", horizontal(2), 1000));

  cases.push_back(unequal_segments());
  cases.push_back(paper_rod_case());
  Scene inside = horizontal(2);
  inside.grippers.front().at = 0.13;
  inside.grippers.push_back({.at = 0.37, .position = {0.2, 0.05, 0.03}, .where = "hard case"});
  cases.push_back(make("grips inside", "a clamp and a pin at inner arc lengths, in space", inside));
  return cases;
}

std::vector<HardCase> hard_surrounding_cases() {
  constexpr double steps_per_second = 20'000;  // the paper's haptic loop
  std::vector<HardCase> cases;
  cases.push_back(make("gripper jumps", "by the rod's length in one step", horizontal(2)));
  cases.back().start = rest_shape(cases.back());
  cases.back().motion = {.steps = 1, .movement = {0, 0.5, 0}};

  cases.push_back(make("gripper races",
                       "10 m/s and 720 deg/s for 0.25 s at 20000 steps/s, then stops",
                       horizontal(2)));
  cases.back().start = rest_shape(cases.back());
  constexpr double seconds = 0.25;
  cases.back().motion = {.steps = static_cast<long>(seconds * steps_per_second),
                         .movement = {10 * seconds, 0, 0},
                         .turn = 4 * pi * seconds};

  cases.push_back(
      make("wall inside the rod", "added while half of the rod is behind it", horizontal(2)));
  HardCase& wall = cases.back();
  wall.start = rest_shape(wall);
  const double height = wall.start(1, 8);
  // The stiffness is the one that discretise() gives a rigid obstacle.
  const Parameters& parameters = wall.discretisation.parameters;
  wall.discretisation.rod.walls = {{.point = {0, height, 0},
                                    .normal = {0, 1, 0},
                                    .stiffness = parameters.c_c / parameters.segment_length}};
  return cases;
}

/// Returns rods between two clamps whose distance is 20 % larger than the rod's length.
std::vector<HardCase> overstretched_rods() {
  Scene scene = horizontal(2);
  Gripper far = scene.grippers.front();
  far.at = scene.length;
  far.position.x() = scene.length;
  scene.grippers.push_back(far);
  HardCase stretched =
      make("pulled too far, as a spring", "the same rod, stretched by 20 % as c_c allows", scene);
  const double distance = 1.2 * scene.length;
  force_model::Grip& pulled = stretched.discretisation.rod.grips.back();
  pulled.targets.row(0).array() += distance - scene.length;
  pulled.reference.x() = distance;
  stretched.start.rightCols<2>() = pulled.targets;
  stretched.discretisation.starts = {stretched.start};

  HardCase refused = stretched;
  refused.name = "pulled too far";
  refused.difficulty = "two grippers 20 % further apart than the rod is long: no shape exists";
  scene.grippers.back().position.x() = distance;
  try {
    (void)discretise(scene, settings_for(scene));
  } catch (const InputError& error) {
    refused.refusal = error.what();
  }
  return {refused, stretched};
}

}  // namespace

Eigen::Matrix3Xd HardCase::moved(const Eigen::Matrix3Xd& points, double share) const {
  const Eigen::Vector3d centre = discretisation.rod.grips.front().reference;
  const Eigen::Matrix3d turned =
      Eigen::AngleAxisd(share * motion.turn, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  return (turned * (points.colwise() - centre)).colwise() + (centre + share * motion.movement);
}

force_model::Rod HardCase::rod(double share) const {
  force_model::Rod result = discretisation.rod;
  force_model::Grip& grip = result.grips.front();
  grip.targets = moved(discretisation.rod.grips.front().targets, share);
  grip.reference += share * motion.movement;
  return result;
}

energy_model::PolygonResult polygon_at_rest(const std::string& name, const force_model::Rod& rod,
                                            const Eigen::Matrix3Xd& start) {
  energy_model::PolygonResult result = energy_model::solve_polygon(polygon_problem(rod), start);
  if (!energy_model::succeeded(result.status)) {
    throw ConvergenceError(
        fmt::format("{}: the chain model has no rest shape: {}", name, result.message));
  }
  return result;
}

Scene hard_case_scene() {
  Scene scene = horizontal(2);
  scene.name = "spring steel, horizontal, Gamma = 2";
  scene.force_model.c_c = soft_stretch_stiffness(scene);
  return scene;
}

std::vector<HardCase> hard_cases(long steps_at_rest) {
  std::vector<HardCase> cases;
  for (std::vector<HardCase> group :
       {hard_start_cases(), hard_rod_cases(), hard_surrounding_cases(), overstretched_rods()}) {
    std::move(group.begin(), group.end(), std::back_inserter(cases));
  }
  cases.push_back(make("stays at rest", "no drift and no growth of energy", horizontal(2)));
  cases.back().start = rest_shape(cases.back());
  cases.back().steps_at_rest = steps_at_rest;
  return cases;
}

}  // namespace dlo::compare
