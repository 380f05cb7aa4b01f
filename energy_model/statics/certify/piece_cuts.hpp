#pragma once

#include <vector>

#include "strain/span_solution.hpp"

namespace dlo::energy_model {

/// Returns element boundaries (Span::cuts) with which few coefficients resolve a shape that is
/// known approximately: at the peaks of its curvature, for example where a soft rod turns back, and
/// on both sides of peaks, grips, loads and section changes, where their effect has decayed. The
/// coefficients on an element decrease with the distance of the nearest complex singularity,
/// measured in half lengths of the element, if it is next to the element's middle, but with the
/// square root of that distance if it is at its end.
[[nodiscard]] std::vector<double> element_cuts(const SpanSolution& solution);

/// Returns the number of coefficients of each element that resolve a rod under this load to about
/// 1e-10 of its length. The load acts on an element of length h as h^2 of it would act on a rod of
/// length 1. A softer rod has elements of their own for the layers at its clamps.
[[nodiscard]] int first_terms(double load, double longest_element);

/// Returns the truncation indicator (SpanEnergy::truncation()) up to which the last of K
/// coefficients contribute at most `tolerance` to positions. The last one contributes an angle of
/// a_K / (2K), and its effect on positions is smaller by this factor again.
[[nodiscard]] inline double allowed_truncation(double tolerance, double K) {
  return tolerance * 4 * K * K;
}

/// Returns how many coefficients of a shape are needed so that the dropped ones contribute at most
/// `tolerance` (allowed_truncation()).
/// @param least  number of coefficients kept in any case, if there are as many
[[nodiscard]] int terms_needed(const SpanEnergy& model, const Eigen::VectorXd& x, double tolerance,
                               int least);

/// Returns the number of coefficients that resolve the buckling modes of a twisted span, helices
/// with a rate of half its torque, even if its own shape is simple.
[[nodiscard]] int terms_for_buckling_modes(const SpanSolution& solution);

/// Returns the arc lengths, ascending, at which a shape begins and ceases to press into a soft
/// obstacle, and at which it passes within it from one face, edge or corner to the next, where the
/// force per length has a kink. Also returns those at which it passes near the core of a cylinder,
/// capsule or ball.
[[nodiscard]] std::vector<double> contact_ends(const SpanSolution& solution);

/// Returns a bound of the force error [in the span's units] of a shape's series whose elements may
/// contain an end of contact with a soft obstacle. The contact force has a kink there. Near that
/// end the force per length is at most the obstacle's stiffness times the distance from the end.
[[nodiscard]] double misplaced_contact_error(const SpanSolution& solution);

/// Passage of a shape through the middle of a soft obstacle.
enum class MiddlePassage {
  none,
  through_line,  ///< through the axis of a cylinder or capsule, or a ball's centre
  on_ridge,      ///< planar, at equal distances from faces of a box on both sides of the plane
  near,          ///< so close to such a line that the series do not show the second variation
};

/// Second variation -(direction . dr(s))^2 of the energy at a point where a shape passes within a
/// box from the region of one face to that of another. The depth d is the smaller one of d_1 and
/// d_2, whose gradients n_1 and n_2 differ. A displacement dr of the rod shifts the point by ds =
/// -(n_2 - n_1) . dr / ((n_2 - n_1) . t), so that
///     direction = (k d / |(n_2 - n_1) . t|)^(1/2) (n_2 - n_1).
struct RidgeCrossing {
  double s = 0;
  Eigen::Vector3d direction = Eigen::Vector3d::Zero();
};

/// Returns all ridge crossings of a shape, by ascending s.
[[nodiscard]] std::vector<RidgeCrossing> ridge_crossings(const SpanSolution& solution);

/// Classifies how a shape passes the middles of soft obstacles. At the distance r from the axis of
/// a cylinder the second derivative of a contact's energy across the axis is -k R / r. Its integral
/// along a rod that crosses the axis has no lower bound, so that no such equilibrium is stable.
/// Series resolve this only down to the distance of their nodes from the axis. On a ridge the force
/// changes its direction with the side, so that no shape on it is an equilibrium.
[[nodiscard]] MiddlePassage classify_middle_passage(const SpanSolution& solution);

}  // namespace dlo::energy_model
