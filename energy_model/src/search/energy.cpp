#include "dlo/energy_model/energy.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <numbers>
#include <string>
#include <utility>

#include "base/legendre.hpp"
#include "base/lowest_combinations.hpp"
#include "base/require.hpp"
#include "certify/rigid_body_modes.hpp"
#include "contact/penetration.hpp"
#include "problem/redundant_obstacles.hpp"
#include "problem/split.hpp"
#include "search/active_set.hpp"
#include "search/assemble.hpp"
#include "search/contact_search.hpp"
#include "search/known_shape.hpp"
#include "search/polygon_fields.hpp"
#include "search/twist_path.hpp"
#include "span/refinement.hpp"
#include "span/same_shape.hpp"
#include "span/search_log.hpp"
#include "span/span_solver.hpp"
#include "span/span_traits.hpp"

namespace dlo::energy_model {
namespace {

/// Most combinations of the spans' equilibria that are put together.
constexpr std::size_t most_combinations = 64;

/// Turn of a clamp at once that may be followed on the same branch [rad].
constexpr double largest_followed_turn = 1;

constexpr const char* from_polygons = "lowest minima of coarse polygons, by Newton's method";
constexpr const char* turned_little_by_little =
    "stable shapes without twist, turned little by little";

void check(const EnergyOptions& options) {
  require(options.terms >= 0 && options.terms <= max_terms, "solve_energy", "terms", options.terms,
          "0 to " + std::to_string(max_terms));
  require_positive("solve_energy", "tolerance", options.tolerance);
  require(options.time_limit > 0, "solve_energy", "time_limit", options.time_limit, "> 0");
  require(options.max_evaluations >= 1, "solve_energy", "max_evaluations", options.max_evaluations,
          ">= 1");
}

std::vector<Equilibrium> combine(const Problem& problem,
                                 const std::vector<std::vector<PlacedSolution>>& solutions,
                                 SearchLog& log) {
  if (solutions.size() == 1 && solutions.front().size() == 1) {
    const PlacedSolution& only = solutions.front().front();
    std::vector<Equilibrium> result;
    result.push_back(assemble(problem, {&only.placed}, {&only.solution}));
    judge_penetration(problem, result.back());
    return result;
  }
  std::vector<std::vector<SpanCandidate>> candidates;
  for (const std::vector<PlacedSolution>& of_span : solutions) {
    std::vector<SpanCandidate> own;
    own.reserve(of_span.size());
    for (const PlacedSolution& found : of_span) {
      own.push_back({succeeded(found.solution.status), found.solution.energy});
    }
    candidates.push_back(std::move(own));
  }
  const Combinations lowest = lowest_combinations(candidates, most_combinations);
  std::vector<Equilibrium> result;
  for (const std::vector<std::size_t>& choice : lowest.choices) {
    std::vector<const PlacedSpan*> placed;
    std::vector<const SpanSolution*> chosen;
    for (std::size_t i = 0; i < solutions.size(); ++i) {
      placed.push_back(&solutions[i][choice[i]].placed);
      chosen.push_back(&solutions[i][choice[i]].solution);
    }
    result.push_back(assemble(problem, placed, chosen));
    judge_penetration(problem, result.back());
  }
  std::stable_sort(result.begin(), result.end(), [](const Equilibrium& a, const Equilibrium& b) {
    if (succeeded(a.status) != succeeded(b.status)) return succeeded(a.status);
    return a.energy.total() < b.energy.total();
  });
  if (lowest.truncated) {
    for (Equilibrium& equilibrium : result) {
      equilibrium.message += "; the " + std::to_string(most_combinations) +
                             " lowest combinations of the spans' equilibria, there are more";
    }
    log.leave_out("combinations of the spans' equilibria beyond the " +
                  std::to_string(most_combinations) + " lowest");
  }
  return result;
}

}  // namespace

class EnergySolver::State {
 public:
  explicit State(const EnergyOptions& options) : options_(options) { check(options); }

  enum class Wanted { lowest, all };
  /// What is made of the shape of the last call.
  enum class From { nothing, last_shape, last_shape_only };

