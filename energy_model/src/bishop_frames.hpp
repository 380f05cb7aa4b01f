#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <vector>

#include "legendre.hpp"
#include "piece.hpp"

namespace dlo::energy_model {

/// What a function f of the tangents and of the end's frame has at a point, for derivatives by the
/// strains: its gradient by the tangents at the nodes (nodes x 3; null: none), and what a turn
/// theta of the end's frame, a rotation vector in space, changes: end_couple . theta.
struct FrameGradient {
  const Eigen::MatrixX3d* nodes = nullptr;
  Eigen::Vector3d end_couple = Eigen::Vector3d::Zero();
};

/// A rod's directors in space from its body strains,
///     R' = R hat(u),  u = (u1, u2, 0),  R = (d1, d2, t),
/// u expanded in orthonormal Legendre polynomials on every piece, so that bending energy is half
/// the square of the coefficients. d1 and d2 do not turn about the tangent (Bishop's frame): a
/// round rod whose grips leave the twist free needs no more. There are no poles.
///
/// Unknowns x: of u1 the coefficients piece by piece, then of u2. If no clamp holds the start, each
/// begins with a component of the rotation vector, in the start frame, that turns the start there.
class BishopFrames {
 public:
  /// Of the last evaluate(), rows are nodes, those of a free start's turn first.
  struct State {
    Eigen::MatrixX4d q;          ///< unit quaternions w, x, y, z
    Eigen::MatrixX2d u;          ///< strains
    Eigen::MatrixX3d d1, d2, t;  ///< directors
    /// Weighted int_s^end t within each piece, in lengths of the piece, at the nodes.
    Eigen::MatrixX3d tails;
    Eigen::Quaterniond end;  ///< frame of the span's end
    /// Derivatives of the turn of the end's frame by x, 3 x unknowns, of the last add_hessian().
    Eigen::Matrix3Xd ends;

    // Scratch, of a piece
    Eigen::MatrixX4d product, defect, turn;
    Eigen::MatrixX3d couples, moments, levers;
    Eigen::VectorXd along;
    Eigen::MatrixXd spins, weighted, scaled, own, before;
    Eigen::Matrix3Xd beside, turned;

    [[nodiscard]] Eigen::Matrix3d end_frame() const { return end.toRotationMatrix(); }
  };

  BishopFrames() = default;
  /// @param start  frame of the span's start: columns d1, d2, t
  BishopFrames(const std::vector<Piece>& pieces, int terms, const Eigen::Matrix3d& start,
               bool free_start) {
    reset(pieces, terms, start, free_start);
  }
  void reset(const std::vector<Piece>& pieces, int terms, const Eigen::Matrix3d& start,
             bool free_start);

  /// Unknowns of one field, and nodes of a free start's turn.
  [[nodiscard]] Eigen::Index columns() const { return columns_; }
  [[nodiscard]] Eigen::Index turn_nodes() const { return turn_nodes_; }

  /// Gives a state its size; nothing else allocates, but for tangent_jacobian() and fit().
  void resize(State& state) const;

  /// Directors by collocation at the nodes: Magnus' fourth-order steps between neighbouring nodes,
  /// then Newton's corrections of q = q0 + 1/2 int q u, each of which squares the error, to 1e-14.
  void evaluate(const Eigen::Ref<const Eigen::VectorXd>& x, State& state) const;

  /// Adds `sense` times the gradient of f by x.
  void pull(const FrameGradient& f, double sense, State& state,
            Eigen::Ref<Eigen::VectorXd> gradient) const;

  /// Derivatives by x of sum_e sign_e int_e t ds over the pieces e, which is where a grip is seen
  /// from the anchor, into 3 x unknowns.
  void pull_position(const std::vector<double>& signs, State& state,
                     Eigen::Ref<Eigen::MatrixXd> jacobian) const;

  /// Adds the second derivatives of f by x.
  /// @param end_curvature  second derivatives of f by turns of the end's frame
  void add_hessian(const FrameGradient& f, const Eigen::Matrix3d& end_curvature, State& state,
                   Eigen::Ref<Eigen::MatrixXd> hessian) const;

  /// Derivatives of the tangents at the nodes by x: three matrices, one an axis, nodes x unknowns.
  [[nodiscard]] std::array<Eigen::MatrixXd, 3> tangent_jacobian(State& state) const;

  /// Coefficients whose tangents at the nodes are these (3 x nodes), by least squares on each
  /// piece.
  [[nodiscard]] Eigen::VectorXd fit(const Eigen::Matrix3Xd& tangents) const;

 private:
  struct Panel {
    double length;
    const LegendreTable* table;
    Eigen::Index terms, column, node;

    [[nodiscard]] Eigen::Index nodes() const { return table->nodes.size(); }
  };

  static void integrate(const Panel& panel, Eigen::Quaterniond& at, State& state);
  void moments(const Panel& panel, const FrameGradient& f, const Eigen::Vector3d& later,
               State& state) const;
  static void own_spins(const Panel& panel, State& state);
  void end_spins(const Panel& panel, State& state) const;
  void add_panel(const Panel& panel, const Eigen::Matrix3d& later_curvature, State& state,
                 Eigen::Ref<Eigen::MatrixXd> hessian) const;
  [[nodiscard]] Eigen::VectorXd from_angles(const Eigen::MatrixX2d& angles) const;
  [[nodiscard]] Eigen::VectorXd cumulated(const Eigen::VectorXd& values) const;
  [[nodiscard]] std::vector<double> piece_lengths() const;

  std::vector<Panel> panels_;
  Eigen::Index columns_ = 0;
  Eigen::Index turn_nodes_ = 0;
  Eigen::Index nodes_ = 0;  // of all panels
  Eigen::Quaterniond start_ = Eigen::Quaterniond::Identity();
};

}  // namespace dlo::energy_model
