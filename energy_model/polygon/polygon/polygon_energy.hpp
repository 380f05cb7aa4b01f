#pragma once

#include <Eigen/Core>
#include <Eigen/LU>
#include <functional>

#include "dlo/energy_model/chain.hpp"
#include "dlo/energy_model/polygon.hpp"

namespace dlo::energy_model {

/// Positions of all points of a polygon [m], 3 x (n+1).
using Points = Eigen::Ref<const Eigen::Matrix3Xd>;

/// Function that receives a 3 x 3 block of a Hessian that belongs to the points `row` and `column`.
/// Blocks on both sides of the diagonal are passed. Some are passed more than once and have to be
/// added up.
using AddBlock =
    std::function<void(Eigen::Index row, Eigen::Index column, const Eigen::Matrix3d& block)>;

/// Adds the Hessian H by the differences d_p = P_(p+1) - P_p and d_q to the blocks of points.
void add_difference_block(Eigen::Index p, Eigen::Index q, const Eigen::Matrix3d& H,
                          const AddBlock& add);

/// Terms of the Hessian to compute.
enum class HessianTerms {
  all,
  /// All terms except those that make the Hessian negative: the changes of direction of compressed
  /// segments, of moments of joints and of forces of round obstacles. Far from equilibrium these
  /// terms are the largest and the least informative (as in projected Newton methods for cloth:
  /// Teran et al., 2005). The terms of twists remain, whatever their sign.
  positive_terms,
};

/// Computes the Hessian of polygon_energy(), without the part of twist_columns().
void polygon_hessian(const PolygonProblem& problem, const Points& points, HessianTerms which,
                     const AddBlock& add);

/// Angle beyond which the moment of a joint is constant [rad]: of a `hooke` joint as in the force
/// model, and of a `binormal` joint.
constexpr double fold_angle = 3.0;

/// Potential of a joint and its first two derivatives by the bending angle.
struct AngleJoint {
  double energy, moment, stiffness;
};

/// Computes the potential of a joint between segments of mean length L that is bent by alpha [rad].
[[nodiscard]] AngleJoint joint_by_angle(JointLaw law, double stiffness, double L, double alpha);

/// Returns the mean of the lengths of the two segments at joint i.
[[nodiscard]] inline double joint_length(const Eigen::VectorXd& lengths, Eigen::Index i) {
  return (lengths[i - 1] + lengths[i]) / 2;
}

/// Returns the bending stiffness of joint i of a chain or polygon.
template <typename JointedProblem>
[[nodiscard]] double joint_stiffness(const JointedProblem& problem, Eigen::Index i) {
  return problem.stiffnesses.size() > 0 ? problem.stiffnesses[i - 1] : problem.stiffness;
}

/// The two segments that meet at a point of a polygon.
struct SegmentPair {
  Eigen::Vector3d u, v;  ///< unit vectors of the segment before and the segment after the point
  double a, b;           ///< lengths of the segments

  SegmentPair(const Points& points, Eigen::Index i)
      : u(points.col(i) - points.col(i - 1)),
        v(points.col(i + 1) - points.col(i)),
        a(u.norm()),
        b(v.norm()) {
    u /= a;
    v /= b;
  }
};

/// Returns the energy of all twists [J] and adds their gradient [N] to `gradient`.
[[nodiscard]] double add_twist_energy(const PolygonProblem& problem, const Points& points,
                                      Eigen::Ref<Eigen::Matrix3Xd> gradient);

/// Adds the part M d2 theta of the Hessian, which couples neighbours. The other part is B B^T, with
/// a column d theta / sqrt(C) of B for each twist (twist_columns()).
void add_twist_hessian(const PolygonProblem& problem, const Points& points, const AddBlock& add);

/// Returns the matrix B of add_twist_hessian(): 3 (n+1) rows, the coordinates of each point
/// consecutively, and a column for each twist [sqrt(N/m)].
[[nodiscard]] Eigen::MatrixXd twist_columns(const PolygonProblem& problem, const Points& points);

/// Factors of H = A + B B^T + shift, with A symmetric and banded and B of few columns, computed in
/// O(rows): L D L^T of A + shift by GSL, and S = 1 + B^T (A + shift)^-1 B. The bordered matrix
///     [ A + shift  B ]
///     [ B^T       -1 ]
/// has the negative eigenvalues of H and one more for each column of B. It also has the negative
/// eigenvalues of A + shift and those of -S (Haynsworth).
class PolygonFactor {
 public:
  /// Factorises H.
  /// @param band  lower half of A, A(j + d, j) in row d and column j; at most as many rows as
  ///              columns
  /// @param B     rows x 0 if there is none
  /// @return whether H is positive definite
  bool compute(const Eigen::MatrixXd& band, const Eigen::MatrixXd& B, double shift);
  /// Returns H^-1 times a vector.
  [[nodiscard]] Eigen::VectorXd solve(Eigen::VectorXd right);

 private:
  void solve_banded(Eigen::Ref<Eigen::VectorXd> vector);

  Eigen::MatrixXd factor_;  // D in the first row, L below
  Eigen::MatrixXd B_;
  Eigen::MatrixXd solved_columns_;  // (A + shift)^-1 B
  Eigen::PartialPivLU<Eigen::MatrixXd> capacitance_;
};

/// Checks the arguments of solve_polygon().
/// @throws std::invalid_argument naming the first number out of range
void require_polygon(const PolygonProblem& problem, const Points& start,
                     const PolygonOptions& options);

/// Checks stiffnesses and natural turns of the joints of chains and polygons with n segments.
/// @throws std::invalid_argument naming `problem` and the first number out of range
void require_unlike_joints(const char* problem, JointLaw law, const Eigen::VectorXd& stiffnesses,
                           const Eigen::VectorXd& natural_turns, Eigen::Index n);

}  // namespace dlo::energy_model
