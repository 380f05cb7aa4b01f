#include "second_variation.hpp"

#include <Eigen/Geometry>
#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>
#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

namespace dlo::energy_model {
namespace {

using Sparse = Eigen::SparseMatrix<double>;
using VariationTriplets = std::vector<Eigen::Triplet<double>>;

constexpr std::size_t order = 4;              // of the elements' polynomials
constexpr std::size_t quadrature_nodes = 6;   // exact to order 11
constexpr double longest_element = 1.0 / 16;  // [l]
constexpr double most_elements = 5000;
/// Weight of the constraints' own block: far below what the constraints see (1 / |C|^2), far above
/// rounding.
constexpr double compliance = 1e-12;

/// Gauss-Lobatto nodes of an element on [-1, 1].
const std::array<double, order + 1> lobatto = {-1, -std::sqrt(3.0 / 7.0), 0, std::sqrt(3.0 / 7.0),
                                               1};
/// Gauss-Legendre nodes and weights on [-1, 1] (Abramowitz and Stegun, table 25.4).
constexpr std::array<double, quadrature_nodes> gauss = {
    -0.932469514203152028, -0.661209386466264514, -0.238619186083196909,
    0.238619186083196909,  0.661209386466264514,  0.932469514203152028};
constexpr std::array<double, quadrature_nodes> gauss_weight = {
    0.171324492379170345, 0.360761573048138608, 0.467913934572691047,
    0.467913934572691047, 0.360761573048138608, 0.171324492379170345};

/// Lagrange's polynomials on the Lobatto nodes, and their derivatives, at the Gauss nodes.
struct ElementBasis {
  Eigen::Matrix<double, quadrature_nodes, order + 1> value;
  Eigen::Matrix<double, quadrature_nodes, order + 1> rate;

  ElementBasis() {
    for (std::size_t q = 0; q < quadrature_nodes; ++q) {
      for (std::size_t a = 0; a <= order; ++a) {
        double product = 1;
        double sum = 0;
        for (std::size_t b = 0; b <= order; ++b) {
          if (b == a) continue;
          const double factor = 1 / (lobatto[a] - lobatto[b]);
          sum = sum * (gauss[q] - lobatto[b]) * factor + product * factor;
          product *= (gauss[q] - lobatto[b]) * factor;
        }
        value(static_cast<Eigen::Index>(q), static_cast<Eigen::Index>(a)) = product;
        rate(static_cast<Eigen::Index>(q), static_cast<Eigen::Index>(a)) = sum;
      }
    }
  }
};

/// Elements that are short where the rod changes its shape over a short length, (EI / n)^(1/2).
Eigen::VectorXd elements_of(const RodSpan& span, const SpanStates& states) {
  constexpr int probes = 64;
  std::vector<double> s;
  s.reserve(probes);
  for (int i = 0; i < probes; ++i) s.push_back(span.length * (i + 0.5) / probes);
  const double soft = 1 / std::sqrt(std::max({1.0, total_load(span), largest_force(states(s))}));
  const double longest = std::min({span.length / 8, longest_element, soft});
  return make_mesh(span, std::max(longest, span.length / most_elements)).s;
}

/// Mass and stiffness of the variations of a span, its constraints and what couples all of it.
class VariationProblem {
 public:
  VariationProblem(const RodSpan& span, const SpanStates& states)
      : elements_(elements_of(span, states)) {
    number_unknowns(span);
    make_bases(states);
    add_elements(span, states);
    second_.resize(size_, size_);
    second_.setFromTriplets(second_triplets_.begin(), second_triplets_.end());
    norm_.resize(size_, size_);
    norm_.setFromTriplets(norm_triplets_.begin(), norm_triplets_.end());
    fixed_.resize(size_, size_);
    fixed_.setFromTriplets(fixed_triplets_.begin(), fixed_triplets_.end());
  }

  using Factors = Eigen::SimplicialLDLT<Sparse, Eigen::Lower, Eigen::NaturalOrdering<int>>;

  /// Factors of the matrix of the header's formula. @return false if a pivot is zero
  [[nodiscard]] bool factorise(double mu, Factors& factors) const {
    factors.compute(second_ - mu * norm_ + fixed_);
    return factors.info() == Eigen::Success && factors.vectorD().allFinite();
  }

