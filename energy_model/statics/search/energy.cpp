#include "dlo/energy_model/energy.hpp"

#include <algorithm>
#include <cstdint>
#include <memory>
#include <string>
#include <utility>

#include "base/found_equilibria.hpp"
#include "base/legendre.hpp"
#include "base/require.hpp"
#include "contact/clearance.hpp"
#include "dlo/energy_model/balance.hpp"
#include "dlo/energy_model/soft_line.hpp"
#include "problem/rod_law.hpp"
#include "problem/span.hpp"
#include "problem/split.hpp"
#include "search/assemble.hpp"
#include "search/known_shape.hpp"
#include "search/placed_span.hpp"
#include "span/found.hpp"
#include "span/local_solver.hpp"

namespace dlo::energy_model {
namespace {

/// Maximum number of combinations of the spans' equilibria that are assembled.
constexpr std::size_t most_combinations = 64;

void check(const EnergyOptions& options) {
  require(options.terms >= 0 && options.terms <= max_terms, "solve_energy", "terms", options.terms,
          "0 to " + std::to_string(max_terms));
  require_positive("solve_energy", "tolerance", options.tolerance);
  require(options.time_limit > 0, "solve_energy", "time_limit", options.time_limit, "> 0");
  require(options.max_evaluations >= 1, "solve_energy", "max_evaluations", options.max_evaluations,
          ">= 1");
}

/// Assembles combinations of the spans' equilibria, stable ones first, by energy.
/// @param each  number of equilibria of each span to combine, in their order
std::vector<Equilibrium> combine(const Problem& problem, const std::vector<PlacedSpan>& placed,
                                 const std::vector<std::vector<SpanSolution>>& solutions,
                                 std::size_t each, SearchLog& log) {
  std::vector<std::vector<SpanCandidate>> candidates;
  for (const std::vector<SpanSolution>& of_span : solutions) {
    std::vector<SpanCandidate> own;
    for (std::size_t i = 0; i < std::min(each, of_span.size()); ++i) {
      own.push_back({succeeded(of_span[i].status), of_span[i].energy});
    }
    candidates.push_back(std::move(own));
  }
  const Combinations lowest = lowest_combinations(candidates, most_combinations);
  std::vector<Equilibrium> result;
  for (const std::vector<std::size_t>& choice : lowest.choices) {
    std::vector<const SpanSolution*> chosen;
    for (std::size_t i = 0; i < solutions.size(); ++i) chosen.push_back(&solutions[i][choice[i]]);
    result.push_back(assemble(problem, placed, chosen));
    judge_penetration(problem, result.back());
    judge_balance(problem, result.back());
  }
  std::ranges::stable_sort(result, [](const Equilibrium& a, const Equilibrium& b) {
    if (succeeded(a.status) != succeeded(b.status)) return succeeded(a.status);
    return a.energy.total() < b.energy.total();
  });
  if (lowest.truncated) {
    for (Equilibrium& equilibrium : result) {
      equilibrium.message += "; the " + std::to_string(most_combinations) +
                             " lowest combinations of the spans' equilibria, there are more";
    }
    log.add_omitted("combinations of the spans' equilibria beyond the " +
                    std::to_string(most_combinations) + " lowest");
  }
  return result;
}

/// Returns the total energies of the combinations of the spans' stable equilibria without missing
/// turns, lowest first, at most `most_combinations` [J].
/// @param lowest  the combination of the spans' first equilibria
std::vector<double> stable_energies(const Problem& problem, const Equilibrium& lowest,
                                    const std::vector<std::vector<SpanSolution>>& solutions) {
  const double unit = bending_unit(problem) / problem.length;
  std::vector<double> sums = {lowest.energy.total()};
  for (const std::vector<SpanSolution>& of_span : solutions) {
    const auto energy = [&](const SpanSolution& found) {
      return unit * found.model->energies(*found.at_x()).total();
    };
    std::vector<double> with_span;
    for (const SpanSolution& found : of_span) {
      if (!succeeded(found.status) || found.missing_turns != 0) continue;
      const double above = &found == &of_span.front() ? 0 : energy(found) - energy(of_span.front());
      for (const double sum : sums) with_span.push_back(sum + above);
    }
    std::sort(with_span.begin(), with_span.end());
    with_span.resize(std::min(with_span.size(), most_combinations));
    sums = std::move(with_span);
  }
  return sums;
}

/// Stores the energies of the stable equilibria and the number of passing starts in each
/// equilibrium.
/// @param result  the lowest equilibrium, or all combinations of `solutions`
void note_search(const Problem& problem, const std::vector<std::vector<SpanSolution>>& solutions,
                 int other_side_starts, std::vector<Equilibrium>& result) {
  std::vector<double> energies;
  if (result.size() == 1 && succeeded(result.front().status)) {
    energies = stable_energies(problem, result.front(), solutions);
  } else {
    for (const Equilibrium& found : result) {
      if (succeeded(found.status)) energies.push_back(found.energy.total());
    }
  }
  for (Equilibrium& found : result) {
    found.stable_energies = energies;
    found.other_side_starts = other_side_starts;
  }
}

}  // namespace

class EnergySolver::State {
 public:
  explicit State(const EnergyOptions& options) : options_(options) { check(options); }

