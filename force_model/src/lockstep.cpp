#include "lockstep.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "require.hpp"
#include "twisted_spans.hpp"

namespace dlo::force_model {
namespace {

// Movements below this fraction of the coordinates are rounding errors, which oscillate at rest.
constexpr double rounding_share = 1024 * std::numeric_limits<double>::epsilon();

/// Whether a rod must stay in the plane z = 0: natural angles have a sign only there.
bool is_bound_to_plane(const Rod& rod) { return rod.bending.natural_turns.size() > 0; }

Eigen::Index count_twisted(const Rod& rod) {
  Eigen::Index count = 0;
  for_each_twisted_span(rod, [&count](const TwistedSpan& /*span*/, const Grip& /*first*/,
                                      const Grip& /*last*/) { ++count; });
  return count;
}

std::vector<Rod> checked_rods(std::span<const BatchRod> start, bool together) {
  std::vector<Rod> rods;
  for (const BatchRod& one : start) {
    check(one.rod);
    const Integration integration = one.options.policy.integration;
    require(!together || integration == Integration::along_force, "Batch", "integration of a rod",
            static_cast<double>(integration),
            "0 (along_force): a batch supports neither velocities nor implicit steps");
    const Eigen::Index twisted = count_twisted(one.rod);
    require(!together || twisted == 0, "Batch", "number of grips with d1",
            static_cast<double>(twisted + 1), "0 or 1: a batch does not support twist");
    require_polygon("Simulation", one.points, one.rod.rest_lengths);
    const double across = one.points.row(2).cwiseAbs().maxCoeff();
    require(!is_bound_to_plane(one.rod) || across == 0, "Simulation", "largest z of a point",
            across,
            "0 for a rod with natural turns, whose sign is undefined out of the plane z = 0");
    rods.push_back(one.rod);
    if (one.rod.twist.angles.size() == 0) rods.back().twist.angles.setZero(twisted);
  }
  return rods;
}

Eigen::Matrix3Xd with_held_points(const BatchRod& start) {
  Eigen::Matrix3Xd points = start.points;
  for (const Grip& grip : start.rod.grips) {
    if (grip.hold == GripHold::spring) continue;
    points.middleCols(grip.first_point, grip.targets.cols()) = grip.targets;
  }
  return points;
}

}  // namespace

BatchBlock::BatchBlock(std::span<const BatchRod> start, bool together)
    : rods_(checked_rods(start, together)),
      block_(rods_, together, start.front().options.instruction_set) {
  for (std::size_t lane = 0; lane < block_lanes; ++lane) {
    const std::size_t rod = lane < start.size() ? lane : 0;
    if (!together && rod != lane) break;
    const Eigen::Matrix3Xd points = with_held_points(start[rod]);
    block_.set(positions, lane, points);
    if (rod == lane) controls_.emplace_back(rods_[rod], points, start[rod].options);
  }
  for (std::size_t rod = 0; rod < start.size(); ++rod) {
    set_active(rod, true);
    c_F_.lane[rod] = controls_[rod].options().c_F;
  }
  block_.update_dimension(rods_);
  points_.resize(3, rods_.front().points());
  forces_.resize(3, rods_.front().points());
  for (std::size_t rod = 0; rod < start.size(); ++rod) update_rounding(rod);
  const StepOptions& options = start.front().options;
  copy_points(0, points_);
  if (options.policy.integration == Integration::implicit_euler) {
    implicit_.emplace(rods_.front(), points_, options);
  } else if (options.policy.integration == Integration::verlet) {
    verlet_.emplace(rods_.front(), options);
  }
}

void BatchBlock::update_rounding(std::size_t rod) {
  const double rounding = rounding_share * block_.view(positions, rod).cwiseAbs().maxCoeff();
  rounding_squared_.lane[rod] = rounding * rounding;
}

void BatchBlock::set_active(std::size_t rod, bool active) { active_.lane[rod] = active ? 1 : 0; }

bool BatchBlock::any_active() const {
  return std::ranges::any_of(active_.lane, [](double lane) { return lane != 0; });
}

void BatchBlock::compute_forces() {
  if (block_.twisted()) block_.update_twist(rods_.front().twist.angles);
  block_.compute_forces(rods_, active_);
}

void BatchBlock::measure_modes() {
  bool due = false;
  for (std::size_t rod = 0; rod < rods_.size(); ++rod) {
    due = due || (active(rod) && controls_[rod].measures_modes());
  }
  if (!due) return;
  block_.measure_modes(measured_modes_);
  if (block_.twisted()) {
    copy_points(0, points_);
    measured_modes_.bending.lane[0] += fastest_twist_mode(rods_.front(), points_);
  }
  for (std::size_t rod = 0; rod < rods_.size(); ++rod) {
    if (!active(rod)) continue;
    controls_[rod].update_modes(
        measured_modes_.contraction.lane[rod] + measured_modes_.bending.lane[rod],
        measured_modes_.force_change.lane[rod], measured_modes_.point_change.lane[rod]);
    c_F_.lane[rod] = controls_[rod].options().c_F;
  }
}

StepResult BatchBlock::step_implicitly() {
  const StepResult result = implicit_->step(rods_.front());
  controls_.front().count(result, implicit_->newton_steps());
  if (result.status == StepStatus::good) block_.set(positions, 0, implicit_->points());
  return result;
}

StepResult BatchBlock::step_by_velocities() {
  StepResult result;
  copy_points(0, points_);
  forces_ = block_.view(forces, 0);
  verlet_->step(forces_, points_, result);
  controls_.front().count(result, 1);
  if (result.status == StepStatus::good) block_.set(positions, 0, points_);
  return result;
}

void BatchBlock::step(std::span<StepResult> results) {
  if (implicit_) {
    if (active(0)) results[0] = step_implicitly();
    return;
  }
  compute_forces();
  measure_modes();
  if (verlet_) {
    if (active(0)) results[0] = step_by_velocities();
    return;
  }
  for (std::size_t rod = 0; rod < rods_.size(); ++rod) {
    momentum_factors_.lane[rod] = controls_[rod].momentum_factor() * c_m_.lane[rod];
  }
  block_.propose(c_F_, momentum_factors_, rounding_squared_, controls_.front().relative(),
                 proposed_);
  PerLane c_m;
  bool moves = false;
  for (std::size_t rod = 0; rod < rods_.size(); ++rod) {
    if (!active(rod)) continue;
    controls_[rod].decide(proposed_.largest_squared.lane[rod], proposed_.sum_squared.lane[rod],
                          proposed_.oscillating.lane[rod], results[rod]);
    c_m.lane[rod] = results[rod].c_m;  // 0 if diverged
    moves = moves || results[rod].status == StepStatus::good;
  }
  if (!moves) return;
  block_.move(c_m);
  c_m_ = c_m;
}

MovingShape BatchBlock::shape(std::size_t rod) {
  points_ = block_.view(positions, rod);
  forces_ = block_.view(forces, rod);
  if (implicit_) return {points_, forces_, implicit_->momentum()};
  if (verlet_) return {points_, forces_, verlet_->momentum()};
  const double momentum = c_m_.lane[rod] * block_.last_proposals(rod).norm() /
                          (1 - controls_[rod].momentum_factor()) /
                          std::sqrt(static_cast<double>(points_.cols()));
  return {points_, forces_, controls_[rod].options().policy.momentum ? momentum : 0};
}

void BatchBlock::nudge(std::size_t rod, const Eigen::Matrix3Xd& direction) {
  constexpr double displacement_share = 1e-6;  // in lengths, far below any tolerance
  block_.set(positions, rod,
             block_.view(positions, rod) + displacement_share * rods_[rod].length() * direction);
  block_.update_dimension(rods_);
  if (!implicit_) return;
  copy_points(rod, points_);
  implicit_->set_points(points_);
}

RelaxResult BatchBlock::relax_implicitly(const RelaxOptions& options) {
  RestSearch search(rods_.front(), controls_.front().estimate(), options);
  const auto measurable_shape = [this] {
    block_.update_dimension(rods_);
    compute_forces();
    return shape(0);
  };
  // A Newton step squares the distance d from rest: about 2 d^2 / l remain, measured on rods from
  // straight to Gamma = 18. If this predicts rest too early, the next prediction requires a step
  // that is ten times shorter.
  const double length = rods_.front().length();
  double promising = std::sqrt(options.tolerance / 4) * length;
  while (search.may_continue()) {
    const StepResult result = step_implicitly();
    search.count_newton_steps(result, implicit_->newton_steps());
    if (!search.may_continue()) break;
    const double moved = std::max(implicit_->movement(), implicit_->momentum());
    const bool converges = implicit_->was_full_newton_step() && moved < promising;
    if (!converges && !(moved < options.tolerance * length)) continue;
    const Eigen::Matrix3Xd descent = search.end_if_at_rest(measurable_shape());
    if (descent.cols() > 0) {
      nudge(0, descent);
    } else if (search.may_continue() && moved == 0) {
      search.end_as_stalled();
    }
    promising = std::min(promising, moved) / 10;
  }
  return search.finish(measurable_shape());
}

std::vector<RelaxResult> BatchBlock::relax(const RelaxOptions& options) {
  if (implicit_) return {relax_implicitly(options)};
  std::vector<RestSearch> searches;
  searches.reserve(rods_.size());
  for (std::size_t rod = 0; rod < rods_.size(); ++rod) {
    searches.emplace_back(rods_[rod], controls_[rod].estimate(), options);
  }
  const PerLane active_before = active_;
  const auto stop_if_done = [&](std::size_t rod) {
    if (!searches[rod].may_continue()) set_active(rod, false);
  };
  std::array<StepResult, block_lanes> results;  // diverged, for rods that are not active
  for (std::size_t rod = 0; rod < rods_.size(); ++rod) {
    if (!active(rod)) (void)searches[rod].count(results[rod]);
    stop_if_done(rod);
  }
  std::array<bool, block_lanes> due{};
  while (any_active()) {
    step(results);
    for (std::size_t rod = 0; rod < rods_.size(); ++rod) {
      due[rod] = active(rod) && searches[rod].count(results[rod]);
    }
    if (std::find(due.begin(), due.end(), true) != due.end()) compute_forces();
    for (std::size_t rod = 0; rod < rods_.size(); ++rod) {
      if (!due[rod]) continue;
      // The equilibrium is unstable, as that of an upright rod: it is displaced, as any
      // disturbance would do.
      const Eigen::Matrix3Xd descent = searches[rod].check_rest(shape(rod));
      if (descent.cols() > 0) nudge(rod, descent);
      controls_[rod].correct_slowest_mode(searches[rod].slowest_mode());
      if (searches[rod].bounces()) controls_[rod].descend();
      c_F_.lane[rod] = controls_[rod].options().c_F;
    }
    for (std::size_t rod = 0; rod < rods_.size(); ++rod) stop_if_done(rod);
  }
  active_ = active_before;
  compute_forces();
  std::vector<RelaxResult> outcomes;
  for (std::size_t rod = 0; rod < rods_.size(); ++rod) {
    outcomes.push_back(searches[rod].finish(shape(rod)));
  }
  return outcomes;
}

void BatchBlock::move_grip(std::size_t rod, std::size_t grip,
                           const Eigen::Ref<const Eigen::Matrix3Xd>& targets,
                           const Eigen::Vector3d& reference, const Eigen::Vector3d* d1) {
  Rod& held = rods_[rod];
  require(grip < held.grips.size(), "Simulation::move_grip", "grip", static_cast<double>(grip),
          "smaller than the number of grips");
  Grip& moved = held.grips[grip];
  require(targets.cols() == moved.targets.cols(), "Simulation::move_grip", "columns of targets",
          static_cast<double>(targets.cols()), "the number of points that the grip holds");
  require(targets.allFinite() && reference.allFinite(), "Simulation::move_grip", "targets",
          targets.norm(), "finite");
  require(!is_bound_to_plane(held) || targets.row(2).isZero(0), "Simulation::move_grip",
          "z of targets", targets.row(2).cwiseAbs().maxCoeff(), "0 for a rod with natural turns");
  const auto direction_of =
      [](const Eigen::Ref<const Eigen::Matrix3Xd>& of_grip) -> Eigen::Vector3d {
    return (of_grip.col(1) - of_grip.col(0)).normalized();
  };
  if (d1 != nullptr) {
    require(moved.d1.has_value(), "Simulation::move_grip", "grip", static_cast<double>(grip),
            "a grip with d1");
    const Eigen::Vector3d across = direction_of(targets).cross(*d1);
    require(across.norm() > 0 && across.allFinite(), "Simulation::move_grip",
            "part of d1 across the segment", across.norm(), "finite and > 0");
    moved.d1 = *d1;
  } else if (moved.d1) {
    moved.d1 =
        Eigen::Quaterniond::FromTwoVectors(direction_of(moved.targets), direction_of(targets)) *
        *moved.d1;
  }
  moved.targets = targets;
  moved.reference = reference;
  if (moved.hold == GripHold::rigid) {
    points_ = block_.view(positions, rod);
    points_.middleCols(moved.first_point, targets.cols()) = targets;
    block_.set(positions, rod, points_);
  }
  if (block_.twisted()) block_.set_twist(held);
  update_rounding(rod);
  block_.update_dimension(rods_);
}

void BatchBlock::move_wall(std::size_t rod, std::size_t wall, const Wall& moved) {
  Rod& held = rods_[rod];
  require(wall < held.walls.size(), "Simulation::move_wall", "wall", static_cast<double>(wall),
          "smaller than the number of walls");
  check(moved);
  require(!is_bound_to_plane(held) || moved.normal.z() == 0, "Simulation::move_wall",
          "z of the normal", moved.normal.z(), "0 for a rod with natural turns");
  held.walls[wall] = moved;
  block_.set_walls(rods_);
  block_.update_dimension(rods_);
  copy_points(rod, points_);
  controls_[rod].change_environment(held, points_);
  c_F_.lane[rod] = controls_[rod].options().c_F;
}

}  // namespace dlo::force_model
