#include "touching/confirm_contacts.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "base/sized_samples.hpp"
#include "problem/ordered_grips.hpp"
#include "problem/reduction.hpp"
#include "touching/chain_stability.hpp"
#include "touching/contact_chain.hpp"

namespace dlo::energy_model {
namespace {

constexpr double at_end = 1e-9;           // of arc lengths, in l
constexpr double growth_of_interval = 3;  // of the fastest mode over an arc, its exponent
constexpr double confirmed_depth = 1e-9;  // in l; a tenth of what a converged shape may have
constexpr double allowed_pull = 1e-7;     // of forces, over 1 + the largest one
constexpr double norm_margin = 1e-3;      // of the second variation's norm

/// A problem in its own units, the shape that it starts from and what it asks of it.
class Confirmation {
 public:
  Confirmation(const Problem& problem, const Equilibrium& shape)
      : problem_(problem),
        shape_(shape),
        l_(problem.length),
        force_unit_(problem.bending_stiffness / (l_ * l_)),
        origin_(problem.grips.front().position) {
    for (const Obstacle& obstacle : problem.obstacles) {
      bodies_.push_back(obstacle.body.seen_from(origin_, Eigen::Matrix3d::Identity(), l_));
    }
    chain_.weight = problem.weight_per_length * (l_ / force_unit_);
  }

  /// @return false where the contacts are others than those that are known here
  bool lay_out() {
    for (const OrderedGrip& ordered : ordered_grips(problem_)) {
      ChainStation& station = at(ordered.grip->at / l_);
      station.position = (ordered.grip->position - origin_) / l_;
      station.grip = ordered.index;
      if (ordered.grip->direction) station.direction = ordered.grip->direction->normalized();
    }
    for (const Load& load : problem_.loads) at(load.at / l_).load += load.force / force_unit_;
    at(0);
    at(1);
    for (const ContactPart& contact : shape_.contacts) {
      if (!add(contact)) return false;
    }
    std::sort(stations_.begin(), stations_.end(),
              [](const ChainStation& a, const ChainStation& b) { return a.s < b.s; });
    chain_.stations = stations_;
    for (std::size_t p = 0; p + 1 < stations_.size(); ++p) {
      if (!add_piece(p)) return false;
    }
    return true;
  }

  Equilibrium solve(const Deadline& deadline) {
    Equilibrium result;
    const bool closed = close_chain(chain_, deadline);
    result.evaluations = chain_.shots;
    result.residual = chain_.residual;
    if (!closed) {
      result.status = deadline.passed() ? SolveStatus::time_limit : SolveStatus::failed;
      result.message = "Newton's method did not close the shots with the contacts of the start";
      return result;
    }
    react(result);
    touch(result);
    result.status = SolveStatus::not_verified;
    result.message = "not judged";
    result.sample = [problem = problem_, chain = chain_](std::span<const double> arc_lengths) {
      Samples samples = sized_samples(arc_lengths, problem.length);
      for (std::size_t i = 0; i < arc_lengths.size(); ++i) {
        const double s = arc_lengths[i] / problem.length;
        std::size_t p = 0;
        while (p + 1 < chain.pieces.size() && s > chain.stations[p + 1].s) ++p;
        const FlowState<double> state = chain.at(p, s);
        const auto column = static_cast<Eigen::Index>(i);
        samples.points.col(column) =
            problem.grips.front().position + problem.length * state.head<3>();
        samples.tangents.col(column) = state.segment<3>(3);
        samples.curvature.col(column) = state.segment<3>(6) / problem.length;
      }
      return samples;
    };
    return result;
  }

  /// Energies; what is closed by its depths, by its signs and by its second variation.
  void judge(Equilibrium& result) {
    if (!result.sample) return;
    integrate(result);
    result.message = objection(result);
    if (!result.message.empty()) return;
    result.status = SolveStatus::converged;
    if (!is_stable(chain_, norm_margin)) {
      result.status =
          is_stable(chain_, -norm_margin) ? SolveStatus::near_singular : SolveStatus::saddle;
    }
    result.message = to_string(result.status);
  }

