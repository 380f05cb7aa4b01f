#include "shooting/second_variation.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "base/moves_for_nothing.hpp"
#include "shooting/lobatto_element.hpp"

namespace dlo::energy_model {
namespace {

constexpr double longest_element = 1.0 / 16;  // [l]
constexpr double most_elements = 5000;

Eigen::Matrix3d hat(const Eigen::Vector3d& v) {
  Eigen::Matrix3d matrix;
  for (Eigen::Index k = 0; k < 3; ++k) matrix.col(k) = v.cross(Eigen::Vector3d::Unit(k));
  return matrix;
}

/// Short where the rod changes its shape over a short length.
Eigen::VectorXd elements_of(const RodSpan& span, double force) {
  const double longest = std::min({span.length / 8, longest_element, 1 / std::sqrt(force)});
  return make_mesh(span, std::max(longest, span.length / most_elements)).s;
}

/// The matrices of second_variation().
class VariationProblem {
 public:
  VariationProblem(const RodSpan& span, const ClampFrames& frames, double force,
                   const SpanStates& states)
      : span_(span),
        free_twist_(span.round() && !span.twisted()),
        elements_(elements_of(span, force)) {
    number_unknowns(frames);
    if (free_twist_) leave_out_twist(states);
    const Eigen::Index count = elements_.size() - 1;
    const std::vector<RodState> inside = states(gauss_points(elements_));
    for (Eigen::Index e = 0; e < count; ++e) add_element(e, inside);
    for (const Eigen::Index multiplier : first_multiplier_) {
      for (Eigen::Index i = 0; i < 3; ++i) {
        fixed_.emplace_back(multiplier + i, multiplier + i, -constraint_compliance);
      }
    }
  }

  [[nodiscard]] bool finite() const { return finite_; }

  [[nodiscard]] ConstrainedPencil pencil() const {
    ConstrainedPencil result{Sparse(size_, size_), Sparse(size_, size_), Sparse(size_, size_),
                             static_cast<int>(3 * first_multiplier_.size())};
    result.second.setFromTriplets(second_.begin(), second_.end());
    result.norm.setFromTriplets(norm_.begin(), norm_.end());
    result.fixed.setFromTriplets(fixed_.begin(), fixed_.end());
    return result;
  }

  [[nodiscard]] Eigen::Matrix3Xd spins(const Eigen::VectorXd& x) const {
    Eigen::Matrix3Xd result(3, static_cast<Eigen::Index>(nodes_.size()));
    for (std::size_t k = 0; k < nodes_.size(); ++k) {
      const SpinNode& node = nodes_[k];
      result.col(static_cast<Eigen::Index>(k)) =
          node.basis * x.segment(node.first, node.basis.cols());
    }
    return result;
  }
  [[nodiscard]] Eigen::VectorXd arc_lengths() const {
    Eigen::VectorXd s(static_cast<Eigen::Index>(nodes_.size()));
    for (Eigen::Index k = 0; k < s.size(); ++k) s[k] = nodes_[static_cast<std::size_t>(k)].s;
    return s;
  }

 private:
  using VariationTriplets = std::vector<Eigen::Triplet<double>>;

  struct SpinNode {
    double s;
    Eigen::Matrix3Xd basis;  // of the spins that are free, one a column
    Eigen::Index first;      // unknown
  };

  /// Three unknowns a node, fewer at clamps; three multipliers after the nodes between two grips.
  void number_unknowns(const ClampFrames& frames) {
    const auto add_node = [&](double s) {
      Eigen::Matrix3Xd basis = Eigen::Matrix3d::Identity();
      if (const RodSpan::Clamp* clamp = span_.clamp_at(s)) {
        const bool held =
            free_twist_ || frames[static_cast<std::size_t>(clamp - span_.clamps.data())];
        basis = held ? Eigen::Matrix3Xd(3, 0) : Eigen::Matrix3Xd(clamp->direction);
      }
      if (free_twist_ && basis.cols() > 0) basis.resize(3, 2);
      nodes_.push_back({s, basis, size_});
      size_ += basis.cols();
    };
    std::size_t next_hold = 1;
    for (Eigen::Index e = 0; e < elements_.size(); ++e) {
      add_node(elements_[e]);
      if (next_hold < span_.holds.size() && span_.holds[next_hold].at <= elements_[e]) {
        first_multiplier_.push_back(size_);
        size_ += 3;
        ++next_hold;
      }
      if (e + 1 == elements_.size()) break;
      for (std::size_t a = 1; a < element_order; ++a) {
        add_node(elements_[e] + (elements_[e + 1] - elements_[e]) * (1 + element_lobatto[a]) / 2);
      }
    }
  }

  /// Spins across the tangents alone.
  void leave_out_twist(const SpanStates& states) {
    const Eigen::VectorXd s = arc_lengths();
    const std::vector<RodState> at_nodes = states({s.begin(), s.end()});
    for (std::size_t k = 0; k < nodes_.size(); ++k) {
      if (nodes_[k].basis.cols() > 0) nodes_[k].basis = at_nodes[k].R.leftCols<2>();
      finite_ = finite_ && at_nodes[k].R.allFinite();
    }
  }

