// Whether the verdict of check() can be fooled: random scenes, and for each of them files that are
// right and files that are wrong.
//
//     dlo_random_verdicts [SCENES [FIRST]]
//
// SCENES is 500 if not given; FIRST, the number of the first scene, is 0.
// The files of a scene, one of each class:
//   (a) a certified stable equilibrium at 7 to 101 points: pass, below 15 points or undetermined
//   (b) that shape scaled, in a wrong unit, mirrored, rotated, or of a rod with 0.5 or 2 times the
//       stiffness: fail, with the cause among the first two
//   (c) a straight line, a smooth curve or a catenary: fail
//   (d) a Hookean chain of 8 to 60 segments: pass, or undetermined if it is too coarse
//   (e) that chain with springs of 0.7 times EI/h: fail, with the cause among the first two
// A file of (b), (c) or (e) that is within 1.1 times the tolerance of a stable equilibrium is not
// certainly wrong and is skipped. Each wrong verdict is printed with the number of its scene; of
// each class the table has the number of files and of wrong verdicts. Ends with 0 if there is no
// wrong pass and at most 1 % of the right files have a wrong verdict, with 1 if not.

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

#include "dlo/compare/chain.hpp"
#include "dlo/compare/check.hpp"
#include "dlo/compare/error.hpp"
#include "dlo/compare/reference.hpp"
#include "dlo/compare/solve.hpp"
#include "random_contact.hpp"
#include "random_problems.hpp"

namespace {

using namespace dlo::compare;
using dlo::energy_model::Equilibrium;
using dlo::energy_model::JointLaw;
using dlo::energy_model::Problem;
using dlo::test::RandomNumbers;
using dlo::test::RandomSpace;
using Points = Eigen::Matrix3Xd;

constexpr double allowed = 0.01;   // tolerance over the length
constexpr double time_limit = 10;  // time limit of a solve [s]
constexpr double certainly_wrong_factor =
    1.1;                                     // factor on the tolerance of what is certainly wrong
constexpr double tolerated_failures = 0.01;  // share of right files that may have a wrong verdict

/// Kinds of scenes, used in turn.
constexpr std::array kinds = {"one clamp",     "between grips", "rigid body",
                              "yielding body", "twisted",       "stretch"};

/// Returns a random rod of the kind that the scene of this number has, of unit length and
/// stiffness.
Problem problem_of(std::uint64_t number, RandomNumbers& random) {
  const std::string kind = kinds[number % kinds.size()];
  const RandomSpace space = random.chance(0.5) ? RandomSpace::plane : RandomSpace::space;
  if (kind == "twisted") return dlo::test::random_problem(number, RandomSpace::twisted);
  for (std::uint64_t next = 1000 * number;; ++next) {
    const auto seed = static_cast<unsigned>(next);
    if (kind.ends_with("body")) {
      const bool in_space = space == RandomSpace::space;
      std::optional<Problem> problem =
          random.chance(0.5) ? dlo::test::random_problem_with_body(seed, in_space)
                             : dlo::test::random_touching_problem(seed, in_space, 1e3);
      if (!problem) continue;
      const double stiffness = std::pow(10, random.uniform(2, 5));
      if (kind == "yielding body") problem->obstacles[0].stiffness = stiffness;
      return *problem;
    }
    Problem problem = dlo::test::random_problem(next, space);
    const bool is_one_clamp = problem.grips.size() == 1 && problem.grips[0].direction;
    if (kind == "stretch") return problem;
    if (kind == "one clamp" ? is_one_clamp : problem.grips.size() > 1) return problem;
  }
}

Scene scene_of(std::uint64_t number, RandomNumbers& random) {
  constexpr double g = 9.81;
  const Problem problem = problem_of(number, random);
  Scene scene;
  scene.name = std::string(kinds[number % kinds.size()]) + " " + std::to_string(number);
  scene.file = scene.name;
  scene.length = problem.length;
  scene.given_bending_stiffness = problem.bending_stiffness;
  scene.given_mass_per_length = problem.weight_per_length.norm() / g;
  scene.gravity = g * problem.weight_per_length.normalized();
  if (problem.torsional_stiffness > 0) scene.torsional_stiffness = problem.torsional_stiffness;
  for (const dlo::energy_model::Grip& grip : problem.grips) {
    Gripper& gripper = scene.grippers.emplace_back();
    gripper.at = grip.at;
    gripper.position = grip.position;
    gripper.direction = grip.direction;
    if (grip.frame) gripper.frame = FrameHold{grip.frame->d1, grip.frame->roll};
  }
  for (const dlo::energy_model::Load& load : problem.loads) {
    scene.loads.push_back({.at = load.at, .force = load.force});
  }
  for (const dlo::energy_model::Obstacle& obstacle : problem.obstacles) {
    scene.obstacles.push_back({obstacle.body, obstacle.stiffness});
  }
  if (kinds[number % kinds.size()] == std::string("stretch")) {
    scene.stretch = Stretch::counted;
    const double force = 1 + scene.weight_per_length().norm() + scene.total_load_magnitude();
    scene.given_axial_stiffness = std::pow(10, random.uniform(1.3, 3)) * force;
  }
  return scene;
}

/// Returns the certified stable equilibria that a search finds; of a rod that stretches, only the
/// equilibrium of model exact.
std::vector<Equilibrium> stable_states(const Scene& scene) {
  if (scene.stretch == Stretch::counted) {
    return {solve_reference(scene, Model::exact, {.time_limit = time_limit})};
  }
  std::vector<Equilibrium> states = reference_states(scene, {.time_limit = time_limit});
  std::erase_if(states, [](const Equilibrium& state) { return !succeeded(state.status); });
  return states;
}

double rms_of(const Eigen::VectorXd& distances) {
  return std::sqrt(distances.squaredNorm() / static_cast<double>(distances.size()));
}

/// Returns the RMS distance of points from the nearest vertices of a dense polyline.
double nearest(const Points& from, const Points& to) {
  Eigen::VectorXd distances(from.cols());
  for (Eigen::Index i = 0; i < from.cols(); ++i) {
    distances[i] = (to.colwise() - from.col(i)).colwise().norm().minCoeff();
  }
  return rms_of(distances);
}

/// Returns `count` points at equal distances along a polyline.
Points refined(const Points& points, int count) {
  Shape shape{{0}, points};
  for (Eigen::Index i = 1; i < points.cols(); ++i) {
    shape.arc_length.push_back(shape.arc_length.back() +
                               (points.col(i) - points.col(i - 1)).norm());
  }
  return resample(shape, equal_arc_lengths(shape.arc_length.back(), count)).points;
}

/// Returns the RMS distance of a file from a rod [m]: at equal arc lengths if the file contains
/// them; else the larger of the distances of either curve from the nearest points of the other.
double distance_from(const MeasuredShape& file, const Equilibrium& rod, double length) {
  constexpr int samples = 400;
  if (!file.arc_length.empty()) {
    return rms_of((file.points - rod.sample(file.arc_length).points).colwise().norm().transpose());
  }
  const Points curve = rod.sample(equal_arc_lengths(length, samples)).points;
  const Points line = refined(file.points, samples);
  return std::max(nearest(line, curve), nearest(curve, line));
}

/// A shape file with its class (see the head of this file) and the expected result.
struct Trial {
  char letter;
  std::string what;
  MeasuredShape file;
  std::vector<std::string> causes = {};  // causes, one of which has to be named

