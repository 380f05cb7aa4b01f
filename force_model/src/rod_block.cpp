#include "rod_block.hpp"

#include <algorithm>

#include "point_masses.hpp"
#include "solid_samples.hpp"
#include "twisted_spans.hpp"

namespace dlo::force_model {
namespace {

constexpr int axes = 3;

bool is_naturally_bent(const Rod& rod) { return rod.bending.natural_turns.size() > 0; }

bool has_spring_grips(const Rod& rod) {
  return std::ranges::find(rod.grips, GripHold::spring, &Grip::hold) != rod.grips.end();
}

std::ptrdiff_t round_up(std::ptrdiff_t size) {
  return (size + block_lanes - 1) / block_lanes * block_lanes;
}

}  // namespace

RodBlock::RodBlock(std::span<const Rod> rods, bool lockstep, InstructionSet set)
    : points_(rods.front().points()),
      stride_(lockstep ? block_lanes : 1),
      size_(round_up(points_ * stride_)),
      pitch_(size_ + block_lanes),
      set_(set),
      law_(rods.front().bending.law),
      natural_(std::any_of(rods.begin(), rods.end(), is_naturally_bent)),
      spring_grips_(std::any_of(rods.begin(), rods.end(), has_spring_grips)),
      solids_(std::ranges::any_of(rods, [](const Rod& rod) { return !rod.solids.empty(); })),
      plain_points_(axes, points_),
      plain_forces_(axes, points_) {
  // The distance between arrays is an odd number of cache lines, so that they do not share cache
  // sets.
  if (pitch_ / block_lanes % 2 == 0) pitch_ += block_lanes;
  memory_.resize(static_cast<std::size_t>(point_array_count * pitch_ / block_lanes));
  set_padding();
  for (std::size_t lane = 0; lane < static_cast<std::size_t>(stride_); ++lane) {
    set_rod(lane, rods[lane < rods.size() ? lane : 0]);
  }
  set_walls(rods);
  if (!lockstep) set_twist(rods.front());
  kernel_ = &step_kernel(set_, {.law = law_}, stride_);
}

PointBlock RodBlock::block() {
  return {.first = memory_.front().lane, .pitch = pitch_, .size = size_};
}

std::ptrdiff_t RodBlock::element(Eigen::Index point, std::size_t rod) const {
  return point * stride_ + static_cast<std::ptrdiff_t>(rod);
}

double& RodBlock::at(int array, std::ptrdiff_t element) {
  const std::ptrdiff_t k = array * pitch_ + element;
  return memory_[static_cast<std::size_t>(k / block_lanes)].lane[k % block_lanes];
}

const double& RodBlock::at(int array, std::ptrdiff_t element) const {
  const std::ptrdiff_t k = array * pitch_ + element;
  return memory_[static_cast<std::size_t>(k / block_lanes)].lane[k % block_lanes];
}

RodBlock::View RodBlock::view(int array, std::size_t rod) const {
  return {&at(array, element(0, rod)), axes, points_, {stride_, pitch_}};
}

void RodBlock::set(PointArray array, std::size_t rod, const Eigen::Matrix3Xd& vectors) {
  for (Eigen::Index i = 0; i < points_; ++i) {
    for (int axis = 0; axis < axes; ++axis) at(array + axis, element(i, rod)) = vectors(axis, i);
  }
}

void RodBlock::set_padding() {
  // Padding: points far away, a metre from each other, that neither move nor exert forces.
  for (std::ptrdiff_t k = 0; k < size_ + block_lanes; ++k) {
    const std::ptrdiff_t point = k / stride_;
    at(positions, k) = 1000 + static_cast<double>(point);
    at(last_positions, k) = at(positions, k);
    at(rest_lengths, k) = 1;
  }
}

void RodBlock::set_rod(std::size_t lane, const Rod& rod) {
  const Eigen::VectorXd& L = rod.rest_lengths;
  set(loads, lane, rod.loads);
  set(external_forces, lane, rod.loads);
  for (Eigen::Index i = 0; i < points_; ++i) {
    const std::ptrdiff_t k = element(i, lane);
    at(is_free, k) = 1;
    if (i + 1 == points_) continue;
    at(is_segment, k) = 1;
    at(rest_lengths, k) = L[i];
    at(stretch, k) = rod.c_c / L[i];
    if (i == 0) continue;
    at(is_joint, k) = 1;
    const double c = bending_at(rod.bending, i).stiffness;
    const double mean = (L[i - 1] + L[i]) / 2;
    at(bend, k) = law_ == BendingLaw::hooke ? 2 * c / mean : c;
    at(natural, k) = natural_moment(rod.bending, i, mean);
  }
  for_each_grip_point(rod, GripHold::rigid, [&](const Grip& grip, Eigen::Index k) {
    at(is_free, element(grip.first_point + k, lane)) = 0;
  });
}

void RodBlock::set_walls(std::span<const Rod> rods) {
  for (const Rod& rod : rods) walls_.resize(std::max(walls_.size(), rod.walls.size()));
  for (std::size_t lane = 0; lane < block_lanes; ++lane) {
    const Rod& rod = rods[lane < rods.size() ? lane : 0];
    for (std::size_t w = 0; w < rod.walls.size(); ++w) {
      for (int axis = 0; axis < axes; ++axis) {
        walls_[w].point[axis].lane[lane] = rod.walls[w].point[axis];
        walls_[w].normal[axis].lane[lane] = rod.walls[w].normal[axis];
      }
      walls_[w].stiffness.lane[lane] = rod.walls[w].stiffness;
    }
  }
}

void RodBlock::set_twist(const Rod& rod) {
  twisted_spans_.clear();
  for_each_twisted_span(rod, [this](const TwistedSpan& span, const Grip& /*first*/,
                                    const Grip& /*last*/) { twisted_spans_.push_back(span); });
}

void RodBlock::update_twist(Eigen::VectorXd& angles) {
  const View points = view(positions, 0);
  for (std::size_t number = 0; number < twisted_spans_.size(); ++number) {
    TwistedSpan& span = twisted_spans_[number];
    const double angle = current_twist_angle(span, points);
    // A rod that diverges continues from its previous shape.
    if (!std::isfinite(angle)) continue;
    span.angle = angles[static_cast<Eigen::Index>(number)] = angle;
    const double moment = angle / span.compliance;
    for (Eigen::Index i = span.first_segment + 1; i <= span.last_segment; ++i) {
      at(twist_share, i) = moment / at(bend, i);
    }
  }
}

void RodBlock::update_dimension(std::span<const Rod> rods) {
  const auto flat = [this](int array) {
    const auto zero = [&](std::ptrdiff_t k) { return at(array + 2, k) == 0; };
    for (std::ptrdiff_t k = 0; k < size_; ++k) {
      if (!zero(k)) return false;
    }
    return true;
  };
  const bool planar = std::all_of(rods.begin(), rods.end(), is_planar) && flat(positions) &&
                      flat(proposals) && flat(proposals + axes);
  // There is no kernel in space with natural angles; BatchBlock keeps such rods in the plane.
  kernel_ = &step_kernel(set_,
                         {.law = law_,
                          .dimension = planar ? 2 : 3,
                          .natural = natural_ && planar,
                          .twisted = twisted()},
                         stride_);
}

void RodBlock::add_spring_grips(std::span<const Rod> rods) {
  for (std::size_t lane = 0; lane < rods.size(); ++lane) {
    const auto on_springs = [&](const auto& action) {
      for_each_grip_point(rods[lane], GripHold::spring, [&](const Grip& grip, Eigen::Index k) {
        for (int axis = 0; axis < axes; ++axis) {
          action(grip, axis, k, element(grip.first_point + k, lane));
        }
      });
    };
    if (walls_.empty() && !solids_) {
      on_springs([this](const Grip&, int axis, Eigen::Index, std::ptrdiff_t e) {
        at(external_forces + axis, e) = at(loads + axis, e);
      });
    }
    on_springs([this](const Grip& grip, int axis, Eigen::Index k, std::ptrdiff_t e) {
      at(external_forces + axis, e) +=
          grip.stiffness * (grip.targets(axis, k) - at(positions + axis, e));
    });
  }
}

void RodBlock::add_solids(std::span<const Rod> rods) {
  for (std::size_t lane = 0; lane < rods.size(); ++lane) {
    if (walls_.empty()) {
      for (Eigen::Index i = 0; i < points_; ++i) {
        const std::ptrdiff_t e = element(i, lane);
        for (int axis = 0; axis < axes; ++axis) at(external_forces + axis, e) = at(loads + axis, e);
      }
    }
    const auto position = [&](Eigen::Index i) {
      const std::ptrdiff_t e = element(i, lane);
      return Eigen::Vector3d(at(positions, e), at(positions + 1, e), at(positions + 2, e));
    };
    for (const Solid& solid : rods[lane].solids) {
      for_each_push(solid, points_, position, [&](const SolidPush& push) {
        const std::ptrdiff_t e = element(push.point, lane);
        for (int axis = 0; axis < axes; ++axis) {
          at(external_forces + axis, e) += (1 - push.share) * push.force[axis];
        }
        if (push.share == 0) return;
        const std::ptrdiff_t next = element(push.point + 1, lane);
        for (int axis = 0; axis < axes; ++axis) {
          at(external_forces + axis, next) += push.share * push.force[axis];
        }
      });
    }
  }
}

void RodBlock::compute_plain_forces(std::size_t lane, const Rod& rod) {
  plain_points_ = view(positions, lane);
  total_forces(rod, plain_points_, plain_forces_);
  for (Eigen::Index i = 0; i < points_; ++i) plain_forces_.col(i) *= at(is_free, element(i, lane));
  set(forces, lane, plain_forces_);
  // Padding next to a segment without direction may contain NaN.
  for (int axis = 0; axis < axes; ++axis) {
    for (std::ptrdiff_t k = points_ * stride_; k < size_; ++k) at(forces + axis, k) = 0;
  }
}

void RodBlock::compute_forces(std::span<const Rod> rods, const PerLane& active) {
  if (!walls_.empty()) kernel_->add_walls(block(), walls_.data(), std::ssize(walls_));
  if (solids_) add_solids(rods);
  if (spring_grips_) add_spring_grips(rods);
  const bool only_loads = walls_.empty() && !spring_grips_ && !solids_;
  kernel_->compute_forces(block(), only_loads ? loads : external_forces, regular_);
  for (std::size_t lane = 0; lane < rods.size(); ++lane) {
    if (regular_.lane[lane] == 0 && active.lane[lane] != 0) compute_plain_forces(lane, rods[lane]);
  }
}

void RodBlock::propose(const PerLane& c_F, const PerLane& momentum_factor,
                       const PerLane& rounding_squared, bool relative, ProposedStep& step) {
  const auto propose = relative ? kernel_->propose_relative : kernel_->propose_absolute;
  propose(block(), proposal_set_, c_F, momentum_factor, rounding_squared, step);
}

void RodBlock::move(const PerLane& c_m) {
  kernel_->move(block(), proposal_set_, c_m);
  proposal_set_ = 1 - proposal_set_;
}

RodBlock::View RodBlock::last_proposals(std::size_t rod) const {
  return view(proposals + axes * (1 - proposal_set_), rod);
}

}  // namespace dlo::force_model
