#include "span_solver.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <utility>

#include "legendre.hpp"
#include "minimise.hpp"
#include "span_starts.hpp"

namespace dlo::energy_model {
namespace {

/// Gradient norm at which L-BFGS hands over: two Newton steps square it to below rounding, while
/// its own line search, which compares energies, would stall near the root of the rounding error.
constexpr double handover_gradient = 1e-5;

/// Above this sum of weight and loads (in EI/l^2) a rod is nearer to its soft limit than to
/// straight.
constexpr double soft_load = 12;

/// Starts, in the order of their energy, that the search for the lowest minimum follows.
constexpr std::size_t followed_starts = 2;

/// Newton's method factors a dense matrix of this size at most.
constexpr int most_unknowns = 320;

/// Unknowns of one field with which the search between grips begins, and its evaluations.
constexpr int coarse_unknowns = 60;
constexpr int most_slsqp_evaluations = 300;

/// SLSQP's work grows with the cube of the unknowns in every iteration.
constexpr Eigen::Index most_descended = 120;

/// Unstable equilibria that are followed to where they fall.
constexpr std::size_t most_falls = 8;

/// Eigenvalues closer to zero than this are neutral: a rod that may turn about an axis for nothing.
constexpr double neutral = 1e-7;

/// Coefficients of each piece that resolve a rod under this load to about 1e-10 of its length. A
/// softer rod has the layers at its clamps in pieces of their own.
int first_terms(double load) {
  return static_cast<int>(std::ceil(8 * std::pow(std::clamp(load, 1.0, 1000.0), 0.24)));
}

/// Orthonormal basis of what the constraints leave free.
Eigen::MatrixXd free_directions(const Eigen::MatrixXd& jacobian, Eigen::Index size) {
  if (jacobian.rows() == 0) return Eigen::MatrixXd::Identity(size, size);
  const Eigen::HouseholderQR<Eigen::MatrixXd> qr(jacobian.transpose());
  const Eigen::MatrixXd Q = qr.householderQ();
  return Q.rightCols(size - jacobian.rows());
}

double smallest_eigenvalue(const Eigen::MatrixXd& hessian, const Eigen::MatrixXd& jacobian) {
  const Eigen::MatrixXd Z = free_directions(jacobian, hessian.rows());
  if (Z.cols() == 0) return 1;
  const Eigen::MatrixXd projected = Z.transpose() * hessian * Z;
  return Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(projected, Eigen::EigenvaluesOnly)
      .eigenvalues()[0];
}

class Search {
 public:
  Search(Span span, SpanOptions options)
      : span_(std::move(span)), options_(std::move(options)), load_(span_.total_load()) {}

  [[nodiscard]] std::vector<SpanSolution> run() {
    if (options_.start) {
      SpanSolution solution = refined(from_field(options_.start));
      if (!span_.planar && succeeded(solution.status)) measure_stability(solution);
      return {std::move(solution)};
    }
    if (is_plain_cantilever() && !options_.all) return {refined(plain_cantilever())};
    std::vector<SpanSolution> found;
    for (const TangentField& field : ranked_fields()) {
      SpanSolution solution = refined(from_field(field));
      if (keep(solution, found)) found.push_back(std::move(solution));
      if (!options_.all) continue;
      // Descending leaves unstable equilibria; Newton's method alone stays near them.
      SpanSolution stayed = refined(near_field(field));
      if (keep(stayed, found)) found.push_back(std::move(stayed));
    }
    // What cannot hold itself falls, once more where it lands on another ridge.
    for (std::size_t i = 0; i < found.size() && i < most_falls; ++i) {
      if (!options_.all && has_stable_lowest(found)) break;
      std::optional<SpanSolution> fallen = fall(found[i]);
      if (fallen && keep(*fallen, found)) found.push_back(std::move(*fallen));
    }
    return sorted(std::move(found));
  }

 private:
  /// One clamp and nothing but weight and loads.
  [[nodiscard]] bool is_plain_cantilever() const {
    return span_.planar && span_.start_direction && span_.holds.empty() && span_.walls.empty();
  }

