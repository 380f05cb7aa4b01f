#include "dlo/compare/scene.hpp"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "dlo/compare/error.hpp"
#include "dlo/energy_model/natural_frame.hpp"
#include "scene/reach.hpp"
#include "scene/scene_problem.hpp"

namespace dlo::compare {
namespace {

/// What a section has more than the rod has elsewhere, of some quantity per length, between two arc
/// lengths.
template <typename Density>
double excess_between(const Scene& scene, double begin, double end, const Density& density,
                      double elsewhere) {
  double sum = 0;
  for (const Section& section : scene.sections) {
    const double part = std::min(end, section.to) - std::max(begin, section.from);
    if (part > 0) sum += part * (density(section) - elsewhere);
  }
  return sum;
}

/// Unit normal of the plane that grips, forces and obstacles in reach share.
std::optional<Eigen::Vector3d> scene_normal(const Scene& scene) {
  std::vector<Eigen::Vector3d> vectors = {scene.gravity};
  for (const Gripper& gripper : scene.grippers) {
    if (gripper.direction) vectors.push_back(*gripper.direction);
    vectors.emplace_back(gripper.position - scene.grippers.front().position);
  }
  for (const PointLoad& load : scene.loads) {
    if (load.follows) continue;
    vectors.push_back(load.force);
    if (load.torque.isZero(0)) continue;
    const Eigen::Vector3d across = load.torque.unitOrthogonal();
    vectors.insert(vectors.end(), {across, load.torque.normalized().cross(across)});
  }
  for (const DistributedLoad& load : scene.distributed_loads) {
    vectors.insert(vectors.end(), load.force_per_length.begin(), load.force_per_length.end());
  }
  if (scene.drag) vectors.push_back(scene.drag->velocity);
  for (const std::size_t i : obstacles_in_reach(scene)) {
    const obstacle::Body& body = scene.obstacles[i].body;
    if (body.is_half_space()) vectors.push_back(body.normal());
  }
  Eigen::Matrix3d moments = Eigen::Matrix3d::Zero();
  for (const Eigen::Vector3d& v : vectors) {
    if (v.norm() > 0) moments += v.normalized() * v.normalized().transpose();
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(moments);
  const Eigen::Vector3d normal = axes.eigenvectors().col(0);
  // Not of the eigenvalue, which is their squares' sum but for a rounding of 1e-16.
  constexpr double noise = 1e-9;
  const bool share_it = std::all_of(vectors.begin(), vectors.end(), [&](const auto& v) {
    return std::abs(v.dot(normal)) <= noise * v.norm();
  });
  if (!share_it) return std::nullopt;
  for (const std::size_t i : obstacles_in_reach(scene)) {
    const Eigen::Vector3d& within = scene.grippers.front().position;
    if (!scene.obstacles[i].body.is_symmetric(within, normal, scene.length)) return std::nullopt;
  }
  return normal;
}

/// Of two numbers; of two equal ones to the last digit that number.
double harmonic_mean(double a, double b) { return a / ((1 + a / b) / 2); }

/// Mean of the rod's own natural curvature between two arc lengths, as if there were no sections.
Eigen::Vector2d series_curvature(const Scene& scene, double begin, double end) {
  Eigen::Vector2d mean = scene.natural_strain.head<2>();
  const double from = 2 * begin / scene.length - 1;
  const double to = 2 * end / scene.length - 1;
  for (std::size_t k = 0; k < scene.natural_variation.size(); ++k) {
    // int P_j = (P_(j+1) - P_(j-1)) / (2 j + 1)
    const auto j = static_cast<unsigned>(k + 1);
    const auto integral = [j](double x) {
      return (std::legendre(j + 1, x) - std::legendre(j - 1, x)) / (2.0 * j + 1);
    };
    const double of_part =
        to > from ? (integral(to) - integral(from)) / (to - from) : std::legendre(j, from);
    mean += of_part * scene.natural_variation[k];
  }
  return mean;
}

/// Index of the first clamp along the rod.
std::optional<std::size_t> first_clamp_of(const Scene& scene) {
  std::optional<std::size_t> first;
  for (std::size_t i = 0; i < scene.grippers.size(); ++i) {
    const Gripper& gripper = scene.grippers[i];
    if (gripper.direction && (!first || gripper.at < scene.grippers[*first].at)) first = i;
  }
  return first;
}

}  // namespace

double Scene::cross_section() const {
  if (width > 0) return width * thickness;
  const double hollow = std::numbers::pi * inner_diameter * inner_diameter / 4;
  return std::numbers::pi * diameter * diameter / 4 - hollow;
}

Eigen::Vector2d Scene::squared_gyration() const {
  if (width > 0) return Eigen::Vector2d(thickness * thickness, width * width) / 12;
  const double outer = diameter * diameter;
  return Eigen::Vector2d::Constant((outer + inner_diameter * inner_diameter) / 16);
}

double Scene::bending_stiffness() const {
  return given_bending_stiffness.value_or(material.youngs_modulus * cross_section() *
                                          squared_gyration().x());
}

std::optional<double> Scene::bending_stiffness_2() const {
  if (given_bending_stiffness) return given_bending_stiffness_2;
  if (width == thickness) return std::nullopt;
  return material.youngs_modulus * cross_section() * squared_gyration().y();
}

double Scene::softer_bending_stiffness() const {
  return std::min(bending_stiffness(), bending_stiffness_2().value_or(bending_stiffness()));
}

double Scene::mean_bending_stiffness() const {
  return harmonic_mean(bending_stiffness(), bending_stiffness_2().value_or(bending_stiffness()));
}

double Section::mean_bending_stiffness() const {
  return harmonic_mean(bending_stiffness, bending_stiffness_2.value_or(bending_stiffness));
}

bool Scene::has_two_stiffnesses() const {
  return bending_stiffness_2() ||
         std::any_of(sections.begin(), sections.end(),
                     [](const Section& section) { return section.bending_stiffness_2; });
}

double Scene::mass_per_length() const {
  return given_mass_per_length.value_or(material.density * cross_section());
}

double Scene::twisting_stiffness() const {
  if (torsional_stiffness) return *torsional_stiffness;
  return has_material_directors() ? assumed_torsional_stiffness() : 0;
}

double Scene::assumed_torsional_stiffness() const {
  if (width > 0 && !given_bending_stiffness) {
    return material.youngs_modulus / (2 * (1 + assumed_poisson_ratio)) *
           rectangle_torsion_constant(width, thickness);
  }
  return mean_bending_stiffness() / (1 + assumed_poisson_ratio);
}

bool Scene::assumes_torsion() const { return has_material_directors() && !torsional_stiffness; }

std::optional<double> Scene::known_axial_stiffness() const {
  if (given_axial_stiffness) return given_axial_stiffness;
  const double EA = material.youngs_modulus * cross_section();
  return EA > 0 ? std::optional(EA) : std::nullopt;
}

double Scene::axial_stiffness() const {
  if (const std::optional<double> EA = known_axial_stiffness()) return *EA;
  if (cross_section() > 0) return bending_stiffness() / squared_gyration().x();
  return 1e6 * bending_stiffness() / (length * length);
}

NamedValue Scene::stiffness() const {
  if (given_bending_stiffness) {
    return {given_bending_stiffness_2 ? "EI about d1" : "EI", "N m^2", *given_bending_stiffness};
  }
  return {"E", "Pa", material.youngs_modulus};
}

NamedValue Scene::heaviness() const {
  if (given_mass_per_length) return {"mass per length", "kg/m", *given_mass_per_length};
  return {"density", "kg/m^3", material.density};
}

double Scene::mass() const {
  const double own = mass_per_length();
  return own * length +
         excess_between(
             *this, 0, length, [](const Section& s) { return s.mass_per_length; }, own);
}

Eigen::Vector3d Scene::weight_per_length() const {
  return (sections.empty() ? mass_per_length() : mass() / length) * gravity;
}

Eigen::Vector3d Scene::weight_between(double begin, double end) const {
  const double own = mass_per_length();
  const double mass =
      own * (end - begin) +
      excess_between(
          *this, begin, end, [](const Section& s) { return s.mass_per_length; }, own);
  return mass * gravity;
}

Eigen::Vector3d DistributedLoad::between(double begin, double end) const {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const energy_model::LineLoad& piece : line_loads(*this)) sum += piece.between(begin, end);
  return sum;
}

double DistributedLoad::size() const {
  double sum = 0;
  for (const energy_model::LineLoad& piece : line_loads(*this)) {
    sum += (piece.at_begin.norm() + piece.at_end.norm()) / 2 * (piece.end - piece.begin);
  }
  return sum;
}

Eigen::Vector3d Scene::distributed_between(double begin, double end) const {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const DistributedLoad& load : distributed_loads) sum += load.between(begin, end);
  return sum;
}

