#include "dlo/compare/scene.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <numbers>

#include "scene/reach.hpp"

namespace dlo::compare {

double Scene::cross_section() const { return std::numbers::pi * diameter * diameter / 4; }

double Scene::bending_stiffness() const {
  return material.youngs_modulus * cross_section() * diameter * diameter / 16;
}

double Scene::axial_stiffness() const { return material.youngs_modulus * cross_section(); }

double Scene::mass() const { return material.density * cross_section() * length; }

Eigen::Vector3d Scene::weight_per_length() const {
  return material.density * cross_section() * gravity;
}

double Scene::gamma() const {
  return weight_per_length().norm() * length * length * length / bending_stiffness();
}

bool Scene::holds_twist() const {
  return std::count_if(grippers.begin(), grippers.end(),
                       [](const Gripper& gripper) { return gripper.frame.has_value(); }) > 1;
}

Scene Scene::without_twist() const {
  Scene scene = *this;
  for (Gripper& gripper : scene.grippers) gripper.frame.reset();
  return scene;
}

void Scene::scale_modulus(double factor) {
  material.youngs_modulus *= factor;
  if (torsional_stiffness) *torsional_stiffness *= factor;
}

std::optional<Eigen::Vector3d> Scene::plane_normal() const {
  if (holds_twist()) return std::nullopt;
  std::vector<Eigen::Vector3d> vectors = {gravity};
  for (const Gripper& gripper : grippers) {
    if (gripper.direction) vectors.push_back(*gripper.direction);
    vectors.emplace_back(gripper.position - grippers.front().position);
  }
  for (const PointLoad& load : loads) vectors.push_back(load.force);
  for (const std::size_t i : obstacles_in_reach(*this)) vectors.push_back(obstacles[i].normal);
  Eigen::Matrix3d moments = Eigen::Matrix3d::Zero();
  for (const Eigen::Vector3d& v : vectors) {
    if (v.norm() > 0) moments += v.normalized() * v.normalized().transpose();
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(moments);
  if (!(axes.eigenvalues()[0] < 1e-18)) return std::nullopt;
  return Eigen::Vector3d(axes.eigenvectors().col(0));
}

int Scene::spans() const {
  int count = 1;
  for (const Gripper& gripper : grippers) {
    if (gripper.direction && gripper.at > 0 && gripper.at < length) ++count;
  }
  return count;
}

}  // namespace dlo::compare
