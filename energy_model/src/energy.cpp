#include "dlo/energy_model/energy.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <string>

#include "assemble.hpp"
#include "legendre.hpp"
#include "penetration.hpp"
#include "require.hpp"
#include "span_solver.hpp"
#include "split.hpp"

namespace dlo::energy_model {
namespace {

/// Most combinations of the spans' equilibria that are put together.
constexpr std::size_t most_combinations = 64;

void check(const EnergyOptions& options) {
  require(options.terms >= 0 && options.terms <= max_terms, "solve_energy", "terms", options.terms,
          "0 to " + std::to_string(max_terms));
  require_positive("solve_energy", "tolerance", options.tolerance);
  require(options.max_evaluations >= 1, "solve_energy", "max_evaluations", options.max_evaluations,
          ">= 1");
}

/// Tangents of an equilibrium as a span sees them.
TangentField field_of(const Equilibrium& start, const PlacedSpan& placed, double length) {
  return [&start, &placed, length](const Eigen::VectorXd& s) {
    std::vector<double> arc_lengths;
    arc_lengths.reserve(static_cast<std::size_t>(s.size()));
    for (const double at : s) {
      const double arc = placed.start + (placed.reversed ? -at : at) * length;
      arc_lengths.push_back(std::clamp(arc, 0.0, length));
    }
    const Eigen::Matrix3Xd tangents = start.sample(arc_lengths).tangents;
    return Eigen::Matrix3Xd((placed.reversed ? -1.0 : 1.0) * (placed.frame * tangents));
  };
}

std::vector<Equilibrium> combine(const Problem& problem, const std::vector<PlacedSpan>& placed,
                                 const std::vector<std::vector<SpanSolution>>& solutions) {
  std::vector<Equilibrium> result;
  std::vector<std::size_t> choice(placed.size(), 0);
  for (bool more = true; more && result.size() < most_combinations;) {
    std::vector<const SpanSolution*> chosen;
    for (std::size_t i = 0; i < placed.size(); ++i) chosen.push_back(&solutions[i][choice[i]]);
    result.push_back(assemble(problem, placed, chosen));
    judge_contact(problem, chosen, result.back());
    more = false;
    for (std::size_t i = 0; i < choice.size() && !more; ++i) {
      more = ++choice[i] < solutions[i].size();
      if (!more) choice[i] = 0;
    }
  }
  std::stable_sort(result.begin(), result.end(), [](const Equilibrium& a, const Equilibrium& b) {
    if (succeeded(a.status) != succeeded(b.status)) return succeeded(a.status);
    return a.energy.total() < b.energy.total();
  });
  return result;
}

}  // namespace

class EnergySolver::State {
 public:
  explicit State(const EnergyOptions& options) : options_(options) { check(options); }

  std::vector<Equilibrium> solve(const Problem& problem, bool all, bool follow) {
    const auto begin = std::chrono::steady_clock::now();
    std::vector<PlacedSpan> placed = split(problem);
    const bool warm = follow && remembered_.size() == placed.size();
    remembered_.resize(placed.size());
    std::vector<std::vector<SpanSolution>> solutions;
    solutions.reserve(placed.size());
    for (std::size_t i = 0; i < placed.size(); ++i) {
      Remembered* last = warm ? &remembered_[i] : nullptr;
      solutions.push_back(solve_placed(placed[i], problem, all, last));
      remember(placed[i], solutions.back().front(), remembered_[i]);
    }
    std::vector<Equilibrium> result = combine(problem, placed, solutions);
    const double seconds =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    for (Equilibrium& equilibrium : result) equilibrium.seconds = seconds;
    return result;
  }

 private:
  /// A span's last solution, to go on from.
  struct Remembered {
    std::shared_ptr<const SpanEnergy> model;  // none after a failure
    Eigen::Matrix3d frame;

    [[nodiscard]] bool planar() const { return !model || model->span().planar; }
  };

  std::vector<SpanSolution> solve_placed(PlacedSpan& placed, const Problem& problem, bool all,
                                         const Remembered* last) {
    SpanOptions options;
    options.terms = options_.terms;
    options.tolerance = options_.tolerance;
    options.max_evaluations = options_.max_evaluations;
    options.all = all;
    if (options_.start != nullptr) {
      options.start = field_of(*options_.start, placed, problem.length);
    } else if (last != nullptr && last->model) {
      options.least_terms = last->model->terms();
      options.start = [&placed, last = *last](const Eigen::VectorXd& s) {
        return follow_field(placed, last, s);
      };
    }
    const bool may_leave_plane = options_.start != nullptr || (last && !last->planar());
    if (placed.span.planar && options.start && may_leave_plane) leave_plane(placed, options.start);
    const PlacedSpan as_placed = placed;
    int spent = 0;
    constexpr std::size_t attempts = 3;
    for (std::size_t attempt = 0;; ++attempt) {
      options.first_start = attempt * followed_starts;
      std::vector<SpanSolution> solutions = search(placed, options);
      SpanSolution& best = solutions.front();
      spent = best.evaluations += spent;
      if (all || options.start || best.is_equilibrium() || attempt + 1 == attempts)
        return solutions;
      placed = as_placed;
    }
  }

