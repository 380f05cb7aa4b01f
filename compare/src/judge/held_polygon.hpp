#pragma once

#include <Eigen/Core>
#include <Eigen/LU>
#include <functional>
#include <optional>
#include <vector>

#include "dlo/compare/scene.hpp"
#include "dlo/compare/shape.hpp"

namespace dlo::compare {

/// A force at a node [N].
struct NodeForce {
  Eigen::Index node = 0;                            ///< where
  Eigen::Vector3d force = Eigen::Vector3d::Zero();  ///< what [N]
};

/// Inextensible segments of a scene's rod, intrinsically straight and free to twist, in its grips:
///     E = - sum_j B_j t_j . t_j+1 - sum_k f_k . r_k,
/// t the segments' unit tangents, 1 / B_j the bending compliance between the middles of two
/// neighbours (or from a middle to a clamp's direction), r_k the nodes and f_k weight, loads and
/// further forces there. Grips, loads and ends of sections are nodes. Second order in the segments'
/// length. Equilibria, stable or not, are found by Newton's method for all forces at once.
class HeldPolygon {
 public:
  /// @param segments  at least so many of them
  /// @param normal    of the plane that it stays in; none: space
  HeldPolygon(const Scene& scene, int segments, const std::optional<Eigen::Vector3d>& normal);

  /// Arc lengths of the nodes [m].
  [[nodiscard]] const std::vector<double>& arc_lengths() const { return s_; }
  /// Lays it along a curve [m]. @param points  at the nodes, 3 x nodes
  void lay_along(const Eigen::Matrix3Xd& points);
  /// Nodes as they are [m], 3 x nodes.
  [[nodiscard]] Eigen::Matrix3Xd nodes() const;
  /// Tangent at a node, unit.
  [[nodiscard]] Eigen::Vector3d tangent(Eigen::Index node) const;

  /// Newton's system here, with the forces of this balance (any at the first call) in its Hessian.
  void linearise(const std::vector<NodeForce>& forces);
  /// Step to the equilibrium under weight and loads alone, by that system.
  [[nodiscard]] Eigen::VectorXd free_step() const;
  /// What a force at a node adds to it.
  [[nodiscard]] Eigen::VectorXd response(const NodeForce& force) const;
  /// Where a step takes the points at these arc lengths, to first order [m]: 3 M numbers.
  [[nodiscard]] Eigen::VectorXd motion(const std::vector<double>& arc_lengths,
                                       const Eigen::VectorXd& step) const;
  /// The points there [m]: 3 M numbers.
  [[nodiscard]] Eigen::VectorXd points(const std::vector<double>& arc_lengths) const;
  /// Takes the grips' forces of a step for the next linearise(), and stays where it is.
  void take_pulls(const Eigen::VectorXd& step) { pulls_ = step.tail(pulls_.size()); }
  /// Goes this step, or as much of it as turns no segment by more than a third of a radian.
  /// @return the largest turn of the whole step [rad]
  double move(const Eigen::VectorXd& step);

 private:
  /// A stiffness [N m] between two segments' tangents, or a segment's and a direction.
  struct Joint {
    Eigen::Index first, second;  // second < 0: `direction`
    double stiffness;
    Eigen::Vector3d direction;
  };
  [[nodiscard]] Eigen::Index turns() const { return axes_.cols() - 1; }  // of one segment
  [[nodiscard]] Eigen::Index unknowns() const { return count() * turns() + axes_.cols(); }
  [[nodiscard]] Eigen::Index count() const { return static_cast<Eigen::Index>(lengths_.size()); }
  /// Grips, and the joints of the nodes.
  void hold(const Scene& scene);
  [[nodiscard]] Eigen::Matrix3Xd basis(Eigen::Index segment) const;
  /// Adds what a force at a node pulls the unknowns with, to the head of a vector.
  void pull(const NodeForce& force, Eigen::Ref<Eigen::VectorXd> result) const;
  /// Sum over the segments of what follows from a step, or of where they are.
  [[nodiscard]] Eigen::VectorXd along(
      const std::vector<double>& arc_lengths, const Eigen::Vector3d& origin,
      const std::function<Eigen::Vector3d(Eigen::Index)>& segment) const;

  Eigen::Matrix3Xd axes_;  // of the plane, or of space, columns
  std::vector<double> s_, lengths_;
  std::vector<Joint> joints_;
  std::vector<NodeForce> dead_;   // weight and loads
  std::vector<NodeForce> grips_;  // where they are, force: position
  Eigen::Matrix3Xd t_;
  Eigen::Vector3d origin_ = Eigen::Vector3d::Zero();
  Eigen::VectorXd pulls_;  // of the grips, from the last step
  Eigen::PartialPivLU<Eigen::MatrixXd> system_;
};

}  // namespace dlo::compare
