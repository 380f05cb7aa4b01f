#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <vector>

#include "base/legendre.hpp"
#include "frames/piece.hpp"
#include "frames/position_operator.hpp"
#include "problem/span.hpp"
#include "strain/contact_place.hpp"

namespace dlo::energy_model {

/// Constraints of the rod's contacts with rigid obstacles, as functions of clearances g of its
/// points. A sliding contact at one point inside the span has a row for the smallest clearance near
/// it, wherever that point is. Any other contact has a row for the clearance at its begin. A
/// contact in which a grip holds the rod has neither row. Where the rod lies on the obstacle, each
/// element also has rows for the moments int phi g' ds of its slope, divided by the element's
/// length. The degree of the polynomials phi is limited to that of a slope that the strains
/// resolve. The strains of such a part are thereby fixed in the direction away from the obstacle
/// and free along it. The series N(s) = sum mu phi(s) / length of the multipliers on an element is
/// the force that the contacts carry at s, and -N' the obstacle's pressure.
///
/// On a half-space g' = n.t, and the moments are linear in the tangents. For other bodies they are
/// computed from clearances alone, int phi g' = [phi g] - int phi' g.
class ContactRows {
 public:
  /// Sets up the rows of a span. @param terms  number of coefficients of an element's strain
  void reset(const Span& span, const std::vector<Element>& elements, int terms,
             const LegendreTable& table);

  [[nodiscard]] Eigen::Index count() const { return linear_.cols(); }
  /// Resizes an evaluation and computes the derivatives of the linear rows; evaluate() needs both.
  void resize(ContactEvaluation& place) const;
  /// Evaluates the rows at a shape. @param tangents  nodes x 3
  void evaluate(const Eigen::MatrixX3d& tangents, ContactEvaluation& place) const;

  /// Returns the arc length of a sliding contact; std::nullopt for other contacts.
  [[nodiscard]] std::optional<double> contact_arc_length(const ContactEvaluation& place,
                                                         std::size_t contact) const;
  /// Whether rows are nonlinear in the tangents.
  [[nodiscard]] bool curved() const { return !clearance_minima_.empty() || !curved_.empty(); }
  /// Subtracts the multipliers times the rows' second derivatives from `hessian`, except the part
  /// with second derivatives of the tangents, which ContactEvaluation::add() covers.
  /// @param tangents  derivatives of the tangents by the unknowns, one matrix per axis, nodes x
  ///   unknowns
  void subtract_hessian(const ContactEvaluation& place,
                        const Eigen::Ref<const Eigen::VectorXd>& multipliers,
                        const std::array<Eigen::MatrixXd, 3>& tangents,
                        Eigen::Ref<Eigen::MatrixXd> hessian) const;
  /// Returns the multipliers of these rows from those of the same contacts with another number of
  /// coefficients.
  [[nodiscard]] Eigen::VectorXd prolong(const ContactRows& other,
                                        const Eigen::VectorXd& multipliers) const;
  /// Returns the force of each of Span::contacts. @param tangents  nodes x 3. @param multipliers
  /// of all rows
  [[nodiscard]] std::vector<ContactForce> forces(const ContactEvaluation& place,
                                                 const Eigen::MatrixX3d& tangents,
                                                 const Eigen::VectorXd& multipliers) const;

 private:
  /// Rows that depend on the clearances of points from a body that is not a half-space.
  struct CurvedContact {
    std::size_t contact = 0;
    obstacle::Body body;
    Eigen::Index first = 0;   // row
    Eigen::MatrixXd weights;  // rows = weights^T clearances, points x rows
    PointOperator reach;      // positions of the points

    /// Returns the forces on the points from the multipliers of all rows.
    [[nodiscard]] Eigen::VectorXd forces(
        const Eigen::Ref<const Eigen::VectorXd>& multipliers) const;
  };
  /// Row of a smallest clearance.
  struct ClearanceMinimum {
    std::size_t contact = 0;
    obstacle::Body body;
    Eigen::Index row = 0;
    double at = 0;             // arc length where the search for it begins
    Eigen::Index before = 0;   // element that ends at the contact
    double low = 0, high = 0;  // bounds of its arc length
  };
  [[nodiscard]] Eigen::Index add_row();
  void add_clearance(const Span& span, std::size_t contact, const std::vector<Element>& elements);
  void add_slopes(const Span& span, std::size_t contact, const std::vector<Element>& elements,
                  Eigen::Index degrees, Eigen::Index terms, const LegendreTable& table);
  void add_curved(CurvedContact curved, Eigen::Index rows);
  [[nodiscard]] ContactEvaluation::ClearanceMinimum least_clearance(
      const Eigen::MatrixX3d& tangents, const ClearanceMinimum& touch) const;

  std::vector<ContactSeries> contacts_;
  std::vector<CurvedContact> curved_;
  std::vector<ClearanceMinimum> clearance_minima_;
  std::vector<Eigen::Vector3d> normals_;  // normals of half-spaces, by contact
  PositionOperator reach_;
  // For rows that are linear in the tangents; zero for others.
  Eigen::MatrixXd linear_;   // weights of normal . t at the nodes, nodes x rows
  Eigen::Matrix3Xd normal_;  // normals, one per row
  Eigen::VectorXd offset_;
};

}  // namespace dlo::energy_model