  /// solve_span(), again about another axis while the solution comes too near to its own.
  std::vector<SpanSolution> search(PlacedSpan& placed, SpanOptions options) {
    std::vector<SpanSolution> solutions = solve_span(placed.span, options, workspace_);
    // The search may have left the plane.
    if (!solutions.front().model->span().planar) placed.span.planar = false;
    if (placed.span.planar || options.all) return solutions;
    constexpr int most_turns = 3;
    for (int turn = 1; turn <= most_turns; ++turn) {
      if (solutions.front().model->elevation() < largest_elevation) break;
      options.past_poles = turn == most_turns;
      solutions = {with_axis_turned(placed, solutions.front(), options)};
    }
    return solutions;
  }

  /// A span that could lie in its plane is spatial if its start has left it.
  static void leave_plane(PlacedSpan& placed, const TangentField& start) {
    const Eigen::VectorXd s = Eigen::VectorXd::LinSpaced(17, 0, placed.span.length);
    const Eigen::Matrix3Xd tangents = start(s);
    constexpr double flat = 1e-6;
    if (tangents.row(2).cwiseAbs().maxCoeff() < flat) return;
    placed.span.planar = false;
    turn_axis(placed, tangents);
  }

  /// Once more, with an axis from which this solution's tangents stay away.
  SpanSolution with_axis_turned(PlacedSpan& placed, const SpanSolution& solution,
                                SpanOptions options) {
    const SpanShape shape = solution.model->shape(solution.x);
    const Eigen::Matrix3d before = placed.frame;
    turn_axis(placed, sample_tangents(shape, solution.model->nodes()));
    const Eigen::Matrix3d turn = placed.frame * before.transpose();
    options.start = [shape, turn](const Eigen::VectorXd& s) {
      return Eigen::Matrix3Xd(turn * sample_tangents(shape, s));
    };
    options.least_terms = solution.terms;
    SpanSolution turned = std::move(solve_span(placed.span, options, workspace_).front());
    turned.evaluations += solution.evaluations;
    return turned;
  }

  static Eigen::Matrix3Xd sample_tangents(const SpanShape& shape, const Eigen::VectorXd& s) {
    return shape.sample({s.data(), static_cast<std::size_t>(s.size())}).tangents;
  }

  /// The nodes are where they were, unless grips or loads have moved along the rod.
  static Eigen::Matrix3Xd follow_field(const PlacedSpan& placed, const Remembered& last,
                                       const Eigen::VectorXd& s) {
    Eigen::Matrix3Xd tangents = placed.frame * last.frame.transpose() * last.model->tangents();
    const Eigen::VectorXd& nodes = last.model->nodes();
    if (s.size() == nodes.size() && s == nodes) return tangents;
    Eigen::Matrix3Xd nearest(3, s.size());
    for (Eigen::Index q = 0; q < s.size(); ++q) {
      Eigen::Index at = 0;
      (nodes.array() - s[q]).abs().minCoeff(&at);
      nearest.col(q) = tangents.col(at);
    }
    return nearest;
  }

  static void remember(const PlacedSpan& placed, const SpanSolution& solution, Remembered& last) {
    last.model = succeeded(solution.status) ? solution.model : nullptr;
    last.frame = placed.frame;
  }

  EnergyOptions options_;
  SpanWorkspace workspace_;
  std::vector<Remembered> remembered_;
};

EnergySolver::EnergySolver(const EnergyOptions& options)
    : state_(std::make_unique<State>(options)) {}
EnergySolver::~EnergySolver() = default;
EnergySolver::EnergySolver(EnergySolver&& other) noexcept = default;
EnergySolver& EnergySolver::operator=(EnergySolver&& other) noexcept = default;

Equilibrium EnergySolver::solve(const Problem& problem) {
  return std::move(state_->solve(problem, false, false).front());
}

Equilibrium EnergySolver::follow(const Problem& problem) {
  return std::move(state_->solve(problem, false, true).front());
}

std::vector<Equilibrium> EnergySolver::solve_all(const Problem& problem) {
  return state_->solve(problem, true, false);
}

Equilibrium solve_energy(const Problem& problem, const EnergyOptions& options) {
  return EnergySolver(options).solve(problem);
}

std::vector<Equilibrium> all_energy(const Problem& problem, const EnergyOptions& options) {
  return EnergySolver(options).solve_all(problem);
}

}  // namespace dlo::energy_model
