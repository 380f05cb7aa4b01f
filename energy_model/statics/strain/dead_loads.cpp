#include "strain/dead_loads.hpp"

#include "frames/position_operator.hpp"

namespace dlo::energy_model {
namespace {

/// Returns the energy of the loads' forces, without weight and couples [EI/l].
double energy_of_forces(const TermSetup& setup, const Eigen::MatrixX3d& tangents) {
  if (setup.span.loads.empty()) return 0;
  const PositionOperator reach(setup.span, setup.elements, setup.table);
  double energy = 0;
  for (const Span::Load& load : setup.span.loads) {
    const Eigen::VectorXd at = reach.begin(elements_before(setup.elements, load.at));
    energy -= load.force.dot(tangents.transpose() * at);
  }
  return energy;
}

/// Returns the rotation of a planar span's tangent at a load from the zero of its couple
/// (CoupleZero) [rad].
double couple_angle(const TermSetup& setup, const Eigen::VectorXd& x, const Span::Load& load) {
  const Span& span = setup.span;
  const double start = span.start_direction ? angle_of(*span.start_direction) : 0;
  const auto angle = [&](double at) {
    return start +
           setup.plane.angle_derivatives_after(elements_before(setup.elements, at) - 1).dot(x) +
           (span.natural.empty() ? 0 : span.natural.integral(at).x());
  };
  const double zero = angle(load.zero_at);
  return angle(load.at) - zero + nearest_equivalent_angle(zero - load.zero_angle, 0);
}

}  // namespace

void DeadLoads::reset(const TermSetup& setup) {
  const Span& span = setup.span;
  force_.resize(setup.nodes.size(), 3);
  for (Eigen::Index q = 0; q < setup.nodes.size(); ++q) {
    const double s = setup.nodes[q];
    const bool after = s > span.anchor;
    Eigen::Vector3d n = span.weight_between(s, after ? span.length : 0);
    for (const Span::Load& load : span.loads) {
      if (after && load.at > s) n += load.force;
      if (!after && load.at < s) n -= load.force;
    }
    force_.row(q) = setup.weights[q] * n.transpose();
  }
  couples_.resize(0);
  couple_ = 0;
  for (const Span::Load& load : span.loads) couple_ += load.couple;
  if (!span.planar || !span.has_couples()) return;
  couples_.setZero(setup.plane.by_unknown().cols());
  for (const Span::Load& load : span.loads) {
    couples_ += load.couple *
                setup.plane.angle_derivatives_after(elements_before(setup.elements, load.at) - 1)
                    .transpose();
  }
}

void DeadLoads::evaluate(SpanPoint& at) const {
  at.energy -= force_.cwiseProduct(at.t).sum();
  at.force += force_;
  if (couples_.size() == 0) return;
  at.energy -= couples_.dot(at.x);
  at.gradient -= couples_;
}

void DeadLoads::add_energies(const TermSetup& setup, const SpanPoint& at,
                             Energies& energies) const {
  const double of_forces = energy_of_forces(setup, at.t);
  energies.load += of_forces;
  energies.gravity -= force_.cwiseProduct(at.t).sum() + of_forces;
  for (const Span::Load& load : setup.span.loads) {
    if (load.couple != 0) energies.load -= load.couple * couple_angle(setup, at.x, load);
  }
}

}  // namespace dlo::energy_model
