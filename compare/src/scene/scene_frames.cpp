#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "dlo/compare/error.hpp"
#include "dlo/compare/scene.hpp"
#include "dlo/energy_model/natural_frame.hpp"
#include "scene/scene_problem.hpp"

// Stress-free curvature and twist of a scene's rod, the frames in which clamps hold it, and the
// plane in which it stays.
namespace dlo::compare {
namespace {

/// Returns the unit normal of a plane that contains grips and forces, is perpendicular to couples
/// and is a plane of symmetry of the obstacles in reach; std::nullopt if there is none. Loads that
/// follow the rod are ignored.
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
  // The test uses each vector rather than the eigenvalue, which is the sum of their squares up to a
  // rounding of 1e-16.
  constexpr double noise = 1e-9;
  const bool is_common = std::ranges::all_of(
      vectors, [&](const auto& v) { return std::abs(v.dot(normal)) <= noise * v.norm(); });
  if (!is_common) return std::nullopt;
  for (const std::size_t i : obstacles_in_reach(scene)) {
    const Eigen::Vector3d& within = scene.grippers.front().position;
    if (!scene.obstacles[i].body.is_symmetric(within, normal, scene.length)) return std::nullopt;
  }
  return normal;
}

/// Returns the mean of the rod's own natural curvature between two arc lengths, ignoring sections.
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

/// Returns the index of the first clamp along the rod; std::nullopt if there is none.
std::optional<std::size_t> first_clamp_of(const Scene& scene) {
  std::optional<std::size_t> first;
  for (std::size_t i = 0; i < scene.grippers.size(); ++i) {
    const Gripper& gripper = scene.grippers[i];
    if (gripper.direction && (!first || gripper.at < scene.grippers[*first].at)) first = i;
  }
  return first;
}

}  // namespace

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
  const auto add_section_until = [&](double end) {
    if (!(end > at)) return;
    all.push_back({.from = at,
                   .to = end,
                   .bending_stiffness = bending_stiffness(),
                   .mass_per_length = mass_per_length(),
                   .torsional_stiffness = std::nullopt,
                   .bending_stiffness_2 = bending_stiffness_2()});
  };
  for (const Section& section : sections) {
    add_section_until(section.from);
    all.push_back(section);
    at = section.to;
  }
  add_section_until(length);
  sections.clear();
  for (Section section : all) {
    for (const RestShape::Arc& arc : shape.arcs) {
      if (arc.end <= section.from) continue;
      Section part = section;
      // Boundaries of a section and an arc that differ by rounding are the same.
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
        "{}: rod.{}: no gripper defines its axis (allowed: a gripper with hold = \"clamp\")", file,
        key));
  }
  const energy_model::Problem problem = scene_problem(*this);
  const Gripper& gripper = grippers[*clamp];
  const bool has_d1 = gripper.frame && gripper.frame->d1;
  if (!has_d1 && !energy_model::natural_normal(problem)) {
    throw InputError(fmt::format(
        "{}: rod.{}: the scene without loads lies in no plane or in more than one, or a load has a "
        "component out of it, and the first clamp does not define d1 (allowed: frame or "
        "quaternion there)",
        gripper.where.empty() ? file : gripper.where, key));
  }
  return energy_model::first_frame(problem);
}

std::optional<Eigen::Vector3d> Scene::assumed_normal() const {
  const std::optional<std::size_t> clamp = first_clamp_of(*this);
  if (!naturally_curved() || !clamp) return std::nullopt;
  const std::optional<FrameHold>& frame = grippers[*clamp].frame;
  if (frame && frame->d1) return std::nullopt;
  return energy_model::natural_normal(scene_problem(*this));
}

bool Scene::naturally_twisted() const {
  const auto twisted = [](const Section& s) { return s.natural_twist.value_or(0) != 0; };
  return natural_strain.z() != 0 || std::ranges::any_of(sections, twisted);
}

bool Scene::naturally_curved() const {
  const auto curved = [](const Eigen::Vector2d& strain) { return !strain.isZero(0); };
  return curved(natural_strain.head<2>()) || std::ranges::any_of(natural_variation, curved) ||
         std::ranges::any_of(sections, [&](const Section& s) {
           return s.natural_curvature && curved(*s.natural_curvature);
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

bool Scene::prescribes_twist() const {
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

std::optional<Eigen::Vector3d> Scene::plane_normal() const {
  if (prescribes_twist()) return std::nullopt;
  for (const PointLoad& load : loads) {
    const bool across = load.force.y() != 0 || load.torque.x() != 0 || load.torque.z() != 0;
    if (load.follows && across) return std::nullopt;
  }
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
                    std::ranges::all_of(natural_variation, about_normal) &&
                    std::ranges::all_of(sections, [&](const Section& s) {
                      return !s.natural_curvature || about_normal(*s.natural_curvature);
                    });
  return flat ? normal : std::nullopt;
}

}  // namespace dlo::compare