  [[nodiscard]] int terms() const {
    return options_.terms > 0 ? options_.terms : std::max(first_terms(load_), options_.least_terms);
  }

  /// The straight rod for a stiff one, the soft limit for a soft one or where straight is a saddle.
  [[nodiscard]] SpanSolution plain_cantilever() {
    int spent = 0;
    if (load_ < soft_load) {
      SpanSolution solution;
      solution.model = std::make_shared<SpanEnergy>(span_, terms());
      solution.x.setZero(solution.model->size());
      descend(solution);
      if (solution.status != SolveStatus::saddle) return solution;
      spent = solution.evaluations;
    }
    SpanSolution solution = from_field(soft_field(span_));
    solution.evaluations += spent;
    return solution;
  }

  [[nodiscard]] std::vector<TangentField> ranked_fields() const {
    std::vector<TangentField> fields = start_fields(span_);
    if (options_.all) return fields;
    std::vector<std::pair<double, std::size_t>> ranks;
    for (std::size_t i = 0; i < fields.size(); ++i) {
      SpanEnergy model(span_, 8);
      const Eigen::VectorXd x = model.fit(fields[i](model.nodes()));
      Eigen::VectorXd gradient(x.size());
      ranks.emplace_back(model.value(x, gradient), i);
    }
    std::stable_sort(ranks.begin(), ranks.end(),
                     [](const auto& a, const auto& b) { return a.first < b.first; });
    std::vector<TangentField> best;
    for (std::size_t i = 0; i < std::min(followed_starts, ranks.size()); ++i) {
      best.push_back(fields[ranks[i].second]);
    }
    return best;
  }

  [[nodiscard]] SpanSolution from_field(const TangentField& field) {
    SpanSolution solution;
    solution.model = std::make_shared<SpanEnergy>(span_, terms());
    if (solution.model->constraints() > 0 && options_.terms == 0 && !options_.start) {
      // SLSQP comes near with few terms; Newton's method adds the others.
      const int coarse = std::max(8, coarse_unknowns / solution.model->pieces());
      if (coarse < terms()) solution.model = std::make_shared<SpanEnergy>(span_, coarse);
    }
    solution.x = solution.model->fit(field(solution.model->nodes()));
    descend(solution);
    return solution;
  }

  [[nodiscard]] SpanSolution near_field(const TangentField& field) {
    SpanSolution solution;
    solution.model = std::make_shared<SpanEnergy>(span_, terms());
    solution.terms = terms();
    solution.x = solution.model->fit(field(solution.model->nodes()));
    polish(solution);
    return solution;
  }

  /// NLopt from solution.x, then Newton; with walls until their multipliers settle.
  void descend(SpanSolution& solution) {
    SpanEnergy& model = *solution.model;
    solution.terms = model.terms();
    const bool warm = static_cast<bool>(options_.start);
    for (int round = 0; round < 200; ++round) {
      if (warm || round > 0) {
        // A start of the caller's own is followed by Newton's method alone, if it can.
        const Eigen::VectorXd before = solution.x;
        polish(solution);
        if (!succeeded(solution.status)) {
          solution.x = before;
          minimise_and_polish(solution);
        }
      } else {
        minimise_and_polish(solution);
      }
      if (!model.has_walls() || !succeeded(solution.status)) return;
      Eigen::VectorXd gradient(model.size());
      solution.energy = model.value(solution.x, gradient);
      ++solution.evaluations;
      if (model.update_contact() < 1e-9 * span_.length) return;
    }
    solution.status = SolveStatus::failed;
    solution.message = "the contact forces of the walls did not settle";
  }