  /// @return none where the last shape only does not lead on
  std::vector<Equilibrium> solve(const Problem& problem, Wanted wanted, From from) {
    const auto begin = std::chrono::steady_clock::now();
    const Deadline deadline(options_.time_limit);
    log_ = {};
    std::vector<PlacedSpan> placed = split(problem);
    for (PlacedSpan& span : placed) {
      remove_redundant_obstacles(span.span);
      require_affordable(span.span, options_.terms, "solve_energy");
    }
    const bool warm = from != From::nothing && remembered_.size() == placed.size();
    const bool only = from == From::last_shape_only;
    followed_ = warm;
    if (only && !warm) return {};
    former_ = remembered_;
    former_twists_ = twists_;
    remembered_.resize(placed.size());
    twists_.resize(placed.size());
    std::vector<std::vector<PlacedSolution>> solutions;
    solutions.reserve(placed.size());
    for (std::size_t i = 0; i < placed.size(); ++i) {
      const Remembered* last = warm ? &remembered_[i] : nullptr;
      SpanOptions options;
      options.terms = options_.terms;
      options.tolerance = options_.tolerance;
      options.max_evaluations = options_.max_evaluations;
      options.deadline = deadline;
      if (only) options.approach = Approach::follow_only;
      if (wanted == Wanted::all) options.log = &log_;
      if (placed[i].frames) {
        RememberedTwist& memory = twists_[i];
        solutions.push_back(twisted(placed[i], problem, options, warm, memory));
        const PlacedSolution& found = solutions.back().front();
        followed_ = followed_ && found.solution.followed;
        if (only && !followed_) return gone_back();
        remember(found, memory.twisted);
        memory.twist = found.solution.model->twist(found.solution.x);
        continue;
      }
      const Equilibrium* start = last != nullptr && last->model ? nullptr : options_.start;
      solutions.push_back(solve_placed(placed[i], problem, options, start, last));
      followed_ = followed_ && solutions.back().front().solution.followed;
      if (only && !followed_) return gone_back();
      remember(solutions.back().front(), remembered_[i]);
    }
    std::vector<Equilibrium> result = combine(problem, solutions, log_);
    const double seconds =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    for (Equilibrium& equilibrium : result) equilibrium.seconds = seconds;
    followed_ = followed_ && (!only || succeeded(result.front().status));
    if (only && !followed_) return gone_back();
    return result;
  }

  void go_back() {
    remembered_ = former_;
    twists_ = former_twists_;
  }

  /// Of the last solve().
  [[nodiscard]] const SearchLog& log() const { return log_; }
  /// Whether the last solve() has followed every span's last shape.
  [[nodiscard]] bool followed() const { return followed_; }

 private:
  /// A span's last solution, to go on from.
  struct Remembered {
    std::shared_ptr<const SpanEnergy> model;  // none after a failure
    Eigen::VectorXd x, multipliers;
    std::shared_ptr<NewtonFactor> factor;
    KnownShape before;  // the one before it, without a factor
    Eigen::Matrix3d frame;

    [[nodiscard]] bool planar() const { return !model || model->span().planar; }
  };

  /// The same of a span that is twisted, which is followed without twist too.
  struct RememberedTwist {
    Remembered untwisted, twisted;
    double twist = 0;   // of `twisted`
    double turned = 0;  // of the end's frame from where the untwisted rod has it
  };

  [[nodiscard]] std::vector<Equilibrium> gone_back() {
    go_back();
    return {};
  }

