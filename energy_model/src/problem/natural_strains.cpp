#include "problem/natural_strains.hpp"

namespace dlo::energy_model {
namespace {

/// P_0(x) .. P_{count-1}(x).
std::vector<double> legendre_polynomials(double x, std::size_t count) {
  std::vector<double> p(count, 1);
  if (count > 1) p[1] = x;
  for (std::size_t j = 2; j < count; ++j) {
    const auto n = static_cast<double>(j);
    p[j] = ((2 * n - 1) * x * p[j - 1] - (n - 1) * p[j - 2]) / n;
  }
  return p;
}

}  // namespace

Eigen::Vector3d NaturalStrains::at(double s) const {
  const std::vector<double> p = legendre_polynomials(from + rate * s, coefficients.size());
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (std::size_t j = 0; j < p.size(); ++j) sum += p[j] * coefficients[j];
  return sum;
}

Eigen::Vector3d NaturalStrains::integral(double s) const {
  // int P_j = (P_{j+1} - P_{j-1}) / (2 j + 1), int P_0 = P_1
  const std::size_t count = coefficients.size();
  const std::vector<double> upper = legendre_polynomials(from + rate * s, count + 1);
  const std::vector<double> lower = legendre_polynomials(from, count + 1);
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (std::size_t j = 0; j < count; ++j) {
    double difference = upper[j + 1] - lower[j + 1];
    if (j > 0) difference -= upper[j - 1] - lower[j - 1];
    sum += difference / (rate * static_cast<double>(2 * j + 1)) * coefficients[j];
  }
  return sum;
}

double NaturalStrains::largest() const {
  double sum = 0;
  for (const Eigen::Vector3d& coefficient : coefficients) sum += coefficient.norm();
  return sum;
}

}  // namespace dlo::energy_model
