#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <optional>
#include <string>

#include "dlo/compare/discretise.hpp"
#include "dlo/compare/scene.hpp"
#include "dlo/energy_model/equilibrium.hpp"

namespace dlo::compare {

/// Points of the polygon that stands for the rod itself.
inline constexpr int rod_points = 97;

/// The hooke polygon of N points with the scene's bookkeeping and a physical c_c; nothing if the
/// grips ask for more points.
[[nodiscard]] std::optional<Discretisation> hooke_polygon(const Scene& scene, int points);

/// Why no polygon answers for a rod that touches nothing (PolygonResponse); empty if one does.
[[nodiscard]] std::string why_no_polygon(const Scene& scene);

/// What stretch changes.
struct StretchResponse {
  double moved_m = 0;  ///< RMS along the rod [m]
  /// Change of the tension where it is largest, over that; NaN where there is no answer or no
  /// tension [-].
  double tension = 0;
};

/// How an equilibrium of the continuous rod answers, to first order, to what a model neglects.
///
/// The rod is cut into the segments of a polygon, each with the rod's own tangent t_i in its middle
/// (a held one with its clamp's) and the force n_i that what lies beyond it exerts on it. Small
/// turns dt_i across t_i minimise
///     sum joints -2 (EI/L) ln((1 + t_i.t_{i+1})/2) - sum L_i n_i.t_i     to second order,
/// minus f_i.dt_i for what was neglected, subject to sum L_i (dt_i + eta_i) = gap between grips,
/// eta the strain that was neglected. With the complementary energy of a rod that stretches and
/// shears,
///     (n.t)^2 / (2 EA) + |n_across|^2 / (2 kGA)  per length,
/// stretch has eta = (n.t) t / (EA), f = L n_across (n.t) / (EA), and shear has eta = n_across /
/// (kGA), f = -L n_across (n.t) / (kGA). The polygon's own error is the first Newton step from the
/// rod's tangents to the polygon's equilibrium. O(N).
class PolygonResponse {
 public:
  /// Of a rod that touches no obstacle, its polygon and the hooke law.
  PolygonResponse(const Scene& scene, const Discretisation& discretisation,
                  const energy_model::Equilibrium& rod);

  // RMS of the points' movement along the rod [m]; infinite if the rod cannot answer, as a taut one
  // cannot get longer, or if the answer's matrix is near singular: on a symmetric shape the answer
  // is then zero, and says nothing of the buckled one next to it. Far from singular means that the
  // second variation with 5 % less of the joints' stiffness is still positive.

  /// @param stiffness  EA [N]
  [[nodiscard]] StretchResponse stretch(double stiffness) const;
  /// @param stiffness  kGA [N]
  [[nodiscard]] double shear(double stiffness) const;
  /// Of the hooke polygon against the rod.
  [[nodiscard]] double discretisation() const;

 private:
  struct Turns {
    bool possible = false;
    Eigen::Matrix3Xd dt;  // 3 x n
    Eigen::Matrix3Xd dn;  // change of the force between two grips each, 3 x (grips - 1) [N]
  };
  void find_held_segments();
  void find_forces(const energy_model::Equilibrium& rod);
  [[nodiscard]] Turns turns(const Eigen::Matrix3Xd& f, const Eigen::Matrix3Xd& gaps) const;
  /// The second derivatives, bordered by the constraints' first ones.
  /// @param joints  share of the joints' stiffness that counts
  [[nodiscard]] Eigen::SparseMatrix<double> matrix(double joints) const;
  [[nodiscard]] Eigen::Index constraints() const;
  /// Whether `matrix` is positive definite where the constraints hold, by Sylvester's law.
  [[nodiscard]] bool is_positive(const Eigen::SparseMatrix<double>& matrix) const;
  struct Answer {
    double moved_m;       // infinite: none
    Eigen::Matrix3Xd dt;  // change of each segment's tangent
    Eigen::Matrix3Xd dn;  // change of the force in each segment [N]
  };
  [[nodiscard]] Answer answer_to(const Eigen::Matrix3Xd& f, const Eigen::Matrix3Xd& eta) const;
  [[nodiscard]] Eigen::Matrix3Xd points_along(const Eigen::Vector3d& start,
                                              const Eigen::Matrix3Xd& steps) const;
  [[nodiscard]] double moved_rms(const Eigen::Matrix3Xd& movement) const;

  const Scene& scene_;
  const Discretisation& polygon_;
  Eigen::Index n_;                  // segments
  std::vector<std::size_t> along_;  // grips in the order of their points
  std::vector<bool> held_;          // segments
  Eigen::Matrix3Xd tangents_;       // t_i
  Eigen::Matrix3Xd forces_;         // n_i [N]
  Eigen::Matrix3Xd rod_points_;     // of the rod at the points' arc lengths [m]
  std::vector<Eigen::Matrix<double, 3, 2>> across_;
};

/// Returns a bound of a movement whose first-order answer is `response` [m]: twice the answer,
/// which covers terms of second order, or infinity if the answer exceeds 3 % of the length.
[[nodiscard]] double bound_of_response(double response, double length);

/// Returns the bound of the distance between the rod and this hooke polygon at rest, RMS along the
/// rod [m]; infinite: none.
[[nodiscard]] double polygon_bound(const Scene& scene, const Discretisation& polygon,
                                   const energy_model::Equilibrium& rod);

}  // namespace dlo::compare
