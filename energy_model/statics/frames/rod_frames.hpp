#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <span>
#include <vector>

#include "base/legendre.hpp"
#include "frames/piece.hpp"
#include "problem/natural_strains.hpp"

namespace dlo::energy_model {

/// What a function f of the tangents and of the frames at the pieces' ends has at a point, for
/// derivatives by the strains: its gradient by the tangents at the nodes (nodes x 3; null: none),
/// and by piece what a turn theta of the frame at its end, a rotation vector in space, changes:
/// couple . theta (empty: nothing).
struct FrameGradient {
  const Eigen::MatrixX3d* nodes = nullptr;
  std::span<const Eigen::Vector3d> couples;
};

/// A rod's directors in space from its body strains,
///     R' = R hat(u),  R = (d1, d2, t),  u = natural strains + what the rod's energy is of,
/// the latter expanded in orthonormal Legendre polynomials on every piece (Piece), so that energy
/// is half the square of the coefficients. There are no poles.
///
/// A round rod that is intrinsically straight and whose grips leave the twist free needs two
/// fields, u = (u1, u2, 0): d1 and d2 do not rotate around the tangent (Bishop's frame). Natural
/// strains and the principal axes of a section that is not round are fixed to the material, so that
/// it takes u3 too: of a straight rod with such a section they are given, as zero.
///
/// Unknowns x: of u1 the coefficients piece by piece, then of u2, then of u3. If no clamp holds the
/// start, each begins with a component of the rotation vector, in the start frame, that turns the
/// start there.
class RodFrames {
 public:
  /// A piece, or the turn of a free start, which is one of length 1, as the directors are
  /// collocated on it.
  struct Panel {
    double length;
    std::array<double, 3> strain;  ///< of the coefficient of p_0 = 1, by field
    const LegendreTable* table;
    Eigen::Index terms, column, node;  ///< its first unknown of a field, and its first node

    [[nodiscard]] Eigen::Index nodes() const { return table->nodes.size(); }
  };

  /// Of the last evaluate(), rows are nodes, those of a free start's turn first.
  struct State {
    Eigen::MatrixX4d q;          ///< unit quaternions w, x, y, z
    Eigen::MatrixX3d u;          ///< strains
    Eigen::MatrixX3d d1, d2, t;  ///< directors
    /// Weighted int_s^end t within each piece, in lengths of the piece, at the nodes.
    Eigen::MatrixX3d tails;
    std::vector<Eigen::Quaterniond> panel_ends;  ///< frames; of a free start's turn first
    /// Derivatives of the turn of the end's frame by x, 3 x unknowns, of the
    /// last end_rotation_jacobian().
    Eigen::Matrix3Xd ends;

    // Scratch, of a piece
    Eigen::MatrixX4d product, defect, turn;
    Eigen::MatrixX3d couples, moments, levers;
    Eigen::MatrixX3d along;
    Eigen::MatrixXd spins, scaled;

    /// Frame of the span's end.
    [[nodiscard]] Eigen::Matrix3d end_frame() const { return panel_ends.back().toRotationMatrix(); }
  };

  RodFrames() = default;
  /// @param start  frame of the span's start: columns d1, d2, t
  RodFrames(const std::vector<Piece>& pieces, int terms, const Eigen::Matrix3d& start,
            bool free_start, const NaturalStrains& natural = {}) {
    reset(pieces, terms, start, free_start, natural);
  }
  void reset(const std::vector<Piece>& pieces, int terms, const Eigen::Matrix3d& start,
             bool free_start, const NaturalStrains& natural);

