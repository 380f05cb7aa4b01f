#pragma once

#include <cstddef>

#include "dlo/force_model/bending_law.hpp"
#include "dlo/force_model/instruction_set.hpp"

// Arithmetic of a step on plain arrays, compiled once per instruction set.

namespace dlo::force_model {

/// Number of elements that are processed together, independent of the register size.
inline constexpr std::ptrdiff_t block_lanes = 8;

/// One number for each of eight rods; lane 0 for a single rod.
struct alignas(64) PerLane {
  double lane[block_lanes] = {};
};

/// Index of each array of a PointBlock; arrays with three axes have three consecutive indices.
enum PointArray : int {
  positions = 0,         ///< P [m], 3 axes
  proposals = 3,         ///< movements before scaling [m], 3 axes, of this step and of the last
  forces = 9,            ///< forces on free points, 0 on rigidly held ones [N], 3 axes
  loads = 12,            ///< constant forces [N], 3 axes
  external_forces = 15,  ///< loads, walls, solids, spring grips [N], 3 axes
  rest_lengths = 18,     ///< L_k of the segment from P_k to P_{k+1} [m]
  stretch = 19,          ///< c_c / L_k [N/m], 0 where there is no segment
  bend = 20,             ///< hooke: 2 EI / L [N m], paper: c_b [N]; 0 where there is no joint
  is_joint = 21,         ///< 1 where two segments meet, else 0
  is_segment = 22,       ///< 1 where a segment begins, else 0
  is_free = 23,          ///< 1 for points that move, 0 for rigidly held ones and padding
  turned_back = 24,  ///< 1 where a step is opposite to the previous one; of this step and the last
  last_positions = 26,  ///< positions at the last measurement of the modes [m], 3 axes
  last_forces = 29,     ///< forces at the last measurement of the modes [N], 3 axes
  natural = 32,         ///< couple of a joint that is bent at rest [N m], from x to y
  /// Twisting moment at a joint divided by its `bend` [-]; 0 where there is none.
  twist_share = 33,
  point_array_count = 34
};

/// Structure of arrays. Element k of a single rod is point k (`stride` 1); element k of eight rods
/// is point k / 8 of rod k % 8 (`stride` 8). `size` is a multiple of eight. Elements beyond the
/// points, and eight more, are padding: points far away that exert no forces.
struct PointBlock {
  double* first = nullptr;   ///< element 0 of array 0
  std::ptrdiff_t pitch = 0;  ///< distance between consecutive arrays
  std::ptrdiff_t size = 0;
};

/// A wall for each lane (see Wall); stiffness 0 where a rod has none.
struct WallLanes {
  PerLane point[3];
  PerLane normal[3];
  PerLane stiffness;
};

/// Measures of a proposed step.
struct ProposedStep {
  PerLane largest_squared;  ///< largest square of the movements that the limit compares [m^2]
  PerLane sum_squared;      ///< sum of their squares; not finite if any movement is not [m^2]
  PerLane oscillating;      ///< number of points that reverse their direction twice in succession
};

/// Results of a measurement of the modes, see mode_bounds and ModeEstimate.
struct ModeMeasurement {
  PerLane contraction;   ///< largest 4 c_c / L [N/m]
  PerLane bending;       ///< largest (16 M' + 4 M + 4 |natural couple|) / L^2 [N/m]
  PerLane force_change;  ///< -dF.dP since the last measurement [N m]
  PerLane point_change;  ///< dP.dP since the last measurement [m^2]
};

/// Properties of a rod that select its kernel.
struct KernelChoice {
  BendingLaw law = BendingLaw::hooke;  ///< law of all joints
  int dimension = 3;                   ///< 2 (z stays 0) or 3
  bool natural = false;  ///< whether joints have natural couples; law hooke and dimension 2 only
  bool twisted = false;  ///< whether joints carry twist; law hooke, dimension 3, stride 1 only
};

/// Functions of a step for one choice, stride and instruction set.
struct StepKernel {
  /// Computes external_forces = loads + walls.
  void (*add_walls)(const PointBlock& block, const WallLanes* walls, std::ptrdiff_t count);
  /// Computes the forces on free points = contraction + bending + twist + `applied` (loads or
  /// external_forces), and 0 for other points. `regular` is set to 1 for rods for which the
  /// formulas hold at every joint. It is set to 0 if a segment has no direction or a joint of
  /// either law is folded beyond hooke_fold_angle: then `forces` is undefined.
  void (*compute_forces)(const PointBlock& block, PointArray applied, PerLane& regular);
  /// Compares positions and forces with those of the last measurement and replaces the latter.
  void (*measure_modes)(const PointBlock& block, ModeMeasurement& measured);
  /// Computes proposals = c_F forces + momentum_factor * those of the last step, each compared with
  /// that of the next point (18).
  /// @param turn  set of proposals of this step, 0 or 1; the other is the last step's
  /// @param rounding_squared  a point reverses its direction if the scalar product of its proposals
  /// is below minus this [m^2]
  void (*propose_relative)(const PointBlock& block, int turn, const PerLane& c_F,
                           const PerLane& momentum_factor, const PerLane& rounding_squared,
                           ProposedStep& step);
  /// Computes the same proposals, each compared on its own (16).
  void (*propose_absolute)(const PointBlock& block, int turn, const PerLane& c_F,
                           const PerLane& momentum_factor, const PerLane& rounding_squared,
                           ProposedStep& step);
  /// Computes positions += c_m proposals; rods with c_m = 0 do not move.
  void (*move)(const PointBlock& block, int turn, const PerLane& c_m);
};

/// Returns the kernel for a choice. @param stride  1 or 8
/// @throws std::invalid_argument if the machine lacks the instruction set
[[nodiscard]] const StepKernel& step_kernel(InstructionSet set, const KernelChoice& choice,
                                            std::ptrdiff_t stride);

}  // namespace dlo::force_model
