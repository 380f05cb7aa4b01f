#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <vector>

namespace dlo::energy_model {

/// Where a span's unknowns stand in x: by field (strain) the rotation of a free start, then the
/// coefficients piece by piece; last the twist psi, if it is one.
struct SpanUnknowns {
  Eigen::Index fields = 1;
  Eigen::Index pieces = 0;
  Eigen::Index terms = 0;       ///< coefficients of a piece
  Eigen::Index free_start = 0;  ///< unknowns of a field's start, 0 or 1
  bool has_psi = false;

  /// Of one field.
  [[nodiscard]] Eigen::Index columns() const { return free_start + pieces * terms; }
  [[nodiscard]] Eigen::Index strains() const { return fields * columns(); }
  [[nodiscard]] Eigen::Index size() const { return strains() + (has_psi ? 1 : 0); }
  /// First coefficient of a piece.
  [[nodiscard]] Eigen::Index first(Eigen::Index field, Eigen::Index piece) const {
    return field * columns() + free_start + piece * terms;
  }
  /// Zeroes what stores no energy, the rotation of a free start.
  template <typename Vector>
  void clear_start(Vector& x) const {
    for (Eigen::Index f = 0; f < fields && free_start == 1; ++f) x[f * columns()] = 0;
  }

  /// Where the unknowns of the same span with no more terms are among these.
  [[nodiscard]] std::vector<Eigen::Index> places_of(const SpanUnknowns& coarse) const {
    std::vector<Eigen::Index> places;
    places.reserve(static_cast<std::size_t>(coarse.size()));
    for (Eigen::Index field = 0; field < fields; ++field) {
      if (free_start == 1) places.push_back(field * columns());
      for (Eigen::Index e = 0; e < pieces; ++e) {
        for (Eigen::Index k = 0; k < coarse.terms; ++k) places.push_back(first(field, e) + k);
      }
    }
    if (has_psi) places.push_back(strains());
    return places;
  }
  /// Unknowns that have the coefficients of the same span with other terms or fields; others are 0.
  [[nodiscard]] Eigen::VectorXd prolong(const SpanUnknowns& from, const Eigen::VectorXd& x) const {
    const Eigen::Index shared = std::min(terms, from.terms);
    Eigen::VectorXd prolonged = Eigen::VectorXd::Zero(size());
    for (Eigen::Index field = 0; field < std::min(fields, from.fields); ++field) {
      if (free_start == 1) prolonged[field * columns()] = x[field * from.columns()];
      for (Eigen::Index e = 0; e < pieces; ++e) {
        prolonged.segment(first(field, e), shared) = x.segment(from.first(field, e), shared);
      }
    }
    if (has_psi && from.has_psi) prolonged[strains()] = x[from.strains()];
    return prolonged;
  }
};

}  // namespace dlo::energy_model
