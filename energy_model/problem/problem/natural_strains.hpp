#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

namespace dlo::energy_model {

/// Strains of the stress-free shape along the rod, as series of Legendre's polynomials P_j(from +
/// rate s), except in parts that have their own.
struct NaturalStrains {
  /// An interval with constant curvature, constant twist or both.
  struct Part {
    double begin = 0, end = 0;  ///< interval of s
    std::optional<Eigen::Vector2d> bend;
    std::optional<double> twist;

    /// Returns the strains in this part, where those of the series are `series`.
    [[nodiscard]] Eigen::Vector3d over(Eigen::Vector3d series) const {
      if (bend) series.head<2>() = *bend;
      if (twist) series.z() = *twist;
      return series;
    }
  };
  /// Coefficients of the series; empty: no material directors; one zero vector: straight, with
  /// material directors.
  std::vector<Eigen::Vector3d> coefficients;
  double from = -1;
  double rate = 2;
  std::vector<Part> parts;  ///< parts by growing s, not overlapping

  [[nodiscard]] bool empty() const { return coefficients.empty(); }
  /// Returns the strains at s; where two parts meet, those of the later one.
  [[nodiscard]] Eigen::Vector3d at(double s) const;
  /// Returns the integral of the strains from 0 to s.
  [[nodiscard]] Eigen::Vector3d integral(double s) const;
  /// Returns an upper bound of the norm of the strains.
  [[nodiscard]] double largest() const;
};

}  // namespace dlo::energy_model
