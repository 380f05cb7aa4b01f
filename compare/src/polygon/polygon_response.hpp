#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <limits>
#include <optional>
#include <string>

#include "dlo/compare/discretise.hpp"
#include "dlo/compare/scene.hpp"
#include "dlo/energy_model/equilibrium.hpp"

namespace dlo::compare {

/// Number of points of the polygon that represents the continuous rod.
inline constexpr int rod_points = 97;

/// Returns the polygon of N points with the law hooke, the scene's bookkeeping and a physical c_c;
/// std::nullopt if discretise() rejects the scene, such as grips that need more points.
[[nodiscard]] std::optional<Discretisation> hooke_polygon(const Scene& scene, int points);

/// Whether an obstacle pushes an equilibrium.
[[nodiscard]] bool touches_obstacle(const energy_model::Equilibrium& rod);

/// Returns why PolygonResponse does not apply to a rod without contact; empty if it does.
[[nodiscard]] std::string why_no_polygon(const Scene& scene);

/// Changes of an equilibrium by stretch, to first order.
struct StretchResponse {
  double displacement_m = 0;  ///< RMS displacement along the rod [m]
  /// Change of the tension by stretch in the segment where the tension (or compression) is largest,
  /// divided by this tension [-]. NaN if the response cannot be computed or if no segment carries
  /// tension.
  double tension = 0;
};

/// First-order response of an equilibrium of the continuous rod to effects that a model neglects.
///
/// The rod is cut into the segments of a polygon, each with the rod's own tangent t_i in its middle
/// (a held one with its clamp's) and the force n_i that the rod beyond it exerts on it. Small
/// rotations dt_i across t_i minimise
///     sum joints -2 (EI/L) ln((1 + t_i.t_{i+1})/2) - sum L_i n_i.t_i     to second order,
/// minus f_i.dt_i for the neglected effect, subject to sum L_i (dt_i + eta_i) = gap between grips,
/// where eta is the neglected strain. With the complementary energy of a rod that stretches and
/// shears,
///     (n.t)^2 / (2 EA) + |n_across|^2 / (2 kGA)  per length,
/// stretch has eta = (n.t) t / (EA), f = L n_across (n.t) / (EA), and shear has eta = n_across /
/// (kGA), f = -L n_across (n.t) / (kGA). The error of the polygon itself is the first Newton step
/// from the rod's tangents to the polygon's equilibrium. The cost is O(N).
class PolygonResponse {
 public:
  /// Prepares the response of a rod without contact.
  /// @param discretisation  its polygon with the law hooke
  PolygonResponse(const Scene& scene, const Discretisation& discretisation,
                  const energy_model::Equilibrium& rod);

  // The functions return the RMS displacement of the points along the rod [m]. It is infinite if
  // the rod cannot respond, as a taut rod cannot get longer, or if the matrix is near singular: for
  // a symmetric shape the response is then zero and does not bound the distance of the buckled
  // shape close to it. The matrix counts as regular if the second variation is still positive with
  // 5 % less stiffness of the joints.

  /// Returns the response to stretch. @param stiffness  EA [N]
  [[nodiscard]] StretchResponse stretch(double stiffness) const;
  /// Returns the response to shear. @param stiffness  kGA [N]
  [[nodiscard]] double shear(double stiffness) const;
  /// Returns the distance between the polygon with the law hooke and the rod.
  [[nodiscard]] double discretisation() const;

 private:
  struct Response {
    double displacement_m = std::numeric_limits<double>::infinity();  // infinite: no response
    Eigen::Matrix3Xd dt;  // change of each segment's tangent, 3 x n
    Eigen::Matrix3Xd dn;  // change of the force in each segment, 3 x n [N]
  };
  void find_forces(const energy_model::Equilibrium& rod);
  /// Returns the rotations without the displacement; std::nullopt if the rod cannot respond.
  [[nodiscard]] std::optional<Response> turns(const Eigen::Matrix3Xd& f,
                                              const Eigen::Matrix3Xd& gaps) const;
  /// Returns the second derivatives with the derivatives of the constraints as border.
  /// @param joints  factor on the stiffness of the joints
  [[nodiscard]] Eigen::SparseMatrix<double> matrix(double joints) const;
  [[nodiscard]] Eigen::Index constraints() const;
  /// Whether `matrix` is positive definite on the null space of the constraints, by Sylvester's law
  /// of inertia.
  [[nodiscard]] bool is_positive(const Eigen::SparseMatrix<double>& matrix) const;
  [[nodiscard]] Response response_to(const Eigen::Matrix3Xd& f, const Eigen::Matrix3Xd& eta) const;
  /// Returns the sums of the steps between the first points of adjacent grips, 3 x (grips - 1).
  [[nodiscard]] Eigen::Matrix3Xd sums_between_grips(const Eigen::Matrix3Xd& steps) const;
  [[nodiscard]] Eigen::Matrix3Xd points_along(const Eigen::Vector3d& start,
                                              const Eigen::Matrix3Xd& steps) const;
  [[nodiscard]] double displacement_rms(const Eigen::Matrix3Xd& movement) const;

  const Scene& scene_;
  const Discretisation& polygon_;
  Eigen::Index n_;                               // number of segments
  std::vector<const force_model::Grip*> grips_;  // in the order of their points
  std::vector<bool> held_;                       // whether a segment is held
  Eigen::Matrix3Xd tangents_;                    // t_i
  Eigen::Matrix3Xd forces_;                      // n_i [N]
  Eigen::Matrix3Xd rod_points_;                  // points of the rod at the points' arc lengths [m]
  std::vector<Eigen::Matrix<double, 3, 2>> across_;
};

/// Returns a bound of a movement whose first-order answer is `response` [m]: twice the answer,
/// which covers terms of second order, or infinity if the answer exceeds 3 % of the length.
[[nodiscard]] double bound_of_response(double response, double length);

/// Returns the bound of the distance between the rod and a polygon with the law hooke at rest, RMS
/// along the rod [m]; infinite if there is none.
[[nodiscard]] double polygon_bound(const Scene& scene, const Discretisation& polygon,
                                   const energy_model::Equilibrium& rod);

}  // namespace dlo::compare
