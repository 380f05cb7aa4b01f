#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "frames/position_operator.hpp"
#include "problem/span.hpp"

namespace dlo::energy_model {

/// What a rigid obstacle resists with, own units: force per length of rod at a depth d
///     p = k d^2 max(0, 1 + d' / u),
/// Hunt's and Crossley's law (J. Appl. Mech. 42, 1975), never a pull. k d^3 / 3 is kept, the rest
/// is lost. What has struck leaves with at most u.
struct ContactLaw {
  double stiffness = 0;  ///< k
  double rebound = 0.1;  ///< u
  double depth = 1e-3;   ///< that k is to allow at most, which says how close the points have to be
};

/// Where an obstacle is at one time and how it moves, along SpanDrive's axes.
struct BodyPlace {
  Eigen::Matrix3d turn = Eigen::Matrix3d::Identity();  ///< from the frame that its Body is in
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();    ///< of that frame
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();  ///< of the origin
  Eigen::Vector3d spin = Eigen::Vector3d::Zero();

  [[nodiscard]] Eigen::Vector3d inside(const Eigen::Vector3d& at) const {
    return turn.transpose() * (at - origin);
  }
};

/// A point of a span within an obstacle, and what that does.
struct Touch {
  std::size_t obstacle = 0;  ///< of the problem's
  Eigen::Vector3d at = Eigen::Vector3d::Zero();
  Eigen::Vector3d normal = Eigen::Vector3d::UnitY();   ///< unit, out of the obstacle
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();  ///< of the obstacle there
  double depth = 0;                                    ///< > 0
  std::size_t piece = 0;                               ///< where it is in a ContactGrid
  Eigen::Index point = 0;                              ///< of the piece's, the same
  double push = 0;                                     ///< force on the rod along the normal
  double kept = 0;                                     ///< energy
  double lost = 0;                                     ///< by time
  double by_depth = 0;                                 ///< derivative of the push
  double by_rate = 0;                                  ///< the same

  /// Up to `depth`.
  Touch(const Span::Obstacle& of, const BodyPlace& place, const Eigen::Vector3d& where);
  [[nodiscard]] Eigen::Vector3d force() const { return push * normal; }
};

/// Points of a span at which it is held against rigid obstacles: evenly on each piece, both ends
/// with them. Their positions are those of the polynomials through the tangents at the nodes, so
/// that forces at them have just the work that they do on the unknowns.
class ContactGrid {
 public:
  /// Points that are no farther apart than 1/128; on a body that is not flat twice law.depth, where
  /// that is less, so that what bears on one point is known to be there to law.depth, and an edge
  /// does not come between two by more.
  ContactGrid(const std::vector<Span::Obstacle>& obstacles, const PositionOperator& reach,
              const ContactLaw& law);

  [[nodiscard]] bool empty() const { return pieces_.empty(); }
  /// Points of a piece.
  [[nodiscard]] const PointsReach& points(std::size_t piece) const { return pieces_[piece]; }
  /// Adds those of a piece that are within an obstacle.
  /// @param begin  of the piece;  @param tangents  nodes x 3
  void find(std::size_t piece, const Span::Obstacle& obstacle, const BodyPlace& place,
            const Eigen::Vector3d& begin, const Eigen::MatrixX3d& tangents,
            std::vector<Touch>& found) const;
  /// Takes in the rate at which the depth grows. Sets what the law says.
  void resist(double rate, Touch& touch) const;

 private:
  ContactLaw law_;
  std::vector<double> spacings_;
  std::vector<PointsReach> pieces_;
};

}  // namespace dlo::energy_model