  [[nodiscard]] bool is_right() const { return letter == 'a' || letter == 'd'; }
};

/// Numbers of the files of a class and of their wrong verdicts.
struct Tally {
  int tried = 0, wrong_pass = 0, wrong_other = 0, missed = 0;
};

class Verdicts {
 public:
  void run(std::uint64_t number) {
    RandomNumbers random(number);
    const Scene scene = scene_of(number, random);
    std::vector<Equilibrium> states;
    try {
      states = stable_states(scene);
    } catch (const ResultError&) {
    }
    if (states.empty()) {
      ++unsolved_;
      return;
    }
    const Equilibrium& state =
        states[static_cast<std::size_t>(random.below(static_cast<int>(states.size())))];
    const int points = 7 + random.below(95);
    const std::vector<double> s = equal_arc_lengths(scene.length, points);
    const bool has_s = random.chance(0.5);
    const MeasuredShape right{"right", state.sample(s).points, has_s ? s : std::vector<double>{}};
    judge(scene, states, {'a', std::to_string(points) + " points", right});
    attempt([&] { judge(scene, states, file_with_error(scene, state, right, random)); });
    judge(scene, states, file_of_other_curve(scene, random));
    attempt([&] { chains(scene, states, random); });
  }

  /// @return the exit status
  [[nodiscard]] int report() const {
    std::printf("class                     files | wrong: pass other cause\n");
    int right = 0, wrong_refusals = 0, wrong_acceptances = 0;
    for (const auto& [name, t] : tallies_) {
      std::printf("%-24s %6d | %11d %5d %5d\n", name.c_str(), t.tried, t.wrong_pass, t.wrong_other,
                  t.missed);
      wrong_acceptances += t.wrong_pass;
      if (name[0] != 'a' && name[0] != 'd') continue;
      right += t.tried;
      wrong_refusals += t.wrong_other;
    }
    std::printf(
        "%d scenes without a stable equilibrium; %d wrong passes, %d of %d right files fail\n",
        unsolved_, wrong_acceptances, wrong_refusals, right);
    return wrong_acceptances == 0 && wrong_refusals <= tolerated_failures * right ? 0 : 1;
  }

