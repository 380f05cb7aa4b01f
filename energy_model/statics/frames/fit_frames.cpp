#include "frames/fit_frames.hpp"

#include <cmath>
#include <numbers>
#include <optional>
#include <vector>

#include "base/legendre.hpp"
#include "base/spin.hpp"
#include "linear/dense_products.hpp"

namespace dlo::energy_model {
namespace {

/// Returns the rotation vector, in body axes and normal to the tangent, that rotates the tangent e3
/// to v.
Eigen::Vector2d rotation_to(const Eigen::Vector3d& v) {
  const double sine = std::hypot(v.x(), v.y());
  const double angle = std::atan2(sine, v.z());
  if (sine < 1e-12) return {v.z() > 0 ? 0 : std::numbers::pi, 0};
  return Eigen::Vector2d(-v.y(), v.x()) * (angle / sine);
}

/// Returns coefficients whose integral of u comes nearest to these angles (nodes of elements x 2),
/// and the rotation of a free start.
Eigen::VectorXd coefficients_from_angles(const RodFrames& frames, const Eigen::MatrixX2d& angles) {
  Eigen::VectorXd x = Eigen::VectorXd::Zero(frames.size());
  const Eigen::Index first = frames.turn_nodes() > 0 ? 1 : 0;
  const LegendreTable& table = *frames.panels().back().table;
  for (Eigen::Index field = 0; field < 2; ++field) {
    std::vector<double> turns;
    for (const RodFrames::Panel& panel : frames.panels()) {
      if (panel.node < frames.turn_nodes()) continue;
      turns.push_back(panel.length * panel.strain[static_cast<std::size_t>(field)]);
    }
    const FittedAngle fitted = fit_angle(table, turns, angles.col(field),
                                         first == 0 ? std::optional<double>(0) : std::nullopt);
    if (first == 1) x[field * frames.columns()] = fitted.start;
    x.segment(field * frames.columns() + first, frames.columns() - first) = fitted.coefficients;
  }
  return x;
}

/// Integrates values at the nodes of elements from the start to each node.
Eigen::VectorXd integrate_to_nodes(const RodFrames& frames, const Eigen::VectorXd& values) {
  Eigen::VectorXd integral(values.size());
  double before = 0;
  for (const RodFrames::Panel& panel : frames.panels()) {
    if (panel.node < frames.turn_nodes()) continue;
    const Eigen::Index Q = panel.nodes();
    const auto own = values.segment(panel.node - frames.turn_nodes(), Q);
    auto result = integral.segment(panel.node - frames.turn_nodes(), Q);
    result.noalias() = panel.length * (panel.table->integration * own);
    result.array() += before;
    before += panel.length * panel.table->weights.dot(own);
  }
  return integral;
}

/// Returns the coefficients of strains at all nodes; those of a free start's rotation stay zero.
Eigen::VectorXd project_strains(const RodFrames& frames, const Eigen::MatrixX3d& strains) {
  Eigen::VectorXd x = Eigen::VectorXd::Zero(frames.size());
  for (const RodFrames::Panel& panel : frames.panels()) {
    if (panel.node < frames.turn_nodes()) continue;
    const auto own = strains.middleRows(panel.node, panel.nodes());
    for (Eigen::Index field = 0; field < frames.fields(); ++field) {
      const Eigen::VectorXd weighted = panel.table->weights.cwiseProduct(own.col(field));
      x.segment(field * frames.columns() + panel.column, panel.terms).noalias() =
          panel.table->values.leftCols(panel.terms).transpose() * weighted /
          panel.strain[static_cast<std::size_t>(field)];
    }
  }
  return x;
}

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

Eigen::VectorXd fit(const RodFrames& frames, const Eigen::Matrix3Xd& tangents, int most_steps,
                    RodFrames::State& scratch) {
  const Eigen::Index nodes = frames.nodes();
  Eigen::MatrixX2d angles(nodes, 2);
  Eigen::Quaterniond frame = frames.start();
  Eigen::Vector2d total = Eigen::Vector2d::Zero();
  for (Eigen::Index q = 0; q < nodes; ++q) {
    const Eigen::Vector2d turn = rotation_to(frame.conjugate() * tangents.col(q));
    frame = frame * from_rotation_vector({turn.x(), turn.y(), 0});
    total += turn;
    angles.row(q) = total.transpose();
  }
  Eigen::VectorXd x = coefficients_from_angles(frames, angles);
  if (frames.fields() == 3) x -= project_strains(frames, frames.natural());
  // Newton steps towards the tangents. A small rotation R omega of the frames, without a component
  // about the tangent at the start, comes from strains omega' + u x omega.
  for (int step = 0; step < most_steps; ++step) {
    frames.evaluate(x, scratch);
    Eigen::MatrixX2d turns(nodes, 2);
    Eigen::VectorXd twisting(nodes);
    for (Eigen::Index q = 0; q < nodes; ++q) {
      const Eigen::Index node = frames.turn_nodes() + q;
      const Eigen::Vector3d v(scratch.d1.row(node) * tangents.col(q),
                              scratch.d2.row(node) * tangents.col(q),
                              scratch.t.row(node) * tangents.col(q));
      turns.row(q) = rotation_to(v).transpose();
      twisting[q] = scratch.u(node, 1) * turns(q, 0) - scratch.u(node, 0) * turns(q, 1);
    }
    if (!(turns.cwiseAbs().maxCoeff() < 1)) break;
    const Eigen::VectorXd twist = integrate_to_nodes(frames, twisting);
    const auto strains = scratch.u.bottomRows(nodes);
    turns.col(0) += integrate_to_nodes(frames, strains.col(1).cwiseProduct(twist));
    turns.col(1) -= integrate_to_nodes(frames, strains.col(0).cwiseProduct(twist));
    x += coefficients_from_angles(frames, turns);
    // The remaining error is about the square of this correction, which suffices for an initial
    // guess.
    if (turns.cwiseAbs().maxCoeff() < 1e-3) break;
  }
  return x;
}

Eigen::VectorXd rolled(const RodFrames& frames, const Eigen::VectorXd& x,
                       const Eigen::VectorXd& roll) {
  RodFrames::State state;
  frames.resize(state);
  frames.evaluate(x, state);
  Eigen::MatrixX3d strains = state.u - frames.natural();
  std::vector<double> turns;
  for (const RodFrames::Panel& panel : frames.panels()) {
    if (panel.node >= frames.turn_nodes()) turns.push_back(panel.length * panel.strain[2]);
  }
  for (Eigen::Index q = 0; q < roll.size(); ++q) {
    const Eigen::Index node = frames.turn_nodes() + q;
    const double c = std::cos(roll[q]);
    const double s = std::sin(roll[q]);
    const Eigen::RowVector3d u = state.u.row(node);
    strains(node, 0) = c * u[0] + s * u[1] - frames.natural()(node, 0);
    strains(node, 1) = c * u[1] - s * u[0] - frames.natural()(node, 1);
    strains(node, 2) = u[2] - frames.natural()(node, 2);
  }
  Eigen::VectorXd result = project_strains(frames, strains);
  const FittedAngle twist = fit_angle(*frames.panels().back().table, turns, roll, 0.0);
  const Eigen::Index first = frames.turn_nodes() > 0 ? 1 : 0;
  result.segment(2 * frames.columns() + first, frames.columns() - first) += twist.coefficients;
  // The rotation of a free start is kept.
  for (Eigen::Index field = 0; field < frames.fields() && first == 1; ++field) {
    result[field * frames.columns()] = x[field * frames.columns()];
  }
  return result;
}

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