  /// Number of eigenvalues below mu.
  [[nodiscard]] int count_below(double mu) const {
    Factors factors;
    // A pivot is zero on a set of mu that a small change leaves.
    for (int attempt = 0; attempt < 5; ++attempt) {
      if (factorise(mu, factors)) {
        const auto negative = (factors.vectorD().array() < 0).count();
        return static_cast<int>(negative) - constraints_ - (turn_unknown_ < 0 ? 0 : 1);
      }
      mu -= 1e-3 * neutral_eigenvalue * (1 + attempt);
    }
    return 0;
  }

  [[nodiscard]] bool finite() const { return finite_; }
  /// Q of a vector of unknowns.
  [[nodiscard]] double second(const Eigen::VectorXd& x) const {
    const double bends = x.dot(second_ * x);
    if (turn_unknown_ < 0) return bends;
    // The column of its unknown, without its own element.
    const double turn = fixed_.col(turn_unknown_).dot(x) + turn_compliance_ * x[turn_unknown_];
    return bends + turn * turn / turn_compliance_;
  }
  [[nodiscard]] const Sparse& norm() const { return norm_; }
  [[nodiscard]] Eigen::Index size() const { return size_; }

  /// Changes of the tangents at the nodes of a vector of unknowns.
  [[nodiscard]] Eigen::Matrix3Xd tangents(const Eigen::VectorXd& x) const {
    Eigen::Matrix3Xd result = Eigen::Matrix3Xd::Zero(3, static_cast<Eigen::Index>(s_.size()));
    for (std::size_t k = 0; k < s_.size(); ++k) {
      if (first_unknown_[k] < 0) continue;
      result.col(static_cast<Eigen::Index>(k)) = across_[k] * x.segment<2>(first_unknown_[k]);
    }
    return result;
  }
  [[nodiscard]] const std::vector<double>& nodes() const { return s_; }

 private:
  /// Two unknowns a node, none at clamps; three multipliers after the nodes between two grips; last
  /// the one of the twist.
  void number_unknowns(const RodSpan& span) {
    const Eigen::Index count = elements_.size() - 1;
    std::size_t next_hold = 1;
    for (Eigen::Index e = 0; e <= count; ++e) {
      const bool clamped = (e == 0 && span.start_direction) || (e == count && span.end_direction);
      s_.push_back(elements_[e]);
      first_unknown_.push_back(clamped ? -1 : size_);
      if (!clamped) size_ += 2;
      if (next_hold < span.holds.size() && span.holds[next_hold].at <= elements_[e]) {
        first_multiplier_.push_back(size_);
        size_ += 3;
        constraints_ += 3;
        ++next_hold;
      }
      if (e == count) break;
      for (std::size_t a = 1; a < order; ++a) {
        s_.push_back(elements_[e] + (elements_[e + 1] - elements_[e]) * (1 + lobatto[a]) / 2);
        first_unknown_.push_back(size_);
        size_ += 2;
      }
    }
    if (!span.twist) return;
    turn_unknown_ = size_++;
    turn_compliance_ = span.length / span.twist->stiffness;
  }

  void make_bases(const SpanStates& states) {
    for (const RodState& state : states(s_)) {
      finite_ = finite_ && state.t.allFinite();
      const Eigen::Vector3d first = state.t.unitOrthogonal();
      Eigen::Matrix<double, 3, 2> basis;
      basis << first, state.t.cross(first);
      across_.push_back(basis);
    }
  }

  void add_elements(const RodSpan& span, const SpanStates& states) {
    const Eigen::Index count = elements_.size() - 1;
    std::vector<double> inner;
    for (Eigen::Index e = 0; e < count; ++e) {
      for (const double x : gauss) {
        inner.push_back(elements_[e] + (elements_[e + 1] - elements_[e]) * (1 + x) / 2);
      }
    }
    const std::vector<RodState> inside = states(inner);
    for (Eigen::Index e = 0; e < count; ++e) add_element(e, span, inside);
    for (const Eigen::Index multiplier : first_multiplier_) {
      for (Eigen::Index i = 0; i < 3; ++i) {
        fixed_triplets_.emplace_back(multiplier + i, multiplier + i, -compliance);
      }
    }
    if (turn_unknown_ < 0) return;
    fixed_triplets_.emplace_back(turn_unknown_, turn_unknown_, -turn_compliance_);
  }

