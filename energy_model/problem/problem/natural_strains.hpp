#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

namespace dlo::energy_model {

/// Strains of the stress-free shape along it, as series in Legendre's polynomials P_j(from + rate
/// s), but for parts that have their own.
struct NaturalStrains {
  /// Where curvature, twist or both are the same all along.
  struct Part {
    double begin = 0, end = 0;  ///< s
    std::optional<Eigen::Vector2d> bend;
    std::optional<double> twist;

    /// Its strains, where the others are these.
    [[nodiscard]] Eigen::Vector3d over(Eigen::Vector3d series) const {
      if (bend) series.head<2>() = *bend;
      if (twist) series.z() = *twist;
      return series;
    }
  };
  std::vector<Eigen::Vector3d> coefficients;  ///< none: no directors that are fixed to the
                                              ///< material; of a straight rod that has some: zero
  double from = -1;
  double rate = 2;
  std::vector<Part> parts;  ///< by growing s, none over another

  [[nodiscard]] bool empty() const { return coefficients.empty(); }
  /// Where two parts meet that of the one after it.
  [[nodiscard]] Eigen::Vector3d at(double s) const;
  /// From 0 to s.
  [[nodiscard]] Eigen::Vector3d integral(double s) const;
  /// A bound on the norm.
  [[nodiscard]] double largest() const;
};

}  // namespace dlo::energy_model
