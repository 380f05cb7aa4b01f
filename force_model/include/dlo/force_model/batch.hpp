#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "dlo/force_model/relax.hpp"
#include "dlo/force_model/rod.hpp"
#include "dlo/force_model/stepper.hpp"

namespace dlo::force_model {

class BatchBlock;

/// Rod, initial points and step settings of one rod of a batch.
struct BatchRod {
  Rod rod;                  ///< the rod
  Eigen::Matrix3Xd points;  ///< [m], 3 x rod.points()
  StepOptions options;      ///< step settings
};

/// Vectorised batch of rods with equal number of points, bending law, size of natural_turns, step
/// policy and instruction set. A block contains eight rods, and vector instructions move the same
/// point of several of them. Batches are meant for sweeps, calibration and stability maps. Lengths,
/// stiffnesses, loads, obstacles, grips, initial points and step constants may differ between rods.
/// Each rod moves as in its own Simulation, up to rounding. Rods between grips that hold their
/// frame are refused, because only a Simulation counts their twist, and so are steps with
/// velocities and implicit steps. Functions throw std::out_of_range for a block that does not
/// exist, and std::invalid_argument for such a rod.
///
/// Blocks share no data. Different threads may work on different blocks at the same time:
///     tbb::parallel_for(std::size_t{0}, batch.blocks(), [&](auto b) { batch.step_block(b, 1000);
///     });
class Batch {
 public:
  /// Number of rods in a block; the last block may have fewer.
  static constexpr std::size_t rods_per_block = 8;

  /// Creates the batch.
  /// @throws std::invalid_argument if there are no rods, if they differ in a property that must be
  /// equal, if a batch does not support one of them, or if Simulation refuses one
  explicit Batch(const std::vector<BatchRod>& rods);
  Batch(const Batch& other) = delete;
  Batch& operator=(const Batch& other) = delete;
  /// Moves the rods; `other` may only be assigned to or destroyed.
  Batch(Batch&& other) noexcept;
  /// Moves the rods; `other` may only be assigned to or destroyed.
  Batch& operator=(Batch&& other) noexcept;
  ~Batch();

  /// Returns the number of rods.
  [[nodiscard]] std::size_t size() const { return size_; }
  /// Returns the number of blocks.
  [[nodiscard]] std::size_t blocks() const;

  /// Makes `count` steps of each rod of one block. A rod whose step diverges permanently stays
  /// where it was before that step. Does not allocate.
  void step_block(std::size_t block, long count);
  /// Makes `count` steps of all rods, block by block.
  void step(long count);

  /// Runs Simulation::relax for the rods of one block; rods at rest wait for the others. Returns
  /// results in the order of the rods. Allocates.
  std::vector<RelaxResult> relax_block(std::size_t block, const RelaxOptions& options);
  /// Runs relax_block() for all blocks, one after another, and returns results in the order of the
  /// rods.
  std::vector<RelaxResult> relax(const RelaxOptions& options = {});

  /// Moves a gripper of a rod, see Simulation::move_grip.
  void move_grip(std::size_t rod, std::size_t grip,
                 const Eigen::Ref<const Eigen::Matrix3Xd>& targets,
                 const Eigen::Vector3d& reference);

  // Properties of each rod, 0 <= index < size().
  /// Returns the rod with its moved grips.
  [[nodiscard]] const Rod& rod(std::size_t index) const;
  [[nodiscard]] Eigen::Matrix3Xd points(std::size_t index) const;  ///< positions now [m], a copy
  /// Whether a step has diverged; the rod stays where it was.
  [[nodiscard]] bool diverged(std::size_t index) const;
  /// Returns the given options with automatic constants filled in.
  [[nodiscard]] const StepOptions& options(std::size_t index) const;
  /// Returns the number of steps since construction.
  [[nodiscard]] long steps(std::size_t index) const;

 private:
  [[nodiscard]] const BatchBlock& block_of(std::size_t index) const;

  std::size_t size_ = 0;
  std::vector<BatchBlock> blocks_;
};

}  // namespace dlo::force_model