  void minimise_and_polish(SpanSolution& solution) {
    SpanEnergy& model = *solution.model;
    const Objective objective = [&model](const Eigen::Ref<const Eigen::VectorXd>& x,
                                         Eigen::Ref<Eigen::VectorXd> gradient) {
      return model.value(x, gradient);
    };
    MinimiseResult result;
    if (model.constraints() == 0) {
      result = minimise_lbfgs(objective, solution.x,
                              {handover_gradient * (1 + load_), options_.max_evaluations});
    } else {
      const Constraints constraints = [&model](Eigen::Ref<Eigen::VectorXd> residual,
                                               Eigen::Ref<Eigen::MatrixXd> jacobian) {
        model.constraint(residual, jacobian);
      };
      const int limit = std::min(options_.max_evaluations, most_slsqp_evaluations);
      result = minimise_slsqp(objective, constraints, model.constraints(), solution.x, limit);
      // Where SLSQP has lost its way Newton's method may still find it.
      if (result.status == SolveStatus::evaluation_limit && limit < options_.max_evaluations) {
        result.status = SolveStatus::roundoff_limited;
      }
    }
    solution.evaluations += result.evaluations;
    solution.status = result.status;
    solution.message = result.message;
    if (succeeded(result.status)) polish(solution);
  }

  /// Newton's method on the gradient of E - mu . c and on the constraints; the projected Hessian
  /// then tells a minimum from a saddle.
  void polish(SpanSolution& solution) const {
    SpanEnergy& model = *solution.model;
    const Eigen::Index n = model.size();
    const Eigen::Index m = model.constraints();
    Eigen::VectorXd gradient(n);
    Eigen::VectorXd residual(m);
    Eigen::MatrixXd jacobian(m, n);
    Eigen::MatrixXd hessian;
    if (solution.multipliers.size() != m) solution.multipliers.setZero(m);
    bool first = true;
    double previous = HUGE_VAL;
    const int most_steps = model.has_walls() ? 60 : 12;
    for (int step = 0; step < most_steps; ++step) {
      solution.energy = model.value(solution.x, gradient);
      ++solution.evaluations;
      if (m > 0) {
        model.constraint(residual, jacobian);
        if (first) solution.multipliers = jacobian.transpose().householderQr().solve(gradient);
        first = false;
        gradient -= jacobian.transpose() * solution.multipliers;
      }
      const double size = std::hypot(gradient.norm(), (1 + load_) * residual.norm());
      solution.residual = size;
      const bool stalled = size > 0.5 * previous && size > 1e-9 * (1 + load_);
      if (!std::isfinite(size) || (stalled && !model.has_walls())) break;
      previous = size;
      model.hessian(solution.multipliers, hessian);
      const bool last = size <= 1e-8 * (1 + load_);
      if (m == 0) {
        const Eigen::LLT<Eigen::MatrixXd> factor(hessian);
        if (factor.info() != Eigen::Success) {
          newton_step(hessian, jacobian, gradient, residual, solution);
          if (last) return finish(solution, SolveStatus::saddle);
          continue;
        }
        const Eigen::VectorXd direction = -factor.solve(gradient);
        solution.x += step_length(solution, gradient, direction) * direction;
        if (last) return finish(solution, SolveStatus::converged);
      } else {
        const bool minimum = !last || is_minimum(hessian, jacobian);
        newton_step(hessian, jacobian, gradient, residual, solution);
        // A residual below 1e-8 is squared by this step, so no evaluation has to prove it.
        if (last) return finish(solution, minimum ? SolveStatus::converged : SolveStatus::saddle);
      }
    }
    finish(solution, SolveStatus::failed);
    solution.message = "Newton's method did not reduce the residual to rounding";
  }

  /// Walls make the energy's second derivative jump: Newton's step is halved until the energy
  /// falls.
  [[nodiscard]] static double step_length(SpanSolution& solution, const Eigen::VectorXd& gradient,
                                          const Eigen::VectorXd& direction) {
    SpanEnergy& model = *solution.model;
    if (!model.has_walls()) return 1;
    const double slope = gradient.dot(direction);
    const double rounding = 1e-14 * (1 + std::abs(solution.energy));
    Eigen::VectorXd unused(gradient.size());
    for (double length = 1; length > 1e-4; length /= 2) {
      ++solution.evaluations;
      const double energy = model.value(solution.x + length * direction, unused);
      if (energy <= solution.energy + 1e-4 * length * slope + rounding) return length;
    }
    return 1e-4;
  }

  static void finish(SpanSolution& solution, SolveStatus status) {
    solution.status = status;
    solution.message = to_string(status);
  }

