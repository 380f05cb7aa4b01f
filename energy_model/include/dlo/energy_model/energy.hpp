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

/// Largest depth of the axis behind a rigid obstacle with which a shape is accepted as converged,
/// divided by the rod length [-].
inline constexpr double allowed_penetration = 1e-8;

/// Discretisation, limits and initial guess of the energy model.
struct EnergyOptions {
  /// Coefficients K of each element and strain component, 1 to max_terms = 128; 0: as many as
  /// `tolerance` requires.
  int terms = 0;
  /// Truncation tolerance: largest contribution of the last coefficients to any point of the shape,
  /// divided by the rod length; > 0. Newton's method always iterates to rounding and does not use
  /// it.
  double tolerance = 1e-10;
  /// Maximum number of energy evaluations of one NLopt descent, >= 1. A descent that reaches it
  /// returns `evaluation_limit`. Descents between grips and Newton's method have separate limits.
  int max_evaluations = 20000;
  /// Time limit of the whole call [s], > 0. A call that reaches it returns the best shape found so
  /// far, or `time_limit` if there is none.
  double time_limit = std::numeric_limits<double>::infinity();
  /// Known equilibrium of a similar problem with the same length and clamps, from which the solver
  /// starts instead of a search. The solver follows its branch, so that a snap-through shows where
  /// the branch ends; the result may be a `saddle`. If no equilibrium is found, a search follows.
  /// search_energy() and all_energy() do not use it. It has to outlive the call. If clamps twist
  /// the rod, its `twists` hold the twist angle of each part.
  const Equilibrium* start = nullptr;
};

/// Returns the lowest equilibrium that a search finds (energy_model/doc/search.md) of an
/// inextensible rod with the energy
///     E = int 1/2 (u - u0) . K (u - u0) ds - int w . r ds - sum_j F_j . r(s_j) + int 1/2 k d^2 ds
/// [J]: strains u, natural strains u0, K = diag(EI_1, EI_2, GJ), weight per length w, depth d in
/// yielding obstacles; |r'| = 1, grips and rigid obstacles are constraints. The unknowns are the
/// coefficients of the strains in orthonormal Legendre polynomials (README.md).
/// @return the lowest stable shape that was found, else the lowest other equilibrium, else the
/// reason why there is none. Stability is proven by the second variation. It is proven that no
/// equilibrium is lower only for a uniform, round and straight rod with one clamp under parallel
/// forces without an obstacle
/// @throws std::invalid_argument if the problem or an option is out of range or not supported; if
/// grips are as far apart as the rod between them is long or farther, unless taut_line() applies;
/// if loads, grips and sections divide the rod into too many elements
Equilibrium solve_energy(const Problem& problem, const EnergyOptions& options = {});

/// Finds the equilibrium to which a local search from the points of a shape converges. If there are
/// obstacles, a penalty equilibrium of a polygon through the points detects the contacts, with each
/// obstacle on the side on which the points lie. The rod descends from that polygon, else from the
/// points; Newton's method and the certificate follow. A saddle is left along a direction of
/// negative curvature. No other initial guess is tried, so the result need not be the lowest
/// equilibrium; its status states whether it is an equilibrium and whether it is stable. Only the
/// directions from point to point are used: the grips determine the position of the rod. Each span
/// between clamps starts from its own points. A taut rod, or one with negligible bending stiffness
/// (shape_without_search()), has one equilibrium, which is returned for all points.
/// @param arc_lengths  arc lengths of the points [m], strictly growing, in [0, length], two or more
/// @param points       positions [m], 3 x M
/// @throws std::invalid_argument as solve_energy(), or if the points are out of range
Equilibrium energy_near(const Problem& problem, const std::vector<double>& arc_lengths,
                        const Eigen::Ref<const Eigen::Matrix3Xd>& points,
                        const EnergyOptions& options = {});

/// A kind of initial guess that a search for all equilibria has used.
struct SearchStrategy {
  std::string name;  ///< description of the initial guess and of the solver that starts from it
  int tried = 0;     ///< number of initial guesses
  int new_equilibria = 0;  ///< number of equilibria that no earlier initial guess had converged to
};

