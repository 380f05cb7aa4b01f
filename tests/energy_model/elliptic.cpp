#include "elliptic.hpp"

#include <gsl/gsl_errno.h>
#include <gsl/gsl_roots.h>
#include <gsl/gsl_sf_ellint.h>

#include <cmath>
#include <numbers>

#include "base/silence_gsl.hpp"

namespace dlo::energy_model {
namespace {

using std::numbers::pi;

/// NaN if GSL refuses.
double carlson_rf(double x, double y, double z) {
  gsl_sf_result result;
  return gsl_sf_ellint_RF_e(x, y, z, GSL_PREC_DOUBLE, &result) == GSL_SUCCESS ? result.val : NAN;
}

double carlson_rd(double x, double y, double z) {
  gsl_sf_result result;
  return gsl_sf_ellint_RD_e(x, y, z, GSL_PREC_DOUBLE, &result) == GSL_SUCCESS ? result.val : NAN;
}

/// Elliptic integrals from the clamp to the tip by the parameter x that fixes the modulus,
///     k' = (1 - k^2)^1/2 = cos(phi_0/2) / cosh x,   k cos u_0 = cos(phi_0/2) tanh x,
/// which is precise at both ends: k' is of the order of exp(-sqrt(P)) for large loads, u_0 nearly
/// pi/2 for small ones. In the amplitude v that is left to the tip, tan u_0 tan v = 1/k',
///     K(k) - F(u_0, k) = F(v, k),   E(k) - E(u_0, k) = E(v, k) - k^2 sin u_0 sin v.
struct Integrals {
  double complement;  // k'
  double k_cosine;    // k cos u_0
  double first;       // of the first kind
  double second;      // of the second kind
};

Integrals integrals(double phi_0, double x) {
  const double sine = std::abs(std::sin(phi_0 / 2));
  const double cosine = std::cos(phi_0 / 2);
  const double k_prime = cosine / std::cosh(x);
  const double k_squared = (1 - k_prime) * (1 + k_prime);
  const double hypotenuse = std::hypot(sine, std::sinh(x));
  // A rod that is pressed along its axis has u_0 = 0, v = pi/2 whatever x.
  const double cos_v = hypotenuse > 0 ? sine / hypotenuse : 0;
  const double sin_v = hypotenuse > 0 ? std::sinh(x) / hypotenuse : 1;
  const double delta_squared = cos_v * cos_v + k_prime * k_prime * sin_v * sin_v;
  const double first = sin_v * carlson_rf(cos_v * cos_v, delta_squared, 1);
  const double rest =
      k_squared / 3 * sin_v * sin_v * sin_v * carlson_rd(cos_v * cos_v, delta_squared, 1);
  return {k_prime, cosine * std::tanh(x), first,
          first - rest - std::sqrt(k_squared) * sine * sin_v};
}

struct Length {
  double phi_0;
  double root_load;
};

double residual(double x, void* data) {
  const auto& length = *static_cast<const Length*>(data);
  return integrals(length.phi_0, x).first - length.root_load;
}

/// The x at which the rod has its length; the first integral grows with x and is not less than it.
double solve_length(Length length) {
  gsl_function function{residual, &length};
  const auto solver =
      gsl_owned(gsl_root_fsolver_alloc(gsl_root_fsolver_brent), gsl_root_fsolver_free);
  if (gsl_root_fsolver_set(solver.get(), &function, 0, length.root_load + 1) != GSL_SUCCESS) {
    return NAN;
  }
  constexpr int most_iterations = 200;
  for (int i = 0; i < most_iterations; ++i) {
    if (gsl_root_fsolver_iterate(solver.get()) != GSL_SUCCESS) return NAN;
    if (gsl_root_test_interval(gsl_root_fsolver_x_lower(solver.get()),
                               gsl_root_fsolver_x_upper(solver.get()), 0, 4e-16) == GSL_SUCCESS) {
      break;
    }
  }
  return gsl_root_fsolver_root(solver.get());
}

}  // namespace

TipDeflection tip_deflection(double load, double angle) {
  silence_gsl();
  const double phi_0 = std::remainder(pi - angle, 2 * pi);
  const double side = phi_0 < 0 ? -1 : 1;
  const double root_load = std::sqrt(load);
  TipDeflection result;
  result.tip = {1, 0};
  constexpr double rounding = 1e-15;
  const bool pulled = std::abs(phi_0) > pi - rounding;
  const bool pushed = std::abs(phi_0) < rounding;
  if (load == 0 || pulled || (pushed && root_load <= pi / 2)) return result;

  const Integrals rod = integrals(phi_0, solve_length({phi_0, root_load}));
  const double along = 2 * rod.second / root_load - 1;
  const double across = side * 2 * rod.k_cosine / root_load;
  const double k = std::sqrt((1 - rod.complement) * (1 + rod.complement));
  result.tip = {along * std::cos(phi_0) + across * std::sin(phi_0),
                across * std::cos(phi_0) - along * std::sin(phi_0)};
  result.tip_angle = side * 2 * std::atan2(k, rod.complement) - phi_0;
  result.clamp_curvature = side * 2 * root_load * rod.k_cosine;
  result.bending_energy = 2 * root_load * rod.second - 2 * load * rod.complement * rod.complement;
  return result;
}

}  // namespace dlo::energy_model
