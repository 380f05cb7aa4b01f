#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <vector>

#include "base/legendre.hpp"
#include "frames/piece.hpp"
#include "frames/position_operator.hpp"
#include "problem/span.hpp"
#include "strain/contact_forces.hpp"
#include "strain/contact_place.hpp"

namespace dlo::energy_model {

/// Constraints of the rod's contacts with rigid obstacles, over clearances g of its points. A
/// contact at one point that slides is the least clearance near it, of whatever point that is. Else
/// there is the clearance of a contact's begin and, where the rod lies, the moments int phi g' ds
/// of its slope on each piece, over the piece's length, with the polynomials phi up to the degree
/// to which its strains resolve it. The strains of a lying part are thereby fixed in the direction
/// away from the obstacle and free along it. The multipliers' series N(s) = sum mu phi(s) is the
/// force that the contacts carry there, -N' the obstacle's pressure.
///
/// On a half-space g' = n.t, and the moments are linear in the tangents. On other bodies they are
/// taken from clearances alone, int phi g' = [phi g] - int phi' g.
class ContactRows {
 public:
  /// @param terms  of a piece's strains
  void reset(const Span& span, const std::vector<Piece>& pieces, int terms,
             const LegendreTable& table);

  [[nodiscard]] Eigen::Index count() const { return linear_.cols(); }
  /// Gives a place its size.
  void resize(ContactPlace& place) const;
  /// Looks where the rod is. @param tangents  nodes x 3
  void look(const Eigen::MatrixX3d& tangents, ContactPlace& place) const;

  /// Where a contact that slides is; nothing of others.
  [[nodiscard]] std::optional<double> touches_at(const ContactPlace& place,
                                                 std::size_t contact) const;
  /// Whether rows bend where tangents turn steadily.
  [[nodiscard]] bool curved() const { return !touches_.empty() || !curved_.empty(); }
  /// Subtracts the multipliers times the rows' second derivatives, but for what bends the tangents
  /// twice, which is in ContactPlace::add().
  /// @param tangents  derivatives of the tangents by the unknowns, an axis each, nodes x unknowns
  void subtract_hessian(const ContactPlace& place,
                        const Eigen::Ref<const Eigen::VectorXd>& multipliers,
                        const std::array<Eigen::MatrixXd, 3>& tangents,
                        Eigen::Ref<Eigen::MatrixXd> hessian) const;
  /// The same along z alone, of a rod in the plane.
  void subtract_tilt_hessian(const ContactPlace& place,
                             const Eigen::Ref<const Eigen::VectorXd>& multipliers,
                             const Eigen::MatrixXd& tangents,
                             Eigen::Ref<Eigen::MatrixXd> hessian) const;
  /// Multipliers of these rows from those of the same contacts with another number of terms.
  [[nodiscard]] Eigen::VectorXd prolong(const ContactRows& other,
                                        const Eigen::VectorXd& multipliers) const;
  /// Of each of Span::contacts. @param tangents  nodes x 3. @param multipliers  of all rows
  [[nodiscard]] std::vector<ContactForce> forces(const ContactPlace& place,
                                                 const Eigen::MatrixX3d& tangents,
                                                 const Eigen::VectorXd& multipliers) const;

 private:
  /// Rows over the clearances of points from a body that is not flat.
  struct Curved {
    std::size_t contact = 0;
    obstacle::Body body;
    Eigen::Index first = 0;   // row
    Eigen::MatrixXd weights;  // rows = weights^T clearances, points x rows
    PointsReach reach;        // of the points

    /// On the points, by the multipliers of all rows.
    [[nodiscard]] Eigen::VectorXd forces(
        const Eigen::Ref<const Eigen::VectorXd>& multipliers) const;
  };
  /// The row of a least clearance.
  struct Touch {
    std::size_t contact = 0;
    obstacle::Body body;
    Eigen::Index row = 0;
    double at = 0;             // s where it is looked for
    Eigen::Index before = 0;   // piece that ends there
    double low = 0, high = 0;  // how far away it may be
  };
  [[nodiscard]] Eigen::Index add_row();
  void add_clearance(const Span& span, std::size_t contact, const std::vector<Piece>& pieces);
  void add_slopes(const Span& span, std::size_t contact, const std::vector<Piece>& pieces,
                  Eigen::Index degrees, Eigen::Index terms, const LegendreTable& table);
  void add_curved(Curved curved, Eigen::Index rows);
  [[nodiscard]] ContactPlace::Touch least_clearance(const Eigen::MatrixX3d& tangents,
                                                    const Touch& touch) const;

  std::vector<ContactSeries> contacts_;
  std::vector<Curved> curved_;
  std::vector<Touch> touches_;
  std::vector<Eigen::Vector3d> normals_;  // of half-spaces, by contact
  PositionOperator reach_;
  // Of rows that are linear in the tangents; zero of others.
  Eigen::MatrixXd linear_;   // weight times phi, nodes x rows
  Eigen::Matrix3Xd normal_;  // by row
  Eigen::VectorXd offset_;
};

}  // namespace dlo::energy_model
