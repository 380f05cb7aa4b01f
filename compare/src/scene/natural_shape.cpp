#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "dlo/compare/error.hpp"
#include "dlo/compare/scene.hpp"
#include "dlo/energy_model/natural_frame.hpp"
#include "scene/first_clamp.hpp"
#include "scene/scene_problem.hpp"

namespace dlo::compare {
namespace {

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

}  // namespace

Scene Scene::without_natural_strain() const {
  Scene scene = *this;
  scene.natural_strain.setZero();
  scene.natural_variation.clear();
  for (Section& section : scene.sections) {
    section.natural_curvature.reset();
    section.natural_twist.reset();
  }
  return scene;
}

Eigen::Matrix3d Scene::first_frame() const {
  const char* const key = naturally_bent()          ? "natural_curvature"
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

}  // namespace dlo::compare
