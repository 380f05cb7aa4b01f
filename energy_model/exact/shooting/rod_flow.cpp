#include "shooting/rod_flow.hpp"

#include <gsl/gsl_errno.h>

#include <cmath>

#include "base/gsl.hpp"
#include "base/spin.hpp"

namespace dlo::energy_model {
namespace {

/// Layout of the integrated vector: r, R, m, n, the integrals, then the derivatives by each
/// parameter.
constexpr Eigen::Index first_integral = 18;
constexpr Eigen::Index state_size = 23;

struct IntegrationData {
  const RodElement* rod;
  const RodVariation* variation;

  /// Whether a force per length depends on the state.
  [[nodiscard]] bool has_spread_force() const {
    return rod->surface != nullptr || rod->section.drag.has_value();
  }
  /// Number of integrated rows of a variation. Its n is constant without a spread force.
  [[nodiscard]] Eigen::Index rows() const { return has_spread_force() ? 12 : 9; }
};

/// Force per length of the surface or of drag, and its derivatives by r, the spin, m and n.
struct DistributedForce {
  Eigen::Vector3d value = Eigen::Vector3d::Zero();
  Eigen::Matrix<double, 3, 12> by_state;
};

/// @param with_derivatives  false: `by_state` is not computed, and neither without such a force
DistributedForce distributed_force(const RodElement& piece, const RodState& state,
                                   bool with_derivatives) {
  DistributedForce spread;
  if (piece.surface == nullptr) {
    if (!piece.section.drag) return spread;
    const Eigen::Vector3d t = state.t();
    spread.value = piece.section.drag->force(t);
    // dt = spin x t
    spread.by_state.setZero();
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
  const auto& flow = *static_cast<const IntegrationData*>(data);
  const RodElement& piece = *flow.rod;
  const RodSection& section = piece.section;
  const RodState state{Vector(y), Eigen::Map<const Eigen::Matrix3d>(y + 3), Vector(y + 12),
                       Vector(y + 15)};
  const auto& [r, R, m, n] = state;
  const double s = piece.begin + at;
  const Eigen::Vector3d t = state.t();
  const Eigen::Vector3d weight = section.weight + s * section.slope;
  const Eigen::Vector3d compliance = section.compliance();
  const Eigen::Vector3d local_moment = R.transpose() * m;
  const Eigen::Vector3d elastic = compliance.cwiseProduct(local_moment);
  Eigen::Vector3d u = elastic;
  if (piece.natural) u += section.natural(piece.natural, s);
  const Eigen::Vector3d omega = R * u;
  const double tension = n.dot(t);
  const double along = 1 + section.stretch * tension;  // dr = along t ds
  Rate(rate + 0) = along * t;
  for (Eigen::Index k = 0; k < 3; ++k) Rate(rate + 3 + 3 * k) = omega.cross(R.col(k));
  Rate(rate + 12) = along * n.cross(t);
  Rate(rate + 15) = -weight;
  rate[first_integral] = (local_moment[0] * elastic[0] + local_moment[1] * elastic[1]) / 2;
  rate[first_integral + 1] = local_moment[2] * elastic[2] / 2;
  rate[first_integral + 2] = -weight.dot(r);
  rate[first_integral + 3] = u[2];
  rate[first_integral + 4] = section.stretch * tension * tension / 2;
  const Eigen::Index parameters = flow.variation == nullptr ? 0 : flow.variation->cols();
  DistributedForce spread;
  if (flow.has_spread_force()) {
    spread = distributed_force(piece, state, parameters > 0);
    Rate(rate + 15) -= spread.value;
  }
  if (parameters == 0) return GSL_SUCCESS;
  const Eigen::Matrix3d yields = R * compliance.asDiagonal() * R.transpose();
  const Eigen::Index rows = flow.rows();
  for (Eigen::Index k = 0; k < parameters; ++k) {
    const double* change = y + state_size + k * rows;
    double* change_rate = rate + state_size + k * rows;
    const Vector spin(change + 3);
    const Vector dm(change + 6);
    Eigen::Vector3d dn = flow.variation->col(k).tail<3>();
    if (flow.has_spread_force()) {
      dn = Vector(change + 9);
      Rate(change_rate + 9) =
          -spread.by_state * Eigen::Map<const Eigen::Matrix<double, 12, 1>>(change);
    }
    const Eigen::Vector3d dt = spin.cross(t);
    const Eigen::Vector3d dr = along * dt + section.stretch * (dn.dot(t) + n.dot(dt)) * t;
    Rate(change_rate + 0) = dr;
    Rate(change_rate + 3) = yields * (dm + m.cross(spin));
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

Eigen::Matrix<double, 12, 1> rate_of(const RodElement& piece, const RodState& state) {
  const Eigen::Vector3d dr = (1 + piece.section.stretch * state.n.dot(state.t())) * state.t();
  Eigen::Matrix<double, 12, 1> rate;
  rate << dr, state.R * strain_of(piece.section, piece.natural, piece.begin, state),
      state.n.cross(dr),
      -(piece.section.weight + piece.begin * piece.section.slope) -
          distributed_force(piece, state, false).value;
  return rate;
}

bool integrate_rod(const RodElement& piece, double tolerance, RodState& state,
                   RodVariation* variation, RodIntegrals* integrals) {
  IntegrationData flow{&piece, variation};
  const Eigen::Index rows = flow.rows();
  const Eigen::Index parameters = variation == nullptr ? 0 : variation->cols();
  std::vector<double> y(static_cast<std::size_t>(state_size + rows * parameters), 0.0);
  Eigen::Map<Eigen::Vector<double, state_size>> all(y.data());
  Eigen::Map<Eigen::MatrixXd> changes(y.data() + state_size, rows, parameters);
  all.head<first_integral>() << state.r, state.R.reshaped(), state.m, state.n;
  if (variation != nullptr) changes = variation->topRows(rows);
  if (piece.length > 0 && !integrate(rod_rates, &flow, piece.length, tolerance, y)) return false;
  state = {all.head<3>(), Eigen::Map<const Eigen::Matrix3d>(y.data() + 3), all.segment<3>(12),
           all.segment<3>(15)};
  if (variation != nullptr) variation->topRows(rows) = changes;
  const auto sums = all.tail<state_size - first_integral>();
  if (integrals != nullptr) *integrals = {sums[0], sums[1], sums[2], sums[3], sums[4]};
  return true;
}

}  // namespace dlo::energy_model
