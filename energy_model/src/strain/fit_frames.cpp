#include <cmath>
#include <numbers>
#include <optional>
#include <vector>

#include "base/fit_angle.hpp"
#include "base/spin.hpp"
#include "strain/rod_frames.hpp"

namespace dlo::energy_model {
namespace {

/// Rotation vector, in body axes and across the tangent, that takes the tangent e3 to v.
Eigen::Vector2d turn_to(const Eigen::Vector3d& v) {
  const double sine = std::hypot(v.x(), v.y());
  const double angle = std::atan2(sine, v.z());
  if (sine < 1e-12) return {v.z() > 0 ? 0 : std::numbers::pi, 0};
  return Eigen::Vector2d(-v.y(), v.x()) * (angle / sine);
}

}  // namespace

/// Coefficients with int u nearest to these angles (real nodes x 2), and the turn of a free start.
Eigen::VectorXd RodFrames::from_angles(const Eigen::MatrixX2d& angles) const {
  Eigen::VectorXd x = Eigen::VectorXd::Zero(fields_ * columns_);
  const Eigen::Index first = turn_nodes_ > 0 ? 1 : 0;
  const LegendreTable& table = *panels_.back().table;
  for (Eigen::Index field = 0; field < 2; ++field) {
    std::vector<double> turns;
    for (const Panel& panel : panels_) {
      if (panel.node < turn_nodes_) continue;
      turns.push_back(panel.length * panel.strain[static_cast<std::size_t>(field)]);
    }
    const FittedAngle fitted = fit_angle(table, turns, angles.col(field),
                                         first == 0 ? std::optional<double>(0) : std::nullopt);
    if (first == 1) x[field * columns_] = fitted.start;
    x.segment(field * columns_ + first, columns_ - first) = fitted.coefficients;
  }
  return x;
}

Eigen::VectorXd RodFrames::fit(const Eigen::Matrix3Xd& tangents, int most_steps,
                               State& state) const {
  const Eigen::Index nodes = nodes_ - turn_nodes_;
  Eigen::MatrixX2d angles(nodes, 2);
  Eigen::Quaterniond frame = start_;
  Eigen::Vector2d total = Eigen::Vector2d::Zero();
  for (Eigen::Index q = 0; q < nodes; ++q) {
    const Eigen::Vector2d turn = turn_to(frame.conjugate() * tangents.col(q));
    frame = frame * from_rotation_vector({turn.x(), turn.y(), 0});
    total += turn;
    angles.row(q) = total.transpose();
  }
  Eigen::VectorXd x = from_angles(angles);
  if (fields_ == 3) x -= projected(natural_);
  // Newton's steps towards the tangents: a small turn R omega of the frames, none of them about the
  // tangent's axis at the start, comes from strains omega' + u x omega.
  for (int step = 0; step < most_steps; ++step) {
    evaluate(x, state);
    Eigen::MatrixX2d turns(nodes, 2);
    Eigen::VectorXd twisting(nodes);
    for (Eigen::Index q = 0; q < nodes; ++q) {
      const Eigen::Index node = turn_nodes_ + q;
      const Eigen::Vector3d v(state.d1.row(node) * tangents.col(q),
                              state.d2.row(node) * tangents.col(q),
                              state.t.row(node) * tangents.col(q));
      turns.row(q) = turn_to(v).transpose();
      twisting[q] = state.u(node, 1) * turns(q, 0) - state.u(node, 0) * turns(q, 1);
    }
    if (!(turns.cwiseAbs().maxCoeff() < 1)) break;
    const Eigen::VectorXd twist = cumulated(twisting);
    const auto strains = state.u.bottomRows(nodes);
    turns.col(0) += cumulated(strains.col(1).cwiseProduct(twist));
    turns.col(1) -= cumulated(strains.col(0).cwiseProduct(twist));
    x += from_angles(turns);
    // What is left is about its square, which is near enough for a start.
    if (turns.cwiseAbs().maxCoeff() < 1e-3) break;
  }
  return x;
}

/// Integral from the start to the nodes, of values at the real nodes.
Eigen::VectorXd RodFrames::cumulated(const Eigen::VectorXd& values) const {
  Eigen::VectorXd integral(values.size());
  double before = 0;
  for (const Panel& panel : panels_) {
    if (panel.node < turn_nodes_) continue;
    const Eigen::Index Q = panel.nodes();
    const auto own = values.segment(panel.node - turn_nodes_, Q);
    auto result = integral.segment(panel.node - turn_nodes_, Q);
    result.noalias() = panel.length * (panel.table->integration * own);
    result.array() += before;
    before += panel.length * panel.table->weights.dot(own);
  }
  return integral;
}

/// Coefficients of strains at all nodes but those of a free start's turn.
Eigen::VectorXd RodFrames::projected(const Eigen::MatrixX3d& strains) const {
  Eigen::VectorXd x = Eigen::VectorXd::Zero(fields_ * columns_);
  for (const Panel& panel : panels_) {
    if (panel.node < turn_nodes_) continue;
    const auto own = strains.middleRows(panel.node, panel.nodes());
    for (Eigen::Index field = 0; field < fields_; ++field) {
      const Eigen::VectorXd weighted = panel.table->weights.cwiseProduct(own.col(field));
      x.segment(field * columns_ + panel.column, panel.terms).noalias() =
          panel.table->values.leftCols(panel.terms).transpose() * weighted /
          panel.strain[static_cast<std::size_t>(field)];
    }
  }
  return x;
}

Eigen::VectorXd RodFrames::rolled(const Eigen::VectorXd& x, const Eigen::VectorXd& roll) const {
  State state;
  resize(state);
  evaluate(x, state);
  Eigen::MatrixX3d strains = state.u - natural_;
  std::vector<double> turns;
  for (const Panel& panel : panels_) {
    if (panel.node >= turn_nodes_) turns.push_back(panel.length * panel.strain[2]);
  }
  for (Eigen::Index q = 0; q < roll.size(); ++q) {
    const Eigen::Index node = turn_nodes_ + q;
    const double c = std::cos(roll[q]);
    const double s = std::sin(roll[q]);
    const Eigen::RowVector3d u = state.u.row(node);
    strains(node, 0) = c * u[0] + s * u[1] - natural_(node, 0);
    strains(node, 1) = c * u[1] - s * u[0] - natural_(node, 1);
    strains(node, 2) = u[2] - natural_(node, 2);
  }
  Eigen::VectorXd result = projected(strains);
  const FittedAngle twist = fit_angle(*panels_.back().table, turns, roll, 0.0);
  const Eigen::Index first = turn_nodes_ > 0 ? 1 : 0;
  result.segment(2 * columns_ + first, columns_ - first) += twist.coefficients;
  // A free start is turned as before.
  for (Eigen::Index field = 0; field < fields_ && first == 1; ++field) {
    result[field * columns_] = x[field * columns_];
  }
  return result;
}

}  // namespace dlo::energy_model