  /// From a shape whose twist is known, if there is one. Else searches without twist: where the
  /// clamp has the frame starts there; then turns what is stable there.
  [[nodiscard]] std::vector<PlacedSolution> twisted(const PlacedSpan& placed,
                                                    const Problem& problem,
                                                    const SpanOptions& options, bool warm,
                                                    RememberedTwist& memory) {
    const HeldFrames& held = *placed.frames;
    const auto from_shape = [&](const TangentField& field, double twist,
                                const Eigen::Vector3d& end_d1,
                                std::vector<Span::Contact> contacts) {
      Span span = placed.span;
      span.contacts =
          moved_contacts(span, std::move(contacts)).value_or(std::vector<Span::Contact>());
      PlacedSolution to{
          placed, twist_from(field, twist, end_d1, span, held.stiffness, options, workspace_)};
      to.placed.span.planar = false;
      return to;
    };
    // A shape that is followed may be one that a bifurcation leaves open.
    const auto is_known = [](const SpanSolution& solution) {
      return solution.is_equilibrium() || solution.is_singular_point();
    };
    const bool starts =
        options_.start != nullptr && !options.wants_all() && !(warm && memory.twisted.model);
    const TwistedPart* part =
        starts ? known_twist(*options_.start, placed, problem.length) : nullptr;
    // A shape of other turns than are asked for is none to start from.
    if (part && holds_turns(held.turns, part->angle,
                            writhe(options_.start->sample, part->begin, part->end))) {
      PlacedSolution to = from_shape(field_of(*options_.start, placed, problem.length), part->angle,
                                     held_end_d1(held, placed.span),
                                     known_contacts(*options_.start, placed, problem.length));
      if (is_known(to.solution)) return one(std::move(to));
    }
    const Remembered* last = warm && memory.untwisted.model ? &memory.untwisted : nullptr;
    // What is found without twist is no result.
    SearchLog without_twist;
    SpanOptions untwisted_options = options;
    if (options.wants_all()) untwisted_options.log = &without_twist;
    std::vector<PlacedSolution> untwisted =
        solve_placed(placed, problem, untwisted_options, nullptr, last);
    if (options.wants_all()) options.log->add_starts(without_twist, ", without twist");
    remember(untwisted.front(), memory.untwisted);
    if (!succeeded(untwisted.front().solution.status)) return untwisted;
    const EndFrame frame = end_frame(held, untwisted_shape(untwisted.front().solution, workspace_));
    const double turned = frame.twist - std::exchange(memory.turned, frame.twist);
    if (warm && memory.twisted.model && std::abs(turned) < largest_followed_turn &&
        !options.wants_all()) {
      const auto field = [&placed, &memory](const Eigen::VectorXd& s) {
        return follow_field(placed, memory.twisted, s);
      };
      PlacedSolution to =
          from_shape(field, memory.twist + turned, frame.d1, memory.twisted.model->span().contacts);
      to.solution.evaluations += untwisted.front().solution.evaluations;
      to.solution.followed = is_known(to.solution);
      if (to.solution.followed || options.only_follows()) return one(std::move(to));
    }
    if (options.only_follows()) {
      untwisted.front().solution.followed = false;
      return untwisted;
    }
    std::vector<PlacedSolution> found;
    int spent = 0;
    note_left_out(options.log,
                  "unstable twisted shapes, and those that no stable one is turned to");
    for (const PlacedSolution& from : untwisted) {
      if (!succeeded(from.solution.status)) continue;
      PlacedSolution to = from;
      to.solution = twist_to(frame, placed.span, held.stiffness,
                             untwisted_shape(from.solution, workspace_), options, workspace_);
      to.placed.span.planar = false;
      spent += from.solution.evaluations + to.solution.evaluations;
      const bool known = std::any_of(found.begin(), found.end(), [&](const auto& other) {
        return other.solution.is_equilibrium() && is_same(to, other);
      });
      note_tried(options.log, turned_little_by_little);
      if (known) continue;
      if (to.solution.is_equilibrium()) note_found(options.log, turned_little_by_little);
      found.push_back(std::move(to));
    }
    sort(found);
    found.front().solution.evaluations = spent;
    return found;
  }

  /// @param shape, last  to start from, the first of them that is there, or neither
  [[nodiscard]] std::vector<PlacedSolution> solve_placed(const PlacedSpan& placed,
                                                         const Problem& problem,
                                                         SpanOptions options,
                                                         const Equilibrium* shape,
                                                         const Remembered* last) {
    // Nothing is known after a failure.
    if (options.only_follows() && !(last != nullptr && last->model)) return one({placed, {}});
    TangentField start;
    if (shape != nullptr) {
      start = field_of(*shape, placed, problem.length);
    } else if (last != nullptr && last->model) {
      options.known = {last->model, last->x, last->multipliers, last->factor};
      options.before = last->before;
      start = [&placed, last = *last](const Eigen::VectorXd& s) {
        return follow_field(placed, last, s);
      };
    }
    int spent = 0;
    if (start && !options.wants_all()) {
      PlacedSpan own = placed;
      if (options.known.model) {
        own.span.cuts = options.known.model->span().cuts;
        own.span.contact_ends = options.known.model->span().contact_ends;
      }
      PlacedSolution followed =
          from_field(own, start, options, shape != nullptr || (last && !last->planar()));
      if (followed.solution.is_equilibrium() || followed.solution.is_singular_point() ||
          options.only_follows()) {
        return one(std::move(followed));
      }
      // The branch has ended, or the step was too large for it.
      spent = followed.solution.evaluations;
      options.known = {};
      options.before = {};
    }
    std::vector<PlacedSolution> found = search(placed, options);
    spent += found.front().solution.evaluations;
    const SolveStatus status = found.front().solution.status;
    const bool at_limit =
        status == SolveStatus::evaluation_limit || status == SolveStatus::time_limit;
    if (options.wants_all() || !(succeeded(status) || at_limit))
      add_polygon_minima(placed, problem, options, found, spent);
    sort(found);
    found.front().solution.evaluations = spent;
    if (!options.wants_all()) found.resize(1, found.front());
    return found;
  }

