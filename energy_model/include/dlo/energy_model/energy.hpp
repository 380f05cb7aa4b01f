#pragma once

#include <Eigen/Core>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "dlo/energy_model/equilibrium.hpp"
#include "dlo/energy_model/problem.hpp"

namespace dlo::energy_model {

/// Depth of the axis behind a rigid obstacle up to which a shape is called converged, over the
/// rod's length [-].
inline constexpr double allowed_penetration = 1e-8;

/// How well to solve, and from where.
struct EnergyOptions {
  /// Coefficients K of each smooth piece and field, 1 to max_terms = 128; 0: as many as `tolerance`
  /// needs.
  int terms = 0;
  /// Of truncation: what the last coefficients add to points of the shape, in l; > 0. Newton's
  /// method goes to rounding whatever this is.
  double tolerance = 1e-10;
  /// Of one descent by NLopt, >= 1; beyond, `evaluation_limit`. Descents between grips and Newton's
  /// method have limits of their own.
  int max_evaluations = 20000;
  /// Of the whole call [s], > 0; the status is then `time_limit`.
  double time_limit = std::numeric_limits<double>::infinity();
  /// A known equilibrium of a similar problem, of the same length and clamps, to start from
  /// instead of a search: it is followed, so that snapping shows where the branch ends. Has to
  /// outlive the call. Of clamps that twist the rod its `twists` say how much it is twisted.
  const Equilibrium* start = nullptr;
};

/// Lowest equilibrium that a search finds (energy_model/doc/search.md), of an inextensible rod with
///     E = int 1/2 (u - u0) . K (u - u0) ds - int w . r ds - sum_j F_j . r(s_j) + int 1/2 k d^2 ds
/// [J]: strains u, natural strains u0, K = diag(EI_1, EI_2, GJ), w weight per length, d the depth
/// in obstacles that yield; |r'| = 1, grips and rigid obstacles are constraints. Unknowns are the
/// strains' coefficients in orthonormal Legendre polynomials (README.md).
/// @return the lowest shape that was found and is stable, else the lowest other equilibrium, else
/// why there is none. Stability is proven by the second variation; that nothing is lower is proven
/// only of one clamp under parallel forces without an obstacle
/// @throws std::invalid_argument if the problem or an option is out of range, with the numbers; if
/// grips are as far apart as the rod between them is long; if loads, grips and sections cut the rod
/// into more pieces than can be afforded
Equilibrium solve_energy(const Problem& problem, const EnergyOptions& options = {});

/// Finds the equilibrium that a local search from the points of a shape leads to: a polygon through
/// them comes to rest where obstacles are, each of them on the side on which the points lie, and
/// says what touches; the rod descends from there, Newton's method follows, and the certificate. A
/// saddle is left downhill. No other start is tried, so that the result need not be the lowest
/// equilibrium; its status says whether it is one, and whether it is stable. Only the directions of
/// the points from each other count: the grips place the rod.
/// Each span between clamps starts from its own points; a rod that is taut, or soft as a line, has
/// one equilibrium, which is returned wherever the points are.
/// @param arc_lengths  of the points [m], strictly growing, in [0, length], two or more
/// @param points       [m], 3 x M
/// @throws std::invalid_argument as solve_energy(), or if the points are out of range
Equilibrium energy_near(const Problem& problem, const std::vector<double>& arc_lengths,
                        const Eigen::Ref<const Eigen::Matrix3Xd>& points,
                        const EnergyOptions& options = {});

/// A kind of start that a search for all equilibria has looked from.
struct SearchStrategy {
  std::string name;     ///< in words: the start, and how it is left
  int tried = 0;        ///< starts
  int found_first = 0;  ///< equilibria that no start before had led to
};

/// What a search for all equilibria has found, from where, and what it may have missed. A search
/// proves nothing of what it has not found.
struct EnergySearch {
  /// Stable ones first, by energy; unstable ones have the status `saddle`, those at a fold or
  /// bifurcation `near_singular`. Never empty.
  std::vector<Equilibrium> equilibria;
  /// In the order of their first use. Spans count each on their own; their equilibria are combined
  /// to those of the rod.
  std::vector<SearchStrategy> looked_from;
  std::vector<std::string> not_looked;  ///< what was cut short or left out, and why; in words
};

/// Every equilibrium that the search's starts lead to, and what these were
/// (energy_model/doc/search.md).
/// @throws std::invalid_argument as solve_energy()
[[nodiscard]] EnergySearch search_energy(const Problem& problem, const EnergyOptions& options = {});

/// Its equilibria alone: stable ones first, by energy.
/// @throws std::invalid_argument as solve_energy()
[[nodiscard]] std::vector<Equilibrium> all_energy(const Problem& problem,
                                                  const EnergyOptions& options = {});

/// The same with buffers that survive a solve, for loops. One thread at a time.
class EnergySolver {
 public:
  /// @throws std::invalid_argument if an option is out of range
  explicit EnergySolver(const EnergyOptions& options = {});
  ~EnergySolver();
  /// Takes the buffers over.
  EnergySolver(EnergySolver&& other) noexcept;
  EnergySolver& operator=(EnergySolver&& other) noexcept;  ///< Takes the buffers over.
  EnergySolver(const EnergySolver& other) = delete;
  EnergySolver& operator=(const EnergySolver& other) = delete;

  /// solve_energy(). What follows throws std::invalid_argument as it does.
  Equilibrium solve(const Problem& problem);
  /// From the shape of the last call instead of a search, if it had one: for a gripper or an
  /// obstacle that has moved a little. By Newton's method with its contacts, which are updated as
  /// they change. Where that leads to no equilibrium near the last shape, or to an unstable one,
  /// the branch has ended: the shape is the next minimum downhill of the last, or failing that what
  /// solve() finds. The problem has the same obstacles in the same order.
  Equilibrium follow(const Problem& problem);
  /// follow() as far as Newton's method stays on the branch, without what it does beyond. None
  /// where that leads to no stable equilibrium near the last shape, or there is none: the next call
  /// then goes on from the same shape as this one, in a smaller step for instance.
  std::optional<Equilibrium> try_follow(const Problem& problem);
  /// Forgets the shape of the last follow() or try_follow() that had one: the next call goes on
  /// from the shape before it. Once for each of them.
  void undo();
  /// Whether the last follow() has stayed on its branch, as far as Newton's method tells: the shape
  /// is next to the one before. Work and energy tell too (a snap-through releases energy).
  [[nodiscard]] bool followed() const;
  /// energy_near(); EnergyOptions::start is not used.
  Equilibrium near(const Problem& problem, const std::vector<double>& arc_lengths,
                   const Eigen::Ref<const Eigen::Matrix3Xd>& points);
  /// search_energy().
  [[nodiscard]] EnergySearch search(const Problem& problem);
  /// all_energy().
  [[nodiscard]] std::vector<Equilibrium> solve_all(const Problem& problem);

 private:
  class State;
  std::unique_ptr<State> state_;
};

}  // namespace dlo::energy_model
