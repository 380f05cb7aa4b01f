#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <vector>

#include "dlo/force_model/batch.hpp"
#include "implicit_step.hpp"
#include "rest_search.hpp"
#include "rod_block.hpp"
#include "step_control.hpp"
#include "verlet_step.hpp"

namespace dlo::force_model {

/// One rod, or up to eight rods of the same size, bending law and step policy that are stepped in a
/// vectorised batch. Simulation and Batch share this class.
class BatchBlock {
 public:
  /// @param together  false: one rod, vectorised over its points; true: 1 to 8, one per lane
  /// @throws std::invalid_argument if rods, points or options are out of range
  BatchBlock(std::span<const BatchRod> start, bool together);

  /// Makes a step of each active rod. Does not allocate.
  /// @param[out] results  one per rod; those of inactive rods are unchanged
  void step(std::span<StepResult> results);

  /// Steps until each active rod is at rest, see Simulation::relax. Allocates.
  std::vector<RelaxResult> relax(const RelaxOptions& options);

  /// Moves a grip of a rod, see Simulation::move_grip. @param d1  null: a held frame follows the
  /// segment
  void move_grip(std::size_t rod, std::size_t grip,
                 const Eigen::Ref<const Eigen::Matrix3Xd>& targets,
                 const Eigen::Vector3d& reference, const Eigen::Vector3d* d1 = nullptr);

  /// Replaces a wall of a rod, see Simulation::move_wall.
  void move_wall(std::size_t rod, std::size_t wall, const Wall& moved);

  [[nodiscard]] const Rod& rod(std::size_t rod) const { return rods_[rod]; }
  [[nodiscard]] const StepControl& control(std::size_t rod) const { return controls_[rod]; }
  [[nodiscard]] Eigen::Matrix3Xd points(std::size_t rod) const {
    return block_.view(positions, rod);
  }
  void copy_points(std::size_t rod, Eigen::Matrix3Xd& points) const {
    points = block_.view(positions, rod);
  }

  [[nodiscard]] std::size_t size() const { return rods_.size(); }

  /// Activates or deactivates a rod; inactive rods do not move.
  void set_active(std::size_t rod, bool active);
  [[nodiscard]] bool active(std::size_t rod) const { return active_.lane[rod] != 0; }
  [[nodiscard]] bool any_active() const;

 private:
  void compute_forces();
  void measure_modes();
  [[nodiscard]] StepResult step_implicitly();
  [[nodiscard]] StepResult step_by_velocities();
  RelaxResult relax_implicitly(const RelaxOptions& options);
  void update_rounding(std::size_t rod);
  MovingShape shape(std::size_t rod);
  void nudge(std::size_t rod, const Eigen::Matrix3Xd& direction);

  std::vector<Rod> rods_;
  RodBlock block_;
  std::vector<StepControl> controls_;
  PerLane c_F_;
  PerLane c_m_;               // c_m of the last step, the factor of its proposed movements
  PerLane momentum_factors_;  // c_h c_m
  PerLane active_;
  PerLane rounding_squared_;  // square of the smallest movement that counts as oscillation [m^2]
  std::optional<ImplicitStep> implicit_;  // implicit steps of a single rod whose policy uses them
  std::optional<VerletStep> verlet_;
  ProposedStep proposed_;
  ModeMeasurement measured_modes_;
  Eigen::Matrix3Xd points_;  // points of the rod that is examined
  Eigen::Matrix3Xd forces_;
};

}  // namespace dlo::force_model