  /// Two, or three with natural strains, were they zero.
  [[nodiscard]] Eigen::Index fields() const { return fields_; }
  /// Frame at the end of a piece.
  [[nodiscard]] Eigen::Matrix3d frame_after(const State& state, Eigen::Index piece) const {
    const auto turns = panels_.size() - pieces_;
    return state.panel_ends[turns + static_cast<std::size_t>(piece)].toRotationMatrix();
  }
  /// That of a free start first.
  [[nodiscard]] const std::vector<Panel>& panels() const { return panels_; }
  [[nodiscard]] std::size_t pieces() const { return pieces_; }
  [[nodiscard]] static const Eigen::MatrixX3d& director(const State& state, Eigen::Index field) {
    return field == 0 ? state.d1 : field == 1 ? state.d2 : state.t;
  }
  /// Frame of the span's start, without the turn of a free one.
  [[nodiscard]] const Eigen::Quaterniond& start() const { return start_; }
  /// Natural strains at the nodes; empty with two fields.
  [[nodiscard]] const Eigen::MatrixX3d& natural() const { return natural_; }
  /// Unknowns of one field, and nodes of a free start's turn.
  [[nodiscard]] Eigen::Index columns() const { return columns_; }
  [[nodiscard]] Eigen::Index size() const { return fields_ * columns_; }
  [[nodiscard]] Eigen::Index turn_nodes() const { return turn_nodes_; }
  /// Those of the pieces.
  [[nodiscard]] Eigen::Index nodes() const { return nodes_ - turn_nodes_; }

  /// Gives a state its size; nothing else allocates, but for tangent_jacobian().
  void resize(State& state) const;

  /// Directors by collocation at the nodes: Magnus' fourth-order steps between neighbouring nodes,
  /// then Newton's corrections of q = q0 + 1/2 int q u, each of which squares the error, to 1e-14
  /// or to what the nodes do not resolve.
  void evaluate(const Eigen::Ref<const Eigen::VectorXd>& x, State& state) const;

  /// Adds `sense` times the gradient of f by x.
  void add_adjoint(const FrameGradient& f, double sense, State& state,
                   Eigen::Ref<Eigen::VectorXd> gradient) const;

  /// Into state.couples and state.moments (rows of a panel): t x g of the nodes, and the moment
  ///     M(s) = int_s^end t x dg
  /// that the discrete spins give them; `later` is the sum of t x g beyond the panel.
  void moments(const Panel& panel, const FrameGradient& f, const Eigen::Vector3d& later,
               State& state) const;
  /// Into state.ends.
  void end_rotation_jacobian(State& state) const;
  /// Derivatives by x of the work of a couple on the turn of the frame at a
  /// piece's end, from state.ends.
  void couple_adjoint(Eigen::Index piece, const Eigen::Vector3d& couple, const State& state,
                      Eigen::Ref<Eigen::RowVectorXd, 0, Eigen::InnerStride<>> row) const;

  /// Derivatives by x of sum_e sign_e int_e t ds over the pieces e, which is
  /// where a grip is seen from the anchor, into 3 x unknowns.
  void position_jacobian(const std::vector<double>& signs, State& state,
                         Eigen::Ref<Eigen::MatrixXd> jacobian) const;

  /// Derivatives of the tangents at the nodes by x: three matrices, one an axis, nodes x unknowns.
  [[nodiscard]] std::array<Eigen::MatrixXd, 3> tangent_jacobian(State& state) const;

 private:
  void integrate(const Panel& panel, Eigen::Quaterniond& at, State& state) const;
  void multiply_by_strains(const Eigen::Ref<const Eigen::MatrixX4d, 0, Eigen::OuterStride<>>& q,
                           const Panel& panel, const State& state,
                           Eigen::Ref<Eigen::MatrixX4d, 0, Eigen::OuterStride<>> product) const;
  void own_spins(const Panel& panel, State& state) const;
  void end_spins(const Panel& panel, State& state) const;

  std::vector<Panel> panels_;
  std::size_t pieces_ = 0;  // of the panels, the last ones
  Eigen::Index fields_ = 2;
  Eigen::MatrixX3d natural_;  // strains at the nodes; empty with two fields
  Eigen::Index columns_ = 0;
  Eigen::Index turn_nodes_ = 0;
  Eigen::Index nodes_ = 0;  // of all panels
  Eigen::Quaterniond start_ = Eigen::Quaterniond::Identity();
};

}  // namespace dlo::energy_model