double Scene::total_of_loads() const {
  double sum = 0;
  for (const PointLoad& load : loads) sum += load.force.norm() + load.torque.norm() / length;
  for (const DistributedLoad& load : distributed_loads) sum += load.size();
  return sum;
}

bool Scene::has_couples() const {
  return std::any_of(loads.begin(), loads.end(),
                     [](const PointLoad& load) { return !load.torque.isZero(0); });
}

void Scene::require_potential(const char* who) const {
  if (drag) {
    throw InputError(fmt::format(
        "{}: medium.velocity: drag, which has no potential and which {} not take (allowed: dlo "
        "solve --model exact or force)",
        file, who));
  }
  const auto follower = std::ranges::find_if(loads, &PointLoad::follows);
  if (follower != loads.end()) {
    throw InputError(fmt::format(
        "{}: load.follows: the load at {:g} m turns with the rod, which has no potential and which "
        "{} not take (allowed: dlo solve --model exact)",
        file, follower->at, who));
  }
  if (!has_couples() || energy_model::has_potential(scene_problem(*this))) return;
  throw InputError(fmt::format(
      "{}: load.torque: out of a plane, where a couple that keeps its axis has no potential, so "
      "that {} not take it (allowed: dlo solve --model exact)",
      file, who));
}

void Scene::require_no_couples(const char* who) const {
  require_potential(who);
  const auto couple =
      std::ranges::find_if(loads, [](const PointLoad& load) { return !load.torque.isZero(0); });
  if (couple == loads.end()) return;
  throw InputError(
      fmt::format("{}: load.torque: the couple at {:g} m, which {} not take (allowed: dlo solve "
                  "--model energy or exact)",
                  file, couple->at, who));
}

