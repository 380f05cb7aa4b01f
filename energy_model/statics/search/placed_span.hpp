#pragma once

#include <Eigen/Core>
#include <memory>
#include <vector>

#include "dlo/energy_model/equilibrium.hpp"
#include "dlo/energy_model/problem.hpp"
#include "problem/split.hpp"
#include "span/span_options.hpp"
#include "strain/span_solution.hpp"

namespace dlo::energy_model {

/// A span's last solution, from which the next one may start; empty unless it was stable or a
/// singular point.
struct RememberedShape {
  KnownShape last;
  std::shared_ptr<const SpanPoint> point;               ///< point of `last`
  Eigen::Matrix3d frame = Eigen::Matrix3d::Identity();  ///< PlacedSpan::frame

  [[nodiscard]] bool is_known() const { return last.model != nullptr; }
  [[nodiscard]] bool planar() const { return !is_known() || last.model->span().planar; }

  void store(const SpanSolution& found, const PlacedSpan& placed);
  /// Returns the remembered shape in the frame of a span, which may differ. Exact at the remembered
  /// nodes; other arc lengths get the value of the nearest node.
  [[nodiscard]] TangentField field(const PlacedSpan& placed) const;
};

/// Last solutions of a span: without the twist from clamps, and with it if clamps twist the span.
struct Remembered {
  RememberedShape untwisted, twisted;
  double twist = 0;   ///< twist of `twisted` [rad]
  double turned = 0;  ///< rotation of the end's frame relative to the untwisted rod's [rad]
};

/// Solves a span of a problem without the twist from clamps: from a known shape, if there is one
/// and not all equilibria are wanted; otherwise, and if that finds none, by a search. It also
/// starts from minima of coarse polygons if the search finds no stable shape (unless it has reached
/// a limit), or if all equilibria are wanted. Approach::follow_only and Approach::descend_only
/// exclude the search. The list is never empty, best first.
/// @param shape, last  initial guesses; `shape` is used unless it is null, then `last` if known
[[nodiscard]] std::vector<SpanSolution> solve_untwisted(const PlacedSpan& placed,
                                                        const Problem& problem, SpanOptions options,
                                                        const Equilibrium* shape,
                                                        const RememberedShape& last,
                                                        SpanWorkspace& workspace);

/// Solves a span between clamps that prescribe frames: from a shape whose twist is known, if there
/// is one; otherwise without twist, after which the clamp is rotated from the best shape, or from
/// each stable one if all equilibria are wanted. With Approach::descend_only, only `start` is
/// relaxed. The list is never empty, best first.
/// @param start  null: none is known; not null with Approach::descend_only
/// @param memory  of the last call, empty if nothing is to be followed; the shape without twist is
///   updated
[[nodiscard]] std::vector<SpanSolution> solve_twisted(const PlacedSpan& placed,
                                                      const Problem& problem,
                                                      const SpanOptions& options,
                                                      const Equilibrium* start, Remembered& memory,
                                                      SpanWorkspace& workspace);

}  // namespace dlo::energy_model
