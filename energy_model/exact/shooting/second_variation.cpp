#include "shooting/second_variation.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "base/lobatto_element.hpp"
#include "base/spin.hpp"

namespace dlo::energy_model {
namespace {

constexpr double longest_element = 1.0 / 16;  // [l]
constexpr double most_elements = 5000;

/// Returns the ends of the elements, which are short where the force bends the rod over a short
/// length.
Eigen::VectorXd elements_of(const RodSpan& span, const RodMesh& mesh, double force) {
  const double longest = std::min({span.length / 8, longest_element, 1 / std::sqrt(force)});
  std::vector<double> touched;
  for (const RodContact& contact : mesh.contacts.nodes) touched.push_back(mesh.s[contact.node]);
  return make_mesh(span, std::max(longest, span.length / most_elements), touched).s;
}

/// Assembles the matrices of second_variation().
class VariationProblem {
 public:
  VariationProblem(const RodSpan& span, const RodMesh& mesh, const ClampFrames& frames,
                   double force, const SpanStates& states)
      : span_(span),
        mesh_(mesh),
        free_twist_(span.round() && !span.twisted()),
        in_plane_(span.has_couples() && span.plane),
        elements_(elements_of(span, mesh, force)) {
    const Eigen::Index count = elements_.size() - 1;
    std::vector<RodState> at_ends;
    if (has_contacts()) at_ends = states({elements_.begin(), elements_.end()});
    number_unknowns(frames, at_ends);
    if (free_twist_ && !in_plane_) omit_twist(states);
    const std::vector<RodState> inside = states(gauss_points(elements_));
    for (Eigen::Index e = 0; e < count; ++e) add_element(e, inside);
    for (std::size_t k = 0; k + 1 < places_.size(); ++k)
      add_position_constraint(places_[k], places_[k + 1]);
    for (const RodContact& contact : mesh.contacts.nodes) add_contact(contact, at_ends);
  }

  [[nodiscard]] bool finite() const { return finite_; }

  [[nodiscard]] ConstrainedPencil pencil() const {
    ConstrainedPencil result{Sparse(size_, size_), Sparse(size_, size_), Sparse(size_, size_),
                             static_cast<int>(3 * (places_.size() - 1))};
    result.second.setFromTriplets(second_.begin(), second_.end());
    result.norm.setFromTriplets(norm_.begin(), norm_.end());
    result.constraint_blocks.setFromTriplets(fixed_.begin(), fixed_.end());
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
    Eigen::Matrix3Xd basis;  // free spins, one per column
    Eigen::Index first;      // index of the first unknown
  };

  /// Point at which dr is zero, at a grip, or tangential to an obstacle.
  struct ConstrainedPosition {
    Eigen::Index end;         // index of an element's end
    Eigen::Matrix3Xd basis;   // free directions of dr, one per column
    Eigen::Matrix3d hessian;  // Hessian of the gap to the obstacle
    Eigen::Index first;       // index of the first unknown
    // Index of the multiplier of dr - (dr at the previous place) = int eta x t ds.
    Eigen::Index multiplier;
  };

  [[nodiscard]] bool has_contacts() const {
    return !mesh_.contacts.nodes.empty() || !mesh_.contacts.surface.empty();
  }

  /// Returns the contact at an element's end; null: none.
  [[nodiscard]] const RodContact* contact_at(Eigen::Index end) const {
    const auto found = std::ranges::find_if(mesh_.contacts.nodes, [&](const RodContact& contact) {
      return mesh_.s[contact.node] == elements_[end];
    });
    return found == mesh_.contacts.nodes.end() ? nullptr : &*found;
  }

  /// Returns the surface on which an element lies; null: none.
  [[nodiscard]] const Surface* surface_of(Eigen::Index element) const {
    if (!has_contacts()) return nullptr;
    const double middle = (elements_[element] + elements_[element + 1]) / 2;
    const auto after = std::upper_bound(mesh_.s.begin(), mesh_.s.end(), middle) - mesh_.s.begin();
    return mesh_.contacts.surface_of(after - 1);
  }

  /// Returns the gap to the obstacle that the rod touches at an element's end; std::nullopt: it
  /// touches none.
  [[nodiscard]] std::optional<obstacle::Gap> gap_at(Eigen::Index end, const RodState& state) const {
    if (const RodContact* contact = contact_at(end)) return contact->gap(state.r);
    const Surface* surface = end + 1 < elements_.size() ? surface_of(end) : nullptr;
    if (surface == nullptr && end > 0) surface = surface_of(end - 1);
    if (surface == nullptr) return std::nullopt;
    return surface->gap(state.r);
  }