  void add_element(Eigen::Index e, const RodSpan& span, const std::vector<RodState>& inside) {
    const double h = elements_[e + 1] - elements_[e];
    constexpr Eigen::Index own = 2 * (order + 1);
    static const ElementBasis basis;
    Eigen::Matrix<double, own, own> second = Eigen::Matrix<double, own, own>::Zero();
    Eigen::Matrix<double, own, own> norm = Eigen::Matrix<double, own, own>::Zero();
    Eigen::Matrix<double, 3, own> integral = Eigen::Matrix<double, 3, own>::Zero();
    Eigen::Matrix<double, 1, own> turn = Eigen::Matrix<double, 1, own>::Zero();
    const auto first_node = static_cast<std::size_t>(e) * order;
    for (std::size_t q = 0; q < quadrature_nodes; ++q) {
      const RodState& state = inside[static_cast<std::size_t>(e) * quadrature_nodes + q];
      const Eigen::Vector3d& t = state.t;
      const Eigen::Vector3d& v = state.v;
      const double weight = h / 2 * gauss_weight[q];
      Eigen::Matrix<double, 3, own> eta;
      Eigen::Matrix<double, 3, own> rate;
      for (std::size_t a = 0; a <= order; ++a) {
        const auto row = static_cast<Eigen::Index>(q);
        const auto node = static_cast<Eigen::Index>(a);
        const Eigen::Matrix<double, 3, 2> z = basis.value(row, node) * across_[first_node + a];
        const Eigen::Matrix<double, 3, 2> dz =
            basis.rate(row, node) * 2 / h * across_[first_node + a];
        // The part across the tangent of what is interpolated, and its derivative.
        eta.middleCols<2>(2 * node) = z - t * (t.transpose() * z);
        rate.middleCols<2>(2 * node) =
            dz - t * (v.transpose() * z + t.transpose() * dz) - v * (t.transpose() * z);
      }
      const Eigen::Matrix<double, own, own> rates = rate.transpose() * rate;
      const Eigen::Matrix<double, own, own> values = eta.transpose() * eta;
      second += weight * (rates + (state.n.dot(t) - v.squaredNorm()) * values);
      norm += weight * (rates + values);
      integral += weight * eta;
      turn += weight * t.cross(v).transpose() * eta;
      if (state.torque == 0) continue;
      Eigen::Matrix<double, 3, own> turned;  // eta x t
      for (Eigen::Index i = 0; i < own; ++i) turned.col(i) = eta.col(i).cross(t);
      const Eigen::Matrix<double, own, own> twists = rate.transpose() * turned;
      second += weight * state.torque / 2 * (twists + twists.transpose());
    }
    finite_ = finite_ && second.allFinite();
    const Eigen::Index multiplier = multiplier_of(elements_[e] + h / 2, span);
    for (Eigen::Index i = 0; i < own; ++i) {
      const Eigen::Index row = unknown(first_node, i);
      if (row < 0) continue;
      for (Eigen::Index j = 0; j < own; ++j) {
        const Eigen::Index column = unknown(first_node, j);
        if (column < 0) continue;
        second_triplets_.emplace_back(row, column, second(i, j));
        norm_triplets_.emplace_back(row, column, norm(i, j));
      }
      for (Eigen::Index k = 0; k < 3 && multiplier >= 0; ++k) {
        fixed_triplets_.emplace_back(row, multiplier + k, integral(k, i));
        fixed_triplets_.emplace_back(multiplier + k, row, integral(k, i));
      }
      if (turn_unknown_ < 0) continue;
      fixed_triplets_.emplace_back(row, turn_unknown_, turn[i]);
      fixed_triplets_.emplace_back(turn_unknown_, row, turn[i]);
    }
  }

  [[nodiscard]] Eigen::Index unknown(std::size_t first_node, Eigen::Index i) const {
    const Eigen::Index first = first_unknown_[first_node + static_cast<std::size_t>(i / 2)];
    return first < 0 ? -1 : first + i % 2;
  }

  /// Of the constraint that an arc length between two grips belongs to; -1 beyond them.
  [[nodiscard]] Eigen::Index multiplier_of(double s, const RodSpan& span) const {
    const auto next =
        std::upper_bound(span.holds.begin(), span.holds.end(), s,
                         [](double at, const RodSpan::Hold& hold) { return at < hold.at; });
    if (next == span.holds.begin() || next == span.holds.end()) return -1;
    return first_multiplier_[static_cast<std::size_t>(next - span.holds.begin()) - 1];
  }

