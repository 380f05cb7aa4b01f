#include "suite/answer.hpp"

#include <fmt/format.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <optional>

#include "dlo/compare/deviation.hpp"
#include "dlo/compare/error.hpp"
#include "dlo/compare/shape.hpp"
#include "dlo/compare/solve.hpp"
#include "parallel/threads.hpp"
#include "record/solution_fields.hpp"
#include "released/hinge_motion.hpp"
#include "scene/scene_problem.hpp"

namespace dlo::compare {
namespace {

/// Points with the load on each, in an order that begins at a held end.
struct LoadedPoints {
  Shape shape;
  Eigen::Matrix3Xd weights;
  Eigen::Matrix3Xd forces;  // all loads except weight

  /// Returns the points in the opposite order.
  [[nodiscard]] LoadedPoints reversed(double length) const {
    LoadedPoints result = *this;
    for (Eigen::Matrix3Xd* each : {&result.shape.points, &result.weights, &result.forces}) {
      *each = each->rowwise().reverse().eval();
    }
    std::reverse(result.shape.arc_length.begin(), result.shape.arc_length.end());
    for (double& s : result.shape.arc_length) s = length - s;
    return result;
  }
};

LoadedPoints loaded_points(const Scene& scene, const Shape& shape) {
  const Eigen::Index n = shape.points.cols() - 1;
  LoadedPoints result{shape, Eigen::Matrix3Xd::Zero(3, n + 1), Eigen::Matrix3Xd::Zero(3, n + 1)};
  const std::vector<double>& s = shape.arc_length;
  const auto at = [&](Eigen::Index i) { return s[static_cast<std::size_t>(i)]; };
  for (Eigen::Index i = 0; i <= n; ++i) {
    const double begin = i == 0 ? 0 : (at(i - 1) + at(i)) / 2;
    const double end = i == n ? scene.length : (at(i) + at(i + 1)) / 2;
    result.weights.col(i) = scene.weight_between(begin, end);
    result.forces.col(i) = scene.distributed_between(begin, end);
  }
  for (const PointLoad& load : scene.loads) {
    // A load between two points is distributed by the lever rule.
    const auto after = std::upper_bound(s.begin() + 1, s.end() - 1, load.at);
    const Eigen::Index i = after - s.begin();
    const double share = std::clamp((load.at - at(i - 1)) / (at(i) - at(i - 1)), 0.0, 1.0);
    result.forces.col(i - 1) += (1 - share) * load.force;
    result.forces.col(i) += share * load.force;
  }
  return result;
}

/// Returns the moments about the inner points of all forces beyond them, as one column.
Eigen::VectorXd moments_beyond(const Eigen::Matrix3Xd& points, const Eigen::Matrix3Xd& forces) {
  const Eigen::Index n = points.cols() - 1;
  Eigen::VectorXd moments = Eigen::VectorXd::Zero(3 * (n - 1));
  for (Eigen::Index i = 1; i < n; ++i) {
    for (Eigen::Index j = i + 1; j <= n; ++j) {
      const Eigen::Vector3d arm = points.col(j) - points.col(i);
      moments.segment<3>(3 * (i - 1)) += arm.cross(Eigen::Vector3d(forces.col(j)));
    }
  }
  return moments;
}

/// Returns the moments about the inner points of unit reactions at the far end, one column per
/// component: none, of a force, or of a force and a torque.
Eigen::MatrixXd moments_of_end(const Eigen::Matrix3Xd& points, Eigen::Index unknown) {
  const Eigen::Index n = points.cols() - 1;
  Eigen::MatrixXd columns(3 * (n - 1), unknown);
  for (Eigen::Index i = 1; i < n; ++i) {
    const Eigen::Index row = 3 * (i - 1);
    const Eigen::Vector3d arm = points.col(n) - points.col(i);
    for (Eigen::Index k = 0; k < std::min<Eigen::Index>(unknown, 3); ++k) {
      columns.block<3, 1>(row, k) = arm.cross(Eigen::Vector3d::Unit(k));
    }
    if (unknown == 6) columns.block<3, 3>(row, 3) = Eigen::Matrix3d::Identity();
  }
  return columns;
}

/// Returns EI kappa of the inner joints, without the joints adjacent to the ends: there discrete
/// springs depend on the assumed position of the clamp. With another power the moments are
/// EI / h c_max (c / c_max)^power, where c = 2 sin(angle / 2), c_max is its largest value and h the
/// joint's length.
Eigen::VectorXd bending_moments(const Scene& scene, const Shape& shape, double power) {
  const Eigen::Index n = shape.points.cols() - 1;
  Eigen::VectorXd moments = Eigen::VectorXd::Zero(3 * (n - 1));
  Eigen::VectorXd chords = Eigen::VectorXd::Zero(n - 1);
  for (Eigen::Index i = 2; i <= n - 2; ++i) {
    const auto joint = static_cast<std::size_t>(i);
    const Eigen::Vector3d curvature = joint_curvature(shape, joint);
    chords[i - 1] = 2 * std::sin(curvature.norm() * joint_length(shape, joint) / 2);
    moments.segment<3>(3 * (i - 1)) = scene.bending_stiffness() * curvature;
  }
  if (power == 1) return moments;
  const double largest = chords.maxCoeff();
  for (Eigen::Index i = 2; i <= n - 2; ++i) {
    const double length = joint_length(shape, static_cast<std::size_t>(i));
    const Eigen::Vector3d moment = moments.segment<3>(3 * (i - 1));
    moments.segment<3>(3 * (i - 1)) = moment.normalized() * scene.bending_stiffness() / length *
                                      largest * std::pow(chords[i - 1] / largest, power);
  }
  return moments;
}

/// Returns MomentBalance::resolution for the scene's stiffness.
double resolution(const Scene& scene, const LoadedPoints& rod) {
  constexpr double of_second_order = 0.25;
  const double h = scene.length / static_cast<double>(rod.shape.points.cols() - 1);
  const double force = rod.weights.colwise().norm().sum() + rod.forces.colwise().norm().sum();
  return of_second_order * h * h * force / scene.bending_stiffness();
}

/// Number of points of the chain with which a rod that stretches is compared.
constexpr int fine_chain = 1024;

/// Returns the answers of `certified` to all scenes, in their order, computed on several threads.
template <typename Of>
std::vector<Of> certify_each(const std::vector<BatteryScene>& scenes, int threads,
                             const SolveOptions& options,
                             Of (*certified)(const BatteryScene&, const SolveOptions&)) {
  std::vector<Of> answers(scenes.size());
  tbb::task_arena arena(arena_threads(threads));
  execute(arena, [&] {
    tbb::parallel_for(std::size_t{0}, scenes.size(),
                      [&](std::size_t i) { answers[i] = certified(scenes[i], options); });
  });
  return answers;
}

double or_zero(double estimate) { return std::isfinite(estimate) ? estimate : 0; }

double largest_distance(const Eigen::Matrix3Xd& a, const Eigen::Matrix3Xd& b) {
  return std::sqrt((a - b).colwise().squaredNorm().maxCoeff());
}

AnswerBounds bounds_between(const Solution& a, const Solution& b) {
  AnswerBounds bounds;
  bounds.points_m = largest_distance(a.shape.points, b.shape.points) + or_zero(a.error_estimate) +
                    or_zero(b.error_estimate);
  for (std::size_t i = 0; i < a.grippers.size(); ++i) {
    bounds.forces_N.push_back((a.grippers[i].force - b.grippers[i].force).norm());
    bounds.torques_Nm.push_back((a.grippers[i].torque - b.grippers[i].torque).norm());
  }
  for (std::size_t i = 0; i < a.obstacles.size(); ++i) {
    bounds.obstacles_N.push_back((a.obstacles[i] - b.obstacles[i]).norm());
  }
  bounds.energy_J = std::abs(a.energy.total() - b.energy.total());
  return bounds;
}

/// Adds every other equilibrium that the energy model finds to the answer, and sets the smallest
/// eigenvalue of the answer itself.
void look_for_others(Answer& answer, const SolveOptions& options) {
  const std::vector<double>& s = answer.first.shape.arc_length;
  const AllSolutions all = solve_all(answer.of.scene, options, s);
  const double length = answer.of.scene.length;
  const double large = magnitudes(answer.of.scene).energy;
  for (const Solution& one : all.solutions) {
    const double apart = rms(s, one.shape.points - answer.first.shape.points);
    if (apart < methods_agree * length) {
      answer.first.smallest_eigenvalue = one.smallest_eigenvalue;
      continue;
    }
    answer.others.push_back({one.energy.total(), is_stable(one), one.smallest_eigenvalue, apart});
    constexpr double same = 1e-9;
    if (is_stable(one) && one.energy.total() < answer.first.energy.total() - same * large) {
      answer.is_lowest = false;
    }
  }
  std::stable_sort(answer.others.begin(), answer.others.end(),
                   [](const auto& a, const auto& b) { return a.energy_J < b.energy_J; });
}

/// Terms of the energy model, and of a second run that measures the truncation error.
constexpr int fine_terms = 16;
constexpr int fewer_terms = 12;
/// Number of segments of the coarsest chain: its points are the motion_points.
constexpr int segments = motion_points - 1;

}  // namespace

std::optional<MomentBalance> moment_balance(const Scene& scene, const Shape& shape, double power) {
  const bool plain = scene.sections.empty() && !scene.has_material_directors() &&
                     !scene.holds_twist() && !scene.has_couples() &&
                     scene.stretch == Stretch::none && obstacles_in_reach(scene).empty();
  constexpr Eigen::Index fewest = 6;
  const Eigen::Index n = shape.points.cols() - 1;
  if (!plain || n < fewest || scene.grippers.size() > 2) return std::nullopt;
  const Gripper* first = nullptr;
  const Gripper* last = nullptr;
  for (const Gripper& gripper : scene.grippers) {
    if (gripper.at != 0 && gripper.at != scene.length) return std::nullopt;
    (gripper.at == 0 ? first : last) = &gripper;
  }
  LoadedPoints rod = loaded_points(scene, shape);
  if (first == nullptr) {
    rod = rod.reversed(scene.length);
    std::swap(first, last);
  }
  const Eigen::Index unknown = last == nullptr ? 0 : last->direction ? 6 : 3;
  const Eigen::Index from = 2;
  const Eigen::Index to = n - 2;
  const auto inside = [&](const auto& rows) {
    return rows.middleRows(3 * (from - 1), 3 * (to - from + 1)).eval();
  };
  const Eigen::VectorXd bending = inside(bending_moments(scene, rod.shape, power));
  if (!(bending.norm() > 0)) return std::nullopt;
  constexpr double no_load = 1e-9;
  const Eigen::VectorXd of_weight = inside(moments_beyond(rod.shape.points, rod.weights));
  const Eigen::VectorXd of_loads = inside(moments_beyond(rod.shape.points, rod.forces));
  const bool has_weight = of_weight.norm() > no_load * bending.norm();
  const bool has_loads = of_loads.norm() > no_load * bending.norm();
  if (!has_weight && !has_loads && unknown == 0) return MomentBalance{.imbalance = 1};
  // The unknowns are the columns, and the right-hand side contains the rest. Without loads the
  // moments do not depend on the stiffness. With only weight or only other loads, the factors of
  // stiffness and load are inverse to each other, so that only the stiffness is fitted.
  Eigen::MatrixXd columns = inside(moments_of_end(rod.shape.points, unknown));
  const auto append_column = [&](const Eigen::VectorXd& column) {
    columns.conservativeResize(Eigen::NoChange, columns.cols() + 1);
    columns.rightCols<1>() = column;
  };
  const bool both = has_weight && has_loads;
  if (both) append_column(of_weight);
  const bool any = has_weight || has_loads;
  if (any) append_column(-bending);
  const Eigen::VectorXd right = !any   ? bending
                                : both ? Eigen::VectorXd(-of_loads)
                                       : Eigen::VectorXd(-of_weight - of_loads);
  const Eigen::VectorXd found = columns.colPivHouseholderQr().solve(right);
  MomentBalance result;
  if (any) result.stiffness = found[found.size() - 1];
  if (both) result.weight = found[found.size() - 2];
  constexpr double least = 1e-3;
  result.resolution = resolution(scene, rod) / std::clamp(result.stiffness, least, 1.0);
  const double size = std::max(std::abs(result.stiffness) * bending.norm(), least * right.norm());
  result.imbalance = (columns * found - right).norm() / size;
  return result;
}

Model answer_model(const Scene& scene) {
  return scene.stretch != Stretch::none ? Model::exact : Model::energy;
}

Answer certified_answer(const BatteryScene& scene, const SolveOptions& options) {
  const std::vector<double> s = equal_arc_lengths(scene.scene.length, answer_points);
  Answer answer{.of = scene};
  answer.first = solve(scene.scene, answer_model(scene.scene), options, s);
  if (scene.scene.stretch != Stretch::none) {
    Scene fine = scene.scene;
    fine.force_model.points = fine_chain;
    answer.second = solve(fine, Model::chain, options, s);
    answer.second_method = fmt::format("chain, N = {}", fine_chain);
  } else {
    answer.second = solve(scene.scene, Model::exact, options, s);
    answer.second_method = to_string(Model::exact);
  }
  answer.bounds = bounds_between(answer.first, answer.second);
  const double agree =
      (scene.scene.stretch != Stretch::none ? chain_agrees : methods_agree) * scene.scene.length;
  if (!(answer.bounds.points_m <= agree)) {
    throw ConvergenceError(fmt::format("{}: {} and {} are {:.3g} m apart (allowed: {:.3g} m)",
                                       scene.id, to_string(answer.first.model),
                                       answer.second_method, answer.bounds.points_m, agree));
  }
  if (scene.scene.stretch == Stretch::none) look_for_others(answer, options);
  return answer;
}

std::vector<Answer> certified_answers(const std::vector<BatteryScene>& scenes, int threads,
                                      const SolveOptions& options) {
  return certify_each(scenes, threads, options, certified_answer);
}

MotionAnswer certified_motion(const BatteryScene& scene, const SolveOptions& options) {
  const double length = scene.scene.length;
  const ReleasedRod rod{scene.scene, scene.motion.value().begin};
  MotionAnswer answer{.of = scene,
                      .times = scene.motion->times(),
                      .arc_length = equal_arc_lengths(length, motion_points)};
  ReleasedMotion fine = release_rod(rod, answer.times, answer.arc_length, fine_terms, options);
  const ReleasedMotion coarse =
      release_rod(rod, answer.times, answer.arc_length, fewer_terms, options);
  const HingeLimit hinges = hinge_limit(rod, segments, answer.times, options);
  answer.frames = std::move(fine.frames);
  answer.second_method =
      fmt::format("hinges, N = {}, {} and {}, extrapolated", segments, 2 * segments, 4 * segments);
  answer.points_bound_m = largest_distance(answer.frames, hinges.frames) + hinges.error +
                          largest_distance(answer.frames, coarse.frames) + fine.step_error * length;
  const double agree = motions_agree * length;
  if (!(answer.points_bound_m <= agree)) {
    throw ConvergenceError(fmt::format("{}: energy and {} are {:.3g} m apart (allowed: {:.3g} m)",
                                       scene.id, answer.second_method, answer.points_bound_m,
                                       agree));
  }
  return answer;
}

std::vector<MotionAnswer> certified_motions(const std::vector<BatteryScene>& scenes, int threads,
                                            const SolveOptions& options) {
  return certify_each(scenes, threads, options, certified_motion);
}

}  // namespace dlo::compare