 private:
  /// The station there, made if there is none.
  ChainStation& at(double s) {
    for (ChainStation& station : stations_) {
      if (std::abs(station.s - s) < at_end) return station;
    }
    stations_.emplace_back();
    stations_.back().s = s < at_end ? 0 : (s > 1 - at_end ? 1 : s);
    return stations_.back();
  }

  bool add(const ContactPart& contact) {
    const double begin = contact.begin / l_;
    const double end = contact.end / l_;
    const auto fixed = stations_.size();
    if (contact.kind != ContactKind::lying) {
      ChainStation& station = at(begin);
      if (station.grip || station.touched) return false;
      station.touched = bodies_[contact.obstacle];
      station.force = contact.force.norm() / force_unit_;
      station.moves = stations_.size() > fixed;
      return station.moves || contact.kind == ContactKind::tip;
    }
    for (const auto& [s, force] :
         {std::pair{begin, contact.begin_force}, std::pair{end, contact.end_force}}) {
      const std::size_t count = stations_.size();
      ChainStation& station = at(s);
      if (stations_.size() > count) station.moves = true;
      if (!station.grip) station.force = force / force_unit_;
    }
    lying_.push_back(&contact);
    return true;
  }

  /// Between the stations p and p + 1.
  bool add_piece(std::size_t p) {
    const double begin = stations_[p].s;
    const double length = stations_[p + 1].s - begin;
    ChainPiece piece;
    for (const ContactPart* contact : lying_) {
      const double middle = (begin + length / 2) * l_;
      if (middle < contact->begin || middle > contact->end) continue;
      // Nothing else may happen within what lies.
      if (contact->begin < (begin - at_end) * l_) return false;
      if (contact->end > (begin + length + at_end) * l_) return false;
      const Eigen::Vector3d on = state_of(begin + length / 2).head<3>();
      piece.surface = surface_of(bodies_[contact->obstacle], on);
    }
    if (p > 0 && piece.surface && chain_.pieces.back().surface) return false;
    const double pulled = force_after(begin).norm() + chain_.weight.norm() * length;
    const double rate = std::sqrt(pulled) + state_of(begin + length / 2).segment<3>(6).norm();
    const int arcs = 1 + static_cast<int>(length * rate / growth_of_interval);
    FlowState<double> node = state_of(begin);
    if (piece.surface) {
      const Eigen::Vector3d N = piece.surface->outward(node.head<3>());
      const Eigen::Vector3d n = node.tail<3>();
      node.tail<3>() -= n.dot(N) * N;
    }
    for (int a = 0; a < arcs; ++a) {
      piece.nodes.push_back(node);
      if (a + 1 == arcs) break;
      const FlowState<double> next = state_of(begin + length * (a + 1) / arcs);
      // The pressure up to there is the surface's.
      node = piece.surface ? flow(piece.surface, chain_.weight, length / arcs, node) : next;
      node.head<9>() = next.head<9>();
    }
    chain_.pieces.push_back(std::move(piece));
    return true;
  }

  /// n just after s, of what the shape's grips, contacts and loads exert before.
  [[nodiscard]] Eigen::Vector3d force_after(double s) const {
    const double reach = (s + at_end) * l_;
    Eigen::Vector3d force = problem_.weight_per_length * (s * l_);
    for (std::size_t i = 0; i < problem_.grips.size(); ++i) {
      if (problem_.grips[i].at <= reach) force += shape_.grips[i].force;
    }
    for (const Load& load : problem_.loads) {
      if (load.at <= reach) force += load.force;
    }
    for (const ContactPart& contact : shape_.contacts) {
      if (contact.end <= reach) force += contact.force;
    }
    return -force / force_unit_;
  }

  /// Of the start, just after s.
  [[nodiscard]] FlowState<double> state_of(double s) const {
    const Samples sample = shape_.sample(std::array{std::min(s + at_end, 1.0) * l_});
    const Eigen::Vector3d t = sample.tangents.col(0);
    const Eigen::Vector3d v = l_ * sample.curvature.col(0);
    FlowState<double> state;
    state << (sample.points.col(0) - origin_) / l_, t, v - v.dot(t) * t, force_after(s);
    return state;
  }