  Eigen::VectorXd elements_;  // their ends
  std::vector<double> s_;     // nodes
  std::vector<Eigen::Index> first_unknown_;
  std::vector<Eigen::Index> first_multiplier_;
  std::vector<Eigen::Matrix<double, 3, 2>> across_;
  Eigen::Index size_ = 0;
  int constraints_ = 0;
  Eigen::Index turn_unknown_ = -1;  // -1: nothing holds the twist
  double turn_compliance_ = 0;
  bool finite_ = true;
  VariationTriplets second_triplets_, norm_triplets_, fixed_triplets_;
  Sparse second_, norm_, fixed_;
};

/// Bounds of the smallest eigenvalue, to 1 % or a tenth of what counts as zero.
struct Bracket {
  double low;
  double high;
};

Bracket bracket_smallest(const VariationProblem& variations) {
  Bracket bracket{-1, 1};
  constexpr int most_doublings = 60;
  if (variations.count_below(0) > 0) {
    bracket.high = 0;
    for (int i = 0; i < most_doublings && variations.count_below(bracket.low) > 0; ++i) {
      bracket.high = bracket.low;
      bracket.low *= 4;
    }
  } else {
    bracket.low = 0;
    for (int i = 0; i < most_doublings && variations.count_below(bracket.high) == 0; ++i) {
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
    (variations.count_below(middle) > 0 ? bracket.high : bracket.low) = middle;
  }
  return bracket;
}

}  // namespace

void judge(const SecondVariation& stability, Equilibrium& shape) {
  shape.status = stability.stable() ? SolveStatus::converged : SolveStatus::saddle;
  shape.message = to_string(shape.status);
  shape.smallest_curvature = stability.smallest;
  if (stability.neutral == 0) return;
  shape.message += ", moves for nothing in " + std::to_string(stability.neutral) +
                   (stability.neutral == 1 ? " way" : " ways");
}

Eigen::Matrix3Xd mode_at(const SecondVariation& variation, const Eigen::VectorXd& s) {
  Eigen::Matrix3Xd result(3, s.size());
  for (Eigen::Index i = 0; i < s.size(); ++i) {
    const Eigen::Index after = std::clamp<Eigen::Index>(
        std::upper_bound(variation.s.begin(), variation.s.end(), s[i]) - variation.s.begin(), 1,
        variation.s.size() - 1);
    const double part =
        (s[i] - variation.s[after - 1]) / (variation.s[after] - variation.s[after - 1]);
    result.col(i) =
        (1 - part) * variation.direction.col(after - 1) + part * variation.direction.col(after);
  }
  return result;
}

SecondVariation second_variation(const RodSpan& span, const SpanStates& states) {
  const VariationProblem variations(span, states);
  SecondVariation result;
  if (!variations.finite()) return result;
  result.negative = variations.count_below(-neutral_eigenvalue);
  result.neutral = variations.count_below(neutral_eigenvalue) - result.negative;
  const Bracket bracket = bracket_smallest(variations);
  // Inverse iteration from below the smallest eigenvalue.
  const double shift = bracket.low - (bracket.high - bracket.low) / 2;
  VariationProblem::Factors factors;
  result.smallest = (bracket.low + bracket.high) / 2;
  if (!variations.factorise(shift, factors)) return result;
  Eigen::VectorXd x(variations.size());
  for (Eigen::Index i = 0; i < x.size(); ++i) x[i] = std::sin(1.0 + 2.3 * static_cast<double>(i));
  constexpr int iterations = 12;
  for (int i = 0; i < iterations; ++i) {
    const Eigen::VectorXd right = variations.norm() * x;
    x = factors.solve(right);
    x /= std::sqrt(x.dot(variations.norm() * x));
  }
  if (!x.allFinite()) return result;
  const double quotient = variations.second(x);
  if (quotient >= bracket.low && quotient <= bracket.high) result.smallest = quotient;
  result.direction = variations.tangents(x);
  result.direction /= std::max(result.direction.colwise().norm().maxCoeff(), 1e-300);
  const std::vector<double>& nodes = variations.nodes();
  result.s =
      Eigen::Map<const Eigen::VectorXd>(nodes.data(), static_cast<Eigen::Index>(nodes.size()));
  return result;
}

}  // namespace dlo::energy_model
