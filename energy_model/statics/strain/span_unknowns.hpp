#pragma once

#include <Eigen/Core>
#include <algorithm>

namespace dlo::energy_model {

/// Layout of a span's unknowns in x: for each field (strain) the rotation of a free start, then the
/// coefficients element by element; last the twist psi, if it is an unknown.
struct SpanUnknowns {
  Eigen::Index fields = 1;
  Eigen::Index elements = 0;
  Eigen::Index terms = 0;       ///< number of coefficients of an element
  Eigen::Index free_start = 0;  ///< number of unknowns for a field's start, 0 or 1
  bool has_psi = false;

  /// Number of unknowns of one field.
  [[nodiscard]] Eigen::Index columns() const { return free_start + elements * terms; }
  [[nodiscard]] Eigen::Index strains() const { return fields * columns(); }
  [[nodiscard]] Eigen::Index size() const { return strains() + (has_psi ? 1 : 0); }
  /// Returns the index of the first coefficient of an element.
  [[nodiscard]] Eigen::Index first(Eigen::Index field, Eigen::Index element) const {
    return field * columns() + free_start + element * terms;
  }
  /// Sets the rotation of a free start to zero, which stores no energy.
  template <typename Vector>
  void clear_start(Vector& x) const {
    for (Eigen::Index f = 0; f < fields && free_start == 1; ++f) x[f * columns()] = 0;
  }

  /// Returns unknowns with the coefficients of the same span with other numbers of coefficients or
  /// fields; the others are 0.
  [[nodiscard]] Eigen::VectorXd prolong(const SpanUnknowns& from, const Eigen::VectorXd& x) const {
    const Eigen::Index shared = std::min(terms, from.terms);
    Eigen::VectorXd prolonged = Eigen::VectorXd::Zero(size());
    for (Eigen::Index field = 0; field < std::min(fields, from.fields); ++field) {
      if (free_start == 1) prolonged[field * columns()] = x[field * from.columns()];
      for (Eigen::Index e = 0; e < elements; ++e) {
        prolonged.segment(first(field, e), shared) = x.segment(from.first(field, e), shared);
      }
    }
    if (has_psi && from.has_psi) prolonged[strains()] = x[from.strains()];
    return prolonged;
  }
};

}  // namespace dlo::energy_model
