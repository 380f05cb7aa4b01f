#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "dlo/obstacle/body.hpp"
#include "frames/position_operator.hpp"

namespace dlo::energy_model {

/// Values of ContactRows at a shape.
struct ContactEvaluation {
  /// Values of the row of a smallest clearance.
  struct ClearanceMinimum {
    PositionOperator::Point point;  ///< weights of the point
    double at = 0;                  ///< arc length of the point
    obstacle::Gap gap;
    Eigen::Vector3d tangent = Eigen::Vector3d::Zero();
    double rate = 0;  ///< second derivative of the clearance by s; 0 if no minimum was found
  };
  Eigen::VectorXd residual;  ///< residuals of all rows
  /// Derivatives of the rows by the tangents: a matrix for each axis, nodes x rows.
  std::array<Eigen::MatrixXd, 3> by_tangent;
  std::vector<ClearanceMinimum> clearance_minima;
  /// Clearances of points from bodies other than half-spaces, with their derivatives: one list for
  /// the clearance at the begin of a contact, and one for the slope on each of its elements.
  std::vector<std::vector<obstacle::Gap>> gaps;

  /// Returns the products of the rows' derivatives with the vectors at the nodes, nodes x rows.
  [[nodiscard]] Eigen::MatrixXd along(const Eigen::MatrixX3d& vectors) const;
  /// Adds the sum of the multipliers times the rows' gradients by the tangents to `carried`, nodes
  /// x 3.
  void add(const Eigen::Ref<const Eigen::VectorXd>& multipliers, Eigen::MatrixX3d& carried) const;
};

/// Returns the moment about the anchor of forces that act on all that lies beyond each node.
/// @param carried  weight of the node times the force that the rod carries there, nodes x 3
[[nodiscard]] Eigen::Vector3d moment_about_anchor(const Eigen::MatrixX3d& tangents,
                                                  const Eigen::MatrixX3d& carried);

/// Forces of a rigid obstacle on one contact, positive away from the obstacle: concentrated forces
/// at the begin and the end of the part in contact, which coincide for a contact at one point, and
/// a pressure between them.
struct ContactForce {
  Eigen::Vector3d force = Eigen::Vector3d::Zero();  ///< resultant
  /// Moment of the contact's rows about the span's anchor.
  Eigen::Vector3d moment = Eigen::Vector3d::Zero();
  double total = 0;           ///< sum of the forces along the normals
  double begin = 0, end = 0;  ///< concentrated forces; `end` is 0 for a contact at one point
  /// Smallest and largest force per length along the part; 0 for a contact at one point.
  double least_pressure = 0;
  double largest_pressure = 0;
  /// Smallest concentrated force inside the part, at loads, grips and section changes; 0 if none is
  /// negative. Jumps between the series of two elements elsewhere are truncation errors and do not
  /// count.
  double least_inner_force = 0;
  /// Force, away from the obstacle, that the multipliers also exert on a grip at the begin or the
  /// end of the part. It is included in `moment`, and belongs to the grip, not to the obstacle.
  double held_begin = 0, held_end = 0;
};

/// Indices of the multipliers of ContactRows that belong to one contact: the multiplier of the
/// clearance at its begin, or of the smallest clearance (-1: a grip holds the contact), and the
/// multipliers of the slope on each of its elements.
struct ContactSeries {
  struct Slope {
    Eigen::Index first = 0, count = 0;
    double length = 0;  ///< length of the element
    bool may_concentrate_force =
        false;  ///< whether a load, a section change or a grip is at its begin
  };
  Eigen::Index clearance = -1;
  std::vector<Slope> slopes;
  /// Whether a grip is at the begin or end of the contact.
  bool held_at_begin = false, held_at_end = false;

  /// Returns the multipliers of all contacts with zeros for those of other contacts.
  [[nodiscard]] Eigen::VectorXd own(const Eigen::VectorXd& multipliers) const;
};

/// Length of an element of a contact, divided by the rod length, below which only a few moments of
/// the slope are rows.
/// With more moments rounding would dominate Newton's last step and the forces derived from it.
inline constexpr double short_part = 5e-3;

/// Returns the forces of one contact from the multipliers' series N(s) (ContactRows);
/// ContactForce::force and ContactForce::moment remain zero.
/// @param multipliers  of the rows of all contacts
[[nodiscard]] ContactForce force_of_series(const ContactSeries& rows,
                                           const Eigen::VectorXd& multipliers);

}  // namespace dlo::energy_model
