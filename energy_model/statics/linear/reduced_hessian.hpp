#pragma once

#include <Eigen/Core>
#include <optional>

namespace dlo::energy_model {

/// A Hessian on what the constraints leave free, factored: with the reflections Q of
/// J^T = Q (R; 0), R triangular, and Q = (Y, Z),
///     Z^T H Z = L L^T.
/// It tells whether it is positive definite, what its smallest eigenvalue is, and Newton's step.
/// Buffers survive from one compute() to the next.
class ReducedHessian {
 public:
  /// @param hessian   n x n, symmetric
  /// @param jacobian  of the constraints, m x n; m may be 0 or exceed n
  void compute(const Eigen::MatrixXd& hessian, const Eigen::MatrixXd& jacobian) {
    constrain(jacobian);
    compute(hessian);
  }
  /// In two steps, where the Hessian takes multipliers that the constraints tell.
  void constrain(const Eigen::MatrixXd& jacobian);
  void compute(const Eigen::MatrixXd& hessian) {
    turned_ = hessian;
    reflect_and_factor();
  }
  /// The same without a copy: the matrix becomes another one.
  void take(Eigen::MatrixXd& hessian) {
    turned_.swap(hessian);
    reflect_and_factor();
  }

  /// Whether the constraints are independent.
  [[nodiscard]] bool is_independent() const { return independent_; }
  /// Multipliers mu with J^T mu nearest to a gradient, of independent constraints, and what is left
  /// of it: Z^T g.
  struct Balance {
    Eigen::VectorXd multipliers, left;
  };
  [[nodiscard]] Balance balance(const Eigen::VectorXd& gradient);

  [[nodiscard]] bool is_definite() const { return definite_; }
  /// z to (Z^T H Z)^-1 z, if it is positive definite.
  void solve_free(Eigen::VectorXd& z) const;
  /// Factors Z^T H Z + mu. @return whether it is positive definite, which solve_shifted() needs
  [[nodiscard]] bool factor_shifted(double mu) { return factor(mu, shifted_); }
  /// z to (Z^T H Z + mu)^-1 z, with the mu of the last factor_shifted()
  void solve_shifted(Eigen::VectorXd& z) const { solve_by(shifted_, z); }
  /// Of Z^T H Z.
  [[nodiscard]] Eigen::VectorXd diagonal() const { return turned_.diagonal().tail(free()); }

  /// Whether Z^T H Z is positive definite (of no free direction it is) and the constraints are
  /// independent: what solve() needs.
  [[nodiscard]] bool has_solutions() const { return definite_ && independent_; }

  /// Solution (x, mu) of H x - J^T mu = a, J x = b. It refines nothing: whoever wants to know how
  /// good it is looks at what is left.
  /// @param right      (a, b), n + m
  /// @param[out] step  (x, mu), another vector
  void solve(const Eigen::VectorXd& right, Eigen::VectorXd& step);

  /// Of Z^T H Z, if it is positive definite, below which by less than a hundredth of it lies no
  /// other one, which a factor proves; none if it is not or the proof fails.
  [[nodiscard]] std::optional<double> smallest_eigenvalue_of_definite();
  /// A unit vector of the free directions along that eigenvalue, to where it changes no more; none
  /// if Z^T H Z is not positive definite.
  [[nodiscard]] std::optional<Eigen::VectorXd> lowest_mode_of_definite();

  /// Smallest element of R's diagonal, by size: by how much a turn of the constraints' derivatives
  /// turns the free directions more than that; infinite without constraints.
  [[nodiscard]] double least_constraint() const;

  /// H, where there are no constraints.
  [[nodiscard]] const Eigen::MatrixXd& unconstrained() const { return turned_; }
  /// Z^T H Z, free x free.
  [[nodiscard]] Eigen::MatrixXd matrix() const;
  /// A vector of the free directions in the unknowns: Z v.
  [[nodiscard]] Eigen::VectorXd in_unknowns(const Eigen::VectorXd& v) const;

 private:
  [[nodiscard]] Eigen::Index free() const { return n_ - constraints_; }
  void reflect_constraints(const Eigen::MatrixXd& jacobian);
  using Vector = Eigen::Ref<Eigen::VectorXd>;
  void reflect(Eigen::Index i, Vector& v) const;
  void turn(Vector v) const;
  void turn_back(Vector v) const;
  void solve_triangle(Vector mu) const;
  void solve_by(const Eigen::MatrixXd& lower, Vector z) const;
  void reflect_and_factor();
  [[nodiscard]] bool factor(double mu, Eigen::MatrixXd& lower) const;
  /// Vectors krylov_ of Lanczos' method with the inverse, and the matrix that they make of it.
  struct Lanczos {
    Eigen::VectorXd along, beside;  // diagonal, and what is next to it
    double largest = 0;             // eigenvalue
  };
  [[nodiscard]] Lanczos look_for_smallest(double settled, Eigen::Index most_steps);

  Eigen::Index n_ = 0, constraints_ = 0;
  bool definite_ = false, independent_ = false;
  Eigen::MatrixXd reflections_;  // v of 1 - tau v v^T, n x m, the first v_i of each zero
  Eigen::VectorXd tau_, diagonal_;
  Eigen::MatrixXd triangle_;  // R above its diagonal
  Eigen::MatrixXd turned_;    // Q^T H Q
  Eigen::MatrixXd factor_;    // L
  Eigen::MatrixXd shifted_;   // the same of a shifted matrix
  Eigen::VectorXd scratch_, turned_right_;
  Eigen::MatrixXd krylov_;
};

}  // namespace dlo::energy_model