double Scene::bending_compliance(double begin, double end) const {
  const double own = 1 / bending_stiffness();
  return own * (end - begin) +
         excess_between(
             *this, begin, end, [](const Section& s) { return 1 / s.bending_stiffness; }, own);
}

double Scene::twisting_compliance(double begin, double end) const {
  const double GJ = twisting_stiffness();
  const auto of_section = [&](const Section& s) {
    return 1 / s.torsional_stiffness.value_or(s.mean_bending_stiffness() /
                                              mean_bending_stiffness() * GJ);
  };
  return (end - begin) / GJ + excess_between(*this, begin, end, of_section, 1 / GJ);
}

double Scene::gamma() const {
  return weight_per_length().norm() * length * length * length / softer_bending_stiffness();
}

Scene Scene::without_natural_strain() const {
  Scene scene = *this;
  scene.natural_strain.setZero();
  scene.natural_variation.clear();
  scene.rest_shape.reset();
  for (Section& section : scene.sections) {
    section.natural_curvature.reset();
    section.natural_twist.reset();
  }
  return scene;
}

void Scene::set_rest_shape(const RestShape& shape) {
  *this = without_natural_strain();
  rest_shape = shape;
  if (shape.arcs.size() == 1) {
    natural_strain = shape.arcs.front().strain;
    return;
  }
  std::vector<Section> all;
  double at = 0;
  const auto fill_to = [&](double end) {
    if (!(end > at)) return;
    all.push_back({.from = at,
                   .to = end,
                   .bending_stiffness = bending_stiffness(),
                   .mass_per_length = mass_per_length(),
                   .torsional_stiffness = std::nullopt,
                   .bending_stiffness_2 = bending_stiffness_2()});
  };
  for (const Section& section : sections) {
    fill_to(section.from);
    all.push_back(section);
    at = section.to;
  }
  fill_to(length);
  sections.clear();
  for (Section section : all) {
    for (const RestShape::Arc& arc : shape.arcs) {
      if (arc.end <= section.from) continue;
      Section part = section;
      // A boundary of the two that differs by rounding is one.
      constexpr double rounding = 1e-12;
      part.to = arc.end < section.to - rounding * length ? arc.end : section.to;
      part.natural_curvature = arc.strain.head<2>();
      if (arc.strain.z() != 0) part.natural_twist = arc.strain.z();
      sections.push_back(part);
      section.from = part.to;
      if (part.to >= section.to) break;
    }
  }
}

