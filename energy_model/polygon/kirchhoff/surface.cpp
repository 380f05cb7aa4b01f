#include "kirchhoff/surface.hpp"

#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <unsupported/Eigen/AutoDiff>

namespace dlo::energy_model {
namespace {

// Curvature in 1/l below which a surface is treated as flat.
constexpr double flat_curvature = 1e-9;

/// A number and its derivatives by r, a spin of R, m and n, three each.
using Dual = Eigen::AutoDiffScalar<Eigen::Matrix<double, 12, 1>>;
template <class T>
using Vector3 = Eigen::Matrix<T, 3, 1>;
template <class T>
using Matrix3 = Eigen::Matrix<T, 3, 3>;

/// Quantities of a cross-section near a surface, in the axes of the cross-section.
template <class T>
struct SurfaceState {
  Vector3<T> normal;  ///< N of lying_conditions(), not normalised
  Matrix3<T> A;
  Vector3<T> moment;
  Vector3<T> force;
  Vector3<T> weight;
  T y;
};

template <class T>
T dot(const Vector3<T>& a, const Vector3<T>& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

template <class T>
SurfaceState<T> surface_state(const Surface& surface, const RodSection& section,
                              const Vector3<T>& r, const Matrix3<T>& R, const Vector3<T>& m,
                              const Vector3<T>& n) {
  SurfaceState<T> on;
  const Matrix3<T> own = R.transpose();
  const Vector3<T> from = r - surface.centre.cast<T>();
  const double curvature = 1 / surface.radius;
  if (curvature > 0) {
    const Vector3<T> outward = (curvature * surface.across).cast<T>() * from;
    on.normal = own * outward;
    on.A = own * (curvature * surface.across).cast<T>() * R;
    on.y = (dot<T>(from, outward) - surface.radius) * 0.5;
  } else {
    on.normal = own * surface.normal.cast<T>();
    on.A = Matrix3<T>::Zero();
    on.y = dot<T>(surface.normal.cast<T>(), from);
  }
  on.moment = own * m;
  on.force = own * n;
  on.weight = own * section.weight.cast<T>();
  return on;
}

/// Derivatives of the tangent by the arc length in axes of the cross-section. The third derivative
/// is linear in the pressure.
template <class T>
struct TangentRates {
  Vector3<T> first;
  Vector3<T> second;
  Vector3<T> third;  ///< part without pressure
  Vector3<T> third_by_pressure;
};

template <class T>
TangentRates<T> tangent_rates(const SurfaceState<T>& on, const RodSection& section) {
  const Vector3<T> t = Eigen::Vector3d::UnitZ().cast<T>();
  const Vector3<T> compliance = section.compliance().cast<T>();
  const Vector3<T>& M = on.moment;
  const Vector3<T> u = compliance.cwiseProduct(M);
  const Vector3<T> M1 = on.force.cross(t) - u.cross(M);
  const Vector3<T> u1 = compliance.cwiseProduct(M1);
  const Vector3<T> F1 = -on.weight - u.cross(on.force);
  const Vector3<T> M2 = F1.cross(t) - u1.cross(M) - u.cross(M1);
  const Vector3<T> u2 = compliance.cwiseProduct(M2);
  TangentRates<T> rates;
  rates.first = u.cross(t);
  rates.second = u.cross(rates.first) + u1.cross(t);
  rates.third = u.cross(rates.second) + u1.cross(rates.first) + u.cross(u1.cross(t)) + u2.cross(t);
  const Vector3<T> pushed = -on.normal.cross(t);
  rates.third_by_pressure = Vector3<T>(compliance.cwiseProduct(pushed)).cross(t);
  return rates;
}

template <class T>
T pressure_of(const SurfaceState<T>& on, const RodSection& section) {
  const TangentRates<T> rates = tangent_rates(on, section);
  const Vector3<T> along = on.A.col(2);
  const Vector3<T> bent = on.A * rates.first;
  const T rest = dot<T>(on.normal, rates.third) + 3.0 * dot<T>(rates.first, bent) +
                 4.0 * dot<T>(along, rates.second);
  return -rest / dot<T>(on.normal, rates.third_by_pressure);
}

SurfaceState<Dual> dual_on_surface(const Surface& surface, const RodSection& section,
                                   const RodState& state) {
  const auto duals = [](const Eigen::Vector3d& v, Eigen::Index first) {
    Vector3<Dual> result;
    for (Eigen::Index k = 0; k < 3; ++k) result[k] = Dual(v[k], 12, first + k);
    return result;
  };
  const Vector3<Dual> spin = duals(Eigen::Vector3d::Zero(), 3);
  Matrix3<Dual> R = state.R.cast<Dual>();
  for (Eigen::Index k = 0; k < 3; ++k) {
    const Vector3<Dual> director = R.col(k);
    R.col(k) += spin.cross(director);
  }
  return surface_state<Dual>(surface, section, duals(state.r, 0), R, duals(state.m, 6),
                             duals(state.n, 9));
}

}  // namespace

obstacle::Gap Surface::gap(const Eigen::Vector3d& r) const {
  obstacle::Gap result;
  const Eigen::Vector3d from = r - centre;
  if (!std::isfinite(radius)) {
    result.value = normal.dot(from);
    result.gradient = normal;
    return result;
  }
  const Eigen::Vector3d outward = across * from;
  const double distance = outward.norm();
  result.value = distance - radius;
  result.gradient = outward / distance;
  result.hessian = (across - result.gradient * result.gradient.transpose()) / distance;
  return result;
}

Surface surface_of(const obstacle::Body& body, const Eigen::Vector3d& near) {
  const obstacle::Gap gap = body.gap(near);
  Surface surface;
  surface.normal = gap.gradient;
  surface.centre = near - gap.value * gap.gradient;
  // Both curvatures of a ball, and the only one of a cylinder, are one over the distance from the
  // core.
  const double curvature =
      gap.hessian.norm() / (gap.hessian.trace() > 1.2 * gap.hessian.norm() ? std::sqrt(2.0) : 1.0);
  if (curvature > flat_curvature) {
    const double distance = 1 / curvature;
    surface.across = distance * gap.hessian + gap.gradient * gap.gradient.transpose();
    surface.centre = near - distance * gap.gradient;
    surface.radius = distance - gap.value;
  }
  return surface;
}

LyingConditions lying_conditions(const Surface& surface, const RodSection& section,
                                 const RodState& state) {
  const SurfaceState<Dual> on = dual_on_surface(surface, section, state);
  const TangentRates<Dual> rates = tangent_rates(on, section);
  const Vector3<Dual> along = on.A.col(2);
  const std::array<Dual, 4> conditions = {
      on.y, on.normal[2], Dual(along[2] + dot<Dual>(on.normal, rates.first)),
      Dual(3.0 * dot<Dual>(along, rates.first) + dot<Dual>(on.normal, rates.second))};
  LyingConditions result{{}, ByState(4, 12)};
  for (Eigen::Index k = 0; k < 4; ++k) {
    const Dual& condition = conditions[static_cast<std::size_t>(k)];
    result.values[k] = condition.value();
    result.by_state.row(k) = condition.derivatives();
  }
  return result;
}

Pressure pressure_with_derivatives(const Surface& surface, const RodSection& section,
                                   const RodState& state) {
  const Dual p = pressure_of(dual_on_surface(surface, section, state), section);
  return {p.value(), p.derivatives().transpose()};
}

double pressure(const Surface& surface, const RodSection& section, const RodState& state) {
  return pressure_of(surface_state<double>(surface, section, state.r, state.R, state.m, state.n),
                     section);
}

}  // namespace dlo::energy_model
