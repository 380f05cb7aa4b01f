#include "problem/natural_strains.hpp"

#include <algorithm>

namespace dlo::energy_model {
namespace {

/// Returns P_0(x) .. P_{count-1}(x).
std::vector<double> legendre_polynomials(double x, std::size_t count) {
  std::vector<double> p(count, 1);
  if (count > 1) p[1] = x;
  for (std::size_t j = 2; j < count; ++j) {
    const auto n = static_cast<double>(j);
    p[j] = ((2 * n - 1) * x * p[j - 1] - (n - 1) * p[j - 2]) / n;
  }
  return p;
}

Eigen::Vector3d series_integral(const NaturalStrains& natural, double a, double b) {
  // int P_j = (P_{j+1} - P_{j-1}) / (2 j + 1), int P_0 = P_1
  const std::size_t count = natural.coefficients.size();
  const std::vector<double> upper =
      legendre_polynomials(natural.from + natural.rate * b, count + 1);
  const std::vector<double> lower =
      legendre_polynomials(natural.from + natural.rate * a, count + 1);
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (std::size_t j = 0; j < count; ++j) {
    double difference = upper[j + 1] - lower[j + 1];
    if (j > 0) difference -= upper[j - 1] - lower[j - 1];
    const double width = natural.rate * static_cast<double>(2 * j + 1);
    sum += difference / width * natural.coefficients[j];
  }
  return sum;
}

}  // namespace

Eigen::Vector3d NaturalStrains::at(double s) const {
  const std::vector<double> p = legendre_polynomials(from + rate * s, coefficients.size());
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (std::size_t j = 0; j < p.size(); ++j) sum += p[j] * coefficients[j];
  const auto after =
      std::find_if(parts.rbegin(), parts.rend(), [s](const Part& part) { return part.begin <= s; });
  return after != parts.rend() && s <= after->end ? after->over(sum) : sum;
}

Eigen::Vector3d NaturalStrains::integral(double s) const {
  Eigen::Vector3d sum = series_integral(*this, 0, s);
  for (const Part& part : parts) {
    const double length = std::min(s, part.end) - part.begin;
    if (!(length > 0)) continue;
    const Eigen::Vector3d mean = series_integral(*this, part.begin, part.begin + length) / length;
    sum += length * (part.over(mean) - mean);
  }
  return sum;
}

double NaturalStrains::largest() const {
  double sum = 0;
  for (const Eigen::Vector3d& coefficient : coefficients) sum += coefficient.norm();
  double most = 0;
  for (const Part& part : parts) most = std::max(most, part.over(Eigen::Vector3d::Zero()).norm());
  return sum + most;
}

}  // namespace dlo::energy_model