 private:
  /// Runs an action. Nothing is counted if a solver does not converge or a model does not accept
  /// the scene.
  template <typename Action>
  static void attempt(const Action& action) {
    try {
      action();
    } catch (const ResultError&) {
    }
  }

  static Trial file_with_error(const Scene& scene, const Equilibrium& state,
                               const MeasuredShape& right, RandomNumbers& random) {
    Trial trial{'b', "", right};
    const auto transform = [&](const Eigen::Matrix3d& matrix) {
      const Eigen::Vector3d origin = scene.grippers.front().position;
      trial.file.points = ((matrix * (right.points.colwise() - origin)).colwise() + origin).eval();
    };
    const int kind = random.below(6);
    if (kind == 0) {
      trial.what = "scaled";
      trial.file.points *= std::pow(10, random.uniform(-3, std::log10(0.99)));
      trial.causes = {"compressed", "the file is in"};
    } else if (kind == 1) {
      constexpr std::array units = {1e-3, 1e-2, 0.0254, 1e-6};  // [m]
      trial.what = "wrong unit";
      trial.file.points /= units[static_cast<std::size_t>(random.below(4))];
      trial.file.arc_length.clear();  // the arc lengths would exceed the rod
      trial.causes = {"the file is in"};
    } else if (kind == 2) {
      Eigen::Vector3d signs = Eigen::Vector3d::Ones();
      signs[random.below(2)] = -1;
      trial.what = "mirrored";
      transform(signs.asDiagonal());
      trial.causes = {"the file's -", "mirrored"};
    } else if (kind == 3) {
      const double angle = random.uniform(2, 20) * std::numbers::pi / 180;
      trial.what = "rotated";
      transform(Eigen::AngleAxisd(angle, random.direction(RandomSpace::space)).toRotationMatrix());
      trial.causes = {"rotated"};
    } else {
      const double factor = kind == 4 ? 0.5 : 2;
      trial.what = kind == 4 ? "half as stiff" : "twice as stiff";
      Scene other = scene;
      other.scale_modulus(factor);
      const bool stretches = scene.stretch == Stretch::counted;
      const Equilibrium rod =
          solve_reference(other, stretches ? Model::exact : Model::energy,
                          {.time_limit = time_limit, .start = stretches ? nullptr : &state});
      trial.file.points =
          rod.sample(equal_arc_lengths(scene.length, static_cast<int>(right.points.cols()))).points;
      trial.causes = {"stiffness"};
    }
    return trial;
  }

  static Trial file_of_other_curve(const Scene& scene, RandomNumbers& random) {
    const std::vector<double> s = equal_arc_lengths(scene.length, 7 + random.below(95));
    const Gripper& grip = scene.grippers.front();
    const int kind = random.below(3);
    Points points(3, static_cast<Eigen::Index>(s.size()));
    const Eigen::Vector3d along = random.direction(RandomSpace::space);
    const Eigen::Vector3d line = grip.direction && random.chance(0.7) ? *grip.direction : along;
    const dlo::test::RandomCurve curve(random, RandomSpace::space);
    const double a = random.uniform(0.1, 2);
    const double lowest = random.uniform(0, 1);
    const Eigen::Vector3d level = Eigen::Vector3d(along.x(), 0, along.z()).normalized();
    for (Eigen::Index i = 0; i < points.cols(); ++i) {
      const double at = s[static_cast<std::size_t>(i)];
      points.col(i) = kind == 0   ? Eigen::Vector3d(at * line)
                      : kind == 1 ? curve.point(at)
                                  : a * std::asinh((at - lowest) / a) * level +
                                        Eigen::Vector3d::UnitY() * std::hypot(a, at - lowest);
    }
    points = (points.colwise() + (grip.position - points.col(0))).eval();
    const char* const what = kind == 0 ? "line" : kind == 1 ? "curve" : "catenary";
    return {'c', what, {"other", points, random.chance(0.5) ? s : std::vector<double>{}}};
  }

