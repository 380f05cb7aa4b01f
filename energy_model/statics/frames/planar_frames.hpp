#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <vector>

#include "base/legendre.hpp"
#include "frames/piece.hpp"
#include "problem/natural_strains.hpp"

namespace dlo::energy_model {

/// Angle of a direction in the plane x-y, from x to y [rad].
[[nodiscard]] double angle_of(const Eigen::Vector3d& direction);

/// The angle that differs from `angle` by whole turns and is nearest to `target` [rad].
[[nodiscard]] double nearest_turn(double angle, double target);

/// Products, row by row, of vectors in the plane x-y. @param[out] result  one a row
void dot_in_plane(const Eigen::MatrixX3d& a, const Eigen::MatrixX3d& b, Eigen::VectorXd& result);

/// A rod's tangents in the plane x-y from its curvature: what RodFrames are in space.
///     t = (cos theta, sin theta, 0),  theta(s) = theta_0 + int_0^s (natural curvature + u) ds,
/// u expanded in orthonormal Legendre polynomials on every piece (Piece), so that its energy is
/// half the square of the coefficients. theta is linear in the unknowns.
///
/// Unknowns x: the coefficients piece by piece. If no clamp holds the start, its angle comes first.
class PlanarFrames {
 public:
  /// Of the last evaluate(), rows are nodes.
  struct State {
    Eigen::VectorXd theta;
    Eigen::MatrixX3d t_theta;  ///< d t / d theta

    // Scratch, by node, by unknown, and of a piece
    Eigen::VectorXd turning, by_unknown, curvature, beside;
    Eigen::MatrixXd scaled, own;
  };

  /// Nodes are those of legendre_table(terms) on each piece.
  /// @param start_theta  angle at the start [rad]; none: it is free
  void reset(const std::vector<Piece>& pieces, int terms, std::optional<double> start_theta,
             const NaturalStrains& natural);
  /// Gives a state its size; nothing else allocates, but for tangent_jacobian() and fit().
  void resize(State& state) const;

  /// 0 of a free one [rad].
  [[nodiscard]] double start_theta() const { return start_theta_; }
  /// Derivatives of the nodes' angles by the unknowns, nodes x unknowns.
  [[nodiscard]] const Eigen::MatrixXd& by_unknown() const { return angle_; }
  /// The same of the angle at a piece's end.
  [[nodiscard]] Eigen::RowVectorXd by_unknown_after(Eigen::Index piece) const;
  /// By how much the angle at a piece's end has to exceed the start's and the stress-free shape's
  /// for the tangent to have this direction, by the fewest turns [rad].
  [[nodiscard]] double angle_towards(const Eigen::Vector3d& direction, Eigen::Index piece) const;

  /// @param[out] tangents  nodes x 3; z is left as it is
  void evaluate(const Eigen::Ref<const Eigen::VectorXd>& x, Eigen::MatrixX3d& tangents,
                State& state) const;
  /// state.by_unknown = derivatives by x of sum nodes . t, whose gradient by the tangents, nodes x
  /// 3, is `nodes`.
  void adjoint(const Eigen::MatrixX3d& nodes, State& state) const;
  /// The same of sum weights t_axis.
  void adjoint(const Eigen::Ref<const Eigen::VectorXd>& weights, Eigen::Index axis,
               State& state) const;
  /// Adds the second derivatives of sum along theta^2 / 2 by x.
  /// @param along  by node
  void add_hessian(const Eigen::VectorXd& along, State& state,
                   Eigen::Ref<Eigen::MatrixXd> hessian) const;
  /// Derivatives of the tangents at the nodes by x: three matrices, one an axis, nodes x unknowns.
  [[nodiscard]] std::array<Eigen::MatrixXd, 3> tangent_jacobian(const State& state) const;

  /// Subtracts from `along` weight B u^2, which bending takes off what the square of a tilt out of
  /// the plane costs. @param weights  of the nodes
  void subtract_bending(const Eigen::VectorXd& x, const Eigen::VectorXd& weights, State& state,
                        Eigen::VectorXd& along) const;

  /// Angles of tangents at the nodes (3 x nodes), continuous, without the stress-free shape's.
  [[nodiscard]] Eigen::VectorXd angles(const Eigen::Matrix3Xd& tangents) const;
  /// Unknowns whose angles at the nodes are nearest to these, by least squares on each piece.
  [[nodiscard]] Eigen::VectorXd fit(const Eigen::VectorXd& angles) const;

 private:
  [[nodiscard]] double turn_of(Eigen::Index piece) const {
    return pieces_[static_cast<std::size_t>(piece)].angle(0);
  }

  void tabulate_angles();

  std::vector<Piece> pieces_;
  Eigen::Index terms_ = 0;
  const LegendreTable* table_ = nullptr;
  Eigen::Index free_start_ = 0;  // unknowns of the start, 0 or 1
  double start_theta_ = 0;
  NaturalStrains natural_;
  Eigen::MatrixXd angle_, angle_transposed_;
  Eigen::VectorXd natural_angle_;
};

}  // namespace dlo::energy_model
