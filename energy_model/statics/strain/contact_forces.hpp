#pragma once

#include <Eigen/Core>
#include <vector>

#include "strain/contact_place.hpp"

namespace dlo::energy_model {

/// Forces with which a rigid obstacle holds a contact, away from it: at the begin and the end of
/// the part in contact, which are the same where it touches at one point, and between.
struct ContactForce {
  Eigen::Vector3d force = Eigen::Vector3d::Zero();   ///< of all of it
  Eigen::Vector3d moment = Eigen::Vector3d::Zero();  ///< of all rows, about the span's anchor
  double total = 0;                                  ///< sum of the magnitudes
  double begin = 0, end = 0;  ///< concentrated ones; `end` is 0 where it touches at one point
  double least_pressure = 0;  ///< per length, of what lies; 0 where it touches at one point
  double largest_pressure = 0;
  /// Least concentrated one inside, at loads and sections; what the series of two pieces differ by
  /// elsewhere is their error.
  double least_inner = 0;
  /// What the multipliers exert besides, away from the obstacle, on a grip that holds the begin or
  /// the end of the part: it is in `moment`, and the grip's force, not the obstacle's.
  double held_begin = 0, held_end = 0;
};

/// Which multipliers of ContactRows are a contact's: of its begin's, or the least, clearance (-1: a
/// grip holds it there), and of the slope on each of its pieces.
struct ContactSeries {
  struct Slope {
    Eigen::Index first = 0, count = 0;
    double length = 0;          ///< of the piece
    bool concentrates = false;  ///< a load, a section's end or a grip is where it begins
  };
  Eigen::Index clearance = -1;
  std::vector<Slope> slopes;
  bool held_at_begin = false, held_at_end = false;  ///< by a grip
};

/// On a part that is shorter [lengths] a few moments of the slope say all: more would be a system
/// whose rounding hides Newton's last step, and forces that are made of it.
inline constexpr double short_part = 5e-3;

/// What the multipliers' series N(s) = sum mu phi(s) of one contact says, but for the direction of
/// its force. @param multipliers  of all contacts' rows
[[nodiscard]] ContactForce force_of_series(const ContactSeries& rows,
                                           const Eigen::VectorXd& multipliers);

/// Moment about the span's anchor of what one contact's multipliers exert.
/// @param tangents  nodes x 3
[[nodiscard]] Eigen::Vector3d moment_of(const ContactSeries& rows, const ContactPlace& place,
                                        const Eigen::MatrixX3d& tangents,
                                        const Eigen::VectorXd& multipliers);

}  // namespace dlo::energy_model
