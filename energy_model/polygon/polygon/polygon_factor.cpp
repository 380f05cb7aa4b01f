#include <gsl/gsl_linalg.h>

#include <Eigen/Eigenvalues>
#include <stdexcept>

#include "base/gsl.hpp"
#include "polygon/polygon_energy.hpp"

namespace dlo::energy_model {
namespace {

/// Returns a GSL view of a banded matrix. GSL stores a column of the band in a row, and rows
/// consecutively.
gsl_matrix_view view_of(Eigen::MatrixXd& band) {
  return gsl_matrix_view_array(band.data(), static_cast<std::size_t>(band.cols()),
                               static_cast<std::size_t>(band.rows()));
}

}  // namespace

bool PolygonFactor::compute(const Eigen::MatrixXd& band, const Eigen::MatrixXd& B, double shift) {
  silence_gsl();
  factor_ = band;
  factor_.row(0).array() += shift;
  gsl_matrix_view factor = view_of(factor_);
  if (gsl_linalg_ldlt_band_decomp(&factor.matrix) != GSL_SUCCESS) return false;
  B_ = B;
  const auto pivots = factor_.row(0).array();
  if (!pivots.isFinite().all() || (pivots == 0).any()) return false;
  Eigen::Index positive = (pivots > 0).count();
  if (B_.cols() == 0) return positive == band.cols();
  solved_columns_ = B_;
  for (Eigen::Index k = 0; k < B_.cols(); ++k) solve_banded(solved_columns_.col(k));
  Eigen::MatrixXd small = B_.transpose() * solved_columns_;
  small.diagonal().array() += 1;
  if (!small.allFinite()) return false;
  capacitance_.compute(small);
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> spectrum(small, Eigen::EigenvaluesOnly);
  positive += (spectrum.eigenvalues().array() < 0).count();
  return positive == band.cols();
}

Eigen::VectorXd PolygonFactor::solve(Eigen::VectorXd right) {
  solve_banded(right);
  if (B_.cols() == 0) return right;
  const Eigen::VectorXd across = capacitance_.solve(B_.transpose() * right);
  right.noalias() -= solved_columns_ * across;
  return right;
}

void PolygonFactor::solve_banded(Eigen::Ref<Eigen::VectorXd> vector) {
  const gsl_matrix_view factor = view_of(factor_);
  gsl_vector_view entries =
      gsl_vector_view_array(vector.data(), static_cast<std::size_t>(vector.size()));
  if (gsl_linalg_ldlt_band_svx(&factor.matrix, &entries.vector) != GSL_SUCCESS) {
    throw std::logic_error("PolygonFactor: the vector has another size than the factor");
  }
}

}  // namespace dlo::energy_model