  void chains(const Scene& scene, const std::vector<Equilibrium>& states, RandomNumbers& random) {
    constexpr std::array laws = {JointLaw::hooke, JointLaw::linear, JointLaw::binormal};
    const JointLaw law = laws[static_cast<std::size_t>(random.below(3))];
    Scene chain = scene;
    chain.force_model.points = 9 + random.below(53);
    chain.force_model.joint_law = law;
    if (scene.stretch != Stretch::counted) {
      // Segments that do not stretch: those of the default c_c would, by up to 0.4 % here.
      chain.force_model.c_c =
          1e6 * (1 + scene.weight_per_length().norm() + scene.total_load_magnitude());
    }
    const bool has_s = random.chance(0.5);
    const auto file_of = [&](const Scene& of) {
      const Shape shape = solve(of, Model::chain, {.time_limit = time_limit}).shape;
      return MeasuredShape{"chain", shape.points, has_s ? shape.arc_length : std::vector<double>{}};
    };
    const MeasuredShape right = file_of(chain);
    const std::string what =
        std::to_string(right.points.cols() - 1) + " segments, " + to_string(law);
    judge(scene, states, {'d', what, right});
    chain.scale_modulus(0.7);
    const MeasuredShape soft = file_of(chain);
    const double moved = rms_of((soft.points - right.points).colwise().norm().transpose());
    if (!(moved > certainly_wrong_factor * allowed * scene.length)) return;
    judge(scene, states, {'e', what, soft, {"springs of", "stiffness"}});
  }

  void judge(const Scene& scene, const std::vector<Equilibrium>& states, const Trial& trial) {
    const std::string name = std::string(1, trial.letter) +
                             (trial.letter == 'b' || trial.letter == 'c' ? " " + trial.what : "");
    Tally& tally = tallies_[name];
    const auto is_away = [&](const Equilibrium& rod) {
      return distance_from(trial.file, rod, scene.length) >
             certainly_wrong_factor * allowed * scene.length;
    };
    if (!trial.is_right() && !std::ranges::all_of(states, is_away)) return;
    std::string wrong;
    try {
      const CheckResult result =
          check(scene, trial.file,
                {.tolerance = ShapeTolerance{.allowed_m = allowed * scene.length},
                 .explaining = trial.causes.empty() ? Explaining::no : Explaining::yes,
                 .shape = {.modulus = ModulusSearch::no, .solve = {.time_limit = time_limit}}});
      wrong = count(trial, is_away(result.check.rod), result, tally);
      if (!wrong.empty()) wrong += ": " + result.judgement.reason;
    } catch (const ResultError& error) {
      if (trial.is_right()) wrong = error.what();
    }
    if (wrong.empty()) return;
    std::printf("%s, %s (%s): %s\n", scene.name.c_str(), name.c_str(), trial.what.c_str(),
                wrong.c_str());
    std::fflush(stdout);
  }

  /// Counts a verdict. @return the error of the verdict; empty if there is none
  static std::string count(const Trial& trial, bool is_away, const CheckResult& result,
                           Tally& tally) {
    ++tally.tried;
    const ShapeVerdict verdict = result.judgement.verdict;
    const bool passed = verdict == ShapeVerdict::pass;
    const bool failed = verdict == ShapeVerdict::fail;
    if (trial.is_right()) {
      const bool may_be_open = trial.letter == 'd' || trial.file.points.cols() < 15;
      if (passed || (may_be_open && !failed)) return "";
      ++tally.wrong_other;
      return to_string(verdict);
    }
    if (!failed) {
      // A file is correct if it is near an equilibrium, even one that only a search from the file
      // finds.
      if (!is_away) return "";
      ++(passed ? tally.wrong_pass : tally.wrong_other);
      return to_string(verdict);
    }
    std::string first_two;
    for (std::size_t i = 0; i < std::min<std::size_t>(2, result.explanations.size()); ++i) {
      first_two += "; " + result.explanations[i].cause;
    }
    const auto is_named = [&](const std::string& cause) {
      return first_two.find(cause) != std::string::npos;
    };
    if (trial.causes.empty() || std::ranges::any_of(trial.causes, is_named)) return "";
    ++tally.missed;
    return "fails without its cause" + first_two;
  }

  std::map<std::string, Tally> tallies_;
  int unsolved_ = 0;
};

}  // namespace

int main(int argc, char** argv) {
  const std::uint64_t scenes = argc > 1 ? std::strtoull(argv[1], nullptr, 10) : 500;
  const std::uint64_t first = argc > 2 ? std::strtoull(argv[2], nullptr, 10) : 0;
  Verdicts verdicts;
  for (std::uint64_t number = first; number < first + scenes; ++number) verdicts.run(number);
  return verdicts.report();
}