  /// Energies, and the largest depth behind an obstacle.
  void integrate(Equilibrium& result) {
    static constexpr std::array<double, 4> node = {0.1834346424956498, 0.5255324099163290,
                                                   0.7966664774136267, 0.9602898564975363};
    static constexpr std::array<double, 4> share = {0.3626837833783620, 0.3137066458778873,
                                                    0.2223810344533745, 0.1012285362903763};
    Energies energy;
    double depth = 0;
    const auto add = [&](std::size_t p, double s, double by) {
      const FlowState<double> state = chain_.at(p, s);
      const Eigen::Vector3d r = state.head<3>();
      energy.bending += by * state.segment<3>(6).squaredNorm() / 2;
      energy.gravity -= by * chain_.weight.dot(r);
      for (const obstacle::Body& body : bodies_) depth = std::max(depth, -body.clearance(r));
      if (!chain_.pieces[p].surface) return;
      least_pressure_ =
          std::min(least_pressure_, pressure(*chain_.pieces[p].surface, chain_.weight, state));
    };
    for (std::size_t p = 0; p < chain_.pieces.size(); ++p) {
      const std::size_t panels = 4 * chain_.pieces[p].nodes.size();
      const double half = chain_.length(p) / static_cast<double>(panels) / 2;
      for (std::size_t k = 0; k < panels; ++k) {
        const double middle = chain_.stations[p].s + (2 * static_cast<double>(k) + 1) * half;
        for (std::size_t i = 0; i < node.size(); ++i) {
          for (const double side : {-1.0, 1.0})
            add(p, middle + side * node[i] * half, half * share[i]);
        }
        add(p, middle + half, 0);
      }
    }
    for (std::size_t j = 0; j < chain_.stations.size(); ++j) {
      const Eigen::Vector3d r =
          j == 0 ? chain_.pieces[0].nodes[0].head<3>() : chain_.before(j).head<3>();
      energy.load -= chain_.stations[j].load.dot(r);
    }
    result.energy = restore(problem_, energy);
    result.penetration = l_ * depth;
  }

  /// n before and after a station; nothing is beyond the ends.
  [[nodiscard]] std::pair<Eigen::Vector3d, Eigen::Vector3d> forces_at(std::size_t j) const {
    std::pair<Eigen::Vector3d, Eigen::Vector3d> n{Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()};
    if (j > 0) n.first = chain_.before(j).tail<3>();
    if (j < chain_.pieces.size()) n.second = chain_.pieces[j].nodes[0].tail<3>();
    return n;
  }

  void react(Equilibrium& result) const {
    result.grips.resize(problem_.grips.size());
    for (std::size_t j = 0; j < chain_.stations.size(); ++j) {
      const ChainStation& station = chain_.stations[j];
      if (!station.grip) continue;
      const auto [before, after] = forces_at(j);
      Reaction& reaction = result.grips[*station.grip];
      reaction.force = force_unit_ * (before - after - station.load);
      if (!station.direction) continue;
      Eigen::Vector3d moment = Eigen::Vector3d::Zero();
      if (j > 0) {
        const FlowState<double> end = chain_.before(j);
        moment += end.segment<3>(3).cross(end.segment<3>(6));
      }
      if (j < chain_.pieces.size()) {
        const FlowState<double>& begin = chain_.pieces[j].nodes[0];
        moment -= begin.segment<3>(3).cross(begin.segment<3>(6));
      }
      reaction.torque = force_unit_ * l_ * moment;
    }
  }

  void touch(Equilibrium& result) {
    result.obstacles.assign(problem_.obstacles.size(), Eigen::Vector3d::Zero());
    const auto is_touched = [](const ChainStation& station) { return station.touched.has_value(); };
    std::size_t point = 0;
    std::size_t piece = 0;
    for (ContactPart contact : shape_.contacts) {
      if (contact.kind != ContactKind::lying) {
        while (!is_touched(chain_.stations[point])) ++point;
        const ChainStation& station = chain_.stations[point++];
        const Eigen::Vector3d r = point == 1 ? Eigen::Vector3d(chain_.pieces[0].nodes[0].head<3>())
                                             : Eigen::Vector3d(chain_.before(point - 1).head<3>());
        contact.begin = contact.end = l_ * station.s;
        contact.force = force_unit_ * station.force * station.touched->gap(r).gradient;
        contact.begin_force = contact.end_force = 0;
        least_force_ = std::min(least_force_, station.force);
      } else {
        while (!chain_.pieces[piece].surface) ++piece;
        set_lying(piece++, contact);
      }
      result.obstacles[contact.obstacle] += contact.force;
      result.contacts.push_back(contact);
    }
  }