  static bool is_minimum(const Eigen::MatrixXd& hessian, const Eigen::MatrixXd& jacobian) {
    const Eigen::MatrixXd Z = free_directions(jacobian, hessian.rows());
    Eigen::MatrixXd projected = Z.transpose() * hessian * Z;
    projected.diagonal().array() += neutral;
    return Z.cols() == 0 || projected.llt().info() == Eigen::Success;
  }

  static void newton_step(const Eigen::MatrixXd& hessian, const Eigen::MatrixXd& jacobian,
                          const Eigen::VectorXd& gradient, const Eigen::VectorXd& residual,
                          SpanSolution& solution) {
    const Eigen::Index n = hessian.rows();
    const Eigen::Index m = jacobian.rows();
    Eigen::MatrixXd system(n + m, n + m);
    system << hessian, -jacobian.transpose(), jacobian, Eigen::MatrixXd::Zero(m, m);
    Eigen::VectorXd right(n + m);
    right << -gradient, -residual;
    Eigen::VectorXd step = system.partialPivLu().solve(right);
    // A neutral direction leaves the system singular; least squares stands still along it.
    if (!((system * step - right).norm() <= 1e-6 * right.norm()) || step.norm() > 1e3) {
      step = system.completeOrthogonalDecomposition().solve(right);
    }
    solution.x += step.head(n);
    solution.multipliers += step.tail(m);
  }

  /// Raises the number of terms until the last ones do not matter any more.
  [[nodiscard]] SpanSolution refined(SpanSolution solution) {
    // With walls the curvature has kinks where contact begins; more terms help only so far.
    if (!solution.model) return solution;
    const int fields = solution.model->span().planar ? 1 : 2;
    const int affordable = std::max(32, most_unknowns / (fields * solution.model->pieces()));
    const int most_terms = span_.walls.empty() ? std::min(max_terms, affordable) : 32;
    while (options_.terms == 0 && succeeded(solution.status) && !resolved(solution)) {
      const int terms = solution.terms;
      // Near the poles polynomials need many terms; the caller turns the axis instead.
      if (fields == 2 && !options_.all && solution.model->elevation() > largest_elevation) break;
      if (terms >= most_terms) {
        if (span_.walls.empty()) {
          finish(solution, SolveStatus::failed);
          solution.message = "the curvature is not resolved by " + std::to_string(terms) + " terms";
        }
        break;
      }
      const int more = std::min(most_terms, terms + std::max(4, terms / 2));
      SpanSolution finer;
      finer.model = std::make_shared<SpanEnergy>(span_, more);
      const Eigen::VectorXd& s = finer.model->nodes();
      finer.x = finer.model->fit(
          solution.model->sample(solution.x, std::vector<double>(s.begin(), s.end())).tangents);
      finer.multipliers = solution.multipliers;
      finer.terms = more;
      polish(finer);
      const bool descends = finer.model->size() <= most_descended;
      if (descends && (!succeeded(finer.status) || finer.model->has_walls())) descend(finer);
      finer.evaluations += solution.evaluations;
      solution = std::move(finer);
    }
    return solution;
  }

  [[nodiscard]] bool resolved(const SpanSolution& solution) const {
    const double K = solution.terms;
    // The angle that the last coefficient adds is a_K / (2K); positions feel it as little again.
    return solution.model->tail(solution.x) <= options_.tolerance * 4 * K * K;
  }

  /// Whether a solution is an equilibrium that is not known yet (or the first failure).
  [[nodiscard]] bool keep(SpanSolution& solution, const std::vector<SpanSolution>& found) const {
    const bool equilibrium = succeeded(solution.status) || solution.status == SolveStatus::saddle;
    if (!equilibrium) return found.empty();
    measure_stability(solution);
    return std::none_of(found.begin(), found.end(), [&](const SpanSolution& other) {
      const bool same_kind = succeeded(other.status) || other.status == SolveStatus::saddle;
      if (!same_kind || std::abs(other.energy - solution.energy) > 1e-8 * (1 + load_)) return false;
      const std::vector<double> s = {0.3 * span_.length, 0.6 * span_.length, span_.length};
      const double distance =
          (other.model->sample(other.x, s).points - solution.model->sample(solution.x, s).points)
              .norm();
      return distance < 1e-6 * span_.length;
    });
  }

