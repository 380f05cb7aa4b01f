#pragma once

#include <Eigen/Core>
#include <Eigen/LU>
#include <Eigen/QR>
#include <optional>

namespace dlo::energy_model {

/// A Hessian restricted to the null space of the constraints' Jacobian J, and its Cholesky factor.
/// With the Householder reflections Q of J^T = Q (R; 0), R triangular, and Q = (Y, Z), the factor
/// is
///     Z^T H Z = L L^T.
/// The class determines definiteness, the smallest eigenvalue and Newton's step. Buffers are kept
/// from one compute() to the next.
class ReducedHessian {
 public:
  /// Restricts the Hessian to the null space of the Jacobian and factors it.
  /// @param hessian   n x n, symmetric
  /// @param jacobian  of the constraints, m x n; m may be 0 or exceed n
  void compute(const Eigen::MatrixXd& hessian, const Eigen::MatrixXd& jacobian) {
    constrain(jacobian);
    compute(hessian);
  }
  /// Sets the constraints alone; compute(hessian) follows, for a Hessian whose multipliers depend
  /// on the constraints (balance()).
  void constrain(const Eigen::MatrixXd& jacobian);
  void compute(const Eigen::MatrixXd& hessian) {
    rotated_hessian_ = hessian;
    reflect_and_factor();
  }
  /// Sets the Hessian by swapping its storage, without a copy; the content of `hessian` is lost.
  void take(Eigen::MatrixXd& hessian) {
    rotated_hessian_.swap(hessian);
    reflect_and_factor();
  }

  /// Whether the constraints are independent.
  [[nodiscard]] bool is_independent() const { return independent_; }
  /// Least-squares multipliers mu, which minimise |J^T mu - g| for a gradient g and independent
  /// constraints, and the remaining part Z^T g of the gradient.
  struct Balance {
    Eigen::VectorXd multipliers, left;
  };
  [[nodiscard]] Balance balance(const Eigen::VectorXd& gradient);

  [[nodiscard]] bool is_definite() const { return definite_; }
  /// Replaces z by (Z^T H Z)^-1 z; Z^T H Z has to be positive definite.
  void solve_free(Eigen::VectorXd& z) const;
  /// Factors Z^T H Z + mu. @return whether it is positive definite, which solve_shifted() needs
  [[nodiscard]] bool factor_shifted(double mu) { return factor(mu, shifted_); }
  /// Replaces z by (Z^T H Z + mu)^-1 z, with the mu of the last factor_shifted().
  void solve_shifted(Eigen::VectorXd& z) const { cholesky_solve(shifted_, z); }
  /// Returns the diagonal of Z^T H Z.
  [[nodiscard]] Eigen::VectorXd diagonal() const {
    return rotated_hessian_.diagonal().tail(free());
  }

  /// Whether Z^T H Z is positive definite (true if no direction is free) and the constraints are
  /// independent, which solve() requires.
  [[nodiscard]] bool has_solutions() const { return definite_ && independent_; }

  /// Solves H x - J^T mu = a, J x = b without iterative refinement; the caller has to check the
  /// residual.
  /// @param right      (a, b), n + m numbers
  /// @param[out] step  (x, mu); must not alias `right`
  void solve(const Eigen::VectorXd& right, Eigen::VectorXd& step);

  /// Returns an estimate of the smallest eigenvalue of Z^T H Z. The eigenvalue is more than 0.99
  /// of the estimate, which a factorisation of the shifted matrix proves. Returns std::nullopt if
  /// Z^T H Z is not positive definite, no direction is free or the proof fails.
  [[nodiscard]] std::optional<double> smallest_eigenvalue_of_definite();
  /// Returns the unit eigenvector of the smallest eigenvalue in coordinates of the free directions,
  /// converged or after 80 steps of Lanczos' method. Returns std::nullopt if Z^T H Z is not
  /// positive definite or no direction is free.
  [[nodiscard]] std::optional<Eigen::VectorXd> lowest_mode_of_definite();

  /// H; only valid without constraints.
  [[nodiscard]] const Eigen::MatrixXd& unconstrained() const { return rotated_hessian_; }
  /// Returns Z^T H Z, free x free.
  [[nodiscard]] Eigen::MatrixXd matrix() const;
  /// Returns Z v, a vector of free directions in the unknowns.
  [[nodiscard]] Eigen::VectorXd to_unknowns(const Eigen::VectorXd& v) const;

 private:
  [[nodiscard]] Eigen::Index free() const { return n_ - constraints_; }
  using Vector = Eigen::Ref<Eigen::VectorXd>;
  void reflect(Eigen::Index i, Vector& v) const;
  void turn(Vector v) const;
  void apply_q(Vector v) const;
  void solve_triangle(Vector mu) const;
  void cholesky_solve(const Eigen::MatrixXd& lower, Vector z) const;
  void reflect_and_factor();
  [[nodiscard]] bool factor(double mu, Eigen::MatrixXd& lower) const;
  /// Tridiagonal matrix of Lanczos' method on the inverse of Z^T H Z; its vectors are in krylov_.
  struct Lanczos {
    Eigen::VectorXd diagonal, off_diagonal;
    double largest = 0;  // largest eigenvalue
  };
  [[nodiscard]] Lanczos run_lanczos(double settled, Eigen::Index most_steps);

