#include "frames/frame_spins.hpp"

#include "base/spin.hpp"
#include "linear/dense_products.hpp"

namespace dlo::energy_model {
namespace {

/// Returns the rates of the strains at a panel's nodes, as vectors in space.
Eigen::MatrixX3d strains_in_space(const RodFrames& frames, const RodFrames::State& state,
                                  const RodFrames::Panel& panel, const Eigen::VectorXd& rates) {
  const Eigen::Index Q = panel.nodes();
  Eigen::MatrixX3d result = Eigen::MatrixX3d::Zero(Q, 3);
  for (Eigen::Index field = 0; field < frames.fields(); ++field) {
    const Eigen::VectorXd strains =
        panel.strain[static_cast<std::size_t>(field)] *
        (panel.table->values.leftCols(panel.terms) *
         rates.segment(field * frames.columns() + panel.column, panel.terms));
    result += strains.asDiagonal() * RodFrames::director(state, field).middleRows(panel.node, Q);
  }
  return result;
}

}  // namespace

FrameSpins frame_spins(const RodFrames& frames, const RodFrames::State& state,
                       const FrameRates& rates) {
  FrameSpins result{{}, {}, rates.spin, rates.spin_rate};
  result.velocities.resize(frames.nodes(), 3);
  result.accelerations.resize(frames.nodes(), 3);
  for (const RodFrames::Panel& panel : frames.panels()) {
    const LegendreTable& table = *panel.table;
    const Eigen::MatrixX3d changed = strains_in_space(frames, state, panel, rates.v);
    Eigen::MatrixX3d velocities(panel.nodes(), 3);
    multiply(table.integration, changed, velocities);
    velocities = (panel.length * velocities).rowwise() + result.end_velocity.transpose();
    const Eigen::MatrixX3d changed_on =
        strains_in_space(frames, state, panel, rates.a) + cross_rows(velocities, changed);
    if (panel.node >= frames.turn_nodes()) {
      auto accelerations =
          result.accelerations.middleRows(panel.node - frames.turn_nodes(), panel.nodes());
      multiply(table.integration, changed_on, accelerations);
      accelerations =
          (panel.length * accelerations).rowwise() + result.end_acceleration.transpose();
      result.velocities.middleRows(panel.node - frames.turn_nodes(), panel.nodes()) = velocities;
    }
    result.end_velocity += panel.length * (changed.transpose() * table.weights);
    result.end_acceleration += panel.length * (changed_on.transpose() * table.weights);
  }
  return result;
}

}  // namespace dlo::energy_model