  /// Numbers the unknowns: three per node, fewer at clamps; at a place those of dr, and three
  /// multipliers except at the first place.
  void number_unknowns(const ClampFrames& frames, const std::vector<RodState>& at_ends) {
    const auto add_node = [&](double s) {
      Eigen::Matrix3Xd basis = Eigen::Matrix3d::Identity();
      if (const RodSpan::Clamp* clamp = span_.clamp_at(s)) {
        const bool is_fixed =
            free_twist_ || frames[static_cast<std::size_t>(clamp - span_.clamps.data())];
        basis = is_fixed ? Eigen::Matrix3Xd(3, 0) : Eigen::Matrix3Xd(clamp->direction);
      }
      if (free_twist_ && basis.cols() > 0) basis.resize(3, 2);
      if (in_plane_ && basis.cols() > 0) basis = span_.plane->x.cross(span_.plane->y);
      if (in_plane_ && span_.clamp_at(s) != nullptr) basis.resize(3, 0);
      nodes_.push_back({s, basis, size_});
      size_ += basis.cols();
    };
    std::size_t next_hold = 0;
    for (Eigen::Index e = 0; e < elements_.size(); ++e) {
      add_node(elements_[e]);
      if (next_hold < span_.holds.size() && span_.holds[next_hold].at <= elements_[e]) {
        add_place(e, Eigen::Matrix3Xd(3, 0), Eigen::Matrix3d::Zero());
        ++next_hold;
      } else if (has_contacts()) {
        const auto gap = gap_at(e, at_ends[static_cast<std::size_t>(e)]);
        if (gap) {
          const Eigen::Vector3d& normal = gap->gradient;
          add_place(e, frame_along(normal, normal.unitOrthogonal()).leftCols<2>(), gap->hessian);
        }
      }
      if (e + 1 == elements_.size()) break;
      for (std::size_t a = 1; a < element_order; ++a) {
        add_node(elements_[e] + (elements_[e + 1] - elements_[e]) * (1 + element_lobatto[a]) / 2);
      }
    }
  }

  /// Adds a ConstrainedPosition with its unknowns. Multipliers precede dr, because dr has a pivot
  /// only through them.
  void add_place(Eigen::Index end, const Eigen::Matrix3Xd& basis, const Eigen::Matrix3d& hessian) {
    const Eigen::Index multipliers = places_.empty() ? 0 : 3;
    places_.push_back({end, basis, hessian, size_ + multipliers, size_});
    size_ += multipliers + basis.cols();
  }

  /// Restricts spins to directions across the tangents.
  void omit_twist(const SpanStates& states) {
    const Eigen::VectorXd s = arc_lengths();
    const std::vector<RodState> at_nodes = states({s.begin(), s.end()});
    for (std::size_t k = 0; k < nodes_.size(); ++k) {
      if (nodes_[k].basis.cols() > 0) nodes_[k].basis = at_nodes[k].R.leftCols<2>();
      finite_ = finite_ && at_nodes[k].R.allFinite();
    }
  }

  /// Sums of an element by the spins of its nodes: second derivatives, norm, and the integral of
  /// dr' between its ends.
  struct ElementSums {
    static constexpr Eigen::Index unknowns = 3 * (element_order + 1);
    Eigen::Matrix<double, unknowns, unknowns> second =
        Eigen::Matrix<double, unknowns, unknowns>::Zero();
    Eigen::Matrix<double, unknowns, unknowns> norm =
        Eigen::Matrix<double, unknowns, unknowns>::Zero();
    Eigen::Matrix<double, 3, unknowns> integral = Eigen::Matrix<double, 3, unknowns>::Zero();
  };