  /// Search for the lowest equilibrium or for all of them, without the previous solution; solve
  /// from the previous solution, followed by a search or not; descent from a given shape alone.
  enum class Mode { search, search_all, follow, follow_only, descend };

  /// Solves a problem. @return equilibria; empty if Mode::follow_only does not lead to one
  std::vector<Equilibrium> solve(const Problem& problem, Mode mode) {
    const auto begin = std::chrono::steady_clock::now();
    const Deadline deadline(options_.time_limit);
    log_ = {};
    require_dead_loads(problem, "solve_energy");
    require_inextensible(problem, "solve_energy");
    if (std::optional<Equilibrium> known = shape_without_search(problem)) {
      followed_ = false;
      if (mode == Mode::follow_only) return {};
      previous_ = std::exchange(remembered_, {});
      return {std::move(*known)};
    }
    std::vector<PlacedSpan> placed = split(problem);
    for (PlacedSpan& span : placed) {
      remove_redundant_obstacles(span.span);
      require_affordable(span.span, options_.terms, "solve_energy");
    }
    previous_ = remembered_;
    std::vector<Equilibrium> result =
        solve_without_similar_obstacles(problem, placed, mode, deadline);
    if (result.empty()) result = solve_placed(problem, placed, mode, deadline);
    const double seconds =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    for (Equilibrium& found : result) {
      found.seconds = seconds;
      if (!deadline.passed() || succeeded(found.status)) continue;
      // With more time the search might have found an equilibrium.
      if (found.status > SolveStatus::not_verified) found.status = SolveStatus::time_limit;
      if (found.message.find("time limit") != std::string::npos) continue;
      found.message += "; the search ended at its time limit";
    }
    return result;
  }

  void undo() { remembered_ = previous_; }

  /// Descends from a shape, without a further search.
  Equilibrium near(const Problem& problem, const Equilibrium& shape) {
    const Equilibrium* const given = std::exchange(options_.start, &shape);
    remembered_ = {};
    const std::shared_ptr<void> restore(nullptr, [&](void*) { options_.start = given; });
    return std::move(solve(problem, Mode::descend).front());
  }

  [[nodiscard]] const SearchLog& log() const { return log_; }
  /// Whether the last solve() followed the last shape of every span.
  [[nodiscard]] bool followed() const { return followed_; }

 private:
  /// Solves with one obstacle of each set of similar ones. If the rod enters an omitted obstacle,
  /// that one replaces the obstacles similar to it in the next attempt.
  /// @return empty if no obstacle was omitted, or if the result is not certified with all obstacles
  ///   although there was time
  std::vector<Equilibrium> solve_without_similar_obstacles(const Problem& problem,
                                                           const std::vector<PlacedSpan>& placed,
                                                           Mode mode, const Deadline& deadline) {
    constexpr int most_exchanges = 4;
    std::size_t preferred = 0;
    for (int exchange = 0; exchange < most_exchanges; ++exchange) {
      std::vector<PlacedSpan> few = placed;
      bool omitted = false;
      for (PlacedSpan& one : few) {
        omitted = omit_similar_obstacles(one.span, preferred) || omitted;
      }
      if (!omitted) return {};
      std::vector<Equilibrium> result = solve_placed(problem, few, mode, deadline);
      const double allowed = allowed_penetration * problem.length;
      const bool outside = std::ranges::all_of(result, [&](const Equilibrium& equilibrium) {
        return equilibrium.penetration <= allowed;
      });
      if (result.empty()) break;
      if (deadline.passed() || (outside && succeeded(result.front().status))) return result;
      if (outside) break;
      const std::size_t entered = judge_penetration(problem, result.front()).obstacle;
      if (entered == preferred && exchange > 0) break;
      preferred = entered;
    }
    return undo_and_return_none();
  }