  void add_element(Eigen::Index e, const std::vector<RodState>& inside) {
    static const ElementBasis basis;
    constexpr Eigen::Index own = 3 * (element_order + 1);
    const double h = elements_[e + 1] - elements_[e];
    RodSection section = section_at(span_, elements_[e] + h / 2);
    if (free_twist_) section.torsion = 0;
    Eigen::Matrix<double, own, own> second = Eigen::Matrix<double, own, own>::Zero();
    Eigen::Matrix<double, own, own> norm = Eigen::Matrix<double, own, own>::Zero();
    Eigen::Matrix<double, 3, own> integral = Eigen::Matrix<double, 3, own>::Zero();
    for (std::size_t q = 0; q < element_quadrature; ++q) {
      const RodState& state = inside[static_cast<std::size_t>(e) * element_quadrature + q];
      const double weight = h / 2 * element_weight[q];
      const Eigen::Matrix3d stiffness = stiffness_of(section, state.R);
      const Eigen::Matrix3d moment = hat(state.m);
      const Eigen::Matrix3d outer = state.n * state.t().transpose();
      const Eigen::Matrix3d force =
          outer.trace() * Eigen::Matrix3d::Identity() - (outer + outer.transpose()) / 2;
      const auto row = static_cast<Eigen::Index>(q);
      for (Eigen::Index a = 0; a <= static_cast<Eigen::Index>(element_order); ++a) {
        const double value = basis.value(row, a);
        const double rate = 2 / h * basis.rate(row, a);
        integral.middleCols<3>(3 * a) -= weight * value * hat(state.t());
        for (Eigen::Index b = 0; b <= static_cast<Eigen::Index>(element_order); ++b) {
          const double other = basis.value(row, b);
          const double other_rate = 2 / h * basis.rate(row, b);
          second.block<3, 3>(3 * a, 3 * b) +=
              weight * (rate * other_rate * stiffness + value * other * force -
                        (rate * other - value * other_rate) / 2 * moment);
          norm.block<3, 3>(3 * a, 3 * b).diagonal().array() +=
              weight * (rate * other_rate + value * other);
        }
      }
    }
    finite_ = finite_ && second.allFinite();
    const Eigen::Index multiplier = multiplier_at(elements_[e] + h / 2);
    const std::size_t first = static_cast<std::size_t>(e) * element_order;
    for (std::size_t a = 0; a <= element_order; ++a) {
      const SpinNode& node = nodes_[first + a];
      const auto at = static_cast<Eigen::Index>(3 * a);
      for (std::size_t b = 0; b <= element_order; ++b) {
        const SpinNode& other = nodes_[first + b];
        const auto to = static_cast<Eigen::Index>(3 * b);
        add(second_, node.first, other.first,
            node.basis.transpose() * second.block<3, 3>(at, to) * other.basis);
        add(norm_, node.first, other.first,
            node.basis.transpose() * norm.block<3, 3>(at, to) * other.basis);
      }
      if (multiplier < 0) continue;
      const Eigen::MatrixXd seen = integral.middleCols<3>(at) * node.basis;
      add(fixed_, multiplier, node.first, seen);
      add(fixed_, node.first, multiplier, seen.transpose());
    }
  }

  static void add(VariationTriplets& triplets, Eigen::Index row, Eigen::Index column,
                  const Eigen::MatrixXd& block) {
    for (Eigen::Index i = 0; i < block.rows(); ++i) {
      for (Eigen::Index j = 0; j < block.cols(); ++j) {
        triplets.emplace_back(static_cast<int>(row + i), static_cast<int>(column + j), block(i, j));
      }
    }
  }

  /// Of the constraint that an arc length between two grips belongs to; -1 beyond them.
  [[nodiscard]] Eigen::Index multiplier_at(double s) const {
    const std::vector<RodSpan::Hold>& holds = span_.holds;
    const auto next =
        std::upper_bound(holds.begin(), holds.end(), s,
                         [](double at, const RodSpan::Hold& hold) { return at < hold.at; });
    if (next == holds.begin() || next == holds.end()) return -1;
    return first_multiplier_[static_cast<std::size_t>(next - holds.begin()) - 1];
  }

  const RodSpan& span_;
  bool free_twist_;           // nothing holds it: spins about the tangent are no unknowns
  Eigen::VectorXd elements_;  // their ends
  std::vector<SpinNode> nodes_;
  std::vector<Eigen::Index> first_multiplier_;
  Eigen::Index size_ = 0;
  bool finite_ = true;
  VariationTriplets second_, norm_, fixed_;
};

}  // namespace

void judge(const SecondVariation& stability, Equilibrium& shape) {
  shape.status = stability.stable() ? SolveStatus::converged : SolveStatus::saddle;
  shape.message = to_string(shape.status);
  shape.smallest_eigenvalue = stability.smallest;
  shape.message += moves_for_nothing(stability.neutral);
}

Eigen::Matrix3Xd SecondVariation::spin_at(const Eigen::VectorXd& at) const {
  Eigen::Matrix3Xd result(3, at.size());
  for (Eigen::Index i = 0; i < at.size(); ++i) {
    const Eigen::Index after = std::clamp<Eigen::Index>(
        std::upper_bound(s.begin(), s.end(), at[i]) - s.begin(), 1, s.size() - 1);
    const double part = (at[i] - s[after - 1]) / (s[after] - s[after - 1]);
    result.col(i) = (1 - part) * spin.col(after - 1) + part * spin.col(after);
  }
  return result;
}

SecondVariation second_variation(const RodSpan& span, const ClampFrames& frames, double force,
                                 const SpanStates& states) {
  const VariationProblem variations(span, frames, force, states);
  SecondVariation result;
  if (!variations.finite()) return result;
  const ConstrainedPencil pencil = variations.pencil();
  const SmallestMode mode =
      smallest_mode(pencil, [&](const Eigen::VectorXd& x) { return x.dot(pencil.second * x); });
  result.negative = mode.negative;
  result.neutral = mode.neutral;
  result.smallest = mode.smallest;
  if (mode.x.size() == 0) return result;
  result.spin = variations.spins(mode.x);
  result.spin /= std::max(result.spin.colwise().norm().maxCoeff(), 1e-300);
  result.s = variations.arc_lengths();
  return result;
}

}  // namespace dlo::energy_model
