#pragma once

#include <Eigen/Core>
#include <vector>

#include "base/legendre.hpp"
#include "problem/span.hpp"
#include "strain/piece.hpp"

namespace dlo::energy_model {

/// Forces with which a rigid wall holds a contact, along its normal: at the begin and the end of
/// the part in contact, which are the same where it touches at one point, and between.
struct ContactForce {
  double total = 0;
  double begin = 0, end = 0;  ///< concentrated ones; `end` is 0 where it touches at one point
  double least_pressure = 0;  ///< per length, of what lies; 0 where it touches at one point
  double largest_pressure = 0;
  double least_inner = 0;  ///< least concentrated one inside, at loads and sections
};

/// Constraints c = sum_q w_q phi(s_q) n.t_q + c0 of the rod's contacts with rigid walls, linear in
/// the tangents: the clearance of a contact's begin; where the rod lies the moments of its slope
/// n.t on each piece, over the piece's length, with the polynomials up to the degree to which its
/// strains resolve it. The strains of a lying part are thereby fixed in the wall's normal direction
/// and free along it. The multipliers' series N(s) = sum mu phi(s) is the force that the contacts
/// carry there, -N' the wall's pressure.
class ContactRows {
 public:
  /// @param terms  of a piece's strains;  @param nodes, weights  of the span's quadrature
  void reset(const Span& span, const std::vector<Piece>& pieces, int terms,
             const LegendreTable& table, const Eigen::VectorXd& nodes,
             const Eigen::VectorXd& weights);

  [[nodiscard]] Eigen::Index count() const { return weighted_.cols(); }
  /// Of all rows. @param tangents  nodes x 3
  [[nodiscard]] Eigen::VectorXd residual(const Eigen::MatrixX3d& tangents) const {
    return along(tangents).colwise().sum().transpose() + offset_;
  }
  /// What the rows change by along these vectors at the nodes, nodes x rows.
  [[nodiscard]] Eigen::MatrixXd along(const Eigen::MatrixX3d& vectors) const {
    return weighted_.cwiseProduct(vectors * normal_);
  }
  /// Gradient by the tangents, nodes x 3.
  [[nodiscard]] Eigen::MatrixX3d by_node(Eigen::Index row) const {
    return weighted_.col(row) * normal_.col(row).transpose();
  }
  /// Adds a multiplier times by_node().
  void add(Eigen::Index row, double multiplier, Eigen::MatrixX3d& carried) const {
    carried.noalias() += multiplier * weighted_.col(row) * normal_.col(row).transpose();
  }
  /// Moment about the anchor of what the multiplier stands for.
  [[nodiscard]] Eigen::Vector3d moment(Eigen::Index row, double multiplier,
                                       const Eigen::MatrixX3d& tangents) const;
  /// Multipliers of these rows from those of the same contacts with another number of terms.
  [[nodiscard]] Eigen::VectorXd adopt(const ContactRows& other,
                                      const Eigen::VectorXd& multipliers) const;
  /// Of each of Span::contacts. @param multipliers  of all rows
  [[nodiscard]] std::vector<ContactForce> forces(const Eigen::VectorXd& multipliers) const;

 private:
  /// Rows of a contact: of its begin's clearance (-1: a grip holds it there), and of the slope on
  /// each of its pieces.
  struct Rows {
    struct Slope {
      Eigen::Index first = 0, count = 0;
      double length = 0;  // of the piece
    };
    Eigen::Index clearance = -1;
    std::vector<Slope> slopes;
  };
  [[nodiscard]] Eigen::Index add_row(const Span::Contact& contact, double offset);

  std::vector<Rows> contacts_;
  Eigen::MatrixXd weighted_;  // weight times phi, nodes x rows
  Eigen::Matrix3Xd normal_;   // by row
  Eigen::VectorXd offset_;
};

}  // namespace dlo::energy_model
