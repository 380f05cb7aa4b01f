#pragma once

#include <Eigen/Core>
#include <vector>

#include "dlo/energy_model/planar.hpp"
#include "dlo/energy_model/problem.hpp"
#include "reduction.hpp"

namespace dlo::energy_model {

/// The energy of a PlanarCantilever over its curvature coefficients, in EI/l. The rod is cut at its
/// loads, where the curvature has kinks; each piece has `terms` coefficients.
class CantileverEnergy {
 public:
  CantileverEnergy(const PlanarCantilever& rod, int terms);

  [[nodiscard]] Eigen::Index size() const { return angle_by_coefficient_.cols(); }
  [[nodiscard]] int terms() const { return terms_; }

  /// |a|^2 / 2 - int n . t ds with n(s) the sum of what hangs beyond s, and its gradient.
  [[nodiscard]] double value(const Eigen::Ref<const Eigen::VectorXd>& coefficients,
                             Eigen::Ref<Eigen::VectorXd> gradient);

  /// Second derivatives at the point of the last call of value().
  void hessian(Eigen::MatrixXd& result) const;

  /// The pendulum's profile 4 atan(tan(psi/4) exp(-sqrt(n) s)) that turns from the clamp to the sum
  /// n of weight and loads by the shorter way: the limit shape of a soft rod.
  [[nodiscard]] Eigen::VectorXd soft_start() const;

  /// Size of the last coefficients of each piece: what cutting the series off left out.
  [[nodiscard]] double tail(const Eigen::VectorXd& coefficients) const;

  /// The same curvature with more terms.
  [[nodiscard]] static Eigen::VectorXd refine(const Eigen::VectorXd& coefficients, int terms,
                                              int more_terms);

  [[nodiscard]] Energies energies(const Eigen::VectorXd& coefficients);

  /// Shape at distances s from the clamp, 0 <= s <= 1.
  [[nodiscard]] PlanarSamples sample(const Eigen::VectorXd& coefficients,
                                     const std::vector<double>& distances) const;

 private:
  struct Piece {
    double begin = 0;
    double length = 0;
    Eigen::Vector2d end_force = Eigen::Vector2d::Zero();  // sum of the loads beyond its end
  };

  PlanarCantilever rod_;
  int terms_;
  std::vector<Piece> pieces_;
  Eigen::MatrixXd angle_by_coefficient_;  // at all nodes, (pieces Q) x (pieces K)
  Eigen::Matrix2Xd force_;                // weight of the node times n
  Eigen::VectorXd angle_, cosine_, sine_, slope_;
};

}  // namespace dlo::energy_model