/// Result of a search for all equilibria: the equilibria, the initial guesses used, and those not
/// used. A search does not prove that there are no other equilibria.
struct EnergySearch {
  /// Stable equilibria first, by energy. Unstable ones have the status `saddle`, those at a fold or
  /// bifurcation `near_singular`. Never empty: if none is found, the result with the reason.
  std::vector<Equilibrium> equilibria;
  /// Kinds of initial guess in the order of their first use. Each span counts separately; the
  /// equilibria of the spans are combined to those of the rod. Empty if shape_without_search()
  /// solves the problem.
  std::vector<SearchStrategy> strategies;
  /// Initial guesses that were interrupted or omitted, and why; in words.
  std::vector<std::string> omitted;
};

/// Returns every equilibrium to which the search's initial guesses converge, and describes these
/// guesses (energy_model/doc/search.md).
/// @throws std::invalid_argument as solve_energy()
[[nodiscard]] EnergySearch search_energy(const Problem& problem, const EnergyOptions& options = {});

/// Returns the equilibria of search_energy(): stable ones first, by energy.
/// @throws std::invalid_argument as solve_energy()
[[nodiscard]] std::vector<Equilibrium> all_energy(const Problem& problem,
                                                  const EnergyOptions& options = {});

/// Solver of the energy model with buffers that are reused between solves, for loops. Not
/// thread-safe. Its functions that take a problem throw std::invalid_argument under the same
/// conditions as solve_energy(), near() also as energy_near().
class EnergySolver {
 public:
  /// @throws std::invalid_argument if an option is out of range
  explicit EnergySolver(const EnergyOptions& options = {});
  ~EnergySolver();
  /// Moves the state of another solver, which may then only be assigned to or destroyed.
  EnergySolver(EnergySolver&& other) noexcept;
  /// Moves the state of another solver, which may then only be assigned to or destroyed.
  EnergySolver& operator=(EnergySolver&& other) noexcept;
  EnergySolver(const EnergySolver& other) = delete;
  EnergySolver& operator=(const EnergySolver& other) = delete;

  /// Solves as solve_energy() does.
  Equilibrium solve(const Problem& problem);
  /// Solves from the shape of the previous call, for a gripper or an obstacle that has moved a
  /// little, by Newton's method with contacts that are updated. It acts as solve() if there is no
  /// such shape, if that shape was neither stable nor at a singular point, or if
  /// shape_without_search() gave it. If Newton's method finds no equilibrium, the result is a
  /// minimum downhill of the previous shape, or failing that the result of solve(). If Newton's
  /// method finds an unstable equilibrium, the result is a stable one downhill of it, or the
  /// unstable one if none is reached or clamps twist the rod. The problem must have the same
  /// obstacles in the same order.
  Equilibrium follow(const Problem& problem);
  /// Follows the branch by Newton's method as follow() does, but does not continue beyond the end
  /// of the branch. Returns std::nullopt if no stable equilibrium is found near the last shape, if
  /// there is no last shape, or if shape_without_search() solves the problem. The next call then
  /// starts from the same shape as this one, for example with a smaller step.
  std::optional<Equilibrium> try_follow(const Problem& problem);
  /// Discards the shape of the last successful follow() or try_follow(): the next call starts from
  /// the shape before it. At most once for each of them.
  void undo();
  /// Whether the last follow() stayed on its branch, as far as Newton's method can detect: the new
  /// shape is adjacent to the previous one. Work and energy detect a branch jump too (a
  /// snap-through releases energy).
  [[nodiscard]] bool followed() const;
  /// Solves as energy_near() does; EnergyOptions::start is not used.
  Equilibrium near(const Problem& problem, const std::vector<double>& arc_lengths,
                   const Eigen::Ref<const Eigen::Matrix3Xd>& points);
  /// Searches as search_energy() does.
  [[nodiscard]] EnergySearch search(const Problem& problem);

 private:
  class State;
  std::unique_ptr<State> state_;
};

}  // namespace dlo::energy_model
