#include "curved/curved_flow.hpp"

#include <gsl/gsl_errno.h>

#include <Eigen/Geometry>
#include <cmath>

#include "base/integrate.hpp"

namespace dlo::energy_model {
namespace {

/// Layout of the integrated vector: r, R, m, the four integrals, then r, spin and m of each
/// parameter.
constexpr Eigen::Index curved_integrals = 15;
constexpr Eigen::Index curved_components = 19;
constexpr Eigen::Index curved_changes = 9;

struct CurvedPiece {
  const RodSection* section;
  const NaturalStrain* natural;
  double begin;
  Eigen::Vector3d n;  // at its beginning
  const CurvedVariation* variation;
};

int curved_rates(double at, const double* y, double* rate, void* data) {
  using Vector = Eigen::Map<const Eigen::Vector3d>;
  using Rate = Eigen::Map<Eigen::Vector3d>;
  const auto& piece = *static_cast<const CurvedPiece*>(data);
  const RodSection& section = *piece.section;
  const Vector r(y);
  const Eigen::Map<const Eigen::Matrix3d> R(y + 3);
  const Vector m(y + 12);
  const Eigen::Vector3d n = piece.n - at * section.weight;
  const Eigen::Vector3d t = R.col(2);
  const Eigen::Vector3d compliance = section.stiffness().cwiseInverse();
  const Eigen::Vector3d own = R.transpose() * m;
  const Eigen::Vector3d stretch = compliance.cwiseProduct(own);
  const Eigen::Vector3d u = (*piece.natural)(piece.begin + at) + stretch;
  const Eigen::Vector3d omega = R * u;
  Rate(rate + 0) = t;
  for (Eigen::Index k = 0; k < 3; ++k) Rate(rate + 3 + 3 * k) = omega.cross(R.col(k));
  Rate(rate + 12) = n.cross(t);
  rate[curved_integrals] = (own[0] * stretch[0] + own[1] * stretch[1]) / 2;
  rate[curved_integrals + 1] = own[2] * stretch[2] / 2;
  rate[curved_integrals + 2] = -section.weight.dot(r);
  rate[curved_integrals + 3] = u[2];
  if (piece.variation->n.cols() == 0) return GSL_SUCCESS;
  const Eigen::Matrix3d yields = R * compliance.asDiagonal() * R.transpose();
  for (Eigen::Index k = 0; k < piece.variation->n.cols(); ++k) {
    const double* change = y + curved_components + k * curved_changes;
    double* change_rate = rate + curved_components + k * curved_changes;
    const Vector spin(change + 3);
    const Vector dm(change + 6);
    const Eigen::Vector3d dt = spin.cross(t);
    Rate(change_rate + 0) = dt;
    Rate(change_rate + 3) = yields * (dm + m.cross(spin));
    Rate(change_rate + 6) = piece.variation->n.col(k).cross(t) + n.cross(dt);
  }
  return GSL_SUCCESS;
}

}  // namespace

Eigen::Vector3d strain_of(const RodSection& section, const NaturalStrain& natural, double s,
                          const CurvedState& state) {
  return natural(s) + (state.R.transpose() * state.m).cwiseQuotient(section.stiffness());
}

Eigen::Matrix3d stiffness_of(const RodSection& section, const Eigen::Matrix3d& R) {
  return R * section.stiffness().asDiagonal() * R.transpose();
}

Eigen::Matrix3d rotation_by(const Eigen::Vector3d& turn) {
  const double angle = turn.norm();
  if (angle == 0) return Eigen::Matrix3d::Identity();
  return Eigen::AngleAxisd(angle, turn / angle).toRotationMatrix();
}

CurvedVariation::CurvedVariation(Eigen::Index parameters)
    : r(Eigen::Matrix3Xd::Zero(3, parameters)),
      spin(Eigen::Matrix3Xd::Zero(3, parameters)),
      m(Eigen::Matrix3Xd::Zero(3, parameters)),
      n(Eigen::Matrix3Xd::Zero(3, parameters)) {}

bool follow_curved(const RodSection& section, const NaturalStrain& natural, double begin,
                   double length, double tolerance, CurvedState& state, CurvedVariation& variation,
                   CurvedIntegrals& integrals) {
  const Eigen::Index parameters = variation.n.cols();
  CurvedPiece piece{&section, &natural, begin, state.n, &variation};
  std::vector<double> y(static_cast<std::size_t>(curved_components + parameters * curved_changes),
                        0.0);
  Eigen::Map<Eigen::VectorXd> all(y.data(), static_cast<Eigen::Index>(y.size()));
  all.head<15>() << state.r, state.R.reshaped(), state.m;
  for (Eigen::Index k = 0; k < parameters; ++k) {
    all.segment<curved_changes>(curved_components + k * curved_changes) << variation.r.col(k),
        variation.spin.col(k), variation.m.col(k);
  }
  if (length > 0 && !integrate(curved_rates, &piece, length, tolerance, y)) return false;
  state.r = all.segment<3>(0);
  state.R = Eigen::Map<const Eigen::Matrix3d>(y.data() + 3);
  state.m = all.segment<3>(12);
  state.n -= length * section.weight;
  integrals = {all[curved_integrals], all[curved_integrals + 1], all[curved_integrals + 2],
               all[curved_integrals + 3]};
  for (Eigen::Index k = 0; k < parameters; ++k) {
    const Eigen::Index at = curved_components + k * curved_changes;
    variation.r.col(k) = all.segment<3>(at);
    variation.spin.col(k) = all.segment<3>(at + 3);
    variation.m.col(k) = all.segment<3>(at + 6);
  }
  return true;
}

}  // namespace dlo::energy_model