  [[nodiscard]] static std::vector<PlacedSolution> one(PlacedSolution solution) {
    std::vector<PlacedSolution> result;
    result.push_back(std::move(solution));
    return result;
  }

  static void sort(std::vector<PlacedSolution>& found) {
    if (found.size() < 2) return;
    std::stable_sort(found.begin(), found.end(), [](const auto& a, const auto& b) {
      return is_better(a.solution, b.solution);
    });
  }

  /// What the minima of a coarse polygon lead to, in the plane and out of it.
  void add_polygon_minima(const PlacedSpan& placed, const Problem& problem,
                          const SpanOptions& options, std::vector<PlacedSolution>& found,
                          int& spent) {
    if (!problem.obstacles.empty()) {
      note_left_out(options.log, "minima of coarse polygons, which know no obstacles");
      return;
    }
    const PolygonFields fields(problem, placed, options.deadline);
    for (std::size_t i = 0; i < fields.size(); ++i) {
      if (options.deadline.passed()) {
        note_left_out(options.log, "starts after the time limit");
        return;
      }
      note_tried(options.log, from_polygons);
      // A minimum of the polygon is next to one of the rod; fewer terms than resolve it would lead
      // away.
      SpanOptions own = options;
      own.approach = Approach::follow;
      PlacedSolution solution = from_field(placed, fields.field(i), own, true);
      spent += solution.solution.evaluations;
      if (!counts(solution.solution, options)) continue;
      const bool known = std::any_of(found.begin(), found.end(), [&](const auto& other) {
        return counts(other.solution, options) && is_same(solution, other);
      });
      if (known) continue;
      if (!counts(found.front().solution, options)) found.clear();
      found.push_back(std::move(solution));
      note_found(options.log, from_polygons);
      if (!options.wants_all() && succeeded(found.back().solution.status)) return;
    }
  }

  [[nodiscard]] static bool is_same(const PlacedSolution& a, const PlacedSolution& b) {
    const double scale = 1 + std::abs(a.solution.energy);
    if (std::abs(a.solution.energy - b.solution.energy) > 1e-8 * scale) return false;
    const double length = a.placed.span.length;
    const std::vector<double> s = {0.3 * length, 0.6 * length, length};
    const auto points = [&](const PlacedSolution& p) {
      const SpanSamples samples = p.solution.model->shape(p.solution.x).sample(s);
      return Eigen::Matrix3Xd(p.placed.frame.transpose() * samples.points);
    };
    const Eigen::Matrix3Xd of_a = points(a);
    const Eigen::Matrix3Xd of_b = points(b);
    const Eigen::Matrix3d& frame = a.placed.frame;
    if ((of_a - of_b).norm() < 1e-6 * length) return true;
    // In its plane a shape and the one turned over are both told, as one that is bent to the left
    // and one to the right.
    const bool planar = a.solution.model->span().planar && b.solution.model->span().planar;
    return !planar && is_turned_copy(a.placed.span, frame * of_a, frame * of_b);
  }

  /// From tangents in the span's frame; out of its plane if they are and may be.
  [[nodiscard]] PlacedSolution from_field(const PlacedSpan& placed, const TangentField& field,
                                          SpanOptions options, bool may_leave_plane) {
    PlacedSpan own = placed;
    options.start = field;
    options.log = nullptr;
    if (placed.span.planar && may_leave_plane) leave_plane(own, field);
    return std::move(search(own, options).front());
  }

  [[nodiscard]] std::vector<PlacedSolution> search(const PlacedSpan& placed,
                                                   const SpanOptions& options) {
    std::vector<PlacedSolution> found;
    const auto solver = placed.span.rigid_obstacles.empty() ? solve_span : solve_touching_span;
    for (SpanSolution& solution : solver(placed.span, options, workspace_)) {
      found.push_back({placed, std::move(solution)});
      PlacedSolution& last = found.back();
      // The search may have left the plane.
      if (last.solution.model) last.placed.span.planar = last.solution.model->span().planar;
    }
    return found;
  }

