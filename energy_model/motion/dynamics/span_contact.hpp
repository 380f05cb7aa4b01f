#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "frames/position_operator.hpp"
#include "problem/span.hpp"

namespace dlo::energy_model {

/// Contact law of rigid obstacles, own units: force per length of rod at the depth d
///     p = k d^2 max(0, 1 + d' / u),
/// the law of Hunt and Crossley (J. Appl. Mech. 42, 1975), without tension. k d^3 / 3 is stored,
/// the rest is lost. The speed after an impact is at most u.
struct ContactLaw {
  double stiffness = 0;  ///< k
  double rebound = 0.1;  ///< u
  double depth = 1e-3;   ///< largest intended depth; it determines the spacing of the points
};

/// Position and velocity of an obstacle at one time, along SpanDrive's axes.
struct ObstaclePose {
  Eigen::Matrix3d turn = Eigen::Matrix3d::Identity();  ///< rotation from the frame of its Body
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();    ///< origin of the Body's frame
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();  ///< velocity of the origin
  Eigen::Vector3d spin = Eigen::Vector3d::Zero();

  [[nodiscard]] Eigen::Vector3d to_body_axes(const Eigen::Vector3d& at) const {
    return turn.transpose() * (at - origin);
  }
};

/// A point of a span within an obstacle, and the contact force there.
struct ContactPoint {
  std::size_t obstacle = 0;  ///< index in the problem
  Eigen::Vector3d at = Eigen::Vector3d::Zero();
  Eigen::Vector3d normal = Eigen::Vector3d::UnitY();   ///< unit, out of the obstacle
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();  ///< velocity of the obstacle at the point
  double depth = 0;                                    ///< > 0
  std::size_t element = 0;                             ///< element in a ContactGrid
  Eigen::Index point = 0;                              ///< index of the point within the element
  double push = 0;                                     ///< force on the rod along the normal
  double kept = 0;                                     ///< stored energy
  double lost = 0;                                     ///< power that is lost
  double by_depth = 0;                                 ///< derivative of the push by the depth
  double by_rate = 0;  ///< derivative of the push by the depth's rate

  /// Computes obstacle, position, normal, velocity and depth of a point; the other members keep
  /// their default values.
  /// @param where  the point
  ContactPoint(const Span::Obstacle& of, const ObstaclePose& place, const Eigen::Vector3d& where);
  [[nodiscard]] Eigen::Vector3d force() const { return push * normal; }
};

/// Points of a span at which contact with rigid obstacles is evaluated: equally spaced on each
/// element, including both ends. Their positions follow from the polynomials through the tangents
/// at the nodes, so that forces at them do exactly the work that they do on the unknowns.
class ContactGrid {
 public:
  /// Places points at most 1/128 apart. For bodies other than half-spaces the spacing is at most 2
  /// law.depth if that is less, but not below 1/4096, so that a contact is located to law.depth,
  /// and an edge enters the rod between two points by no more than that.
  ContactGrid(const std::vector<Span::Obstacle>& obstacles, const PositionOperator& reach,
              const ContactLaw& law);

  [[nodiscard]] bool empty() const { return elements_.empty(); }
  /// Returns the points of an element.
  [[nodiscard]] const PointOperator& points(std::size_t element) const {
    return elements_[element];
  }
  /// Adds the points of an element that are within an obstacle.
  /// @param begin  position of the element's begin;  @param tangents  nodes x 3
  void find(std::size_t element, const Span::Obstacle& obstacle, const ObstaclePose& place,
            const Eigen::Vector3d& begin, const Eigen::MatrixX3d& tangents,
            std::vector<ContactPoint>& found) const;
  /// Sets the contact force, energy and derivatives. @param rate  rate of the depth
  void set_contact_force(double rate, ContactPoint& touch) const;

 private:
  ContactLaw law_;
  std::vector<double> spacings_;
  std::vector<PointOperator> elements_;
};

}  // namespace dlo::energy_model
