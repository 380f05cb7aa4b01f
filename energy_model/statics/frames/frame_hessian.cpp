#include "frames/frame_hessian.hpp"

#include <algorithm>

#include "base/spin.hpp"
#include "linear/dense_products.hpp"

namespace dlo::energy_model {

void FrameHessian::resize(const RodFrames& frames) {
  const Eigen::Index Q = frames.panels().back().nodes();
  const Eigen::Index K = std::max(frames.panels().back().terms, frames.panels().front().terms);
  const Eigen::Index pairs = frames.fields() * (frames.fields() + 1) / 2;
  for (auto* m : {&curvatures_, &later_curvatures_}) m->resize(Q, 6);
  for (auto* by_field : {&adjoints_, &turns_}) {
    for (Eigen::MatrixX3d& m : *by_field) m.resize(Q, 3);
  }
  pairs_.resize(Q, pairs * Q);
  by_node_.resize(K, pairs * Q);
  own_block_.resize(frames.fields() * K, frames.fields() * K);
  beside_.resize(3, frames.fields() * K);
  turned_.resize(3, K);
  earlier_coupling_.resize(frames.columns(), K);
}

/// Computes later_curvatures_: the integral int_s^end A of f's second derivatives A by rotations of
/// the panel's nodes, from each node to the panel's end, times the node's quadrature weight.
/// @return the sum of A over the panel
Eigen::Matrix3d FrameHessian::gather_curvatures(const RodFrames& frames,
                                                const RodFrames::Panel& panel,
                                                const FrameGradient& f,
                                                const RodFrames::State& state) {
  const Eigen::Index Q = panel.nodes();
  auto beyond = later_curvatures_.topRows(Q);
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  if (panel.node < frames.turn_nodes()) {
    beyond.setZero();
    return sum;
  }
  auto curvatures = curvatures_.topRows(Q);
  for (Eigen::Index r = 0; r < Q; ++r) {
    const Eigen::Index node = panel.node + r;
    const Eigen::Matrix3d a =
        spin_hessian(state.t.row(node), f.nodes->row(node - frames.turn_nodes()));
    sum += a;
    curvatures.row(r) << a(0, 0), a(1, 1), a(2, 2), a(0, 1), a(0, 2), a(1, 2);
  }
  multiply(panel.table->integration_transposed, curvatures, beyond);
  beyond *= panel.length;
  return sum;
}

/// Computes turns_, the rotation rate of a node by an unknown whose polynomial is 1 there, times
/// the panel's length, and adjoints_, the derivative of f by that unknown after a rotation theta of
/// the node, adjoint . theta, times the node's quadrature weight: with M = state.moments and B =
/// later_curvatures_ it is d x M / 2 + B d.
void FrameHessian::compute_rotation_rates(const RodFrames& frames, const RodFrames::Panel& panel,
                                          const RodFrames::State& state) {
  const Eigen::Index Q = panel.nodes();
  const auto M = state.moments.topRows(Q).array();
  const auto B = later_curvatures_.topRows(Q).array();
  for (Eigen::Index field = 0; field < frames.fields(); ++field) {
    const auto which = static_cast<std::size_t>(field);
    const auto d = RodFrames::director(state, field).middleRows(panel.node, Q).array();
    auto adjoint = adjoints_[which].topRows(Q).array();
    adjoint.col(0) = (d.col(1) * M.col(2) - d.col(2) * M.col(1)) / 2 + B.col(0) * d.col(0) +
                     B.col(3) * d.col(1) + B.col(4) * d.col(2);
    adjoint.col(1) = (d.col(2) * M.col(0) - d.col(0) * M.col(2)) / 2 + B.col(3) * d.col(0) +
                     B.col(1) * d.col(1) + B.col(5) * d.col(2);
    adjoint.col(2) = (d.col(0) * M.col(1) - d.col(1) * M.col(0)) / 2 + B.col(4) * d.col(0) +
                     B.col(5) * d.col(1) + B.col(2) * d.col(2);
    adjoint *= panel.strain[which];
    turns_[which].topRows(Q).array() = panel.length * panel.strain[which] * d;
  }
}

/// Computes own_block_: second derivatives of f by pairs of the panel's own unknowns. With the
/// strains p and p' of a pair, and the rotation theta' = int turn' p' that p' causes up to a node,
/// f changes by
///     int adjoint . theta' p ds
/// and by the same expression with p and p' exchanged: theta . A theta' has been integrated by
/// parts, and each order of two rotations counts half. Rotations of all nodes by all unknowns are
/// not computed; only pairs of nodes are, and the polynomials are applied last.
void FrameHessian::pair_unknowns(const RodFrames::Panel& panel, Eigen::Index fields) {
  const LegendreTable& table = *panel.table;
  const Eigen::Index Q = panel.nodes();
  const Eigen::Index K = panel.terms;
  const Eigen::Index pairs = fields * (fields + 1) / 2;
  const auto values = table.values_transposed.topRows(K);
  Eigen::Index pair = 0;
  for (Eigen::Index a = 0; a < fields; ++a) {
    for (Eigen::Index b = a; b < fields; ++b, ++pair) {
      const auto first = static_cast<std::size_t>(a);
      const auto second = static_cast<std::size_t>(b);
      auto nodes = pairs_.block(0, pair * Q, Q, Q);
      dense_kernel().add_weighted_products(
          {columns_of(table.integration), columns_of(adjoints_[first].topRows(Q)),
           columns_of(turns_[second].topRows(Q))},
          {columns_of(table.integration_transposed), columns_of(turns_[first].topRows(Q)),
           columns_of(adjoints_[second].topRows(Q))},
          result_columns(nodes));
    }
  }
  auto by_node = by_node_.topLeftCorner(K, pairs * Q);
  multiply(values, pairs_.topLeftCorner(Q, pairs * Q), by_node);
  pair = 0;
  for (Eigen::Index a = 0; a < fields; ++a) {
    for (Eigen::Index b = a; b < fields; ++b, ++pair) {
      auto own = own_block_.block(a * K, b * K, K, K);
      const auto of_pair = by_node.middleCols(pair * Q, Q);
      if (a == b) {
        multiply_symmetric(values, of_pair, own);
        continue;
      }
      multiply(of_pair, table.values.leftCols(K), own);
      own_block_.block(b * K, a * K, K, K) = own.transpose();
    }
  }
}

void FrameHessian::add(const RodFrames& frames, const FrameGradient& f,
                       std::span<const Eigen::Matrix3d> curvatures, RodFrames::State& state,
                       Eigen::Ref<Eigen::MatrixXd> hessian) {
  resize(frames);
  frames.end_rotation_jacobian(state);
  Eigen::Matrix3d later_curvature = Eigen::Matrix3d::Zero();
  Eigen::Vector3d later = Eigen::Vector3d::Zero();
  std::size_t element = frames.elements();
  for (auto panel = frames.panels().rbegin(); panel != frames.panels().rend(); ++panel) {
    if (element > 0 && !f.couples.empty()) {
      later += f.couples[--element];
      later_curvature += curvatures[element];
    }
    frames.moments(*panel, f, later, state);
    const Eigen::Matrix3d curvature = gather_curvatures(frames, *panel, f, state);
    compute_rotation_rates(frames, *panel, state);
    pair_unknowns(*panel, frames.fields());
    // Coupling of the panel's unknowns with the rotation of everything beyond an earlier panel.
    const Eigen::Index Q = panel->nodes();
    const Eigen::Index K = panel->terms;
    for (Eigen::Index field = 0; field < frames.fields() && panel->column > 0; ++field) {
      auto turned = state.product.topLeftCorner(K, 3);
      multiply(panel->table->values_transposed.topRows(K),
               adjoints_[static_cast<std::size_t>(field)].topRows(Q), turned);
      auto beside = beside_.middleCols(field * K, K);
      const auto ends = state.ends.middleCols(field * frames.columns() + panel->column, K);
      beside = turned.transpose();
      beside.noalias() += later_curvature * ends;
    }
    add_panel(frames, *panel, later_curvature, state, hessian);
    later_curvature += curvature;
    later += state.couples.topRows(Q).colwise().sum().transpose();
  }
}

/// Adds own_block_, the contribution of the rotation of everything beyond the panel, and the blocks
/// that couple the panel with earlier panels.
void FrameHessian::add_panel(const RodFrames& frames, const RodFrames::Panel& panel,
                             const Eigen::Matrix3d& later_curvature, const RodFrames::State& state,
                             Eigen::Ref<Eigen::MatrixXd> hessian) {
  const Eigen::Index K = panel.terms;
  const bool has_later_curvature = (later_curvature.array() != 0).any();
  for (Eigen::Index row = 0; row < frames.fields(); ++row) {
    const Eigen::Index at_row = row * frames.columns() + panel.column;
    for (Eigen::Index column = 0; column < frames.fields(); ++column) {
      const Eigen::Index at_column = column * frames.columns() + panel.column;
      auto block = hessian.block(at_row, at_column, K, K);
      block += own_block_.block(row * K, column * K, K, K);
      if (has_later_curvature) {
        const auto ends = state.ends.middleCols(at_column, K);
        auto turned = turned_.leftCols(K);
        turned.noalias() = later_curvature * ends;
        block.noalias() += state.ends.middleCols(at_row, K).transpose() * turned;
      }
      if (panel.column == 0) continue;
      auto before = earlier_coupling_.topLeftCorner(panel.column, K);
      before.noalias() = state.ends.middleCols(row * frames.columns(), panel.column).transpose() *
                         beside_.middleCols(column * K, K);
      hessian.block(row * frames.columns(), at_column, panel.column, K) += before;
      hessian.block(at_column, row * frames.columns(), K, panel.column) += before.transpose();
    }
  }
}

}  // namespace dlo::energy_model