  Eigen::Index n_ = 0, constraints_ = 0;
  bool definite_ = false, independent_ = false;
  Eigen::MatrixXd reflections_;  // column i: v of 1 - tau v v^T, first i elements zero; n x m
  Eigen::VectorXd tau_, diagonal_;
  Eigen::MatrixXd triangle_;         // R above its diagonal
  Eigen::MatrixXd rotated_hessian_;  // Q^T H Q
  Eigen::MatrixXd factor_;           // L
  Eigen::MatrixXd shifted_;          // L of a shifted matrix
  Eigen::VectorXd scratch_, rotated_right_;
  Eigen::MatrixXd krylov_;
};

/// Magnitude below which an eigenvalue counts as zero.
inline constexpr double zero_eigenvalue_limit = 1e-7;

/// Returns smallest_eigenvalue_of_definite() as the only element if it exists and exceeds `above`;
/// otherwise all eigenvalues of the reduced Hessian in ascending order. Returns an empty vector if
/// the constraints leave no direction free.
[[nodiscard]] Eigen::VectorXd smallest_eigenvalues(ReducedHessian& hessian, double above);

/// Returns the eigenvector (in the unknowns, unit length) of the eigenvalue that is number `index`
/// by magnitude, counted from 0 at the smallest.
[[nodiscard]] Eigen::VectorXd eigenvector_by_magnitude(ReducedHessian& hessian, Eigen::Index index);

/// Whether no eigenvalue of a symmetric matrix is below -`zero_eigenvalue_limit`; only the lower
/// half is read.
[[nodiscard]] bool is_minimum(const Eigen::MatrixXd& hessian);

/// Returns the unit vector of the unknowns along the eigenvector of the smallest eigenvalue, if
/// that is at most -`zero_eigenvalue_limit`; else std::nullopt.
[[nodiscard]] std::optional<Eigen::VectorXd> negative_curvature_direction(
    const ReducedHessian& hessian);

/// The linear system of Newton's method under constraints,
///     H x - J^T mu = a,  J x = b.
/// If H is positive definite on the null space of J, and the rows of J are independent, the system
/// is factored there (ReducedHessian); otherwise it is factored as a whole. Buffers are kept from
/// one compute() to the next.
class NewtonSystem {
 public:
  /// Factors the system. @param[in,out] hessian  n x n, symmetric; its storage is swapped out, and
  /// its content is lost
  /// @param jacobian         m x n
  void compute(Eigen::MatrixXd& hessian, const Eigen::MatrixXd& jacobian);

  /// Whether the last compute() had these numbers of unknowns and constraints.
  [[nodiscard]] bool has_size(Eigen::Index unknowns, Eigen::Index constraints) const {
    return hessian().rows() == unknowns && jacobian_.rows() == constraints;
  }
  [[nodiscard]] const Eigen::MatrixXd& hessian() const {
    return jacobian_.rows() > 0 ? hessian_ : reduced_.unconstrained();
  }

  /// Solves the system.
  /// @param right      (a, b), n + m numbers
  /// @param[out] step  (x, mu); must not alias `right`
  void solve(const Eigen::VectorXd& right, Eigen::VectorXd& step);

  /// Whether a step solves the system to 1e-6 of the norm of `right`, and its x is no longer than
  /// `longest`. A step longer than 1e3 shows that the system is nearly singular.
  [[nodiscard]] bool is_solved_by(const Eigen::VectorXd& right, const Eigen::VectorXd& step,
                                  double longest = 1e3);

  /// Returns the minimum-norm least-squares solution, which has no component along near-null modes.
  [[nodiscard]] Eigen::VectorXd minimum_norm_step(const Eigen::VectorXd& right);

  /// Returns H on the directions that the constraints leave free; without constraints, H itself.
  [[nodiscard]] ReducedHessian& reduced_hessian() { return reduced_; }
  [[nodiscard]] const ReducedHessian& reduced_hessian() const { return reduced_; }

 private:
  [[nodiscard]] Eigen::MatrixXd whole() const;

  Eigen::MatrixXd hessian_;  // empty without constraints
  Eigen::MatrixXd jacobian_;
  ReducedHessian reduced_;
  Eigen::PartialPivLU<Eigen::MatrixXd> lu_;
  /// Orthogonal factorisation of the whole system; computed by the first minimum_norm_step().
  std::optional<Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd>> orthogonal_;
  Eigen::VectorXd left_;
};

}  // namespace dlo::energy_model
