#include "laws/catenary.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace dlo::energy_model {
namespace {

using Vector = Eigen::Vector3d;

/// Maximum number of halvings of an interval; rounding may keep it from closing.
constexpr int halvings = 200;

/// Solves sinh(u) / u = ratio for u, given ratio - 1.
double root_of_sinh_ratio(double excess) {
  const auto excess_at = [](double u) {
    if (u > 1) return std::sinh(u) / u - 1;
    double term = 1;
    double sum = 0;
    for (int k = 1; k < 12; ++k) sum += term *= u * u / (2 * k * (2 * k + 1));
    return sum;
  };
  double low = 0;
  double high = 1;
  while (excess_at(high) < excess && high < 700) high *= 2;
  for (int i = 0; i < halvings && high - low > 1e-16 * high; ++i) {
    const double middle = (low + high) / 2;
    (excess_at(middle) < excess ? low : high) = middle;
  }
  return (low + high) / 2;
}

}  // namespace

double Catenary::hanging_arc_length(double s) const {
  if (s < low) return s - low;
  return std::max(0.0, s - low - lying_length);
}

double Catenary::height(double s) const { return std::hypot(a, hanging_arc_length(s)); }

Vector Catenary::point(double s) const {
  const double q = hanging_arc_length(s);
  const double x = std::clamp(s - low, 0.0, lying_length) + (a > 0 ? a * std::asinh(q / a) : 0.0);
  return origin + x * horizontal + (std::hypot(a, q) - a) * up;
}

Vector Catenary::tangent(double s) const {
  if (a == 0)
    return hanging_arc_length(s) < 0 || (hanging_arc_length(s) == 0 && low > 0) ? Vector(-up) : up;
  return (a * horizontal + hanging_arc_length(s) * up) / height(s);
}

Vector Catenary::curvature(double s) const {
  if (a == 0 || is_lying(s)) return Vector::Zero();
  const double y = height(s);
  return a / (y * y) * (a * up - hanging_arc_length(s) * horizontal) / y;
}

double Catenary::height_integral(double q) const {
  const double area = (q * std::hypot(a, q) + (a > 0 ? a * a * std::asinh(q / a) : 0.0)) / 2;
  return area - a * q;
}

double Catenary::squared_curvature_integral(double q) const {
  if (a == 0) return 0;
  return (q / (a * a + q * q) + std::atan(q / a) / a) / 2;
}

std::optional<Catenary> hanging_catenary(const Vector& begin, const Vector& end, double l,
                                         const Vector& up) {
  const Vector chord = end - begin;
  const double rise = chord.dot(up);
  const Vector flat = chord - rise * up;
  const double x = flat.norm();
  if (!(x > negligible_length * l) || !(chord.norm() < l * (1 - negligible_length)))
    return std::nullopt;
  const double ratio = std::sqrt((l - rise) * (l + rise)) / x;
  const double excess = (l - chord.norm()) * (l + chord.norm()) / (x * x * (ratio + 1));
  const double u = root_of_sinh_ratio(excess);
  Catenary line;
  line.a = x / (2 * u);
  line.horizontal = flat / x;
  line.up = up;
  const double first = line.a * std::sinh(std::atanh(rise / l) - u);
  line.low = -first;
  line.origin = begin - line.a * std::asinh(first / line.a) * line.horizontal -
                (std::hypot(line.a, first) - line.a) * up;
  return line;
}

std::optional<Catenary> catenary_on_floor(const Vector& begin, const Vector& end, double l,
                                          const Vector& up, double floor) {
  const Vector chord = end - begin;
  const Vector flat = chord - chord.dot(up) * up;
  const double x = flat.norm();
  if (!(x > negligible_length * l)) return std::nullopt;
  const std::array<double, 2> heights = {std::max(0.0, begin.dot(up) - floor),
                                         std::max(0.0, end.dot(up) - floor)};
  const auto length = [](double h, double a) { return std::sqrt(h * (h + 2 * a)); };
  const auto reach = [](double h, double a) {
    const double z = h / a;
    return a * std::log1p(z + std::sqrt(z * (z + 2)));
  };
  const auto spare = [&](double a) {
    double sum = 0;
    for (const double h : heights) sum += length(h, a) - reach(h, a);
    return sum;
  };
  double low = 1e-6 * l;
  double high = 1e6 * l;
  if (!(spare(low) > l - x) || !(spare(high) < l - x)) return std::nullopt;
  for (int i = 0; i < halvings && high / low > 1 + 1e-15; ++i) {
    const double middle = std::sqrt(low * high);
    (spare(middle) > l - x ? low : high) = middle;
  }
  Catenary line;
  line.a = std::sqrt(low * high);
  line.horizontal = flat / x;
  line.up = up;
  line.low = length(heights[0], line.a);
  line.lying_length = l - line.low - length(heights[1], line.a);
  if (!(line.lying_length > 0)) return std::nullopt;
  line.origin = begin + reach(heights[0], line.a) * line.horizontal - heights[0] * up;
  return line;
}

}  // namespace dlo::energy_model
