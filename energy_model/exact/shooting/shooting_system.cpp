#include "shooting/shooting_system.hpp"

#include <Eigen/Geometry>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

#include "base/spin.hpp"

namespace dlo::energy_model {
namespace {

// Largest rotation of a tangent in one Newton step [rad].
constexpr double largest_tangent_rotation = 0.5;
// Largest step of a contact, divided by the distance of its neighbouring fixed nodes or contacts.
constexpr double longest_share = 0.3;

double unit_of_force(const RodSpan& span, const std::vector<RodState>& start) {
  double force = std::max(1.0, total_load(span));
  for (const RodState& state : start) {
    force = std::max({force, state.n.norm(), state.m.squaredNorm()});
  }
  return force;
}

}  // namespace

ShootingSystem::ShootingSystem(const RodSpan& span, const RodMesh& mesh, const ClampFrames& frames,
                               const ShootingOptions& options, const std::vector<RodState>& start)
    : span_(span),
      mesh_(mesh),
      tolerance_(options.tolerance),
      deadline_(options.deadline),
      rate_(std::sqrt(unit_of_force(span, start))),
      positions_(Eigen::Matrix3d::Identity()),
      turns_(Eigen::Matrix3d::Identity()) {
  const bool planar = options.motion == Motion::in_plane;
  if (planar) {
    positions_.resize(3, 2);
    positions_ << span.plane->x, span.plane->y;
    turns_ = span.plane->x.cross(span.plane->y);
  }
  for (const double s : mesh.s) {
    const RodSpan::Clamp* clamp = span.clamp_at(s);
    clamps_.push_back(clamp);
    frames_.push_back(clamp == nullptr
                          ? std::nullopt
                          : frames[static_cast<std::size_t>(clamp - span.clamps.data())]);
  }
  for (const RodState& state : start) {
    start_.push_back(planar ? in_plane(state) : state);
  }
  unknowns_ = equations_ = unknowns_per_node() * mesh.s.size();
  number_contacts();
  share_arc_lengths();
}

void ShootingSystem::number_contacts() {
  contacts_.assign(static_cast<std::size_t>(mesh_.s.size()), -1);
  arc_length_ = contacts_;
  for (const RodContact& contact : mesh_.contacts.nodes) {
    const auto node = static_cast<std::size_t>(contact.node);
    contacts_[node] = &contact - mesh_.contacts.nodes.data();
    if (contact.is_position_unknown) arc_length_[node] = unknowns_++;
    force_.push_back(unknowns_++);
    if (contact.touched) equations_ += contact.is_position_unknown ? 2 : 1;
  }
  for (Eigen::Index i = 0; i < mesh_.intervals(); ++i) {
    const bool lies = mesh_.contacts.surface_of(i) != nullptr;
    if (lies && (i == 0 || mesh_.contacts.surface_of(i - 1) == nullptr)) equations_ += 4;
  }
}

void ShootingSystem::share_arc_lengths() {
  if (std::ranges::all_of(arc_length_, [](Eigen::Index unknown) { return unknown < 0; })) return;
  for (Eigen::Index before = 0; before < mesh_.intervals();) {
    Eigen::Index after = before + 1;
    while (!mesh_.is_fixed(after) && contact_at(after) == nullptr) ++after;
    const double distance = mesh_.s[after] - mesh_.s[before];
    for (Eigen::Index i = before; i < after; ++i) {
      shares_.push_back(
          {before, after, (mesh_.s[i] - mesh_.s[before]) / distance, mesh_.width(i) / distance});
    }
    before = after;
  }
}

ShootingPoint ShootingSystem::start() const {
  ShootingPoint point{mesh_.s, start_, {}};
  for (const RodContact& contact : mesh_.contacts.nodes) point.forces.push_back(contact.force);
  return point;
}

const RodContact* ShootingSystem::contact_at(Eigen::Index node) const {
  const Eigen::Index contact = contacts_[static_cast<std::size_t>(node)];
  return contact < 0 ? nullptr : &mesh_.contacts.nodes[static_cast<std::size_t>(contact)];
}

RodState ShootingSystem::in_plane(const RodState& state) const {
  const auto projected = [&](const Eigen::Vector3d& v) {
    return Eigen::Vector3d(positions_ * (positions_.transpose() * v));
  };
  const Eigen::Vector3d& base = span_.holds.front().position;
  RodState result;
  result.r = base + projected(state.r - base);
  result.R = transported(state.R, projected(state.t()).normalized());
  result.m = turns_ * (turns_.transpose() * state.m);
  result.n = projected(state.n);
  return result;
}

ShootingPoint ShootingSystem::moved(const ShootingPoint& point, const Eigen::VectorXd& step) const {
  const Eigen::Index positions = positions_.cols();
  const Eigen::Index turns = turns_.cols();
  ShootingPoint result = point;
  Eigen::Index at = 0;
  for (RodState& state : result.nodes) {
    state.r += positions_ * step.segment(at, positions);
    state.R = from_rotation_vector(turns_ * step.segment(at + spin_index(), turns)) * state.R;
    state.m += rate_ * (turns_ * step.segment(at + m_index(), turns));
    state.n += rate_ * rate_ * (positions_ * step.segment(at + n_index(), positions));
    at += unknowns_per_node();
  }
  for (std::size_t k = 0; k < force_.size(); ++k) {
    result.forces[k] += rate_ * rate_ * step[force_[k]];
  }
  for (std::size_t i = 0; i < arc_length_.size(); ++i) {
    if (arc_length_[i] >= 0) result.s[static_cast<Eigen::Index>(i)] += step[arc_length_[i]];
  }
  for (std::size_t i = 0; i < shares_.size(); ++i) {
    const auto& [before, after, begin, width] = shares_[i];
    const auto node = static_cast<Eigen::Index>(i);
    if (node == before) continue;
    result.s[node] = result.s[before] + begin * (result.s[after] - result.s[before]);
  }
  return result;
}

double ShootingSystem::allowed_step_share(const ShootingPoint& point,
                                          const Eigen::VectorXd& step) const {
  double turn = 0;
  Eigen::Index at = spin_index();
  for (const RodState& node : point.nodes) {
    const Eigen::Vector3d spin = turns_ * step.segment(at, turns_.cols());
    turn = std::max(turn, spin.cross(node.t()).norm());
    at += unknowns_per_node();
  }
  double part = turn > largest_tangent_rotation ? largest_tangent_rotation / turn : 1;
  for (const Share& share : shares_) {
    for (const Eigen::Index node : {share.before, share.after}) {
      const Eigen::Index unknown = arc_length_[static_cast<std::size_t>(node)];
      if (unknown < 0) continue;
      const double distance = longest_share * (point.s[share.after] - point.s[share.before]);
      if (std::abs(part * step[unknown]) > distance) part = distance / std::abs(step[unknown]);
    }
  }
  return part;
}

double ShootingSystem::gap(const ShootingPoint& point) const {
  const std::vector<RodState>& nodes = point.nodes;
  Eigen::VectorXd equations;
  if (!evaluate(point, equations, nullptr)) return std::numeric_limits<double>::infinity();
  double largest = equations.cwiseAbs().maxCoeff();
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    if (clamps_[i] == nullptr) continue;
    largest = std::max(largest, (nodes[i].t() - clamps_[i]->direction).cwiseAbs().maxCoeff());
  }
  return largest;
}

}  // namespace dlo::energy_model
