#pragma once

#include <Eigen/Core>
#include <vector>

namespace dlo::energy_model {

/// Strains of the stress-free shape along it, as series in Legendre's polynomials P_j(from + rate
/// s).
struct NaturalStrains {
  std::vector<Eigen::Vector3d> coefficients;  ///< none: no directors that are fixed to the
                                              ///< material; of a straight rod that has some: zero
  double from = -1;
  double rate = 2;

  [[nodiscard]] bool empty() const { return coefficients.empty(); }
  [[nodiscard]] Eigen::Vector3d at(double s) const;
  /// From 0 to s.
  [[nodiscard]] Eigen::Vector3d integral(double s) const;
  /// A bound on the norm.
  [[nodiscard]] double largest() const;
};

}  // namespace dlo::energy_model
