#include "shooting/rod_flow.hpp"

#include <gsl/gsl_errno.h>

#include <cmath>

#include "base/gsl.hpp"
#include "base/spin.hpp"

namespace dlo::energy_model {
namespace {

/// Layout of the integrated vector: r, R, m, the first four integrals, then r, spin and m for each
/// parameter. A piece that lies on a surface or has drag adds the impulse int p N ds or that of the
/// drag, with its derivatives. A piece that stretches (and does not lie) adds the energy of
/// stretch.
constexpr Eigen::Index first_integral = 15;
constexpr Eigen::Index state_size = 19;
constexpr Eigen::Index variation_size = 9;

struct IntegrationData {
  const RodElement* rod;
  Eigen::Vector3d n;  // inner force at the begin, without the force of a surface or of drag
  const RodVariation* variation;

  [[nodiscard]] bool has_impulse() const {
    return rod->surface != nullptr || rod->section.drag.has_value();
  }
  [[nodiscard]] Eigen::Index impulse() const {
    return state_size + variation->n.cols() * variation_size;
  }
  [[nodiscard]] bool stretches() const { return rod->section.stretch > 0; }
  [[nodiscard]] Eigen::Index size() const {
    return impulse() + (has_impulse() ? 3 * (1 + variation->n.cols()) : 0) + (stretches() ? 1 : 0);
  }
};

/// Force per length of the surface or of drag, and its derivatives by r, the spin, m and n.
struct DistributedForce {
  Eigen::Vector3d value;
  Eigen::Matrix<double, 3, 12> by_state;
};

/// @param with_derivatives  false: `by_state` is not computed
DistributedForce distributed_force(const RodElement& piece, const RodState& state,
                                   bool with_derivatives) {
  DistributedForce spread;
  if (piece.surface == nullptr) {
    const Eigen::Vector3d t = state.t();
    spread.value = piece.section.drag->force(t);
    spread.by_state.setZero();
    // dt = spin x t
    spread.by_state.middleCols<3>(3) = -piece.section.drag->by_tangent(t) * cross_matrix(t);
    return spread;
  }
  const obstacle::Gap gap = piece.surface->gap(state.r);
  if (!with_derivatives) {
    spread.value = pressure(*piece.surface, piece.section, state) * gap.gradient;
    return spread;
  }
  const Pressure p = pressure_with_derivatives(*piece.surface, piece.section, state);
  spread.value = p.value * gap.gradient;
  spread.by_state = gap.gradient * p.by_state;
  spread.by_state.leftCols<3>() += p.value * gap.hessian;
  return spread;
}

int rod_rates(double at, const double* y, double* rate, void* data) {
  using Vector = Eigen::Map<const Eigen::Vector3d>;
  using Rate = Eigen::Map<Eigen::Vector3d>;
  const auto& piece = *static_cast<const IntegrationData*>(data);
  const RodSection& section = piece.rod->section;
  const bool has_impulse = piece.has_impulse();
  const Eigen::Index impulse = piece.impulse();
  const Vector r(y);
  const Eigen::Map<const Eigen::Matrix3d> R(y + 3);
  const Vector m(y + 12);
  const double s = piece.rod->begin + at;
  Eigen::Vector3d n = piece.n - section.weight_of_interval(piece.rod->begin, at);
  if (has_impulse) n -= Vector(y + impulse);
  const Eigen::Vector3d t = R.col(2);
  const Eigen::Vector3d compliance = section.compliance();
  const Eigen::Vector3d local_moment = R.transpose() * m;
  const Eigen::Vector3d stretch = compliance.cwiseProduct(local_moment);
  Eigen::Vector3d u = stretch;
  if (piece.rod->natural) u += section.natural(piece.rod->natural, s);
  const Eigen::Vector3d omega = R * u;
  Rate(rate + 0) = t;
  for (Eigen::Index k = 0; k < 3; ++k) Rate(rate + 3 + 3 * k) = omega.cross(R.col(k));
  Rate(rate + 12) = n.cross(t);
  rate[first_integral] = (local_moment[0] * stretch[0] + local_moment[1] * stretch[1]) / 2;
  rate[first_integral + 1] = local_moment[2] * stretch[2] / 2;
  rate[first_integral + 2] = -(section.weight + s * section.slope).dot(r);
  rate[first_integral + 3] = u[2];
  double along = 1;  // dr = along t ds
  if (piece.stretches()) {
    along += section.stretch * n.dot(t);
    Rate(rate + 0) *= along;
    Rate(rate + 12) *= along;
    rate[piece.size() - 1] = (along - 1) * n.dot(t) / 2;
  }
  const Eigen::Index parameters = piece.variation->n.cols();
  if (has_impulse) {
    const DistributedForce spread = distributed_force(*piece.rod, {r, R, m, n}, parameters > 0);
    Rate(rate + impulse) = spread.value;
    for (Eigen::Index k = 0; k < parameters; ++k) {
      Eigen::Matrix<double, 12, 1> by;
      by << Eigen::Map<const Eigen::Matrix<double, 9, 1>>(y + state_size + k * variation_size),
          piece.variation->n.col(k) - Vector(y + impulse + 3 * (k + 1));
      Rate(rate + impulse + 3 * (k + 1)) = spread.by_state * by;
    }
  }
  if (parameters == 0) return GSL_SUCCESS;
  const Eigen::Matrix3d yields = R * compliance.asDiagonal() * R.transpose();
  for (Eigen::Index k = 0; k < parameters; ++k) {
    const double* change = y + state_size + k * variation_size;
    double* change_rate = rate + state_size + k * variation_size;
    const Vector spin(change + 3);
    const Vector dm(change + 6);
    const Eigen::Vector3d dt = spin.cross(t);
    Eigen::Vector3d dn = piece.variation->n.col(k);
    if (has_impulse) dn -= Vector(y + impulse + 3 * (k + 1));
    Rate(change_rate + 3) = yields * (dm + m.cross(spin));
    if (!piece.stretches()) {
      Rate(change_rate + 0) = dt;
      Rate(change_rate + 6) = dn.cross(t) + n.cross(dt);
      continue;
    }
    const Eigen::Vector3d dr = along * dt + section.stretch * (dn.dot(t) + n.dot(dt)) * t;
    Rate(change_rate + 0) = dr;
    Rate(change_rate + 6) = along * dn.cross(t) + n.cross(dr);
  }
  return GSL_SUCCESS;
}

}  // namespace

Eigen::Vector3d strain_of(const RodSection& section, const NaturalStrain& natural, double s,
                          const RodState& state) {
  const Eigen::Vector3d strain = (state.R.transpose() * state.m).cwiseProduct(section.compliance());
  return natural ? Eigen::Vector3d(section.natural(natural, s) + strain) : strain;
}

Eigen::Vector3d curvature_of(const RodSection& section, const NaturalStrain& natural, double s,
                             const RodState& state) {
  const Eigen::Vector3d u = strain_of(section, natural, s, state);
  return u[1] * state.R.col(0) - u[0] * state.R.col(1);
}

std::vector<Eigen::Matrix3d> frames_of(const std::vector<RodState>& states) {
  std::vector<Eigen::Matrix3d> frames;
  frames.reserve(states.size());
  for (const RodState& state : states) frames.push_back(state.R);
  return frames;
}

Eigen::Matrix3Xd tangents_of(const std::vector<RodState>& states) {
  Eigen::Matrix3Xd tangents(3, static_cast<Eigen::Index>(states.size()));
  for (Eigen::Index i = 0; i < tangents.cols(); ++i) {
    tangents.col(i) = states[static_cast<std::size_t>(i)].t();
  }
  return tangents;
}

RodElement rod_element(const RodSpan& span, const RodMesh& mesh, Eigen::Index interval) {
  return {mesh.section_of(interval), span.natural, mesh.s[interval], mesh.width(interval),
          mesh.contacts.surface_of(interval)};
}

RodVariation::RodVariation(Eigen::Index parameters)
    : r(Eigen::Matrix3Xd::Zero(3, parameters)),
      spin(Eigen::Matrix3Xd::Zero(3, parameters)),
      m(Eigen::Matrix3Xd::Zero(3, parameters)),
      n(Eigen::Matrix3Xd::Zero(3, parameters)) {}

RodRate rate_of(const RodElement& piece, const RodState& state) {
  const Eigen::Vector3d dr = (1 + piece.section.stretch * state.n.dot(state.t())) * state.t();
  RodRate rate{dr, state.R * strain_of(piece.section, piece.natural, piece.begin, state),
               state.n.cross(dr), -(piece.section.weight + piece.begin * piece.section.slope)};
  if (piece.section.drag || piece.surface != nullptr) {
    rate.n -= distributed_force(piece, state, false).value;
  }
  return rate;
}

std::optional<RodIntegrals> integrate_rod(const RodElement& piece, double tolerance,
                                          RodState& state, RodVariation& variation) {
  const Eigen::Index parameters = variation.n.cols();
  IntegrationData flow{&piece, state.n, &variation};
  std::vector<double> y(static_cast<std::size_t>(flow.size()), 0.0);
  Eigen::Map<Eigen::VectorXd> all(y.data(), flow.size());
  all.head<15>() << state.r, state.R.reshaped(), state.m;
  for (Eigen::Index k = 0; k < parameters; ++k) {
    all.segment<variation_size>(state_size + k * variation_size) << variation.r.col(k),
        variation.spin.col(k), variation.m.col(k);
  }
  if (piece.length > 0 && !integrate(rod_rates, &flow, piece.length, tolerance, y)) {
    return std::nullopt;
  }
  state.r = all.segment<3>(0);
  state.R = Eigen::Map<const Eigen::Matrix3d>(y.data() + 3);
  state.m = all.segment<3>(12);
  state.n -= piece.section.weight_of_interval(piece.begin, piece.length);
  const RodIntegrals integrals{all[first_integral], all[first_integral + 1],
                               all[first_integral + 2], all[first_integral + 3],
                               flow.stretches() ? all[flow.size() - 1] : 0.0};
  for (Eigen::Index k = 0; k < parameters; ++k) {
    const Eigen::Index at = state_size + k * variation_size;
    variation.r.col(k) = all.segment<3>(at);
    variation.spin.col(k) = all.segment<3>(at + 3);
    variation.m.col(k) = all.segment<3>(at + 6);
  }
  if (!flow.has_impulse()) return integrals;
  state.n -= all.segment<3>(flow.impulse());
  for (Eigen::Index k = 0; k < parameters; ++k) {
    variation.n.col(k) -= all.segment<3>(flow.impulse() + 3 * (k + 1));
  }
  return integrals;
}

std::optional<RodIntegrals> integrate_rod(const RodElement& piece, double tolerance,
                                          RodState& state) {
  RodVariation none;
  return integrate_rod(piece, tolerance, state, none);
}

}  // namespace dlo::energy_model