Eigen::Matrix3d Scene::first_frame() const {
  const char* const key = rest_shape                ? "rest_shape"
                          : naturally_bent()        ? "natural_curvature"
                          : given_bending_stiffness ? "bending_stiffness"
                          : width > 0               ? "width"
                                                    : "bending_stiffness";
  const std::optional<std::size_t> clamp = first_clamp_of(*this);
  if (!clamp) {
    throw InputError(fmt::format(
        "{}: rod.{}: no gripper says about which axis (allowed: a gripper with hold = \"clamp\")",
        file, key));
  }
  const energy_model::Problem problem = scene_problem(*this);
  const Gripper& gripper = grippers[*clamp];
  const bool has_d1 = gripper.frame && gripper.frame->d1;
  if (!has_d1 && !energy_model::natural_normal(problem)) {
    throw InputError(fmt::format(
        "{}: rod.{}: the scene lies in no plane, and the first clamp does not say where d1 is "
        "(allowed: frame or quaternion there)",
        gripper.where.empty() ? file : gripper.where, key));
  }
  return energy_model::first_frame(problem);
}

bool Scene::naturally_twisted() const {
  return natural_strain.z() != 0 ||
         std::any_of(sections.begin(), sections.end(),
                     [](const Section& section) { return section.natural_twist.value_or(0) != 0; });
}

bool Scene::naturally_curved() const {
  return !natural_strain.head<2>().isZero(0) ||
         std::any_of(natural_variation.begin(), natural_variation.end(),
                     [](const Eigen::Vector2d& strain) { return !strain.isZero(0); }) ||
         std::any_of(sections.begin(), sections.end(), [](const Section& section) {
           return section.natural_curvature && !section.natural_curvature->isZero(0);
         });
}

Eigen::Vector3d Scene::natural_curvature() const { return natural_curvature(0, length); }

Eigen::Vector3d Scene::natural_curvature(double begin, double end) const {
  if (!naturally_curved()) return Eigen::Vector3d::Zero();
  Eigen::Vector2d mean = series_curvature(*this, begin, end);
  for (const Section& section : sections) {
    const double from = std::max(begin, section.from);
    const double to = std::min(end, section.to);
    if (!section.natural_curvature || !(to > from)) continue;
    mean += (to - from) / (end - begin) *
            (*section.natural_curvature - series_curvature(*this, from, to));
  }
  return first_frame().leftCols<2>() * mean;
}

bool Scene::holds_twist() const {
  const std::optional<std::size_t> always =
      has_material_directors() ? first_clamp_of(*this) : std::nullopt;
  int holding = 0;
  for (std::size_t i = 0; i < grippers.size(); ++i) {
    if (grippers[i].frame || always == i) ++holding;
  }
  return holding > 1;
}

Scene Scene::without_twist() const {
  Scene scene = *this;
  const std::optional<std::size_t> always =
      has_material_directors() ? first_clamp_of(*this) : std::nullopt;
  for (std::size_t i = 0; i < grippers.size(); ++i) {
    if (always != i) scene.grippers[i].frame.reset();
  }
  return scene;
}

void Scene::scale_modulus(double factor) {
  material.youngs_modulus *= factor;
  if (layers) {
    for (double* stiffness : {&layers->bonded_bending_stiffness, &layers->free_bending_stiffness,
                              &layers->bonded_torsional_stiffness,
                              &layers->free_torsional_stiffness, &layers->axial_stiffness}) {
      *stiffness *= factor;
    }
  }
  if (given_bending_stiffness) *given_bending_stiffness *= factor;
  if (given_bending_stiffness_2) *given_bending_stiffness_2 *= factor;
  if (given_axial_stiffness) *given_axial_stiffness *= factor;
  if (torsional_stiffness) *torsional_stiffness *= factor;
  for (Section& section : sections) {
    section.bending_stiffness *= factor;
    if (section.bending_stiffness_2) *section.bending_stiffness_2 *= factor;
    if (section.torsional_stiffness) *section.torsional_stiffness *= factor;
  }
}