  static void measure_stability(SpanSolution& solution) {
    SpanEnergy& model = *solution.model;
    Eigen::VectorXd gradient(model.size());
    solution.energy = model.value(solution.x, gradient);
    Eigen::MatrixXd hessian;
    Eigen::MatrixXd jacobian(model.constraints(), model.size());
    Eigen::VectorXd residual(model.constraints());
    model.constraint(residual, jacobian);
    model.hessian(solution.multipliers, hessian);
    solution.smallest_curvature = smallest_eigenvalue(hessian, jacobian);
    if (model.span().planar) {
      model.sideways(solution.multipliers, hessian, jacobian);
      solution.smallest_curvature =
          std::min(solution.smallest_curvature, smallest_eigenvalue(hessian, jacobian));
    }
    if (solution.smallest_curvature < -neutral) finish(solution, SolveStatus::saddle);
  }

  [[nodiscard]] static bool has_stable_lowest(const std::vector<SpanSolution>& found) {
    const auto lowest = std::min_element(
        found.begin(), found.end(),
        [](const SpanSolution& a, const SpanSolution& b) { return a.energy < b.energy; });
    return lowest != found.end() && succeeded(lowest->status);
  }

  /// Where an equilibrium that cannot hold itself comes to rest; out of its plane if that is where
  /// it gives way.
  [[nodiscard]] std::optional<SpanSolution> fall(const SpanSolution& solution) const {
    if (solution.status != SolveStatus::saddle || solution.model == nullptr) return std::nullopt;
    SpanEnergy& model = *solution.model;
    const bool flat = model.span().planar;
    Eigen::VectorXd gradient(model.size());
    (void)model.value(solution.x, gradient);
    Eigen::MatrixXd hessian;
    Eigen::MatrixXd jacobian(model.constraints(), model.size());
    Eigen::VectorXd residual(model.constraints());
    if (flat) {
      model.sideways(solution.multipliers, hessian, jacobian);
    } else {
      model.constraint(residual, jacobian);
      model.hessian(solution.multipliers, hessian);
    }
    const Eigen::MatrixXd Z = free_directions(jacobian, hessian.rows());
    if (Z.cols() == 0) return std::nullopt;
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(Z.transpose() * hessian * Z);
    if (eigen.eigenvalues()[0] > -neutral) return std::nullopt;
    const Eigen::VectorXd mode = 0.5 * (Z * eigen.eigenvectors().col(0)).normalized();

    Span space = model.span();
    space.planar = false;
    SpanOptions options = options_;
    options.start = nullptr;
    Search search(space, options);
    SpanSolution fallen;
    fallen.model = std::make_shared<SpanEnergy>(space, model.terms());
    // The winding of the end clamp goes along with the start.
    const Eigen::VectorXd& s = model.nodes();
    (void)fallen.model->fit(
        model.sample(solution.x, std::vector<double>(s.begin(), s.end())).tangents);
    fallen.x.resize(fallen.model->size());
    if (flat) {
      fallen.x << solution.x, mode;
    } else {
      fallen.x = solution.x + mode;
    }
    search.descend(fallen);
    return search.refined(std::move(fallen));
  }

  [[nodiscard]] std::vector<SpanSolution> sorted(std::vector<SpanSolution> found) const {
    int evaluations = 0;
    for (const SpanSolution& solution : found) evaluations += solution.evaluations;
    std::stable_sort(found.begin(), found.end(), [](const SpanSolution& a, const SpanSolution& b) {
      const bool a_stable = succeeded(a.status);
      const bool b_stable = succeeded(b.status);
      if (a_stable != b_stable) return a_stable;
      return a.energy < b.energy;
    });
    found.front().evaluations = evaluations;
    if (!options_.all) found.resize(1);
    return found;
  }

  Span span_;
  SpanOptions options_;
  double load_;
};

}  // namespace

std::vector<SpanSolution> solve_span(const Span& span, const SpanOptions& options) {
  return Search(span, options).run();
}

}  // namespace dlo::energy_model
