#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <limits>
#include <optional>
#include <vector>

#include "dlo/compare/scene.hpp"
#include "dlo/compare/solution.hpp"
#include "dlo/energy_model/energy.hpp"
#include "motion/frame_clock.hpp"

namespace dlo::compare {

/// The scene at one time of the motion, and the energy model's solution.
struct SolvedInstant {
  Scene scene;
  energy_model::Equilibrium rod;
  double couple_potential_offset = 0;  ///< offset of the zero of the couples' potential since the
                                       ///< first frame [J]
};

/// Returns energies with zeros that do not move with the grippers: those of gravity and forces are
/// at the origin, that of couples is at energy_model::couple_zero() of the first frame.
[[nodiscard]] SceneEnergies energies_of(const SolvedInstant& moment);

/// How the rod reached a frame from the one before.
struct Passage {
  bool stayed_on_branch = true;    ///< it stayed on its branch: each shape is close to the one
                                   ///< before, and the energy balances
  bool has_smaller_steps = false;  ///< whether steps smaller than a frame were made
  bool is_stationary = false;      ///< whether nothing moved
  /// If the branch was not kept: whether the end of each branch left was observed, as loss of
  /// stability or as a vanishing contact force.
  bool end_was_observed = false;
  /// Smallest eigenvalue of the last shape on a branch that was not kept, divided by EI/l [-].
  double last_eigenvalue = std::numeric_limits<double>::quiet_NaN();
  double work = 0;  ///< work of grippers and obstacles on the rod [J]
  /// Work minus the increase of the energy, for a branch that was not kept only of its snaps, and
  /// the bound of its error by forces between those before and after each step [J]. `released` is
  /// NaN if Branch::has_energy_balance() is false.
  double released = 0, released_bound = 0;
};

/// Quantities of a shape that show whether its branch is about to end.
struct BranchSample {
  double at = 0;  ///< time [frames]
  /// Smallest eigenvalue of the second variation, divided by EI/l [-]; NaN if unknown.
  double smallest_eigenvalue = std::numeric_limits<double>::quiet_NaN();
  std::vector<energy_model::ContactPart> contacts;
};

/// Whether a branch was observed to end before a step that left it. At a fold the square of the
/// smallest eigenvalue decreases to zero in proportion to the distance from the fold, at a
/// bifurcation the eigenvalue itself does, and where an obstacle releases the rod the contact force
/// does.
/// @param before, last  the last two shapes on the branch
/// @param rejected  size of the step from the last one [frames]
[[nodiscard]] bool branch_ends_before(const BranchSample& before, const BranchSample& last,
                                      double rejected);

/// The equilibrium shapes of a rod in the frames of a motion, each on the branch of the one before
/// as long as the branch exists.
///
/// A step keeps the branch if Newton's method converges to a stable shape close to the one before,
/// the energy increases by the work within the bound for forces between those of both shapes (if
/// has_energy_balance()), and the rod does not pass through an obstacle. If a step of a whole frame
/// does not, smaller steps are made, down to `smallest_step` of a frame. Beyond the end of the
/// branch the rod takes the next minimum downhill of its last shape, or else the shape that a
/// search finds there, and is followed from it.
class Branch {
 public:
  /// Size of a step, in frames, down to which the end of a branch is located.
  static constexpr double smallest_step = 1.0 / 1024;

  /// @param scene  with its motion; scene and clock must outlive this
  Branch(const Scene& scene, const FrameClock& clock, const energy_model::EnergyOptions& options);

  /// Returns the indices of the scene's obstacles that are in reach in any frame.
  [[nodiscard]] const std::vector<std::size_t>& obstacles() const { return obstacles_; }
  /// Whether work and energy are known. They are not with yielding obstacles, nor, for a rod with
  /// material directors, out of a plane or with held frames.
  [[nodiscard]] bool has_energy_balance() const { return has_energy_balance_; }

  /// Solves the first frame: the lowest shape that is found.
  /// @throws InputError, std::invalid_argument if the frame is invalid
  void begin();
  /// Continues to the next frame. now().rod.status states whether a shape was found.
  /// @throws InputError, std::invalid_argument if the frame is invalid
  [[nodiscard]] Passage next();
  /// Returns the last frame.
  [[nodiscard]] const SolvedInstant& now() const { return now_; }

 private:
  [[nodiscard]] bool is_stationary() const;
  [[nodiscard]] Scene scene_at(double share) const;
  void advance_to_frame(Passage& passage);
  double leave_branch(double at, double rejected, Passage& passage);
  [[nodiscard]] bool try_follow(Scene scene, double from, double step, Passage& passage);
  void record_sample(double at);

  const Scene& scene_;
  const FrameClock& clock_;
  std::vector<std::size_t> obstacles_;
  energy_model::EnergySolver solver_;
  bool has_energy_balance_ = true;
  double noise_ = 0;
  std::size_t frame_ = 0;
  SolvedInstant now_;
  std::vector<Eigen::Vector3d> changes_;  // rates of change of the forces in the last step
  std::optional<std::array<BranchSample, 2>> last_samples_;  // the last two shapes
};

}  // namespace dlo::compare
