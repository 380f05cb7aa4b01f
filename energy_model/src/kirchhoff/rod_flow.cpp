#include "kirchhoff/rod_flow.hpp"

#include <gsl/gsl_errno.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <vector>

#include "base/integrate.hpp"

namespace dlo::energy_model {
namespace {

/// Layout of the integrated vector: r, t, v, bending, gravity, d without twist if there is one,
/// then r, t, v and with d its turn, of each parameter.
constexpr Eigen::Index plain_state = 11;
constexpr Eigen::Index plain_variation = 9;

struct FlowPiece {
  Eigen::Vector3d weight;
  // Forces and torques over the stiffness: so they bend every section in the same way.
  Eigen::Vector3d n;  // at its beginning
  double torque;
  double bending;
  bool framed;                    // a director comes along
  const RodVariation* variation;  // whose n and torque are constant along the piece

  [[nodiscard]] Eigen::Index state_size() const { return plain_state + (framed ? 3 : 0); }
  [[nodiscard]] Eigen::Index variation_size() const { return plain_variation + (framed ? 1 : 0); }
};

int rod_rates(double s, const double* y, double* rate, void* data) {
  using Vector = Eigen::Map<const Eigen::Vector3d>;
  using Rate = Eigen::Map<Eigen::Vector3d>;
  const auto& piece = *static_cast<const FlowPiece*>(data);
  const Vector r(y);
  const Vector t(y + 3);
  const Vector v(y + 6);
  const Eigen::Vector3d n = piece.n - s / piece.bending * piece.weight;
  const double pull = n.dot(t) - v.squaredNorm();
  Rate(rate + 0) = t;
  Rate(rate + 3) = v;
  Rate(rate + 6) = pull * t - n;
  rate[9] = v.squaredNorm() / 2;
  rate[10] = -piece.weight.dot(r);
  if (piece.torque != 0) Rate(rate + 6) += piece.torque * t.cross(v);
  if (piece.framed) Rate(rate + plain_state) = -Vector(y + plain_state).dot(v) * t;
  const RodVariation& variation = *piece.variation;
  for (Eigen::Index k = 0; k < variation.n.cols(); ++k) {
    const double* change = y + piece.state_size() + k * piece.variation_size();
    double* change_rate = rate + piece.state_size() + k * piece.variation_size();
    const Vector dt(change + 3);
    const Vector dv(change + 6);
    const Eigen::Vector3d dn = variation.n.col(k) / piece.bending;
    const double dpull = dn.dot(t) + n.dot(dt) - 2 * v.dot(dv);
    Rate(change_rate + 0) = dt;
    Rate(change_rate + 3) = dv;
    Rate(change_rate + 6) = dpull * t + pull * dt - dn;
    if (!piece.framed) continue;
    Rate(change_rate + 6) += piece.torque * (dt.cross(v) + t.cross(dv)) +
                             variation.torque[k] / piece.bending * t.cross(v);
    change_rate[plain_variation] = v.dot(t.cross(dt));
  }
  return GSL_SUCCESS;
}

}  // namespace

double largest_force(const std::vector<RodState>& states, double bending) {
  double force = 0;
  for (const RodState& state : states) {
    const double torque = state.torque / bending;
    force = std::max({force, state.n.norm() / bending, state.v.squaredNorm(), torque * torque});
  }
  return force;
}

Eigen::Matrix3Xd tangents_of(const std::vector<RodState>& states) {
  Eigen::Matrix3Xd tangents(3, static_cast<Eigen::Index>(states.size()));
  for (Eigen::Index i = 0; i < tangents.cols(); ++i) {
    tangents.col(i) = states[static_cast<std::size_t>(i)].t;
  }
  return tangents;
}

Eigen::Vector3d turned(const Eigen::Vector3d& d, const Eigen::Vector3d& t, double angle) {
  return std::cos(angle) * d + std::sin(angle) * t.cross(d);
}

RodVariation::RodVariation(Eigen::Index parameters)
    : r(Eigen::Matrix3Xd::Zero(3, parameters)),
      t(Eigen::Matrix3Xd::Zero(3, parameters)),
      v(Eigen::Matrix3Xd::Zero(3, parameters)),
      n(Eigen::Matrix3Xd::Zero(3, parameters)),
      torque(Eigen::RowVectorXd::Zero(parameters)),
      turn(Eigen::RowVectorXd::Zero(parameters)) {}

bool follow_rod(const RodSection& section, double length, double tolerance, RodState& state,
                RodVariation& variation, RodIntegrals& integrals) {
  const Eigen::Index parameters = variation.n.cols();
  const bool framed = !state.d.isZero(0);
  const double b = section.bending;
  FlowPiece piece{section.weight, state.n / b, state.torque / b, b, framed, &variation};
  std::vector<double> y(
      static_cast<std::size_t>(piece.state_size() + parameters * piece.variation_size()), 0.0);
  Eigen::Map<Eigen::VectorXd> all(y.data(), static_cast<Eigen::Index>(y.size()));
  all.head<9>() << state.r, state.t, state.v;
  if (framed) all.segment<3>(plain_state) = state.d;
  for (Eigen::Index k = 0; k < parameters; ++k) {
    const Eigen::Index at = piece.state_size() + k * piece.variation_size();
    all.segment<plain_variation>(at) << variation.r.col(k), variation.t.col(k), variation.v.col(k);
    if (framed) all[at + plain_variation] = variation.turn[k];
  }
  if (length > 0 && !integrate(rod_rates, &piece, length, tolerance, y)) return false;
  state.r = all.segment<3>(0);
  state.t = all.segment<3>(3);
  state.v = all.segment<3>(6);
  state.n -= length * section.weight;
  if (framed) {
    const double twist = length * state.torque / section.torsion;
    state.d = turned(all.segment<3>(plain_state), state.t, twist);
  }
  integrals = {b * all[9], all[10]};
  for (Eigen::Index k = 0; k < parameters; ++k) {
    const Eigen::Index at = piece.state_size() + k * piece.variation_size();
    variation.r.col(k) = all.segment<3>(at);
    variation.t.col(k) = all.segment<3>(at + 3);
    variation.v.col(k) = all.segment<3>(at + 6);
    if (framed) variation.turn[k] = all[at + plain_variation];
  }
  return true;
}

bool follow_rod(const RodSection& section, double length, double tolerance, RodState& state,
                RodIntegrals& integrals) {
  RodVariation none;
  return follow_rod(section, length, tolerance, state, none, integrals);
}

}  // namespace dlo::energy_model
