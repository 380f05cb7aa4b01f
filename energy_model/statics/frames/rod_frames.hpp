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

/// Derivatives, at a shape, of a function f of the tangents and of the frames at the ends of
/// elements. `nodes` is its gradient by the tangents at the nodes (nodes x 3; null: zero).
/// `couples` holds one vector per element: a rotation vector theta, in space, of the frame at the
/// element's end changes f by couple . theta (empty: f does not depend on the frames).
struct FrameGradient {
  const Eigen::MatrixX3d* nodes = nullptr;
  std::span<const Eigen::Vector3d> couples;
};

/// Directors of a rod in space as functions of its body strains,
///     R' = R hat(u),  R = (d1, d2, t),  u = natural strains + elastic strains.
/// The elastic strains are expanded in orthonormal Legendre polynomials on every Element, so that
/// their energy is half the sum of the squares of the coefficients. This parametrisation has no
/// poles.
///
/// A round rod that is intrinsically straight needs two fields, u = (u1, u2, 0), even if clamps
/// twist it (SpanUnknowns::has_psi): d1 and d2 do not rotate about the tangent (Bishop's frame).
/// Natural strains and the principal axes of a section that is not round are fixed to the material
/// and require the field u3 too. For a straight rod with such a section the natural strains are
/// given, as zero.
///
/// Unknowns x: the coefficients of u1, element by element, then of u2, then of u3. If no clamp
/// fixes the start, each field begins with a component of the rotation vector, in the start frame,
/// that rotates the start.
class RodFrames {
 public:
  /// An element, or the rotation of a free start as an element of length 1, with its collocation of
  /// the directors.
  struct Panel {
    double length;
    std::array<double, 3> strain;  ///< strain for a coefficient of 1 of p_0 = 1, by field
    const LegendreTable* table;
    Eigen::Index terms, column, node;  ///< coefficients, first unknown in a field, first node

    [[nodiscard]] Eigen::Index nodes() const { return table->nodes.size(); }
  };

  /// Results of the last evaluate(). Rows are nodes; those of a free start's rotation come first.
  struct State {
    Eigen::MatrixX4d q;          ///< unit quaternions w, x, y, z
    Eigen::MatrixX3d u;          ///< strains
    Eigen::MatrixX3d d1, d2, t;  ///< directors
    /// Integral of t from each node to the end of its element, times the node's quadrature weight
    /// on [0, 1], divided by the length of the element.
    Eigen::MatrixX3d rest_integrals;
    std::vector<Eigen::Quaterniond> panel_ends;  ///< frames at panel ends
    /// Derivatives by x of the rotation of the end's frame, 3 x unknowns, from the last
    /// end_rotation_jacobian().
    Eigen::Matrix3Xd ends;

    // Scratch of one panel
    Eigen::MatrixX4d product, defect, turn;
    Eigen::MatrixX3d couples, moments, levers;
    Eigen::MatrixX3d along;
    Eigen::MatrixXd spins, scaled;

    /// Returns the frame of the span's end: columns d1, d2, t.
    [[nodiscard]] Eigen::Matrix3d end_frame() const { return panel_ends.back().toRotationMatrix(); }
  };

  RodFrames() = default;
  /// @param start  frame of the span's start: columns d1, d2, t
  RodFrames(const std::vector<Element>& elements, int terms, const Eigen::Matrix3d& start,
            bool free_start, const NaturalStrains& natural = {}) {
    reset(elements, terms, start, free_start, natural);
  }
  void reset(const std::vector<Element>& elements, int terms, const Eigen::Matrix3d& start,
             bool free_start, const NaturalStrains& natural);

