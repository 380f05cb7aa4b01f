#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "base/legendre.hpp"
#include "problem/span.hpp"
#include "strain/piece.hpp"

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
  [[nodiscard]] Eigen::Vector3d velocity_at(const Eigen::Vector3d& at) const {
    return velocity + spin.cross(at - origin);
  }
};

/// A point of a ContactGrid within an obstacle.
struct Touch {
  std::size_t obstacle = 0;  ///< of Span::rigid_obstacles
  std::size_t piece = 0;
  Eigen::Index point = 0;  ///< of the piece's
  Eigen::Vector3d at = Eigen::Vector3d::Zero();
  Eigen::Vector3d normal = Eigen::Vector3d::UnitY();   ///< unit, out of the obstacle
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();  ///< of the obstacle there
  double depth = 0;                                    ///< > 0
  double rate = 0;                                     ///< d'
  double push = 0;                                     ///< force on the rod along the normal
  double kept = 0;                                     ///< energy
  double lost = 0;                                     ///< by time
  double by_depth = 0;                                 ///< derivative of the push
  double by_rate = 0;                                  ///< the same
};

/// Points of a span at which it is held against rigid obstacles: evenly on each piece, both ends
/// with them. Their positions are those of the polynomials through the tangents at the nodes, so
/// that forces at them have just the work that they do on the unknowns.
class ContactGrid {
 public:
  /// Points that are no farther apart than 1/128; on a body that is not flat twice law.depth, where
  /// that is less, so that what bears on one point is known to be there to law.depth, and an edge
  /// does not come between two by more.
  ContactGrid(const std::vector<Span::Obstacle>& obstacles, const std::vector<Piece>& pieces,
              const LegendreTable& table, const ContactLaw& law);

  [[nodiscard]] bool empty() const { return places_.empty(); }
  /// A point of a piece from its begin, over its length: weights of the tangents at its Q nodes.
  [[nodiscard]] Eigen::Block<const Eigen::MatrixXd, Eigen::Dynamic, 1, true> place(
      std::size_t piece, Eigen::Index point) const {
    return places_[piece].col(point);
  }
  /// Adds those of a piece that are within an obstacle. Their `normal`, `depth`, `velocity` and
  /// `at` are set.
  /// @param begin  of the piece;  @param along  its length times the tangents at its nodes, Q x 3
  void find(const obstacle::Body& body, const BodyPlace& place, const Touch& of,
            const Eigen::Vector3d& begin, const Eigen::MatrixX3d& along,
            std::vector<Touch>& found) const;
  /// Takes in the rate at which the depth grows. Sets what the law says.
  void resist(double rate, Touch& touch) const;

 private:
  ContactLaw law_;
  std::vector<double> spacings_;
  std::vector<Eigen::MatrixXd> places_;  // Q x M
};

}  // namespace dlo::energy_model
