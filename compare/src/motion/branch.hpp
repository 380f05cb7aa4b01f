#pragma once

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

/// One frame's scene and what the energy model says of it.
struct Moment {
  Scene scene;
  energy_model::Equilibrium rod;
  double couples = 0;  ///< by which the zero of their potential has moved since the first frame [J]
};

/// Returns energies whose zeros stay where they are while grippers move: gravity and forces are
/// zero at the origin, couples where energy_model::couple_zero() is in the first frame.
[[nodiscard]] SceneEnergies energies_of(const Moment& moment);

/// How the rod has come to a frame from the one before.
struct Passage {
  bool kept = true;      ///< on its branch: next to the shape before, and no energy is missing
  bool smaller = false;  ///< in smaller steps than a frame
  bool stands = false;   ///< nothing has moved
  /// A branch that is not kept: whether it has been seen to end, by its stability or by a contact's
  /// force that vanishes.
  bool ended = false;
  /// Of the last shape on a branch that is not kept.
  double last_eigenvalue = std::numeric_limits<double>::quiet_NaN();
  double work = 0;  ///< of grippers and obstacles on the rod [J]
  /// That less what the energy has grown by, of a branch that is not kept in its snaps alone, and
  /// what it may be with forces between those before and after each step [J]. NaN where
  /// Branch::balances() is false.
  double released = 0, released_bound = 0;
};

/// What of a shape tells whether its branch comes to an end.
struct BranchWitness {
  double at = 0;  ///< when, in frames
  /// Of the second variation, over EI/l [-]; NaN: not known.
  double smallest_eigenvalue = std::numeric_limits<double>::quiet_NaN();
  std::vector<energy_model::ContactPart> contacts;
};

/// Whether a branch has been seen to end before a step that left it: at a fold the square of the
/// smallest eigenvalue comes to zero in proportion to the way that is left, at a bifurcation it
/// does so itself, and where an obstacle lets go of the rod its force.
/// @param before, last  the last two shapes on it; @param rejected  the step from the last one
/// [frames]
[[nodiscard]] bool shows_its_end(const BranchWitness& before, const BranchWitness& last,
                                 double rejected);

/// The shapes of a rod at rest in the frames of a motion, each on the branch of the one before as
/// long as there is one.
///
/// A step keeps it if Newton's method leads to a stable shape next to the one before, the energy
/// grows by the work that is done, to the bound of forces between those of both shapes, and the rod
/// goes through no obstacle. Where a whole frame's step does not, smaller ones are made, down to
/// `smallest_step` of a frame, and beyond them the rod is in the shape that a search finds there;
/// then it is followed on.
class Branch {
 public:
  /// Share of a frame to which the end of a branch is looked for.
  static constexpr double smallest_step = 1.0 / 1024;

  /// @param scene  with its motion; it and the clock outlive this
  Branch(const Scene& scene, const FrameClock& clock, const energy_model::EnergyOptions& options);

  /// Those that are in reach at any of the frames, by their number in the scene.
  [[nodiscard]] const std::vector<std::size_t>& obstacles() const { return obstacles_; }
  /// Whether work and energy are known: not where obstacles yield, nor out of a plane or with held
  /// frames where the rod has material directors.
  [[nodiscard]] bool balances() const { return balances_; }

  /// The lowest shape that is found in the first frame.
  /// @throws InputError, std::invalid_argument if the frame is impossible
  void begin();
  /// Goes on to the next frame. Whether a shape has been found: now().rod.status
  /// @throws InputError, std::invalid_argument if the frame is impossible
  [[nodiscard]] Passage next();
  /// The last frame.
  [[nodiscard]] const Moment& now() const { return now_; }

 private:
  [[nodiscard]] bool stands() const;
  [[nodiscard]] Scene scene_at(double share) const;
  void go_to_frame(Passage& passage);
  double leave(double at, double rejected, Passage& passage);
  [[nodiscard]] bool try_follow(Scene scene, double from, double step, Passage& passage);
  void witness(double at);

  const Scene& scene_;
  const FrameClock& clock_;
  std::vector<std::size_t> obstacles_;
  energy_model::EnergySolver solver_;
  bool balances_ = true;
  double noise_ = 0;
  std::size_t frame_ = 0;
  Moment now_;
  std::vector<Eigen::Vector3d> changes_;              // of forces, in the last step
  std::optional<std::array<BranchWitness, 2>> seen_;  // the last two shapes
};

}  // namespace dlo::compare