  /// Number of fields: two, or three with natural strains, even if these are zero.
  [[nodiscard]] Eigen::Index fields() const { return fields_; }
  /// Returns the frame at the end of an element.
  [[nodiscard]] Eigen::Matrix3d frame_after(const State& state, Eigen::Index element) const {
    const auto turns = panels_.size() - elements_;
    return state.panel_ends[turns + static_cast<std::size_t>(element)].toRotationMatrix();
  }
  /// Panels; that of a free start's rotation comes first.
  [[nodiscard]] const std::vector<Panel>& panels() const { return panels_; }
  [[nodiscard]] std::size_t elements() const { return elements_; }
  [[nodiscard]] static const Eigen::MatrixX3d& director(const State& state, Eigen::Index field) {
    return field == 0 ? state.d1 : field == 1 ? state.d2 : state.t;
  }
  /// Frame of the span's start, before the rotation of a free start.
  [[nodiscard]] const Eigen::Quaterniond& start() const { return start_; }
  /// Natural strains at the nodes of all panels, zero at those of a free start's rotation; empty
  /// with two fields.
  [[nodiscard]] const Eigen::MatrixX3d& natural() const { return natural_; }
  /// Number of unknowns of one field.
  [[nodiscard]] Eigen::Index columns() const { return columns_; }
  [[nodiscard]] Eigen::Index size() const { return fields_ * columns_; }
  [[nodiscard]] Eigen::Index turn_nodes() const { return turn_nodes_; }
  /// Number of nodes of the elements.
  [[nodiscard]] Eigen::Index nodes() const { return nodes_ - turn_nodes_; }

  /// Resizes a state; with it no function except tangent_jacobian() allocates.
  void resize(State& state) const;

  /// Computes the directors by collocation at the nodes: fourth-order Magnus steps between
  /// neighbouring nodes, then Newton corrections of q = q0 + 1/2 int q u. Each correction squares
  /// the error, down to 1e-14 or to what the nodes do not resolve.
  void evaluate(const Eigen::Ref<const Eigen::VectorXd>& x, State& state) const;

  /// Adds `sense` times the gradient of f by x to `gradient`.
  void add_adjoint(const FrameGradient& f, double sense, State& state,
                   Eigen::Ref<Eigen::VectorXd> gradient) const;

  /// Computes state.couples (t x g at the panel's nodes) and state.moments: at each node of the
  /// panel its quadrature weight times the moment
  ///     M(s) = int_s^end t x dg
  /// by the discrete rule for rotations. @param later  sum of t x g and of f.couples beyond the
  /// panel
  void moments(const Panel& panel, const FrameGradient& f, const Eigen::Vector3d& later,
               State& state) const;
  /// Computes state.ends.
  void end_rotation_jacobian(State& state) const;
  /// Computes the derivatives by x of the work of a couple on the rotation of the frame at an
  /// element's end, from state.ends.
  void couple_adjoint(Eigen::Index element, const Eigen::Vector3d& couple, const State& state,
                      Eigen::Ref<Eigen::RowVectorXd, 0, Eigen::InnerStride<>> row) const;

  /// Computes the derivatives by x of sum_e sign_e int_e t ds over the elements e (the position of
  /// a grip relative to the anchor), 3 x unknowns.
  void position_jacobian(const std::vector<double>& signs, State& state,
                         Eigen::Ref<Eigen::MatrixXd> jacobian) const;

  /// Returns the derivatives of the tangents at the nodes by x: one matrix per axis, nodes x
  /// unknowns.
  [[nodiscard]] std::array<Eigen::MatrixXd, 3> tangent_jacobian(State& state) const;

 private:
  void integrate(const Panel& panel, Eigen::Quaterniond& at, State& state) const;
  void multiply_by_strains(const Eigen::Ref<const Eigen::MatrixX4d, 0, Eigen::OuterStride<>>& q,
                           const Panel& panel, const State& state,
                           Eigen::Ref<Eigen::MatrixX4d, 0, Eigen::OuterStride<>> product) const;
  void own_spins(const Panel& panel, State& state) const;
  void end_spins(const Panel& panel, State& state) const;

  std::vector<Panel> panels_;
  std::size_t elements_ = 0;  // number of elements; their panels are the last ones
  Eigen::Index fields_ = 2;
  Eigen::MatrixX3d natural_;  // strains at the nodes; empty with two fields
  Eigen::Index columns_ = 0;
  Eigen::Index turn_nodes_ = 0;
  Eigen::Index nodes_ = 0;  // number of nodes of all panels
  Eigen::Quaterniond start_ = Eigen::Quaterniond::Identity();
};

}  // namespace dlo::energy_model
