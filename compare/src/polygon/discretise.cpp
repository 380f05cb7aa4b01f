#include "dlo/compare/discretise.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "dlo/compare/bending_rule.hpp"
#include "dlo/compare/error.hpp"
#include "polygon/natural_plane.hpp"
#include "polygon/point_layout.hpp"
#include "scene/scene_problem.hpp"

namespace dlo::compare {
namespace {

/// Moment of a straight rod's load about a grip, from one side of the grip [N m].
struct ClampMoment {
  double along = 0;  ///< moment for the actual directions of the forces and of the rod
  double most = 0;   ///< moment if all forces were perpendicular to the rod
};

ClampMoment clamp_moment(const Scene& scene, const Gripper& grip, double side) {
  const double rod = side > 0 ? scene.length - grip.at : grip.at;
  const Eigen::Vector3d direction = side * *grip.direction;
  Eigen::Vector3d moment = direction.cross(scene.weight_per_length()) * rod * rod / 2;
  double most = scene.weight_per_length().norm() * rod * rod / 2;
  for (const PointLoad& load : scene.loads) {
    const double arm = side * (load.at - grip.at);
    if (!(arm > 0)) continue;
    moment += direction.cross(load.force) * arm;
    most += load.force.norm() * arm;
  }
  for (const DistributedLoad& load : scene.distributed_loads) {
    for (const energy_model::LineLoad& piece : line_loads(load)) {
      const double from = side > 0 ? std::max(piece.begin, grip.at) : piece.begin;
      const double to = side > 0 ? piece.end : std::min(piece.end, grip.at);
      if (!(to > from)) continue;
      const double arm = side * ((from + to) / 2 - grip.at);
      moment += direction.cross(arm * piece.force_between(from, to) +
                                side * std::pow(to - from, 3) / 12 * piece.slope());
      most += arm * piece.force_between(from, to).norm();
    }
  }
  return {moment.norm(), most};
}

/// Returns the default design curvature, at which a moment-matched c_b is exact [1/m]. With one
/// clamp it is the curvature at the clamp of a straight rod under the load, but at least a tenth of
/// what the load could cause if it were perpendicular to the rod, since a rod along its load bends
/// into other shapes than the straight one. With other grips it is the RMS curvature of the start
/// shape, plus the curvature that the load would cause in a straight rod between two clamps, which
/// the load does not exceed.
double design_curvature(const Scene& scene, const Layout& layout, const Eigen::Matrix3Xd& start) {
  const Gripper& grip = scene.grippers.front();
  if (scene.grippers.size() == 1 && grip.direction) {
    double curvature = 0;
    for (const double side : {-1.0, 1.0}) {
      const ClampMoment moment = clamp_moment(scene, grip, side);
      curvature = std::max(curvature, std::max(moment.along, moment.most / 10));
    }
    return curvature / scene.bending_stiffness();
  }
  double turned = 0;
  for (Eigen::Index i = 1; i + 1 < start.cols(); ++i) {
    const Eigen::Vector3d u = (start.col(i) - start.col(i - 1)).normalized();
    const Eigen::Vector3d v = (start.col(i + 1) - start.col(i)).normalized();
    const double share = (layout.rest_lengths[i - 1] + layout.rest_lengths[i]) / 2;
    turned += std::pow(2 * std::asin(std::min(1.0, (v - u).norm() / 2)), 2) / share;
  }
  double longest = 0;
  double begin = 0;
  for (const std::size_t index : layout.along) {
    longest = std::max(longest, scene.grippers[index].at - begin);
    begin = scene.grippers[index].at;
  }
  longest = std::max(longest, scene.length - begin);
  double moment = scene.weight_per_length().norm() * longest * longest / 12;
  for (const PointLoad& load : scene.loads) moment += load.force.norm() * longest / 8;
  for (const DistributedLoad& load : scene.distributed_loads) moment += load.size() * longest / 8;
  return std::sqrt(turned / scene.length) + moment / scene.bending_stiffness();
}

void derive_bending(const Scene& scene, const ForceModelSettings& settings, const Layout& layout,
                    Discretisation& result) {
  if (settings.law == BendingLaw::hooke) {
    result.rod.bending = {force_model::BendingLaw::hooke, scene.bending_stiffness()};
    return;
  }
  Parameters& parameters = result.parameters;
  if (settings.c_b) {
    parameters.c_b = *settings.c_b;
  } else {
    parameters.design_curvature = settings.design_curvature
                                      ? *settings.design_curvature
                                      : design_curvature(scene, layout, result.starts.front());
    const double alpha = parameters.design_curvature * parameters.segment_length;
    if (!(alpha > 0 && alpha < std::numbers::pi)) {
      throw InputError(
          fmt::format("{}: force_model.design_curvature = {:g} 1/m: with {} points a joint would "
                      "rotate by {:g} rad "
                      "(allowed: > 0 and < pi; give design_curvature, c_b or other points)",
                      scene.file, parameters.design_curvature, settings.points, alpha));
    }
    parameters.c_b =
        paper_bending_stiffness(settings.bending_rule, scene.bending_stiffness(),
                                parameters.design_curvature, parameters.segment_length);
  }
  result.rod.bending = {force_model::BendingLaw::paper, parameters.c_b};
}

/// Interval of the rod whose bend a polygon concentrates in one joint, or whose weight it
/// concentrates in one point: from the middle of the segment before the point to the middle of the
/// segment after it [m].
struct Cell {
  double begin = 0;
  double end = 0;
};

Cell cell_of(const Scene& scene, const Layout& layout, Eigen::Index point) {
  const std::vector<double>& s = layout.arc_length;
  const auto i = static_cast<std::size_t>(point);
  const auto on_rod = [&](double at) { return std::clamp(at, 0.0, scene.length); };
  return {i > 0 ? on_rod((s[i - 1] + s[i]) / 2) : on_rod(s.front()),
          i + 1 < s.size() ? on_rod((s[i] + s[i + 1]) / 2) : on_rod(s.back())};
}

/// Sets joints that differ from each other or have a twist or a rest angle: those of a rod with
/// sections, of a rod twisted by grips, and of an intrinsically curved rod.
void derive_unlike_joints(const Scene& scene, const ForceModelSettings& settings,
                          const Layout& layout, Discretisation& result) {
  const bool is_curved = models_natural_curvature(scene, settings);
  if (is_curved && plane_transform(scene, settings)) {
    throw InputError(fmt::format(
        "{}: rod.natural_curvature: not in the plane z = 0 (allowed here: z = 0 of positions, "
        "directions, forces and normals; dlo solve and dlo compare rotate other planes into it)",
        scene.file));
  }
  const Eigen::Index joints = settings.points - 2;
  force_model::Bending& bending = result.rod.bending;
  force_model::Twist& twist = result.rod.twist;
  const bool is_twisted = models_twist(scene, settings);
  if (is_twisted) twist.stiffness = scene.twisting_stiffness();
  if (!scene.sections.empty()) bending.stiffnesses.resize(joints);
  if (!scene.sections.empty() && is_twisted) twist.stiffnesses.resize(joints);
  if (is_curved) bending.natural_turns.resize(joints);
  for (Eigen::Index i = 0; i < joints; ++i) {
    const Cell cell = cell_of(scene, layout, i + 1);
    const double length = cell.end - cell.begin;
    if (bending.stiffnesses.size() > 0) {
      const double EI = length / scene.bending_compliance(cell.begin, cell.end);
      bending.stiffnesses[i] = EI / scene.bending_stiffness() * bending.stiffness;
    }
    if (twist.stiffnesses.size() > 0) {
      twist.stiffnesses[i] = length / scene.twisting_compliance(cell.begin, cell.end);
    }
    if (!is_curved) continue;
    bending.natural_turns[i] = scene.natural_curvature(cell.begin, cell.end).z() * length;
  }
  if (!is_curved) return;
  Eigen::Index most = 0;
  const double largest = bending.natural_turns.cwiseAbs().maxCoeff(&most);
  if (!(largest < force_model::hooke_fold_angle)) {
    const Cell cell = cell_of(scene, layout, most + 1);
    throw InputError(fmt::format(
        "{}: force_model.points = {}: at rest a joint would rotate by {:.3g} rad, as the rod is "
        "curved by {:.4g} 1/m (allowed: less than {:g} rad, {} points or more)",
        scene.file, settings.points, largest, largest / (cell.end - cell.begin),
        force_model::hooke_fold_angle,
        static_cast<long>(std::ceil(settings.points * largest / 1.5))));
  }
  for (Eigen::Matrix3Xd& start : result.starts) start.row(2).setZero();
}

/// Returns half the length of a point's adjacent segments, 0 for a point inside an end gripper [m].
/// For equal segments the value is the same to the last digit, in contrast to a cell between two
/// arc lengths.
double weighing_length(const Scene& scene, const Layout& layout, Eigen::Index point) {
  const double s = layout.arc_length[static_cast<std::size_t>(point)];
  if (s < 0 || s > scene.length) return 0;
  const Eigen::VectorXd& L = layout.rest_lengths;
  return ((point > 0 ? L[point - 1] : 0) + (point < L.size() ? L[point] : 0)) / 2;
}

void add_weights(const Scene& scene, const ForceModelSettings& settings, const Layout& layout,
                 Discretisation& result) {
  const Eigen::Index N = settings.points;
  result.weights.setZero(3, N);
  for (Eigen::Index i = 0; i < N; ++i) {
    const bool equal = settings.bookkeeping == Bookkeeping::paper;
    const double share = scene.length / static_cast<double>(N);
    if (scene.sections.empty()) {
      const double length = equal ? share : weighing_length(scene, layout, i);
      result.weights.col(i) = length * scene.weight_per_length();
    } else {
      const auto at = static_cast<double>(i);
      const Cell cell = equal ? Cell{at * share, i + 1 == N ? scene.length : (at + 1) * share}
                              : cell_of(scene, layout, i);
      result.weights.col(i) = scene.weight_between(cell.begin, cell.end);
    }
    if (settings.bookkeeping == Bookkeeping::paper && settings.point_weight) {
      result.weights.col(i) = *settings.point_weight * scene.gravity.normalized();
    }
  }
  result.parameters.point_weight = result.weights.col(N / 2).norm();
}

void add_loads(const Scene& scene, const Layout& layout, Discretisation& result) {
  const std::vector<double>& s = layout.arc_length;
  result.rod.loads = result.weights;
  // The load on the cell of a point acts on the point. Sums and moments are then accurate to second
  // order in L.
  for (const DistributedLoad& load : scene.distributed_loads) {
    for (Eigen::Index i = 0; i < result.rod.loads.cols(); ++i) {
      const Cell cell = cell_of(scene, layout, i);
      result.rod.loads.col(i) += load.force_between(cell.begin, cell.end);
    }
  }
  for (const PointLoad& load : scene.loads) {
    const auto above = std::upper_bound(s.begin() + 1, s.end() - 1, load.at);
    const Eigen::Index right = above - s.begin();
    const double share =
        std::clamp((load.at - *(above - 1)) / layout.rest_lengths[right - 1], 0.0, 1.0);
    result.rod.loads.col(right - 1) += (1 - share) * load.force;
    result.rod.loads.col(right) += share * load.force;
  }
}

/// Rejects rods with two bending stiffnesses, since a joint of a polygon has one stiffness about
/// every axis.
/// @throws InputError
void require_round(const Scene& scene) {
  if (!scene.has_two_stiffnesses()) return;
  const bool of_rod = scene.bending_stiffness_2().has_value();
  throw InputError(fmt::format(
      "{}: {}.bending_stiffness: two values, about d1 and d2, which the polygons of models force "
      "and chain have no axes for (allowed here: one value; of two: --model energy or exact)",
      scene.file, of_rod ? "rod" : "section"));
}

}  // namespace

double largest_strain(const Scene& scene, const ForceModelSettings& settings) {
  const bool asked = settings.c_c && *settings.c_c <= scene.axial_stiffness();
  return asked ? 0.5 : 0.01;
}

void set_obstacles(const Scene& scene, const std::vector<std::size_t>& obstacles,
                   Discretisation& discretisation) {
  const double L = discretisation.parameters.segment_length;
  force_model::Rod& rod = discretisation.rod;
  rod.walls.clear();
  rod.solids.clear();
  discretisation.walls.clear();
  discretisation.solids.clear();
  for (const std::size_t i : obstacles) {
    const Obstacle& obstacle = scene.obstacles[i];
    const obstacle::Body& body = obstacle.body;
    const double stiffness = std::isfinite(obstacle.stiffness) ? obstacle.stiffness * L
                                                               : discretisation.parameters.c_c / L;
    if (body.is_half_space()) {
      rod.walls.push_back(
          {body.centre() + body.radius() * body.normal(), body.normal(), stiffness});
      discretisation.walls.push_back(i);
    } else {
      rod.solids.push_back({body, stiffness, obstacle::samples_per_segment(body, L)});
      discretisation.solids.push_back(i);
    }
  }
}

Discretisation discretise(const Scene& scene, const ForceModelSettings& settings) {
  if (settings.joint_law) {
    throw InputError(fmt::format(
        "{}: force_model.joint_law = \"{}\": only model chain supports this key (allowed: dlo "
        "solve --model chain, or no joint_law)",
        scene.file, to_string(*settings.joint_law)));
  }
  require_round(scene);
  scene.require_no_couples("the polygons of models force and chain");
  const Layout layout = lay_out(scene, settings);
  const double L = layout.segment_length;
  Discretisation result;
  result.length = scene.length;
  result.arc_length = layout.arc_length;
  result.parameters.segment_length = L;
  result.parameters.c_c = settings.c_c.value_or(scene.axial_stiffness());
  result.rod.rest_lengths = layout.rest_lengths;
  result.rod.c_c = result.parameters.c_c;
  result.rod.grips = grips_of(scene, layout);
  require_feasible_grips(scene, settings, layout, result.rod.grips);
  set_obstacles(scene, obstacles_in_reach(scene, settings), result);
  const std::vector<Side> sides = scene.grippers.size() == 1
                                      ? std::vector<Side>{Side::along_load}
                                      : std::vector<Side>{Side::along_load, Side::against_load};
  for (const Side side : sides) {
    Eigen::Matrix3Xd start = start_shape(scene, layout.along, layout.arc_length, side);
    for (const force_model::Grip& grip : result.rod.grips) {
      start.middleCols(grip.first_point, grip.targets.cols()) = grip.targets;
    }
    keep_free_ends_clear(result.rod, start);
    result.starts.push_back(std::move(start));
  }
  derive_bending(scene, settings, layout, result);
  derive_unlike_joints(scene, settings, layout, result);
  add_weights(scene, settings, layout, result);
  add_loads(scene, layout, result);
  return result;
}

Shape Discretisation::shape(const Eigen::Matrix3Xd& points) const {
  Shape result;
  result.arc_length = arc_length;
  result.points = points;
  for (const force_model::Grip& grip : rod.grips) {
    if (arc_length.front() < 0 && grip.first_point == 0) {
      result.arc_length.front() = 0;
      result.points.leftCols<1>() = grip.reference;
      result.half_at_start = true;
    }
    if (arc_length.back() > length && grip.first_point == points.cols() - 2) {
      result.arc_length.back() = length;
      result.points.rightCols<1>() = grip.reference;
      result.half_at_end = true;
    }
  }
  return result;
}

}  // namespace dlo::compare
