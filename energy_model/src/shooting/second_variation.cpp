#include "shooting/second_variation.hpp"

#include <Eigen/Geometry>
#include <Eigen/SparseCore>
#include <algorithm>
#include <cmath>
#include <vector>

#include "base/moves_for_nothing.hpp"
#include "shooting/constrained_pencil.hpp"
#include "shooting/lobatto_element.hpp"

namespace dlo::energy_model {
namespace {

using VariationTriplets = std::vector<Eigen::Triplet<double>>;

constexpr double longest_element = 1.0 / 16;  // [l]
constexpr double most_elements = 5000;
/// Elements that are short where the rod changes its shape over a short length, (EI / n)^(1/2).
Eigen::VectorXd elements_of(const RodSpan& span, const SpanStates& states) {
  constexpr int probes = 64;
  std::vector<double> s;
  s.reserve(probes);
  for (int i = 0; i < probes; ++i) s.push_back(span.length * (i + 0.5) / probes);
  const double soft = 1 / std::sqrt(std::max({1.0, total_load(span) / softest(span),
                                              largest_force(states(s), softest(span))}));
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

  [[nodiscard]] ConstrainedPencil pencil() const {
    return {second_, norm_, fixed_, constraints_ + (turn_unknown_ < 0 ? 0 : 1)};
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
      for (std::size_t a = 1; a < element_order; ++a) {
        s_.push_back(elements_[e] +
                     (elements_[e + 1] - elements_[e]) * (1 + element_lobatto[a]) / 2);
        first_unknown_.push_back(size_);
        size_ += 2;
      }
    }
    if (!span.twist) return;
    turn_unknown_ = size_++;
    turn_compliance_ = span.twist->compliance;
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
    const std::vector<RodState> inside = states(gauss_points(elements_));
    for (Eigen::Index e = 0; e < count; ++e) add_element(e, span, inside);
    for (const Eigen::Index multiplier : first_multiplier_) {
      for (Eigen::Index i = 0; i < 3; ++i) {
        fixed_triplets_.emplace_back(multiplier + i, multiplier + i, -constraint_compliance);
      }
    }
    if (turn_unknown_ < 0) return;
    fixed_triplets_.emplace_back(turn_unknown_, turn_unknown_, -turn_compliance_);
  }

  void add_element(Eigen::Index e, const RodSpan& span, const std::vector<RodState>& inside) {
    const double h = elements_[e + 1] - elements_[e];
    const double b = section_at(span, elements_[e] + h / 2).bending;
    constexpr Eigen::Index own = 2 * (element_order + 1);
    static const ElementBasis basis;
    Eigen::Matrix<double, own, own> second = Eigen::Matrix<double, own, own>::Zero();
    Eigen::Matrix<double, own, own> norm = Eigen::Matrix<double, own, own>::Zero();
    Eigen::Matrix<double, 3, own> integral = Eigen::Matrix<double, 3, own>::Zero();
    Eigen::Matrix<double, 1, own> turn = Eigen::Matrix<double, 1, own>::Zero();
    const auto first_node = static_cast<std::size_t>(e) * element_order;
    for (std::size_t q = 0; q < element_quadrature; ++q) {
      const RodState& state = inside[static_cast<std::size_t>(e) * element_quadrature + q];
      const Eigen::Vector3d& t = state.t;
      const Eigen::Vector3d& v = state.v;
      const double weight = h / 2 * element_weight[q];
      Eigen::Matrix<double, 3, own> eta;
      Eigen::Matrix<double, 3, own> rate;
      for (std::size_t a = 0; a <= element_order; ++a) {
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
      second += weight * (b * rates + (state.n.dot(t) - b * v.squaredNorm()) * values);
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

}  // namespace

void judge(const SecondVariation& stability, Equilibrium& shape) {
  shape.status = stability.stable() ? SolveStatus::converged : SolveStatus::saddle;
  shape.message = to_string(shape.status);
  shape.smallest_curvature = stability.smallest;
  shape.message += moves_for_nothing(stability.neutral);
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
  const SmallestMode mode = smallest_mode(
      variations.pencil(), [&](const Eigen::VectorXd& x) { return variations.second(x); });
  result.negative = mode.negative;
  result.neutral = mode.neutral;
  result.smallest = mode.smallest;
  if (mode.x.size() == 0) return result;
  result.direction = variations.tangents(mode.x);
  result.direction /= std::max(result.direction.colwise().norm().maxCoeff(), 1e-300);
  const std::vector<double>& nodes = variations.nodes();
  result.s =
      Eigen::Map<const Eigen::VectorXd>(nodes.data(), static_cast<Eigen::Index>(nodes.size()));
  return result;
}

}  // namespace dlo::energy_model