  void set_lying(std::size_t p, ContactPart& contact) {
    const ChainStation& begin = chain_.stations[p];
    const ChainStation& end = chain_.stations[p + 1];
    contact.begin = l_ * begin.s;
    contact.end = l_ * end.s;
    contact.begin_force = begin.grip ? 0 : force_unit_ * begin.force;
    contact.end_force = end.grip ? 0 : force_unit_ * end.force;
    const Surface& surface = *chain_.pieces[p].surface;
    const FlowState<double> last = chain_.before(p + 1);
    const FlowState<double>& first = chain_.pieces[p].nodes[0];
    const Eigen::Vector3d pressed =
        first.tail<3>() - last.tail<3>() - chain_.length(p) * chain_.weight;
    contact.force = force_unit_ * pressed + contact.begin_force * surface.outward(first.head<3>()) +
                    contact.end_force * surface.outward(last.head<3>());
    contact.largest_pressure = 0;
    for (const FlowState<double>& node : chain_.pieces[p].nodes) {
      contact.largest_pressure = std::max(
          contact.largest_pressure, force_unit_ / l_ * pressure(surface, chain_.weight, node));
    }
    contact.largest_pressure = std::max(contact.largest_pressure,
                                        force_unit_ / l_ * pressure(surface, chain_.weight, last));
    if (!begin.grip) least_force_ = std::min(least_force_, begin.force);
    if (!end.grip) least_force_ = std::min(least_force_, end.force);
  }

  /// Empty: none.
  [[nodiscard]] std::string objection(const Equilibrium& result) const {
    double largest = 1 + chain_.weight.norm();
    for (const Reaction& grip : result.grips) {
      largest = std::max(largest, grip.force.norm() / force_unit_);
    }
    if (result.penetration > confirmed_depth * l_) {
      return "the rod is " + std::to_string(result.penetration) +
             " m within an obstacle that it is not said to touch";
    }
    const double least = std::min(least_force_, least_pressure_);
    return least < -allowed_pull * largest ? "an obstacle would have to pull" : "";
  }

  const Problem& problem_;
  const Equilibrium& shape_;
  double l_;
  double force_unit_;
  Eigen::Vector3d origin_;
  std::vector<obstacle::Body> bodies_;
  std::vector<ChainStation> stations_;
  std::vector<const ContactPart*> lying_;
  ContactChain chain_;
  double least_force_ = 0;
  double least_pressure_ = 0;
};

std::optional<Confirmation> laid_out(const Problem& problem, const Equilibrium& shape) {
  if (!can_confirm(problem) || !shape.sample || shape.grips.size() != problem.grips.size()) {
    return std::nullopt;
  }
  Confirmation confirmation(problem, shape);
  if (!confirmation.lay_out()) return std::nullopt;
  return confirmation;
}

}  // namespace

bool can_confirm(const Problem& problem) {
  const bool rigid =
      std::none_of(problem.obstacles.begin(), problem.obstacles.end(),
                   [](const Obstacle& obstacle) { return std::isfinite(obstacle.stiffness); });
  const bool twists = std::any_of(problem.grips.begin(), problem.grips.end(),
                                  [](const Grip& grip) { return grip.frame.has_value(); });
  return rigid && !twists && problem.sections.empty() && !has_material_directors(problem);
}

std::optional<Equilibrium> close_contacts(const Problem& problem, const Equilibrium& shape,
                                          const Deadline& deadline) {
  std::optional<Confirmation> confirmation = laid_out(problem, shape);
  if (!confirmation) return std::nullopt;
  return confirmation->solve(deadline);
}

std::optional<Equilibrium> confirm_contacts(const Problem& problem, const Equilibrium& shape,
                                            const Deadline& deadline) {
  std::optional<Confirmation> confirmation = laid_out(problem, shape);
  if (!confirmation) return std::nullopt;
  Equilibrium result = confirmation->solve(deadline);
  confirmation->judge(result);
  return result;
}

}  // namespace dlo::energy_model
