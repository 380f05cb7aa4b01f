#include "explain/scene_causes.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>
#include <vector>

#include "base/timer.hpp"
#include "dlo/compare/error.hpp"
#include "least_squares/gauss_newton.hpp"
#include "least_squares/scene_change.hpp"
#include "scene/scene_problem.hpp"

namespace dlo::compare {
namespace {

/// Smallest relative decrease of the mean square that a step must promise.
constexpr double least_gain = 0.1;

/// Sets the rods to an equilibrium of the scene at the start of the cause: if the start is zero,
/// the one to which the compared equilibrium leads, else the one that a search finds. If the cause
/// changes how the rod is held, the one that a search finds is used if it is nearer to the shape.
/// Returns false if there is no equilibrium.
bool start_at_equilibrium(const SceneCause& cause, const energy_model::Equilibrium& rod,
                          FittedRods& rods) {
  if (cause.start.isZero()) rods.set_initial_rods({rod});
  FittedRods::State state = rods.state(cause.start);
  if (cause.changes_support) {
    rods.clear_initial_rods();
    FittedRods::State lowest = rods.state(cause.start);
    if (lowest.sum_of_squares[0] < state.sum_of_squares[0]) state = std::move(lowest);
  }
  rods.set_initial_rods(state.rods);
  return state.rods[0].has_value();
}

/// Returns the numbers whose rod is nearest to the shape, and sets `rods` to that rod.
Eigen::VectorXd fit_parameters(const SceneCause& cause, double noise, FittedRods& rods) {
  if (cause.difference_step.isZero()) return cause.start;
  GaussNewton fit(rods, cause.start, {.noise = noise, .last_step = 0.05, .least_gain = least_gain});
  const FittedRods::Rods start = rods.rods();
  try {
    (void)fit.descend();
  } catch (const ConvergenceError&) {
    // The time limit ends the fit; the numbers so far are used.
  }
  rods.set_initial_rods(fit.rods().empty() ? start : fit.rods());
  return fit.values();
}

constexpr double degree = std::numbers::pi / 180;

using Numbers = Eigen::VectorXd;

/// Returns a cause whose numbers change the scene. @param difference_step, longest_step  of every
/// number
template <typename Change, typename Words>
SceneCause make_cause(const Scene& scene, const Numbers& start, double difference_step,
                      double longest_step, const Change& change, const Words& words) {
  const auto changed = [scene, change](const Numbers& p) {
    Scene result = scene;
    change(result, p);
    return result;
  };
  return {start, Numbers::Constant(start.size(), difference_step), longest_step, changed, words};
}

SceneCause stiffness(const Scene& scene) {
  return make_cause(
      scene, Numbers::Zero(1), 0.02, 1.5,
      [](Scene& changed, const Numbers& p) { changed.scale_modulus(std::exp(p[0])); },
      [scene](const Scene&, const Numbers& p) {
        std::string text =
            fmt::format("the bending stiffness is {:.3g} times the scene's", std::exp(p[0]));
        if (is_loaded_by_weight_alone(scene)) {
          text += fmt::format(", or the weight {:.3g} times", std::exp(-p[0]));
        }
        return text;
      });
}

SceneCause torsional_stiffness(const Scene& scene) {
  return make_cause(
      scene, Numbers::Zero(1), 0.05, 1.5,
      [](Scene& changed, const Numbers& p) { changed.scale_torsion(std::exp(p[0])); },
      [](const Scene&, const Numbers& p) {
        return fmt::format("the torsional stiffness is {:.3g} times the scene's", std::exp(p[0]));
      });
}

/// Returns the cause that gravity has another size or direction.
/// @param down  direction at the start of the fit
SceneCause gravity(const Scene& scene, const Eigen::Vector3d& down) {
  const double size = scene.gravity.norm();
  return make_cause(
      scene, down * size - scene.gravity, 0.02 * size, size,
      [](Scene& changed, const Numbers& p) { changed.gravity += p; },
      [scene](const Scene& changed, const Numbers&) {
        const Eigen::Vector3d& g = changed.gravity;
        const double turned = std::atan2(g.cross(scene.gravity).norm(), g.dot(scene.gravity));
        return fmt::format("gravity is [{:.3g}, {:.3g}, {:.3g}] m/s^2, rotated by {:.3g} deg",
                           g.x(), g.y(), g.z(), turned / degree);
      });
}

/// Returns the cause that the rod has the length of the shape, for which nothing is fitted.
SceneCause length(const Scene& scene, double of_shape) {
  return make_cause(
      scene, Numbers::Constant(1, std::log(of_shape / scene.length)), 0, 0,
      [](Scene& changed, const Numbers& p) { scale_length(changed, std::exp(p[0])); },
      [scene](const Scene& changed, const Numbers&) {
        return fmt::format("the rod is {:.4g} m long, not {:.4g} m", changed.length, scene.length);
      });
}

/// Returns the cause that a clamp has another direction: in the plane with this normal, or any.
SceneCause direction(const Scene& scene, std::size_t index,
                     const std::optional<Eigen::Vector3d>& normal) {
  const Eigen::Matrix3Xd ways = rotation_axes(*scene.grippers[index].direction, normal);
  return make_cause(
      scene, Numbers::Zero(ways.cols()), 1 * degree, 40 * degree,
      [index, ways](Scene& changed, const Numbers& p) {
        rotate_clamp(changed.grippers[index], ways * p);
      },
      [index](const Scene& changed, const Numbers& p) {
        const Eigen::Vector3d& to = *changed.grippers[index].direction;
        return fmt::format("gripper {} is rotated by {:.3g} deg, to [{:.4g}, {:.4g}, {:.4g}]",
                           index + 1, p.norm() / degree, to.x(), to.y(), to.z());
      });
}

/// Returns the cause that a gripper has another position: in the plane with this normal, or any.
SceneCause position(const Scene& scene, std::size_t index,
                    const std::optional<Eigen::Vector3d>& normal) {
  const Eigen::Matrix3Xd ways = translation_directions(normal);
  return make_cause(
      scene, Numbers::Zero(ways.cols()), 1e-3 * scene.length, 0.2 * scene.length,
      [index, ways](Scene& changed, const Numbers& p) {
        changed.grippers[index].position += ways * p;
      },
      [index, ways](const Scene&, const Numbers& p) {
        const Eigen::Vector3d displacement = ways * p * 1e3;
        return fmt::format("gripper {} is {:.3g} mm away, by [{:.3g}, {:.3g}, {:.3g}] mm",
                           index + 1, displacement.norm(), displacement.x(), displacement.y(),
                           displacement.z());
      });
}

std::string text_of(const Eigen::Vector3d& direction) {
  const Eigen::Vector3d shown = direction.unaryExpr([](double x) {
    constexpr double rounding = 1e-6;
    return std::abs(x) < rounding ? 0.0 : x;
  });
  return fmt::format("[{:.4g}, {:.4g}, {:.4g}]", shown.x(), shown.y(), shown.z());
}

/// Returns the direction of the segment of a shape at an arc length; x if its points coincide.
Eigen::Vector3d tangent_at(const Shape& shape, double at) {
  const std::vector<double>& s = shape.arc_length;
  const auto above = std::upper_bound(s.begin() + 1, s.end() - 1, at);
  const Eigen::Index i = above - s.begin();
  const Eigen::Vector3d along = shape.points.col(i) - shape.points.col(i - 1);
  return along.norm() > 0 ? along.normalized() : Eigen::Vector3d::UnitX();
}

/// Returns the cause that pins hold directions; the fit starts at the directions of the shape.
SceneCause pins_to_clamps_cause(const Scene& scene, const std::vector<std::size_t>& pins,
                                const Shape& shape, const std::optional<Eigen::Vector3d>& normal) {
  Scene held = scene;
  std::vector<Eigen::Matrix3Xd> ways;
  ways.reserve(pins.size());
  Eigen::Index count = 0;
  for (const std::size_t i : pins) {
    Eigen::Vector3d along = tangent_at(shape, scene.grippers[i].at);
    if (normal) along = (along - along.dot(*normal) * *normal).normalized();
    held.grippers[i].direction = along;
    ways.push_back(rotation_axes(along, normal));
    count += ways.back().cols();
  }
  const auto turn = [pins, ways](Scene& changed, const Numbers& p) {
    Eigen::Index first = 0;
    for (std::size_t k = 0; k < pins.size(); ++k) {
      rotate_clamp(changed.grippers[pins[k]], ways[k] * p.segment(first, ways[k].cols()));
      first += ways[k].cols();
    }
  };
  const auto words = [pins](const Scene& changed, const Numbers&) {
    std::vector<std::string> directions;
    for (const std::size_t i : pins) directions.push_back(text_of(*changed.grippers[i].direction));
    if (pins.size() == 1) {
      return fmt::format("gripper {} holds its direction, {}: a clamp, not a pin", pins[0] + 1,
                         directions[0]);
    }
    for (std::size_t k = 0; k < pins.size(); ++k) {
      directions[k] = fmt::format("gripper {} {}", pins[k] + 1, directions[k]);
    }
    return fmt::format("the pins hold their directions, {}: clamps, not pins",
                       fmt::join(directions, ", "));
  };
  SceneCause cause = make_cause(held, Numbers::Zero(count), 1 * degree, 40 * degree, turn, words);
  cause.changes_support = true;
  return cause;
}

/// Returns the cause that clamps let the rod rotate.
SceneCause clamps_to_pins_cause(const Scene& scene, const std::vector<std::size_t>& clamps) {
  Scene free = scene;
  for (const std::size_t i : clamps) {
    free.grippers[i].direction.reset();
    free.grippers[i].frame.reset();
  }
  const std::string words =
      clamps.size() == 1
          ? fmt::format("gripper {} lets the rod rotate: a pin, not a clamp", clamps[0] + 1)
          : "the clamps let the rod rotate: pins, not clamps";
  SceneCause cause = make_cause(
      free, Numbers::Zero(0), 0, 0, [](Scene&, const Numbers&) {},
      [words](const Scene&, const Numbers&) { return words; });
  cause.changes_support = true;
  return cause;
}

/// Adds the exchange of clamp for pin for each clamp, and for all if there are several; then the
/// exchange of pin for clamp for each pin, and for all if there are several.
void add_support_causes(std::vector<SceneCause>& causes, const Scene& scene, const Shape& shape,
                        const std::optional<Eigen::Vector3d>& normal) {
  std::vector<std::size_t> pins;
  std::vector<std::size_t> clamps;
  for (std::size_t i = 0; i < scene.grippers.size(); ++i) {
    (scene.grippers[i].direction ? clamps : pins).push_back(i);
  }
  for (const std::size_t i : clamps) causes.push_back(clamps_to_pins_cause(scene, {i}));
  if (clamps.size() > 1) causes.push_back(clamps_to_pins_cause(scene, clamps));
  for (const std::size_t i : pins)
    causes.push_back(pins_to_clamps_cause(scene, {i}, shape, normal));
  if (pins.size() > 1) causes.push_back(pins_to_clamps_cause(scene, pins, shape, normal));
}

SceneCause natural_curvature(const Scene& scene) {
  const double unit = 1 / scene.length;
  return make_cause(
      scene, Numbers::Zero(1), 0.02 * unit, 3 * unit,
      [](Scene& changed, const Numbers& p) {
        increase_natural_curvature(changed, 0, {0, p[0]});
      },
      [scene](const Scene&, const Numbers& p) {
        return fmt::format("the rod is intrinsically curved, {:.3g} 1/m{}",
                           scene.natural_strain.y() + p[0],
                           scene.naturally_curved() ? " in the mean" : "");
      });
}

SceneCause twist(const Scene& scene, std::size_t last) {
  return make_cause(
      scene, Numbers::Constant(1, 60 * degree), 2 * degree, 60 * degree,
      [last](Scene& changed, const Numbers& p) {
        for (Gripper& gripper : changed.grippers) {
          if (gripper.direction && !gripper.frame) gripper.frame.emplace();
        }
        changed.grippers[last].frame->roll += p[0];
        if (changed.torsional_stiffness) return;
        changed.torsional_stiffness = changed.bending_stiffness() / (1 + assumed_poisson_ratio);
      },
      [last](const Scene&, const Numbers& p) {
        return fmt::format("gripper {} turns the rod about its direction by {:.3g} deg (twist)",
                           last + 1, p[0] / degree);
      });
}

/// Adds another gravity, fitted from the scene's and from four directions perpendicular to it.
void add_gravity_causes(std::vector<SceneCause>& causes, const Scene& scene) {
  const Eigen::Vector3d down = scene.gravity.normalized();
  const Eigen::Vector3d across = down.unitOrthogonal();
  const std::size_t first = causes.size();
  causes.push_back(gravity(scene, down));
  for (const Eigen::Vector3d& other : {across, Eigen::Vector3d(down.cross(across))}) {
    causes.push_back(gravity(scene, other));
    causes.push_back(gravity(scene, -other));
  }
  for (std::size_t i = first; i < causes.size(); ++i) causes[i].cause_group = "gravity";
}

}  // namespace

std::optional<FittedCause> fit_cause(const SceneCause& cause, const MeasuredShape& shape,
                                     const energy_model::Equilibrium& rod,
                                     const ShapeCheckOptions& options, double noise,
                                     const Timer& timer) {
  const std::vector<Scene> scene = {cause.changed(cause.start)};
  MeasuredShapes measured(scene, {shape},
                          {.pose = options.pose,
                           .arc_lengths = options.arc_lengths,
                           .weights = PointWeights::by_length,
                           .solve = options.solve,
                           .flat = FlatShapes::measured},
                          timer);
  std::vector<Unknown> unknowns;
  for (const double difference_step : cause.difference_step) {
    unknowns.push_back({.difference_step = difference_step, .longest_step = cause.longest_step});
  }
  FittedRods rods(
      measured, [&](std::size_t, const Eigen::VectorXd& p) { return cause.changed(p); }, unknowns);
  if (!start_at_equilibrium(cause, rod, rods)) return std::nullopt;
  const Eigen::VectorXd numbers = fit_parameters(cause, noise, rods);
  return FittedCause{numbers, *rods.rods()[0]};
}

bool is_loaded_by_weight_alone(const Scene& scene) {
  return scene.loads.empty() && scene.distributed_loads.empty() && !scene.drag &&
         scene.weight_per_length().norm() > 0;
}

std::vector<SceneCause> scene_causes(const Scene& scene, const Shape& shape,
                                     double estimated_shape_length, bool flat) {
  std::vector<SceneCause> causes = {stiffness(scene)};
  // GJ affects the shape only of a rod that twists.
  const bool twists = scene.prescribes_twist() || scene.has_material_directors();
  if (!flat && twists && scene.twisting_stiffness() > 0) {
    causes.push_back(torsional_stiffness(scene));
  }
  std::size_t last = 0;
  std::size_t clamps = 0;
  for (std::size_t i = 0; i < scene.grippers.size(); ++i) {
    if (!scene.grippers[i].direction) continue;
    ++clamps;
    if (clamps == 1 || scene.grippers[i].at > scene.grippers[last].at) last = i;
  }
  const bool has_defined_roll = scene.planar() || (clamps > 0 && scene.has_material_directors());
  if (clamps > 0 && has_defined_roll && !scene.prescribes_twist()) {
    causes.push_back(natural_curvature(scene));
  }
  // Another length is a possible cause only if the length of the points differs by at least this.
  constexpr double noticeable = 0.005;
  const double longer = std::abs(std::log(estimated_shape_length / scene.length));
  if (longer > noticeable && longer < 1) causes.push_back(length(scene, estimated_shape_length));
  const std::optional<Eigen::Vector3d> normal = flat ? scene.plane_normal() : std::nullopt;
  for (std::size_t i = 0; i < scene.grippers.size(); ++i) {
    const Gripper& gripper = scene.grippers[i];
    const bool held_frame = gripper.frame && gripper.frame->d1;
    if (gripper.direction && !held_frame) causes.push_back(direction(scene, i, normal));
    // A displaced single gripper only shifts the whole shape. The cause "the file has another
    // origin" (file_causes) covers this case.
    if (scene.grippers.size() > 1 || !scene.obstacles.empty()) {
      causes.push_back(position(scene, i, normal));
    }
  }
  add_support_causes(causes, scene, shape, normal);
  if (scene.gravity.norm() > 0) add_gravity_causes(causes, scene);
  const bool round = !scene.has_material_directors();
  if (!flat && clamps == scene.grippers.size() && clamps > 1 && round) {
    causes.push_back(twist(scene, last));
  }
  return causes;
}

}  // namespace dlo::compare