void Scene::scale_torsion(double factor) {
  if (twisting_stiffness() > 0) torsional_stiffness = twisting_stiffness() * factor;
  for (Section& section : sections) {
    if (section.torsional_stiffness) *section.torsional_stiffness *= factor;
  }
}

void Scene::scale_density(double factor) {
  material.density *= factor;
  if (layers) layers->mass_per_length *= factor;
  if (given_mass_per_length) *given_mass_per_length *= factor;
  for (Section& section : sections) section.mass_per_length *= factor;
}

std::optional<Eigen::Vector3d> Scene::plane_normal() const {
  if (holds_twist()) return std::nullopt;
  const bool leaves_plane = std::any_of(loads.begin(), loads.end(), [](const PointLoad& load) {
    return load.follows && (load.force.y() != 0 || load.torque.x() != 0 || load.torque.z() != 0);
  });
  if (leaves_plane) return std::nullopt;
  std::optional<Eigen::Vector3d> normal = scene_normal(*this);
  const bool curved = naturally_curved();
  if (!normal || !(curved || has_two_stiffnesses())) return normal;
  normal = energy_model::natural_normal(scene_problem(*this));
  if (!normal) return std::nullopt;
  constexpr double noise = 1e-9;
  if (has_two_stiffnesses()) {
    const Eigen::Matrix3d frame = first_frame();
    const bool oblique =
        std::abs(frame.col(0).dot(*normal)) > noise && std::abs(frame.col(1).dot(*normal)) > noise;
    if (oblique || naturally_twisted()) return std::nullopt;
    if (!curved) return normal;
  }
  const Eigen::Matrix3d frame = first_frame();
  const auto about_normal = [&](const Eigen::Vector2d& strain) {
    return normal->cross(frame.leftCols<2>() * strain).norm() <= noise * strain.norm();
  };
  const bool flat = about_normal(natural_strain.head<2>()) && !naturally_twisted() &&
                    std::all_of(natural_variation.begin(), natural_variation.end(), about_normal) &&
                    std::all_of(sections.begin(), sections.end(), [&](const Section& section) {
                      return !section.natural_curvature || about_normal(*section.natural_curvature);
                    });
  return flat ? normal : std::nullopt;
}

int Scene::spans() const {
  int count = 1;
  for (const Gripper& gripper : grippers) {
    if (gripper.direction && gripper.at > 0 && gripper.at < length) ++count;
  }
  return count;
}

std::optional<TimeSpan> motion_of(const Scene& scene) {
  std::optional<TimeSpan> span;
  const auto add = [&span](const Trajectory& trajectory) {
    if (trajectory.empty()) return;
    if (!span) span = {trajectory.begin(), trajectory.end()};
    span->begin = std::min(span->begin, trajectory.begin());
    span->end = std::max(span->end, trajectory.end());
  };
  for (const Gripper& gripper : scene.grippers) add(gripper.trajectory);
  for (const Obstacle& obstacle : scene.obstacles) add(obstacle.trajectory);
  return span;
}

std::optional<double> on_rod(double s, double length) {
  const double rounding = arc_rounding * length;
  if (!(s >= -rounding && s <= length + rounding)) return std::nullopt;
  return std::clamp(s, 0.0, length);
}

Scene scene_at(const Scene& scene, double time, double obstacle_time) {
  Scene result = scene;
  for (Gripper& gripper : result.grippers) {
    if (gripper.trajectory.empty()) continue;
    const Pose pose = gripper.trajectory.pose_at(time);
    gripper.position = pose.position;
    if (pose.direction) gripper.direction = pose.direction;
    if (pose.roll && gripper.frame) {
      gripper.frame->roll += *pose.roll - *gripper.trajectory.poses().front().roll;
    }
    gripper.trajectory = {};
  }
  for (Obstacle& obstacle : result.obstacles) {
    if (obstacle.trajectory.empty()) continue;
    const Eigen::Vector3d moved = obstacle.trajectory.pose_at(obstacle_time).position -
                                  obstacle.trajectory.poses().front().position;
    obstacle.body = obstacle.body.seen_from(-moved, Eigen::Matrix3d::Identity(), 1);
    obstacle.trajectory = {};
  }
  return result;
}

Scene scene_at(const Scene& scene, double time) { return scene_at(scene, time, time); }

}  // namespace dlo::compare
