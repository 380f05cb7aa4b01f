#pragma once

#include <cstddef>

#include "dlo/force_model/bending_law.hpp"
#include "dlo/force_model/instruction_set.hpp"

// The step's arithmetic on plain arrays, compiled once per instruction set.

namespace dlo::force_model {

/// Elements are handled eight at a time, however many a register holds.
inline constexpr std::ptrdiff_t block_lanes = 8;

/// One number for each of eight rods, or eight times that of a single rod.
struct alignas(64) PerLane {
  double lane[block_lanes] = {};
};

/// The arrays of a PointBlock by number; those with three axes take three numbers.
enum PointArray : int {
  positions = 0,         ///< P [m], 3 axes
  movements = 3,         ///< of the last step [m], 3 axes
  proposals = 6,         ///< movements of this step before scaling [m], 3 axes
  forces = 9,            ///< on free points, 0 on rigidly held ones [N], 3 axes
  loads = 12,            ///< constant forces [N], 3 axes
  external_forces = 15,  ///< loads, walls and spring grips [N], 3 axes
  segment_forces = 18,   ///< of segment k on P_k; the opposite acts on P_{k+1} [N], 3 axes
  lengths = 21,          ///< of segment k, from P_k to P_{k+1} [m]
  inverse_lengths = 22,  ///< [1/m]
  joint_factors = 23,    ///< m_k in step_kernel.cpp [N/m]
  rest_lengths = 24,     ///< L_k [m]
  stretch = 25,          ///< c_c / L_k [N/m], 0 where there is no segment
  bend = 26,             ///< hooke: 2 EI / L [N m], paper: c_b [N]; 0 where there is no joint
  is_joint = 27,         ///< 1 where two segments meet, else 0
  is_segment = 28,       ///< 1 for a rod's segments, else 0
  is_free = 29,          ///< 1 for points that move, 0 for rigidly held ones and padding
  turned_back = 30,      ///< 1 where the last step went against the one before
  point_array_count = 31
};

/// Structure of arrays. Element k of a single rod is point k (`stride` 1); of eight rods in
/// lockstep it is point k / 8 of rod k % 8 (`stride` 8). Before its `size` elements, a multiple of
/// eight, and two strides behind them each array has more that are read but change nothing.
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

/// What a proposed step looks like, for each lane; the lanes of a single rod are parts of it.
struct ProposedStep {
  PerLane largest_squared;  ///< of the movements that the limit compares [m^2]
  PerLane sum_squared;      ///< of them; not finite if any movement is not [m^2]
  PerLane oscillating;      ///< points that turn back for the second time
};

/// The parts of a step for one bending law, dimension, stride and instruction set.
struct StepKernel {
  /// external_forces = loads + walls
  void (*add_walls)(PointBlock block, const WallLanes* walls, std::ptrdiff_t count);
  /// forces = contraction + bending + `applied` (loads or external_forces). `regular` is 1 in
  /// lanes where the formulas hold for every joint, 0 where a segment has no direction or a joint
  /// is folded beyond hooke_fold_angle: there `forces` means nothing.
  void (*compute_forces)(PointBlock block, PointArray applied, PerLane& regular);
  /// proposals = c_F forces + c_h movements, compared with their neighbours (18)
  void (*propose_relative)(PointBlock block, const PerLane& c_F, const PerLane& c_h,
                           ProposedStep& step);
  /// the same, each on its own (16)
  void (*propose_absolute)(PointBlock block, const PerLane& c_F, const PerLane& c_h,
                           ProposedStep& step);
  /// movements = c_m proposals, positions += movements; lanes with c_m = 0 stay as they are
  void (*move)(PointBlock block, const PerLane& c_m);
};

/// @param stride  1 or 8; @param dimension  2 (z stays 0) or 3
/// @throws std::invalid_argument if the machine lacks the instruction set
[[nodiscard]] const StepKernel& step_kernel(InstructionSet set, BendingLaw law, int dimension,
                                            std::ptrdiff_t stride);

}  // namespace dlo::force_model
