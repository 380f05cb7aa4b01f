#pragma once

#include <cstddef>

#include "dlo/force_model/bending_law.hpp"
#include "dlo/force_model/instruction_set.hpp"

// The step's arithmetic on plain arrays, compiled once per instruction set.

namespace dlo::force_model {

/// Elements are handled eight at a time, however many a register holds.
inline constexpr std::ptrdiff_t block_lanes = 8;

/// One number for each of eight rods; that of a single rod stands in lane 0.
struct alignas(64) PerLane {
  double lane[block_lanes] = {};
};

/// The arrays of a PointBlock by number; those with three axes take three numbers.
enum PointArray : int {
  positions = 0,         ///< P [m], 3 axes
  proposals = 3,         ///< movements before scaling [m], 3 axes, of this step and of the last
  forces = 9,            ///< on free points, 0 on rigidly held ones [N], 3 axes
  loads = 12,            ///< constant forces [N], 3 axes
  external_forces = 15,  ///< loads, walls and spring grips [N], 3 axes
  rest_lengths = 18,     ///< L_k of the segment from P_k to P_{k+1} [m]
  stretch = 19,          ///< c_c / L_k [N/m], 0 where there is no segment
  bend = 20,             ///< hooke: 2 EI / L [N m], paper: c_b [N]; 0 where there is no joint
  is_joint = 21,         ///< 1 where two segments meet, else 0
  is_segment = 22,       ///< 1 where a segment begins, else 0
  is_free = 23,          ///< 1 for points that move, 0 for rigidly held ones and padding
  turned_back = 24,      ///< 1 where a step goes against the one before; of this step and the last
  last_positions = 26,   ///< when the modes were last looked at [m], 3 axes
  last_forces = 29,      ///< then [N], 3 axes
  natural = 32,          ///< couple of a joint that is bent at rest [N m], from x to y
  twist_share = 33,      ///< twisting moment at a joint over its `bend` [-]; 0 where there is none
  point_array_count = 34
};

/// Structure of arrays. Element k of a single rod is point k (`stride` 1); of eight rods in
/// lockstep it is point k / 8 of rod k % 8 (`stride` 8). `size` is a multiple of eight. What is
/// left of it, and eight elements more, is padding: points that lie apart and do nothing.
struct PointBlock {
  double* first = nullptr;   ///< element 0 of array 0
  std::ptrdiff_t pitch = 0;  ///< from one array to the next
  std::ptrdiff_t size = 0;
};

/// A wall for each lane (see Wall); stiffness 0 where a rod has none.
struct WallLanes {
  PerLane point[3];
  PerLane normal[3];
  PerLane stiffness;
};

/// What a proposed step looks like.
struct ProposedStep {
  PerLane largest_squared;  ///< of the movements that the limit compares [m^2]
  PerLane sum_squared;      ///< of them; not finite if any movement is not [m^2]
  PerLane oscillating;      ///< points that turn back for the second time
};

/// What a look at the modes finds, see mode_bounds and ModeEstimate.
struct ModeLook {
  PerLane contraction;   ///< 4 c_c / L, the largest [N/m]
  PerLane bending;       ///< (16 M' + 4 M) / L^2, the largest [N/m]
  PerLane force_change;  ///< -dF.dP since the last look [N m]
  PerLane point_change;  ///< dP.dP [m^2]
};

/// What a kernel is made for.
struct KernelChoice {
  BendingLaw law = BendingLaw::hooke;  ///< of all joints
  int dimension = 3;                   ///< 2 (z stays 0) or 3
  bool natural = false;                ///< joints have couples; law hooke and dimension 2 only
  bool twisted = false;                ///< joints bear twist; law hooke, dimension 3, stride 1 only
};

/// The parts of a step for one choice, stride and instruction set.
struct StepKernel {
  /// external_forces = loads + walls
  void (*add_walls)(const PointBlock& block, const WallLanes* walls, std::ptrdiff_t count);
  /// forces = contraction + bending + `applied` (loads or external_forces). `regular` is 1 for
  /// rods where the formulas hold for every joint, 0 where a segment has no direction or a joint is
  /// folded beyond hooke_fold_angle: there `forces` means nothing.
  void (*compute_forces)(const PointBlock& block, PointArray applied, PerLane& regular);
  /// Compares positions and forces with the last look's and takes their place.
  void (*look_at_modes)(const PointBlock& block, ModeLook& look);
  /// proposals = c_F forces + kept * those of the last step, compared with their neighbours (18).
  /// @param turn  which of the two sets is this step's, 0 or 1; the other is the last step's
  /// @param rounding_squared  a point turns back if its proposals' scalar product is below minus
  ///                          this [m^2]
  void (*propose_relative)(const PointBlock& block, int turn, const PerLane& c_F,
                           const PerLane& kept, const PerLane& rounding_squared,
                           ProposedStep& step);
  /// The same, each on its own (16).
  void (*propose_absolute)(const PointBlock& block, int turn, const PerLane& c_F,
                           const PerLane& kept, const PerLane& rounding_squared,
                           ProposedStep& step);
  /// positions += c_m proposals; rods with c_m = 0 stay where they are.
  void (*move)(const PointBlock& block, int turn, const PerLane& c_m);
};

/// @param stride  1 or 8
/// @throws std::invalid_argument if the machine lacks the instruction set
[[nodiscard]] const StepKernel& step_kernel(InstructionSet set, const KernelChoice& choice,
                                            std::ptrdiff_t stride);

}  // namespace dlo::force_model