  /// A span that could lie in its plane is spatial if its start has left it.
  static void leave_plane(PlacedSpan& placed, const TangentField& start) {
    const Eigen::VectorXd s = Eigen::VectorXd::LinSpaced(17, 0, placed.span.length);
    const Eigen::Matrix3Xd tangents = start(s).tangents;
    constexpr double flat = 1e-6;
    if (tangents.row(2).cwiseAbs().maxCoeff() < flat) return;
    placed.span.planar = false;
  }

  /// The nodes are where they were, unless grips or loads have moved along the rod.
  static StartShape follow_field(const PlacedSpan& placed, const Remembered& last,
                                 const Eigen::VectorXd& s) {
    StartShape shape(placed.frame * last.frame.transpose() * last.model->tangents());
    if (placed.span.has_material_directors() && !last.planar()) {
      shape.roll = roll_of(last.model->tangents(), last.model->d1());
    }
    const Eigen::VectorXd& nodes = last.model->nodes();
    if (s.size() == nodes.size() && s == nodes) return shape;
    StartShape nearest(Eigen::Matrix3Xd(3, s.size()),
                       Eigen::VectorXd(shape.roll.size() > 0 ? s.size() : 0));
    for (Eigen::Index q = 0; q < s.size(); ++q) {
      Eigen::Index at = 0;
      (nodes.array() - s[q]).abs().minCoeff(&at);
      nearest.tangents.col(q) = shape.tangents.col(at);
      if (shape.roll.size() > 0) nearest.roll[q] = shape.roll[at];
    }
    return nearest;
  }

  static void remember(const PlacedSolution& found, Remembered& last) {
    const bool is_known = succeeded(found.solution.status) || found.solution.is_singular_point();
    last.before = {std::exchange(last.model, is_known ? found.solution.model : nullptr),
                   std::move(last.x), std::move(last.multipliers)};
    last.x = found.solution.x;
    last.multipliers = found.solution.multipliers;
    last.factor = found.solution.factor;
    last.frame = found.placed.frame;
  }

  EnergyOptions options_;
  SearchLog log_;
  bool followed_ = false;
  SpanWorkspace workspace_;
  std::vector<Remembered> remembered_, former_;          // after the last call, and before it
  std::vector<RememberedTwist> twists_, former_twists_;  // the same
};

EnergySolver::EnergySolver(const EnergyOptions& options)
    : state_(std::make_unique<State>(options)) {}
EnergySolver::~EnergySolver() = default;
EnergySolver::EnergySolver(EnergySolver&& other) noexcept = default;
EnergySolver& EnergySolver::operator=(EnergySolver&& other) noexcept = default;

Equilibrium EnergySolver::solve(const Problem& problem) {
  return std::move(state_->solve(problem, State::Wanted::lowest, State::From::nothing).front());
}

Equilibrium EnergySolver::follow(const Problem& problem) {
  return std::move(state_->solve(problem, State::Wanted::lowest, State::From::last_shape).front());
}

std::optional<Equilibrium> EnergySolver::keep(const Problem& problem) {
  std::vector<Equilibrium> kept =
      state_->solve(problem, State::Wanted::lowest, State::From::last_shape_only);
  if (kept.empty()) return std::nullopt;
  return std::move(kept.front());
}

void EnergySolver::go_back() { state_->go_back(); }

bool EnergySolver::followed() const { return state_->followed(); }

EnergySearch EnergySolver::search(const Problem& problem) {
  EnergySearch result;
  result.equilibria = state_->solve(problem, State::Wanted::all, State::From::nothing);
  result.looked_from = state_->log().looked_from();
  result.not_looked = state_->log().not_looked();
  return result;
}

std::vector<Equilibrium> EnergySolver::solve_all(const Problem& problem) {
  return state_->solve(problem, State::Wanted::all, State::From::nothing);
}

Equilibrium solve_energy(const Problem& problem, const EnergyOptions& options) {
  return EnergySolver(options).solve(problem);
}

EnergySearch search_energy(const Problem& problem, const EnergyOptions& options) {
  return EnergySolver(options).search(problem);
}

std::vector<Equilibrium> all_energy(const Problem& problem, const EnergyOptions& options) {
  return EnergySolver(options).solve_all(problem);
}

}  // namespace dlo::energy_model
