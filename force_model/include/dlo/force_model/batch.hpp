#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "dlo/force_model/relax.hpp"
#include "dlo/force_model/rod.hpp"
#include "dlo/force_model/stepper.hpp"

namespace dlo::force_model {

class Lockstep;

/// A rod, where its points start, and how it steps.
struct BatchRod {
  Rod rod;                  ///< what makes forces
  Eigen::Matrix3Xd points;  ///< [m], 3 x rod.points()
  StepOptions options;      ///< how it steps
};

/// Many rods of the same number of points, bending law and step policy, eight to a block and the
/// eight in lockstep: one instruction moves the same point of all. For sweeps, calibration and
/// stability maps; lengths, stiffnesses, loads, walls, grips, starts and step constants may differ
/// from rod to rod. Each rod does what its own Simulation would do, up to rounding. Rods between
/// grips that hold their frame are refused: their twist is counted by a Simulation only.
///
/// Blocks share nothing. Different threads may work on different blocks at the same time:
///     tbb::parallel_for(std::size_t{0}, batch.blocks(), [&](auto b) { batch.step_block(b, 1000);
///     });
class Batch {
 public:
  /// Size of a block; the last one may have fewer.
  static constexpr std::size_t rods_per_block = 8;

  /// @throws std::invalid_argument if there are no rods, if they differ in what they have to share,
  ///         or as Simulation
  explicit Batch(const std::vector<BatchRod>& rods);
  Batch(const Batch& other) = delete;
  Batch& operator=(const Batch& other) = delete;
  /// Takes the rods over.
  Batch(Batch&& other) noexcept;
  Batch& operator=(Batch&& other) noexcept;  ///< Takes the rods over.
  ~Batch();

  /// How many rods.
  [[nodiscard]] std::size_t size() const { return size_; }
  /// How many blocks.
  [[nodiscard]] std::size_t blocks() const;

  /// Steps the rods of one block, or of all blocks one after another, `count` times. A rod that
  /// diverges stays where it was before that step, for good. Allocates nothing.
  void step_block(std::size_t block, long count);
  /// Every block in turn.
  void step(long count);

  /// Steps until each rod rests, see Simulation::relax; those that rest wait for the others.
  /// Results in the order of the rods, of one block or of all. Allocates.
  std::vector<RelaxResult> relax_block(std::size_t block, const RelaxOptions& options);
  /// Every block in turn.
  std::vector<RelaxResult> relax(const RelaxOptions& options = {});

  /// Moves a gripper of a rod, see Simulation::move_grip.
  void move_grip(std::size_t rod, std::size_t grip,
                 const Eigen::Ref<const Eigen::Matrix3Xd>& targets,
                 const Eigen::Vector3d& reference);

  // Of each rod, 0 <= index < size().
  /// As moved.
  [[nodiscard]] const Rod& rod(std::size_t index) const;
  [[nodiscard]] Eigen::Matrix3Xd points(std::size_t index) const;  ///< positions now [m], a copy
  /// It stays where it was.
  [[nodiscard]] bool diverged(std::size_t index) const;
  /// As given; automatic constants filled in.
  [[nodiscard]] const StepOptions& options(std::size_t index) const;
  /// Made since construction.
  [[nodiscard]] long steps(std::size_t index) const;

 private:
  [[nodiscard]] const Lockstep& block_of(std::size_t index) const;

  std::size_t size_ = 0;
  std::vector<Lockstep> blocks_;
};

}  // namespace dlo::force_model
