#include "shooting/constrained_pencil.hpp"

#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cmath>

namespace dlo::energy_model {
namespace {

using Factors = Eigen::SimplicialLDLT<Sparse, Eigen::Lower, Eigen::NaturalOrdering<int>>;

/// Factorises the bordered matrix of ConstrainedPencil. @return false if a pivot is zero
bool factorise(const ConstrainedPencil& pencil, double mu, Factors& factors) {
  factors.compute(pencil.second - mu * pencil.norm + pencil.constraint_blocks);
  return factors.info() == Eigen::Success && factors.vectorD().allFinite();
}

/// Returns the number of eigenvalues below mu; -1: undetermined by the pivots.
int count_below(const ConstrainedPencil& pencil, double mu) {
  Factors factors;
  // A pivot is zero only for isolated mu, so that a small change of mu suffices.
  for (int attempt = 0; attempt < 5; ++attempt) {
    if (factorise(pencil, mu, factors)) {
      const auto negative = (factors.vectorD().array() < 0).count();
      return static_cast<int>(negative) - pencil.constraint_count;
    }
    mu -= 1e-3 * neutral_eigenvalue * (1 + attempt);
  }
  return -1;
}

/// Bounds of the smallest eigenvalue, to 1 % or a tenth of neutral_eigenvalue.
struct EigenvalueBracket {
  double low;
  double high;
};

EigenvalueBracket bracket_smallest(const ConstrainedPencil& pencil) {
  EigenvalueBracket bracket{-1, 1};
  constexpr int most_doublings = 60;
  if (count_below(pencil, 0) > 0) {
    bracket.high = 0;
    for (int i = 0; i < most_doublings && count_below(pencil, bracket.low) > 0; ++i) {
      bracket.high = bracket.low;
      bracket.low *= 4;
    }
  } else {
    bracket.low = 0;
    for (int i = 0; i < most_doublings && count_below(pencil, bracket.high) == 0; ++i) {
      bracket.low = bracket.high;
      bracket.high *= 4;
    }
  }
  const auto wide = [&] {
    const double size = std::max(std::abs(bracket.low), std::abs(bracket.high));
    return bracket.high - bracket.low > std::max(0.01 * size, 0.1 * neutral_eigenvalue);
  };
  while (wide()) {
    const double middle = (bracket.low + bracket.high) / 2;
    (count_below(pencil, middle) > 0 ? bracket.high : bracket.low) = middle;
  }
  return bracket;
}

}  // namespace

SmallestMode smallest_mode(const ConstrainedPencil& pencil,
                           const std::function<double(const Eigen::VectorXd&)>& quotient) {
  SmallestMode result;
  result.negative = count_below(pencil, -neutral_eigenvalue);
  const int not_positive = count_below(pencil, neutral_eigenvalue);
  if (result.negative < 0 || not_positive < 0) return {.negative = -1};
  result.neutral = not_positive - result.negative;
  const EigenvalueBracket bracket = bracket_smallest(pencil);
  // The shift for inverse iteration is below the smallest eigenvalue.
  const double shift = bracket.low - (bracket.high - bracket.low) / 2;
  Factors factors;
  result.smallest = (bracket.low + bracket.high) / 2;
  if (!factorise(pencil, shift, factors)) return result;
  Eigen::VectorXd x(pencil.second.rows());
  for (Eigen::Index i = 0; i < x.size(); ++i) x[i] = std::sin(1.0 + 2.3 * static_cast<double>(i));
  for (int i = 0; i < 12; ++i) {
    const Eigen::VectorXd right = pencil.norm * x;
    x = factors.solve(right);
    x /= std::sqrt(x.dot(pencil.norm * x));
  }
  if (!x.allFinite()) return result;
  const double value = quotient(x);
  if (value >= bracket.low && value <= bracket.high) result.smallest = value;
  result.x = x;
  return result;
}

}  // namespace dlo::energy_model
