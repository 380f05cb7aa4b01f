#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "dlo/force_model/rod.hpp"
#include "step_kernel.hpp"

namespace dlo::force_model {

/// Points of one rod, or of up to eight rods of the same size and bending law, in the memory layout
/// of the step kernel. Unused lanes repeat the first rod. Only the constructor allocates.
class RodBlock {
 public:
  /// Positions or forces of one rod, as a matrix.
  using View = Eigen::Map<const Eigen::Matrix3Xd, Eigen::Unaligned,
                          Eigen::Stride<Eigen::Dynamic, Eigen::Dynamic>>;

  /// Creates the block. @param rods  1 to 8, checked; @param lockstep  false: one rod, vectorised
  /// over its points
  RodBlock(std::span<const Rod> rods, bool lockstep, InstructionSet set);

  /// Returns an array with three axes, of one rod; 3 x points.
  [[nodiscard]] View view(int array, std::size_t rod) const;
  void set(PointArray array, std::size_t rod, const Eigen::Matrix3Xd& vectors);

  /// Whether a rigid grip holds the point.
  [[nodiscard]] bool held(Eigen::Index point, std::size_t rod) const {
    return at(is_free, element(point, rod)) == 0;
  }

  /// Copies the rods' walls. Their number must not exceed that in the constructor, so that nothing
  /// is allocated.
  void set_walls(std::span<const Rod> rods);

  /// Copies the spans between grips that hold the frame of a single rod, and their twist angles.
  /// Their number must not exceed that in the constructor, so that nothing is allocated.
  void set_twist(const Rod& rod);
  [[nodiscard]] bool twisted() const { return !twisted_spans_.empty(); }
  /// Updates the twist angles to the present shape, also in `angles`, and the moments of the
  /// joints.
  void update_twist(Eigen::VectorXd& angles);

  /// Determines whether all rods stay in the plane z = 0 in which they lie. Must be called after
  /// positions, loads, targets or walls have changed.
  void update_dimension(std::span<const Rod> rods);

  /// Computes the total forces on the free points; rods that are not `active` may be omitted.
  void compute_forces(std::span<const Rod> rods, const PerLane& active);

  /// Measures the modes of the present shape, whose forces must have been computed.
  void measure_modes(ModeMeasurement& measured) { kernel_->measure_modes(block(), measured); }

  /// Proposes movements, c_F forces + `momentum_factor` times the last proposed ones, and measures
  /// them.
  void propose(const PerLane& c_F, const PerLane& momentum_factor, const PerLane& rounding_squared,
               bool relative, ProposedStep& step);

  /// Moves the points of each rod by c_m times its proposed movements.
  void move(const PerLane& c_m);

  /// Returns the proposed movements of a rod in the last step.
  [[nodiscard]] View last_proposals(std::size_t rod) const;

 private:
  struct alignas(64) Line {
    double lane[block_lanes] = {};
  };

  [[nodiscard]] PointBlock block();
  [[nodiscard]] std::ptrdiff_t element(Eigen::Index point, std::size_t rod) const;
  [[nodiscard]] double& at(int array, std::ptrdiff_t element);
  [[nodiscard]] const double& at(int array, std::ptrdiff_t element) const;
  void set_padding();
  void set_rod(std::size_t lane, const Rod& rod);
  void add_spring_grips(std::span<const Rod> rods);
  void add_solids(std::span<const Rod> rods);
  void compute_plain_forces(std::size_t lane, const Rod& rod);

  Eigen::Index points_ = 0;
  std::ptrdiff_t stride_ = 1;
  std::ptrdiff_t size_ = 0;
  std::ptrdiff_t pitch_ = 0;
  InstructionSet set_ = InstructionSet::baseline;
  BendingLaw law_ = BendingLaw::hooke;
  bool natural_ = false;  // some rod is not intrinsically straight
  std::vector<TwistedSpan> twisted_spans_;
  const StepKernel* kernel_ = nullptr;
  std::vector<Line> memory_;
  std::vector<WallLanes> walls_;
  bool spring_grips_ = false;
  bool solids_ = false;
  int proposal_set_ = 0;  // set of proposals that the next step writes
  PerLane regular_;
  Eigen::Matrix3Xd plain_points_;
  Eigen::Matrix3Xd plain_forces_;
};

}  // namespace dlo::force_model
