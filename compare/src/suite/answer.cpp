#include "suite/answer.hpp"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <optional>

#include "dlo/compare/deviation.hpp"
#include "dlo/compare/error.hpp"
#include "dlo/compare/shape.hpp"
#include "dlo/compare/solve.hpp"
#include "polygon/shape_loads.hpp"
#include "record/solution_fields.hpp"
#include "released/hinge_motion.hpp"
#include "scene/scene_problem.hpp"

namespace dlo::compare {
namespace {

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

/// Returns EI kappa of the inner joints; zero at the joints adjacent to the ends, where discrete
/// springs depend on the assumed position of the clamp. With another power the moments are EI / h
/// c_max (c / c_max)^power, where c = 2 sin(angle / 2), c_max is its largest value and h the
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
double resolution(const Scene& scene, const PointForces& forces) {
  constexpr double second_order_coefficient = 0.25;
  const double h = scene.length / static_cast<double>(forces.loads.cols() - 1);
  const double force = forces.weights.colwise().norm().sum() + forces.loads.colwise().norm().sum();
  return second_order_coefficient * h * h * force / scene.bending_stiffness();
}

/// Number of points of the chain with which a rod that stretches is compared.
constexpr int fine_chain = 1024;

double finite_or_zero(double estimate) { return std::isfinite(estimate) ? estimate : 0; }

AnswerBounds bounds_between(const Solution& a, const Solution& b) {
  AnswerBounds bounds;
  bounds.points_m = largest_distance({a.shape.points}, {b.shape.points}) +
                    finite_or_zero(a.error_estimate) + finite_or_zero(b.error_estimate);
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
/// eigenvalue of the answer itself and Answer::is_lowest.
void add_other_equilibria(Answer& answer) {
  const std::vector<double>& s = answer.first.shape.arc_length;
  const AllSolutions all = solve_all(answer.battery_scene.scene, {}, s);
  const double length = answer.battery_scene.scene.length;
  const double large = magnitudes(answer.battery_scene.scene).energy;
  for (const Solution& one : all.solutions) {
    const double difference = rms(s, one.shape.points - answer.first.shape.points);
    if (difference < method_tolerance * length) {
      answer.first.smallest_eigenvalue = one.smallest_eigenvalue;
      continue;
    }
    answer.others.push_back({one.energy.total(), is_stable(one), difference});
    constexpr double tolerance = 1e-9;
    if (is_stable(one) && one.energy.total() < answer.first.energy.total() - tolerance * large) {
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

/// Reverses the order of a rod's points and of the forces on them.
void reverse_order(Shape& rod, PointForces& forces, double length) {
  for (Eigen::Matrix3Xd* each : {&rod.points, &forces.weights, &forces.loads}) {
    *each = each->rowwise().reverse().eval();
  }
  std::ranges::reverse(rod.arc_length);
  for (double& s : rod.arc_length) s = length - s;
}

}  // namespace

std::optional<MomentBalance> moment_balance(const Scene& scene, const Shape& shape, double power) {
  const bool plain = scene.sections.empty() && !scene.has_material_directors() &&
                     !scene.prescribes_twist() && !scene.has_couples() &&
                     scene.stretch == Stretch::none && obstacles_in_reach(scene).empty();
  constexpr Eigen::Index least_count = 6;
  const Eigen::Index n = shape.points.cols() - 1;
  if (!plain || n < least_count || scene.grippers.size() > 2) return std::nullopt;
  const Gripper* first = nullptr;
  const Gripper* last = nullptr;
  for (const Gripper& gripper : scene.grippers) {
    if (gripper.at != 0 && gripper.at != scene.length) return std::nullopt;
    (gripper.at == 0 ? first : last) = &gripper;
  }
  Shape rod = shape;
  PointForces forces = forces_on_points(scene, shape.arc_length);
  if (first == nullptr) {  // the order begins at a held end
    reverse_order(rod, forces, scene.length);
    std::swap(first, last);
  }
  const Eigen::Index unknown = last == nullptr ? 0 : last->direction ? 6 : 3;
  const Eigen::Index from = 2;
  const Eigen::Index to = n - 2;
  const auto inside = [&](const auto& rows) {
    return rows.middleRows(3 * (from - 1), 3 * (to - from + 1)).eval();
  };
  const Eigen::VectorXd bending = inside(bending_moments(scene, rod, power));
  if (!(bending.norm() > 0)) return std::nullopt;
  constexpr double negligible_load_share = 1e-9;
  const Eigen::VectorXd of_weight = inside(moments_beyond(rod.points, forces.weights));
  const Eigen::VectorXd of_loads = inside(moments_beyond(rod.points, forces.loads));
  const bool has_weight = of_weight.norm() > negligible_load_share * bending.norm();
  const bool has_loads = of_loads.norm() > negligible_load_share * bending.norm();
  if (!has_weight && !has_loads && unknown == 0) return MomentBalance{.imbalance = 1};
  // The unknowns are the columns, and the right-hand side contains the rest. Without loads the
  // moments do not depend on the stiffness. With only weight or only other loads, the factors of
  // stiffness and load are inverse to each other, so that only the stiffness is fitted.
  Eigen::MatrixXd columns(bending.size(), 0);
  const auto append_column = [&](const Eigen::VectorXd& column) {
    columns.conservativeResize(Eigen::NoChange, columns.cols() + 1);
    columns.rightCols<1>() = column;
  };
  // Components of the force and of the torque at the far end.
  for (Eigen::Index k = 0; k < unknown; ++k) {
    const Eigen::Vector3d unit = Eigen::Vector3d::Unit(k % 3);
    Eigen::Matrix3Xd force = Eigen::Matrix3Xd::Zero(3, n + 1);
    if (k < 3) force.col(n) = unit;
    append_column(k < 3 ? inside(moments_beyond(rod.points, force))
                        : Eigen::VectorXd(unit.replicate(to - from + 1, 1)));
  }
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
  constexpr double least_stiffness_factor = 1e-3;
  result.resolution =
      resolution(scene, forces) / std::clamp(result.stiffness, least_stiffness_factor, 1.0);
  const double size =
      std::max(std::abs(result.stiffness) * bending.norm(), least_stiffness_factor * right.norm());
  result.imbalance = (columns * found - right).norm() / size;
  return result;
}

Model answer_model(const Scene& scene) {
  return scene.stretch != Stretch::none ? Model::exact : Model::energy;
}

Answer certified_answer(const BatteryScene& scene) {
  const std::vector<double> s = equal_arc_lengths(scene.scene.length, answer_points);
  const bool stretches = scene.scene.stretch != Stretch::none;
  Answer answer{.battery_scene = scene};
  answer.first = solve(scene.scene, answer_model(scene.scene), {}, s);
  Solution second;
  if (stretches) {
    Scene fine = scene.scene;
    fine.force_model.points = fine_chain;
    second = solve(fine, Model::chain, {}, s);
    answer.second_method = fmt::format("chain, N = {}", fine_chain);
  } else {
    second = solve(scene.scene, Model::exact, {}, s);
    answer.second_method = to_string(Model::exact);
  }
  answer.bounds = bounds_between(answer.first, second);
  const double agree = (stretches ? chain_method_tolerance : method_tolerance) * scene.scene.length;
  if (!(answer.bounds.points_m <= agree)) {
    throw ConvergenceError(fmt::format("{}: {} and {} are {:.3g} m apart (allowed: {:.3g} m)",
                                       scene.id, to_string(answer.first.model),
                                       answer.second_method, answer.bounds.points_m, agree));
  }
  if (!stretches) add_other_equilibria(answer);
  return answer;
}

MotionAnswer certified_motion(const BatteryScene& scene) {
  const double length = scene.scene.length;
  const ReleasedRod rod{scene.scene, scene.motion.value().begin};
  MotionAnswer answer{.battery_scene = scene,
                      .times = scene.motion->times(),
                      .arc_length = equal_arc_lengths(length, motion_points)};
  ReleasedMotion fine = release_rod(rod, answer.times, answer.arc_length, fine_terms);
  const ReleasedMotion coarse = release_rod(rod, answer.times, answer.arc_length, fewer_terms);
  const HingeLimit hinges = hinge_limit(rod, segments, answer.times);
  answer.frames = std::move(fine.frames);
  answer.second_method =
      fmt::format("hinges, N = {}, {} and {}, extrapolated", segments, 2 * segments, 4 * segments);
  answer.points_bound_m = largest_distance(answer.frames, hinges.frames) + hinges.error +
                          largest_distance(answer.frames, coarse.frames) + fine.step_error * length;
  const double agree = motion_method_tolerance * length;
  if (!(answer.points_bound_m <= agree)) {
    throw ConvergenceError(fmt::format("{}: energy and {} are {:.3g} m apart (allowed: {:.3g} m)",
                                       scene.id, answer.second_method, answer.points_bound_m,
                                       agree));
  }
  return answer;
}

}  // namespace dlo::compare
