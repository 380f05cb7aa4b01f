#include "wire/wire_numbers.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "dlo/compare/error.hpp"
#include "least_squares/measured_shapes.hpp"
#include "least_squares/scene_change.hpp"
#include "wire/identifiable.hpp"

namespace dlo::compare {
namespace {

/// Stride of the differences by each number, relative or in rad. A rod next to the limit of its
/// stability responds far from linearly; with 1e-3, steps of the fit pointed uphill 1e-4 before the
/// optimum. The solver's error (1e-10 l) changes the differences by 1e-6.
constexpr double difference_step = 1e-4;

/// Prior standard deviation of each term of natural curvature, times the length [rad]. It is large,
/// because the stress-free shape may have several whole turns.
constexpr double prior_curvature_deviation = 10;

/// Prior standard deviation of ln(GJ / EI): a factor of ten.
constexpr double prior_torsion_deviation = 2.3;

/// Longest step of a roll for which the fit is nearly linear [rad].
constexpr double longest_roll_step = 0.5;
/// Prior deviation of a roll above which several starts are tried; below it the fit starts at the
/// scene's roll only [rad].
constexpr double searched_roll_deviation = 0.7;

constexpr double unknown = std::numeric_limits<double>::infinity();

/// Returns the normal of the plane in which a shape's grippers may be misplaced: the scene's plane
/// if no point was measured out of it.
std::optional<Eigen::Vector3d> plane_of(const Scene& scene, const MeasuredShape& shape) {
  return lies_in_a_plane(shape.points) ? scene.plane_normal() : std::nullopt;
}

/// Whether GJ affects the shape of a scene.
bool twists(const Scene& scene) { return scene.twisting_stiffness() > 0 && !scene.planar(); }

void add_natural_curvature(std::vector<WireNumber>& numbers, const std::vector<Scene>& scenes,
                           const std::vector<MeasuredShape>& shapes,
                           const MaterialFitOptions& options) {
  bool planar = options.roll_tolerance == 0;
  for (std::size_t i = 0; i < scenes.size(); ++i) {
    planar = planar && plane_of(scenes[i], shapes[i]).has_value();
  }
  // If the roll of the rod is unknown, its mean curvature is about d2 by definition.
  const bool turned = options.roll_tolerance > searched_roll_deviation;
  for (const Scene& scene : scenes) {
    if (scene.rest_shape) {
      throw InputError(
          fmt::format("{}: rod.rest_shape: defines the natural curvature that is to be fitted "
                      "(allowed: natural_curvature or none)",
                      scene.file));
    }
    Scene bent = scene;
    increase_natural_curvature(bent, 0, {0, 1 / scene.length});
    (void)bent.first_frame();
  }
  const double length = scenes.front().length;
  for (int term = 0; term < options.natural_curvature_terms; ++term) {
    for (const int axis : {2, 1}) {
      if (axis == 1 && (planar || (turned && term == 0))) continue;
      const Eigen::Vector2d about = axis == 1 ? Eigen::Vector2d::UnitX() : Eigen::Vector2d::UnitY();
      numbers.push_back({{.name = fmt::format("natural curvature{}, P_{}",
                                              planar ? "" : fmt::format(" about d{}", axis), term),
                          .unit = "1/m",
                          .prior_deviation = prior_curvature_deviation / length,
                          .shape = std::nullopt},
                         difference_step / length,
                         [about, term](Scene& scene, double value) {
                           increase_natural_curvature(scene, static_cast<std::size_t>(term),
                                                      value * about);
                         },
                         term});
    }
  }
}

void add_torsion(std::vector<WireNumber>& numbers, const std::vector<Scene>& scenes) {
  if (std::none_of(scenes.begin(), scenes.end(), twists)) {
    throw InputError(
        fmt::format("{}: no shape of this scene depends on the torsional stiffness (allowed: two "
                    "clamps that hold the rod's frame, roll or frame, or an intrinsically curved "
                    "rod that leaves its plane)",
                    scenes.front().file));
  }
  numbers.push_back(
      {{.name = "", .unit = "", .prior_deviation = prior_torsion_deviation, .shape = std::nullopt},
       difference_step,
       [](Scene& scene, double value) { scene.scale_torsion(std::exp(value)); }});
}

void add_directions(std::vector<WireNumber>& numbers, const Scene& scene,
                    const std::optional<std::size_t>& shape,
                    const std::optional<Eigen::Vector3d>& normal, double tolerance) {
  for (std::size_t i = 0; i < scene.grippers.size(); ++i) {
    if (!scene.grippers[i].direction) continue;
    const Eigen::Matrix3Xd ways = rotation_axes(*scene.grippers[i].direction, normal);
    for (Eigen::Index k = 0; k < ways.cols(); ++k) {
      const Eigen::Vector3d axis = ways.col(k);
      numbers.push_back({{.name = fmt::format("direction of gripper {}, about [{:.3g}, {:.3g}, "
                                              "{:.3g}]",
                                              i + 1, axis.x(), axis.y(), axis.z()),
                          .unit = "rad",
                          .prior_deviation = tolerance,
                          .shape = shape},
                         difference_step,
                         [i, axis](Scene& changed, double value) {
                           rotate_clamp(changed.grippers[i], value * axis);
                         }});
    }
  }
}

void add_positions(std::vector<WireNumber>& numbers, const Scene& scene,
                   const std::optional<std::size_t>& shape,
                   const std::optional<Eigen::Vector3d>& normal, double tolerance) {
  const Eigen::Matrix3Xd ways = translation_directions(normal);
  for (std::size_t i = 0; i < scene.grippers.size(); ++i) {
    for (Eigen::Index k = 0; k < ways.cols(); ++k) {
      const Eigen::Vector3d axis = ways.col(k);
      numbers.push_back({{.name = fmt::format("position of gripper {}, along [{:.3g}, {:.3g}, "
                                              "{:.3g}]",
                                              i + 1, axis.x(), axis.y(), axis.z()),
                          .unit = "m",
                          .prior_deviation = tolerance,
                          .shape = shape},
                         1e-4 * scene.length,
                         [i, axis](Scene& changed, double value) {
                           changed.grippers[i].position += value * axis;
                         }});
    }
  }
}

/// Returns the first clamp along the rod; null if there is none.
Gripper* first_clamp(Scene& scene) {
  Gripper* first = nullptr;
  for (Gripper& gripper : scene.grippers) {
    if (gripper.direction && (first == nullptr || gripper.at < first->at)) first = &gripper;
  }
  return first;
}

/// Whether a roll of the first clamp does not change any shape.
bool is_roll_invariant(const Scene& scene, const MaterialFitOptions& options) {
  return options.natural_curvature_terms == 0 && !scene.has_material_directors();
}

void add_rolls(std::vector<WireNumber>& numbers, Scene scene, std::size_t shape,
               const MaterialFitOptions& options) {
  const Gripper* const first = first_clamp(scene);
  bool is_first = true;
  for (std::size_t i = 0; i < scene.grippers.size(); ++i) {
    if (!scene.grippers[i].frame) continue;
    const bool rotates_rod = &scene.grippers[i] == first;
    const bool is_gauge = std::exchange(is_first, false) && is_roll_invariant(scene, options);
    if (is_gauge) continue;
    numbers.push_back(
        {.described = {.name = fmt::format("roll of gripper {}", i + 1),
                       .unit = "rad",
                       .prior_deviation = options.roll_tolerance,
                       .shape = shape},
         .difference_step = difference_step,
         .change = [i](Scene& changed, double value) { changed.grippers[i].frame->roll += value; },
         .longest_step = longest_roll_step,
         .rotates_rod = rotates_rod && options.roll_tolerance > searched_roll_deviation});
  }
}

/// Returns a unit vector perpendicular to a direction and to gravity, or to the direction alone if
/// the two are parallel.
Eigen::Vector3d horizontal_normal(const Eigen::Vector3d& direction,
                                  const Eigen::Vector3d& gravity) {
  const Eigen::Vector3d level = gravity.cross(direction);
  constexpr double vertical_tolerance = 1e-6;
  return level.norm() > vertical_tolerance * gravity.norm()
             ? Eigen::Vector3d(level.normalized())
             : Eigen::Vector3d(direction.unitOrthogonal());
}

/// Adds the tilt about the normal of the shapes' plane, or, for shapes in space, about all level
/// axes.
void add_camera_tilt(std::vector<WireNumber>& numbers, const std::vector<Scene>& scenes,
                     const std::vector<MeasuredShape>& shapes, double tolerance) {
  if (const std::string why = why_no_camera_tilt(scenes, shapes); !why.empty()) {
    throw InputError(why);
  }
  const Eigen::Matrix3Xd ways =
      rotation_axes(scenes.front().gravity.normalized(), plane_of(scenes.front(), shapes.front()));
  for (const Eigen::Vector3d axis : ways.colwise()) {
    numbers.push_back(
        {.described = {.name = fmt::format("camera tilt about [{:.3g}, {:.3g}, {:.3g}]", axis.x(),
                                           axis.y(), axis.z()),
                       .unit = "rad",
                       .prior_deviation = tolerance,
                       .shape = std::nullopt},
         .difference_step = difference_step,
         .change = [axis](Scene& scene, double value) { rotate_scene(scene, value * axis); },
         .camera_axis = axis});
  }
}

/// Checks that all scenes have the same clamps, since only then the clamps' errors can be shared.
/// @throws InputError
void require_equal_clamps(const std::vector<Scene>& scenes) {
  const std::vector<Gripper>& first = scenes.front().grippers;
  for (const Scene& scene : scenes) {
    const bool alike =
        std::equal(first.begin(), first.end(), scene.grippers.begin(), scene.grippers.end(),
                   [](const Gripper& a, const Gripper& b) {
                     return a.at == b.at && a.direction.has_value() == b.direction.has_value();
                   });
    if (alike) continue;
    throw InputError(
        fmt::format("{}: its grippers differ from those of {}, so they cannot share misalignments "
                    "(allowed: as many grippers, at the same arc lengths, clamps or pins)",
                    scene.file, scenes.front().file));
  }
}

}  // namespace

std::string why_no_camera_tilt(const std::vector<Scene>& scenes,
                               const std::vector<MeasuredShape>& shapes) {
  const Scene& first = scenes.front();
  const std::optional<Eigen::Vector3d> normal = plane_of(first, shapes.front());
  constexpr double parallel_tolerance = 1e-6;
  for (std::size_t i = 0; i < scenes.size(); ++i) {
    if (!is_bent_by_weight_alone(scenes[i])) {
      return fmt::format(
          "{}: a camera's tilt of a rod without weight, or with loads, a stream, obstacles or "
          "grippers that move (allowed: a rod that its weight alone bends)",
          scenes[i].file);
    }
    const std::optional<Eigen::Vector3d> other = plane_of(scenes[i], shapes[i]);
    const bool in_one_plane = other.has_value() == normal.has_value() &&
                              (!normal || normal->cross(*other).norm() < parallel_tolerance);
    if (!in_one_plane || !scenes[i].gravity.isApprox(first.gravity, parallel_tolerance)) {
      return fmt::format(
          "{}: its plane or gravity differs from that of {}, so one camera tilt cannot apply to "
          "both (allowed: shapes in one plane, or all in space, under one gravity)",
          scenes[i].file, first.file);
    }
  }
  return "";
}

std::vector<Scene> with_nominal_frames(std::vector<Scene> scenes, const MeasuredShapes& measured,
                                       const MaterialFitOptions& options) {
  const bool turned = options.direction_tolerance > 0 || options.roll_tolerance > 0;
  if (options.natural_curvature_terms == 0 || !turned) return scenes;
  for (std::size_t i = 0; i < scenes.size(); ++i) {
    Gripper* const first = first_clamp(scenes[i]);
    if (measured.is_flat(i) || first == nullptr || (first->frame && first->frame->d1)) continue;
    const double roll = first->frame ? first->frame->roll : 0;
    Scene bent = scenes[i];
    bent.natural_strain.y() += 1 / bent.length;
    const bool is_open = options.roll_tolerance > 0 && !bent.plane_normal();
    const Eigen::Vector3d d1 = is_open ? horizontal_normal(*first->direction, scenes[i].gravity)
                                       : Eigen::Vector3d(bent.first_frame().col(0));
    first->frame = FrameHold{.d1 = d1, .roll = roll};
  }
  return scenes;
}

std::vector<WireNumber> wire_numbers(const std::vector<Scene>& scenes,
                                     const std::vector<MeasuredShape>& shapes,
                                     const MaterialFitOptions& options, bool density) {
  std::vector<WireNumber> numbers;
  // Without forces, differences by E are rounding, or movements along a family of equilibria.
  const bool forced = std::any_of(scenes.begin(), scenes.end(), has_external_force);
  const FittedNumber of_wire{
      .name = "", .unit = "", .prior_deviation = unknown, .shape = std::nullopt};
  numbers.push_back({of_wire, forced ? difference_step : 0,
                     [](Scene& scene, double value) { scene.scale_modulus(std::exp(value)); }});
  if (density) {
    numbers.push_back({of_wire, difference_step,
                       [](Scene& scene, double value) { scene.scale_density(std::exp(value)); }});
  }
  if (options.torsional_stiffness) add_torsion(numbers, scenes);
  if (options.natural_curvature_terms > 0) {
    add_natural_curvature(numbers, scenes, shapes, options);
  }
  const std::size_t sets = options.shared_clamps ? 1 : scenes.size();
  if (options.shared_clamps) require_equal_clamps(scenes);
  for (std::size_t i = 0; i < sets; ++i) {
    const std::optional<Eigen::Vector3d> normal = plane_of(scenes[i], shapes[i]);
    const std::optional<std::size_t> own = options.shared_clamps ? std::nullopt : std::optional(i);
    if (options.direction_tolerance > 0) {
      add_directions(numbers, scenes[i], own, normal, options.direction_tolerance);
    }
    if (options.position_tolerance > 0) {
      add_positions(numbers, scenes[i], own, normal, options.position_tolerance);
    }
  }
  if (options.direction_scatter > 0) {
    for (std::size_t i = 0; i < scenes.size(); ++i) {
      add_directions(numbers, scenes[i], i, plane_of(scenes[i], shapes[i]),
                     options.direction_scatter);
    }
  }
  if (options.roll_tolerance > 0) {
    const std::size_t others = numbers.size();
    for (std::size_t i = 0; i < scenes.size(); ++i) {
      if (!plane_of(scenes[i], shapes[i])) add_rolls(numbers, scenes[i], i, options);
    }
    if (numbers.size() == others) {
      throw InputError(
          fmt::format("{}: no shape of this scene depends on the clamps' rotation about the "
                      "tangent (allowed: two clamps that hold the rod's frame, roll or frame, or "
                      "natural curvature of a rod in space)",
                      scenes.front().file));
    }
  }
  // The tilt is applied last, because errors of clamps are given in the scene's coordinates.
  if (options.camera_tilt > 0) add_camera_tilt(numbers, scenes, shapes, options.camera_tilt);
  return numbers;
}

}  // namespace dlo::compare