  void add_element(Eigen::Index e, const std::vector<RodState>& inside) {
    static const ElementBasis basis;
    const double h = elements_[e + 1] - elements_[e];
    RodSection section = section_at(span_, elements_[e] + h / 2);
    if (free_twist_) section.torsion = 0;
    ElementSums sums;
    auto& [second, norm, integral] = sums;
    Eigen::Matrix3d yields = Eigen::Matrix3d::Zero();
    for (std::size_t q = 0; q < element_quadrature; ++q) {
      const RodState& state = inside[static_cast<std::size_t>(e) * element_quadrature + q];
      const double weight = h / 2 * element_weight[q];
      const Eigen::Matrix3d stiffness =
          state.R * section.stiffness().asDiagonal() * state.R.transpose();
      const Eigen::Matrix3d moment = cross_matrix(state.m);
      const Eigen::Matrix3d outer = state.n * state.t().transpose();
      Eigen::Matrix3d force =
          outer.trace() * Eigen::Matrix3d::Identity() - (outer + outer.transpose()) / 2;
      Eigen::Matrix3d moved = -cross_matrix(state.t());  // dr' by eta
      if (section.stretch > 0) {
        const Eigen::Vector3d turned = state.t().cross(state.n);
        const double along = 1 + section.stretch * outer.trace();
        force = along * force - section.stretch * turned * turned.transpose();
        moved = along * moved + section.stretch * state.t() * turned.transpose();
        yields += weight * section.stretch * state.t() * state.t().transpose();
      }
      const auto row = static_cast<Eigen::Index>(q);
      for (Eigen::Index a = 0; a <= static_cast<Eigen::Index>(element_order); ++a) {
        const double value = basis.value(row, a);
        const double rate = 2 / h * basis.rate(row, a);
        integral.middleCols<3>(3 * a) += weight * value * moved;
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
    add_surface_curvature(e, inside);
    const Eigen::Index multiplier = multiplier_of(e);
    if (section.stretch > 0 && multiplier >= 0) add(fixed_, multiplier, multiplier, -yields);
    distribute(e, sums);
  }

  void distribute(Eigen::Index e, const ElementSums& sums) {
    const auto& [second, norm, integral] = sums;
    const Eigen::Index multiplier = multiplier_of(e);
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
      const Eigen::MatrixXd block = integral.middleCols<3>(at) * node.basis;
      add(fixed_, multiplier, node.first, block);
      add(fixed_, node.first, multiplier, block.transpose());
    }
  }

  /// Adds the curvature of the surface on which an element lies, with half of the pressure at
  /// either end.
  void add_surface_curvature(Eigen::Index e, const std::vector<RodState>& inside) {
    const Surface* surface = surface_of(e);
    if (surface == nullptr) return;
    const double h = elements_[e + 1] - elements_[e];
    const RodSection& section = section_at(span_, elements_[e] + h / 2);
    double force = 0;
    for (std::size_t q = 0; q < element_quadrature; ++q) {
      const RodState& state = inside[static_cast<std::size_t>(e) * element_quadrature + q];
      force += h / 2 * element_weight[q] * pressure(*surface, section, state);
    }
    for (const Eigen::Index end : {e, e + 1}) {
      if (const ConstrainedPosition* place = place_at(end)) add_gap_curvature(*place, force / 2);
    }
  }

  /// Adds minus f dr.(H dr) to the second variation.
  void add_gap_curvature(const ConstrainedPosition& place, double force) {
    add(second_, place.first, place.first,
        -force * place.basis.transpose() * place.hessian * place.basis);
  }

  void add_contact(const RodContact& contact, const std::vector<RodState>& at_ends) {
    const Eigen::Index end = node_at(elements_, mesh_.s[contact.node]);
    const ConstrainedPosition& place = *place_at(end);
    const RodState& state = at_ends[static_cast<std::size_t>(end)];
    const obstacle::Gap gap = contact.gap(state.r);
    add_gap_curvature(place, contact.force);
    if (!contact.touched || !contact.is_position_unknown) return;
    const Eigen::Vector3d t = state.t();
    const Eigen::Vector3d along = gap.hessian * t;
    const Eigen::Vector3d bent = curvature_of(section_at(span_, mesh_.s[contact.node]),
                                              span_.natural, elements_[end], state);
    const double opening = gap.gradient.dot(bent) + t.dot(along);
    const SpinNode& node = nodes_[static_cast<std::size_t>(end) * element_order];
    const Eigen::MatrixXd by_spin = t.cross(gap.gradient).transpose() * node.basis;
    const Eigen::MatrixXd by_place = along.transpose() * place.basis;
    const double share = contact.force / opening;
    add(second_, node.first, node.first, share * by_spin.transpose() * by_spin);
    add(second_, node.first, place.first, share * by_spin.transpose() * by_place);
    add(second_, place.first, node.first, share * by_place.transpose() * by_spin);
    add(second_, place.first, place.first, share * by_place.transpose() * by_place);
  }

  /// Adds the parts of the constraint between two neighbouring places that contain their dr.
  void add_position_constraint(const ConstrainedPosition& before,
                               const ConstrainedPosition& after) {
    for (Eigen::Index i = 0; i < 3; ++i) {
      fixed_.emplace_back(after.multiplier + i, after.multiplier + i, -constraint_compliance);
    }
    for (const auto& [place, sign] : {std::pair{&before, 1.0}, std::pair{&after, -1.0}}) {
      add(fixed_, after.multiplier, place->first, sign * place->basis);
      add(fixed_, place->first, after.multiplier, sign * place->basis.transpose());
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

  /// Returns the place at an element's end; null: none.
  [[nodiscard]] const ConstrainedPosition* place_at(Eigen::Index end) const {
    const auto found = std::ranges::find_if(
        places_, [&](const ConstrainedPosition& place) { return place.end == end; });
    return found == places_.end() ? nullptr : &*found;
  }

  /// Returns the index of the multiplier of the constraint between the two places around an
  /// element; -1 outside the places.
  [[nodiscard]] Eigen::Index multiplier_of(Eigen::Index e) const {
    const auto next = std::ranges::find_if(
        places_, [&](const ConstrainedPosition& place) { return place.end > e; });
    return next == places_.begin() || next == places_.end() ? -1 : next->multiplier;
  }

  const RodSpan& span_;
  const RodMesh& mesh_;
  // Whether nothing holds the twist: spins about the tangent are then no unknowns.
  bool free_twist_;
  // Whether spins are restricted to the plane's normal, because couples have no potential for
  // others.
  bool in_plane_;
  Eigen::VectorXd elements_;  // arc lengths of the elements' ends
  std::vector<SpinNode> nodes_;
  std::vector<ConstrainedPosition> places_;
  Eigen::Index size_ = 0;
  bool finite_ = true;
  VariationTriplets second_, norm_, fixed_;
};

}  // namespace

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

SecondVariation second_variation(const RodSpan& span, const RodMesh& mesh,
                                 const ClampFrames& frames, double force,
                                 const SpanStates& states) {
  const VariationProblem variations(span, mesh, frames, force, states);
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
