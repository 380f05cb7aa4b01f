#include "dlo/compare/scene.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "scene/scene_problem.hpp"

namespace dlo::compare {
namespace {

/// Returns the integral of a quantity per length between two arc lengths.
/// @param density  returns its value of a section;  @param elsewhere  its value of the rod
template <typename Density>
double integral_between(const Scene& scene, double begin, double end, const Density& density,
                        double elsewhere) {
  double sum = 0;
  for (const Section& section : scene.sections) {
    const double part = std::min(end, section.to) - std::max(begin, section.from);
    if (part > 0) sum += part * (density(section) - elsewhere);
  }
  return elsewhere * (end - begin) + sum;
}

double mass_between(const Scene& scene, double begin, double end) {
  const auto of_section = [](const Section& s) { return s.mass_per_length; };
  return integral_between(scene, begin, end, of_section, scene.mass_per_length());
}

void scale(std::optional<double>& value, double factor) {
  if (value) *value *= factor;
}

/// Returns the harmonic mean of two numbers; if they are equal, exactly that number.
double harmonic_mean(double a, double b) { return a / ((1 + a / b) / 2); }

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
  const auto has_two = [](const Section& s) { return s.bending_stiffness_2.has_value(); };
  return bending_stiffness_2() || std::ranges::any_of(sections, has_two);
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

NamedValue Scene::mass_parameter() const {
  if (given_mass_per_length) return {"mass per length", "kg/m", *given_mass_per_length};
  return {"density", "kg/m^3", material.density};
}

double Scene::mass() const { return mass_between(*this, 0, length); }

Eigen::Vector3d Scene::weight_per_length() const {
  return (sections.empty() ? mass_per_length() : mass() / length) * gravity;
}

Eigen::Vector3d Scene::weight_between(double begin, double end) const {
  return mass_between(*this, begin, end) * gravity;
}

double Scene::bending_compliance(double begin, double end) const {
  const auto of_section = [](const Section& s) { return 1 / s.bending_stiffness; };
  return integral_between(*this, begin, end, of_section, 1 / bending_stiffness());
}

double Scene::twisting_compliance(double begin, double end) const {
  const double GJ = twisting_stiffness();
  const auto of_section = [&](const Section& s) {
    return 1 / s.torsional_stiffness.value_or(s.mean_bending_stiffness() /
                                              mean_bending_stiffness() * GJ);
  };
  return integral_between(*this, begin, end, of_section, 1 / GJ);
}

double Scene::gamma() const {
  return weight_per_length().norm() * length * length * length / softer_bending_stiffness();
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
  for (std::optional<double>* stiffness : {&given_bending_stiffness, &given_bending_stiffness_2,
                                           &given_axial_stiffness, &torsional_stiffness}) {
    scale(*stiffness, factor);
  }
  for (Section& section : sections) {
    section.bending_stiffness *= factor;
    scale(section.bending_stiffness_2, factor);
    scale(section.torsional_stiffness, factor);
  }
}

void Scene::scale_torsion(double factor) {
  if (twisting_stiffness() > 0) torsional_stiffness = twisting_stiffness() * factor;
  for (Section& section : sections) scale(section.torsional_stiffness, factor);
}

void Scene::scale_density(double factor) {
  material.density *= factor;
  if (layers) layers->mass_per_length *= factor;
  scale(given_mass_per_length, factor);
  for (Section& section : sections) section.mass_per_length *= factor;
}

int Scene::spans() const {
  int count = 1;
  for (const Gripper& gripper : grippers) {
    if (gripper.direction && gripper.at > 0 && gripper.at < length) ++count;
  }
  return count;
}

std::optional<TimeSpan> motion_time_span(const Scene& scene) {
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
    obstacle.body = obstacle.body.transformed(-moved, Eigen::Matrix3d::Identity(), 1);
    obstacle.trajectory = {};
  }
  return result;
}

Scene scene_at(const Scene& scene, double time) { return scene_at(scene, time, time); }

}  // namespace dlo::compare
