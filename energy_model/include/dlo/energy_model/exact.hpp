#pragma once

#include <limits>

#include "dlo/energy_model/equilibrium.hpp"
#include "dlo/energy_model/problem.hpp"

namespace dlo::energy_model {

/// How well to integrate, and from where.
struct ExactOptions {
  double tolerance = 1e-13;  ///< local error of the integrator per step, > 0
  /// Of the whole call [s], > 0; the status is then `time_limit`, with the lowest shape so far if
  /// there is one: it is an equilibrium, but others were not looked for.
  double time_limit = std::numeric_limits<double>::infinity();
  /// A shape to confirm or correct, of this problem or a similar one, with its grips' reactions:
  /// Newton's method starts from it, without a search. Has to outlive the call. Where clamps twist
  /// the rod it starts with the torque of the shape's `twists` and counts whole turns as they do. A
  /// shape without `twists` is taken for the rod without twist. Of a rod with material directors
  /// the frames are those of the shape's d1 or, if it has none, follow from the first clamp's, of
  /// which there has to be one, and from what the grips exert.
  const Equilibrium* start = nullptr;
};

/// Equilibrium of the inextensible rod as a boundary value problem, by GSL and without any basis.
/// Of a round one that is intrinsically straight
///     r' = t,  EI t'' = -(n - (n.t) t) - EI |t'|^2 t + M t x t',  n' = -w,  n falls by F at a load
///     F,  EI t' stays where sections meet,
/// n the force of what lies beyond s on what lies before, M the torque of the twist, which is
/// constant between two clamps that hold the rod's frame and zero elsewhere; of one with material
/// directors (Problem)
///     r' = t,  R' = R hat(u),  m = R diag(EI_1, EI_2, GJ) (u - u0),  m' = n x t,  n' = -w,
/// R = (d1, d2, t), m the moment of what lies beyond.
///
/// A round planar rod of one section, intrinsically straight, with one clamp at an end is shot from
/// its tip and all of the tip's angles are scanned; for sums of weight and loads over EI/l^2 up to
/// 4e5 if they are parallel, up to 60 if not. The scan's cells are halved until a cubic describes
/// the residual of the clamp's angle in them, and pairs of roots are looked for at its extrema:
/// found are all equilibria in the plane but those that lie closer together than the scan resolves
/// (at a fold: within 1e-7 of its Gamma). Those out of the plane are not.
///
/// All others that are round and intrinsically straight (any clamps and pins, in the plane or in
/// space, up to 1e6 EI/l^2 of the softest section) are cut at their clamps and solved by multiple
/// shooting: Newton's method closes the gaps between integrations over short intervals. It starts
/// from `start`, or from the six lowest minima (sixteen while nothing is stable) that a coarse
/// polygon of frames finds when L-BFGS relaxes it from the natural shape, straight, hanging,
/// arched, S-shaped and looped ones, in the plane and out of it, and from beside the unstable
/// equilibria that lie below all stable ones. That is a search: it may miss equilibria.
///
/// Twist (Problem) is put in from the lowest equilibrium without it, by continuation in the roll;
/// where a shape becomes unstable the gradient flow of the energy leads to the next stable one, the
/// rod passing through itself if it has to. `all_exact` has one shape of a twisted part then. If it
/// ends before the whole roll the status is `failed` and the message says how far it came: long
/// rods whose buckle moves along them for nearly nothing may need a `start`.
///
/// Over rigid half-spaces a loaded round rod of one section, intrinsically straight, with one clamp
/// at its begin is followed while weight and loads are raised from nothing: its end is free,
/// touches or lies. The branch's end may be a `saddle` where there is a minimum.
///
/// Any other contact of a round untwisted rod of one section with rigid bodies needs a `start`
/// whose contacts say which parts touch what. Multiple shooting confirms or corrects it: where a
/// part lies the rod is integrated along the plane, cylinder or ball, whose pressure is what keeps
/// it there; gap, slope and curvature are the surface's where it lifts off, gap and slope vanish
/// where it touches at a point, the gap at a tip; those arc lengths and the concentrated forces are
/// unknowns. Where Newton's method does not close the shots it is `failed`; with depths elsewhere
/// or forces that pull it is `not_verified`: no other contact is looked for. Whether the second
/// variation is positive is asked of its own elements, with its norm times 1e-3 on or off it;
/// `smallest_eigenvalue` is not known. A rod that lies on both sides of a grip or on two features
/// of a body side by side is refused.
///
/// A rod with material directors is not cut, because its torque passes through clamps that do not
/// hold the frame; the first clamp holds the frame that Problem says. Else it is solved alike. The
/// frames of clamps after the first are let go for the search. Then they are turned, all together,
/// from where the lowest shape has them, by their roll less the first clamp's and to their d1 by
/// the angle in (-pi, pi] that is left if both rolls are zero. `twists` has a part for each two
/// neighbouring clamps that hold frames, of which the first clamp is one.
///
/// The second variation of each equilibrium is looked at on its own shape, by finite elements, in
/// space and under the grips' constraints: `smallest_eigenvalue` is its smallest eigenvalue over
/// int |eta'|^2 + |eta|^2 ds, eta the change of the tangent, of a rod with material directors the
/// spin of its cross-sections, lengths in l. The stable equilibrium of lowest energy is returned;
/// if none is stable the lowest one, as `saddle`. The message counts the zero modes (rotation about
/// a line), combinations of spans beyond the 64 lowest, and tips that could not be shot from.
/// @throws std::invalid_argument if the problem or an option is out of range, or has obstacles that
/// are not as said above
Equilibrium solve_exact(const Problem& problem, const ExactOptions& options = {});

/// Every equilibrium that the scan or the search finds, stable ones first, by energy; unstable ones
/// have the status `saddle`. Of several spans the 64 lowest combinations; the message says if there
/// are more. If the time is up before the search is, what it has found until then: all have the
/// status `time_limit`, and the message says what they are. Empty if nothing was found.
[[nodiscard]] std::vector<Equilibrium> all_exact(const Problem& problem,
                                                 const ExactOptions& options = {});

/// Gamma = w l^3 / (EI) at which an upright rod buckles under its own weight: z^3 with z the first
/// root of sqrt(3) Ai(-z) + Bi(-z).
[[nodiscard]] double self_buckling_gamma();

}  // namespace dlo::energy_model