  /// Solves the spans and assembles them. @return equilibria; empty if Mode::follow_only does not
  /// lead to one
  std::vector<Equilibrium> solve_placed(const Problem& problem, std::vector<PlacedSpan>& placed,
                                        Mode mode, const Deadline& deadline) {
    const bool all = mode == Mode::search_all;
    const bool searches = all || mode == Mode::search;
    const bool warm = !searches && remembered_.size() == placed.size();
    const bool only = mode == Mode::follow_only;
    followed_ = warm;
    if (only && !warm) return {};
    log_ = {};
    remembered_.resize(placed.size());
    std::vector<std::vector<SpanSolution>> solutions;
    solutions.reserve(placed.size());
    int other_side_starts = 0;
    for (std::size_t i = 0; i < placed.size(); ++i) {
      SpanOptions options;
      options.terms = options_.terms;
      options.tolerance = options_.tolerance;
      options.max_evaluations = options_.max_evaluations;
      options.deadline = deadline;
      if (only) options.start.approach = Approach::follow_only;
      if (mode == Mode::descend) options.start.approach = Approach::descend_only;
      if (all) options.log = &log_;
      options.other_side_starts = &other_side_starts;
      solutions.push_back(solve_span_at(i, placed[i], problem, options, warm));
      followed_ = followed_ && solutions.back().front().followed;
      if (only && !followed_) return undo_and_return_none();
    }
    std::vector<Equilibrium> result = combine(problem, placed, solutions, all ? SIZE_MAX : 1, log_);
    if (searches && options_.start == nullptr) {
      note_search(problem, solutions, other_side_starts, result);
    }
    followed_ = followed_ && (!only || succeeded(result.front().status));
    if (only && !followed_) return undo_and_return_none();
    return result;
  }

  [[nodiscard]] std::vector<Equilibrium> undo_and_return_none() {
    undo();
    return {};
  }

  /// Returns a span's equilibria, best first, and remembers the best one.
  [[nodiscard]] std::vector<SpanSolution> solve_span_at(std::size_t index, const PlacedSpan& placed,
                                                        const Problem& problem,
                                                        const SpanOptions& options, bool warm) {
    Remembered& memory = remembered_[index];
    if (!warm) memory = {};
    if (placed.frames) {
      std::vector<SpanSolution> found =
          solve_twisted(placed, problem, options, options_.start, memory, workspace_);
      memory.twisted.store(found.front(), placed);
      if (memory.twisted.is_known()) memory.twist = found.front().model->twist(found.front().x);
      return found;
    }
    const Equilibrium* start = memory.untwisted.is_known() ? nullptr : options_.start;
    std::vector<SpanSolution> found =
        solve_untwisted(placed, problem, options, start, memory.untwisted, workspace_);
    memory.untwisted.store(found.front(), placed);
    return found;
  }

  EnergyOptions options_;
  SearchLog log_;
  bool followed_ = false;
  SpanWorkspace workspace_;
  std::vector<Remembered> remembered_, previous_;  // after the last call and before it
};

EnergySolver::EnergySolver(const EnergyOptions& options)
    : state_(std::make_unique<State>(options)) {}
EnergySolver::~EnergySolver() = default;
EnergySolver::EnergySolver(EnergySolver&& other) noexcept = default;
EnergySolver& EnergySolver::operator=(EnergySolver&& other) noexcept = default;

Equilibrium EnergySolver::solve(const Problem& problem) {
  return std::move(state_->solve(problem, State::Mode::search).front());
}

Equilibrium EnergySolver::follow(const Problem& problem) {
  return std::move(state_->solve(problem, State::Mode::follow).front());
}

std::optional<Equilibrium> EnergySolver::try_follow(const Problem& problem) {
  std::vector<Equilibrium> kept = state_->solve(problem, State::Mode::follow_only);
  if (kept.empty()) return std::nullopt;
  return std::move(kept.front());
}

void EnergySolver::undo() { state_->undo(); }

bool EnergySolver::followed() const { return state_->followed(); }

Equilibrium EnergySolver::near(const Problem& problem, const std::vector<double>& arc_lengths,
                               const Eigen::Ref<const Eigen::Matrix3Xd>& points) {
  return state_->near(problem, shape_through(arc_lengths, points, problem.length));
}

EnergySearch EnergySolver::search(const Problem& problem) {
  EnergySearch result;
  result.equilibria = state_->solve(problem, State::Mode::search_all);
  result.strategies = state_->log().strategies();
  result.omitted = state_->log().omitted();
  return result;
}

Equilibrium solve_energy(const Problem& problem, const EnergyOptions& options) {
  return EnergySolver(options).solve(problem);
}

Equilibrium energy_near(const Problem& problem, const std::vector<double>& arc_lengths,
                        const Eigen::Ref<const Eigen::Matrix3Xd>& points,
                        const EnergyOptions& options) {
  return EnergySolver(options).near(problem, arc_lengths, points);
}

EnergySearch search_energy(const Problem& problem, const EnergyOptions& options) {
  return EnergySolver(options).search(problem);
}

std::vector<Equilibrium> all_energy(const Problem& problem, const EnergyOptions& options) {
  return search_energy(problem, options).equilibria;
}

}  // namespace dlo::energy_model
