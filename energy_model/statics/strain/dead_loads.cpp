#include "strain/dead_loads.hpp"

namespace dlo::energy_model {

void DeadLoads::reset(const Span& span, const Eigen::VectorXd& nodes,
                      const Eigen::VectorXd& weights) {
  couples_.resize(0);
  force_.resize(nodes.size(), 3);
  for (Eigen::Index q = 0; q < nodes.size(); ++q) {
    const double s = nodes[q];
    const bool after = s > span.anchor;
    Eigen::Vector3d n = span.weight_between(s, after ? span.length : 0);
    for (const Span::Load& load : span.loads) {
      if (after && load.at > s) n += load.force;
      if (!after && load.at < s) n -= load.force;
    }
    force_.row(q) = weights[q] * n.transpose();
  }
}

void DeadLoads::tabulate_couples(const Span& span, const std::vector<Piece>& pieces,
                                 const PlanarFrames& frames) {
  if (!span.has_couples()) return;
  couples_.setZero(frames.by_unknown().cols());
  for (const Span::Load& load : span.loads) {
    const Eigen::Index last = pieces_before(pieces, load.at) - 1;
    couples_ += load.couple * frames.by_unknown_after(last).transpose();
  }
}

double energy_of_forces(const std::vector<Span::Load>& loads, const PositionOperator& reach,
                        const Eigen::MatrixX3d& tangents) {
  double energy = 0;
  for (const Span::Load& load : loads) {
    const Eigen::VectorXd at = reach.begin(pieces_before(reach.pieces(), load.at));
    energy -= load.force.dot(tangents.transpose() * at);
  }
  return energy;
}

void DeadLoads::add_moment(const Span& span, const Eigen::MatrixX3d& tangents,
                           Eigen::Vector3d& moment) const {
  // sum t x force
  const auto about = [&](Eigen::Index a, Eigen::Index b) {
    return tangents.col(a).dot(force_.col(b)) - tangents.col(b).dot(force_.col(a));
  };
  moment.z() += about(0, 1);
  for (const Span::Load& load : span.loads) moment.z() += load.couple;
  if (!span.planar) moment.head<2>() += Eigen::Vector2d(about(1, 2), about(2, 0));
}

}  // namespace dlo::energy_model
