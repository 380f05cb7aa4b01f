#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "base/legendre.hpp"
#include "dlo/energy_model/problem.hpp"
#include "frames/piece.hpp"
#include "frames/planar_frames.hpp"
#include "problem/span.hpp"
#include "strain/span_point.hpp"

namespace dlo::energy_model {

/// Discretisation of a span, from which its terms are set up.
struct TermSetup {
  const Span& span;
  const std::vector<Element>& elements;
  const LegendreTable& table;
  const Eigen::VectorXd& nodes;    ///< arc lengths of the quadrature nodes
  const Eigen::VectorXd& weights;  ///< quadrature weights
  const PlanarFrames& plane;       ///< frames of a span in its plane
};

/// Base of the terms of a span's energy besides that of its strains. A term is a function of the
/// tangents t at the nodes and, in the plane, of the unknowns x. Its class declares reset(),
/// evaluate() and add_energies(), and each other function whose result is not that of this base.
/// SpanEnergy::Terms lists all terms.
struct Term {
  void reset(const TermSetup& setup) = delete;
  /// Adds the energy [EI/l] to at.energy, -dE/dt to at.force and dE/dx at fixed t to at.gradient.
  /// -dE/dt at a node is its quadrature weight times the force on all that lies beyond it, as seen
  /// from the anchor; at nodes before the anchor with the opposite sign.
  void evaluate(SpanPoint& at) const = delete;
  /// Whether the energy is nonlinear in the tangents.
  [[nodiscard]] static bool is_curved() { return false; }
  /// Adds the second derivatives at a point, except the part with second derivatives of the
  /// tangents, which at.force covers.
  /// @param tangents  derivatives of the tangents by the unknowns, one matrix per axis, nodes x
  ///   unknowns; for tilts out of the plane of a planar span only that of z is not zero
  void add_hessian(const SpanPoint& /*at*/, const std::array<Eigen::MatrixXd, 3>& /*tangents*/,
                   Eigen::Ref<Eigen::MatrixXd> /*hessian*/) const {}
  /// Adds the couples about the anchor that SpanPoint::force does not include.
  void add_couples(Eigen::Vector3d& /*moment*/) const {}
  /// Adds the energy [EI/l] to the member of `energies` for its kind.
  void add_energies(const TermSetup& setup, const SpanPoint& at, Energies& energies) const = delete;
};

}  // namespace dlo::energy_model
