#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <vector>

#include "base/legendre.hpp"
#include "frames/piece.hpp"
#include "problem/natural_strains.hpp"

namespace dlo::energy_model {

/// Returns the angle of a direction in the plane x-y, from x to y [rad].
[[nodiscard]] double angle_of(const Eigen::Vector3d& direction);

/// Returns the angle that is nearest to `target` and differs from `angle` by a multiple of 2 pi
/// [rad].
[[nodiscard]] double nearest_equivalent_angle(double angle, double target);

/// Computes dot products of vectors in the plane x-y, row by row. @param[out] result  one per row
void dot_in_plane(const Eigen::MatrixX3d& a, const Eigen::MatrixX3d& b, Eigen::VectorXd& result);

/// Tangents of a rod in the plane x-y as functions of its curvature; RodFrames is the counterpart
/// in space.
///     t = (cos theta, sin theta, 0),  theta(s) = theta_0 + int_0^s (natural curvature + u) ds,
/// where u is expanded in orthonormal Legendre polynomials on every Element, so that its energy is
/// half the sum of the squares of the coefficients. theta is linear in the unknowns.
///
/// Unknowns x: the coefficients, element by element. If no clamp fixes the start, its angle is the
/// first unknown.
class PlanarFrames {
 public:
  /// Results of the last evaluate(); rows are nodes.
  struct State {
    Eigen::VectorXd theta;
    Eigen::MatrixX3d t_theta;  ///< d t / d theta

    // Scratch: per node, per unknown, and of one element.
    Eigen::VectorXd turning, by_unknown, curvature, beside;
    Eigen::MatrixXd scaled, own;
  };

  /// Sets the elements. Nodes are those of legendre_table(terms) on each element.
  /// @param start_theta  angle at the start [rad]; std::nullopt: it is unknown
  void reset(const std::vector<Element>& elements, int terms, std::optional<double> start_theta,
             const NaturalStrains& natural);
  /// Resizes a state; with it evaluate(), adjoint(), add_hessian() and subtract_bending() allocate
  /// nothing.
  void resize(State& state) const;

  /// Returns the angle at the start [rad]; 0 if it is unknown.
  [[nodiscard]] double start_theta() const { return start_theta_; }
  /// Derivatives of the nodes' angles by the unknowns, nodes x unknowns.
  [[nodiscard]] const Eigen::MatrixXd& by_unknown() const { return angle_; }
  /// Derivatives of the angle at an element's end by the unknowns.
  [[nodiscard]] Eigen::RowVectorXd angle_derivatives_after(Eigen::Index element) const;
  /// Returns the angle of `direction`, shifted by a multiple of 2 pi to be nearest to
  /// start_theta(), minus the integral of the natural curvature from the start to an element's end
  /// [rad].
  [[nodiscard]] double angle_towards(const Eigen::Vector3d& direction, Eigen::Index element) const;

  /// Computes the tangents and the state. @param[out] tangents  nodes x 3; z is not written
  void evaluate(const Eigen::Ref<const Eigen::VectorXd>& x, Eigen::MatrixX3d& tangents,
                State& state) const;
  /// Computes state.by_unknown, the derivatives by x of the sum of nodes . t over the nodes.
  /// @param nodes  gradient by the tangents, nodes x 3
  void adjoint(const Eigen::MatrixX3d& nodes, State& state) const;
  /// Computes state.by_unknown for the sum of weights t_axis over the nodes.
  void adjoint(const Eigen::Ref<const Eigen::VectorXd>& weights, Eigen::Index axis,
               State& state) const;
  /// Adds the second derivatives by x of the sum of along theta^2 / 2 over the nodes.
  /// @param along  one per node
  void add_hessian(const Eigen::VectorXd& along, State& state,
                   Eigen::Ref<Eigen::MatrixXd> hessian) const;
  /// Derivatives of the tangents at the nodes by x: three matrices, one per axis, nodes x unknowns.
  [[nodiscard]] std::array<Eigen::MatrixXd, 3> tangent_jacobian(const State& state) const;

  /// Subtracts weight B u^2 from `along`: the amount by which bending reduces the energy of a
  /// squared tilt out of the plane. @param weights  of the nodes
  void subtract_bending(const Eigen::VectorXd& x, const Eigen::VectorXd& weights, State& state,
                        Eigen::VectorXd& along) const;

  /// Returns the angles of tangents at the nodes (3 x nodes), continuous along the rod, minus the
  /// integral of the natural curvature from the start [rad].
  [[nodiscard]] Eigen::VectorXd angles(const Eigen::Matrix3Xd& tangents) const;
  /// Returns the unknowns whose angles at the nodes, without the natural curvature, come nearest to
  /// these, by least squares on each element.
  [[nodiscard]] Eigen::VectorXd fit(const Eigen::VectorXd& angles) const;

 private:
  [[nodiscard]] double element_rotation(Eigen::Index element) const {
    return elements_[static_cast<std::size_t>(element)].angle(0);
  }

  std::vector<Element> elements_;
  Eigen::Index terms_ = 0;
  const LegendreTable* table_ = nullptr;
  Eigen::Index free_start_ = 0;  // unknowns of the start, 0 or 1
  double start_theta_ = 0;
  NaturalStrains natural_;
  Eigen::MatrixXd angle_, angle_transposed_;
  Eigen::VectorXd natural_angle_;
};

}  // namespace dlo::energy_model
