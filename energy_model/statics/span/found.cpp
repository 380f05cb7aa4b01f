#include "span/found.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "certify/rigid_body_modes.hpp"
#include "strain/span_energy.hpp"

namespace dlo::energy_model {
namespace {

bool is_better(const SpanSolution& a, const SpanSolution& b) {
  const auto rank = [](const SpanSolution& solution) {
    if (succeeded(solution.status)) return 0;
    return solution.is_equilibrium() ? 1 : 2;
  };
  if (rank(a) != rank(b)) return rank(a) < rank(b);
  if ((a.missing_turns == 0) != (b.missing_turns == 0)) return a.missing_turns == 0;
  return a.energy < b.energy;
}

}  // namespace

SearchStrategy& SearchLog::entry_of(const std::string& strategy) {
  const auto known = std::ranges::find(strategies_, strategy, &SearchStrategy::name);
  if (known != strategies_.end()) return *known;
  strategies_.push_back({strategy, 0, 0});
  return strategies_.back();
}

void SearchLog::add_omitted(const std::string& what) {
  if (std::ranges::find(omitted_, what) != omitted_.end()) return;
  omitted_.push_back(what);
}

void SearchLog::add_starts(const SearchLog& other, const std::string& suffix) {
  for (const SearchStrategy& strategy : other.strategies_) {
    count_tried(strategy.name + suffix, strategy.tried);
  }
  for (const std::string& what : other.omitted_) add_omitted(what);
}

int SearchLog::starts() const {
  int sum = 0;
  for (const SearchStrategy& strategy : strategies_) sum += strategy.tried;
  return sum;
}

std::optional<Writhe> writhe_of(const SpanSolution& solution) {
  const SpanShape shape = solution.model->shape(solution.x);
  return writhe([&shape](std::span<const double> at) { return shape.sample(at); }, 0,
                solution.model->span().length);
}

bool belongs_to_class(SpanSolution& solution, const std::optional<double>& turns) {
  const bool asks =
      turns && solution.is_equilibrium() && solution.model->span().has_material_directors();
  if (!asks) return true;
  const std::optional<int> lost =
      missing_turns({.turns = turns}, solution.model->twist(solution.x), writhe_of(solution));
  solution.missing_turns = lost.value_or(0);
  return lost.has_value();
}

std::vector<SpanSolution> as_list(SpanSolution solution) {
  std::vector<SpanSolution> result;
  result.push_back(std::move(solution));
  return result;
}

bool is_same_shape(const SpanSolution& a, const SpanSolution& b, double tolerance) {
  const Span& span = a.model->span();
  if (std::abs(a.energy - b.energy) > 1e-2 * tolerance * (1 + span.total_load())) return false;
  // If the span has no parts of smaller stiffness, points differ by less than the strains.
  if (a.model->size() == b.model->size() && a.terms == b.terms && span.parts.empty() &&
      span.planar == b.model->span().planar && span.cuts == b.model->span().cuts &&
      (a.x - b.x).norm() < tolerance * span.length) {
    return true;
  }
  const std::vector<double> s = {0.3 * span.length, 0.6 * span.length, span.length};
  const Eigen::Matrix3Xd of_a = a.model->shape(a.x).sample(s).points;
  const Eigen::Matrix3Xd of_b = b.model->shape(b.x).sample(s).points;
  if ((of_a - of_b).norm() < tolerance * span.length) return true;
  const bool planar = span.planar && b.model->span().planar;
  return !planar && is_rotated_copy(span, of_a, of_b);
}

bool Found::add(SpanSolution solution, const std::string& strategy) {
  evaluations_ += std::exchange(solution.evaluations, 0);
  if (!strategy.empty()) log_tried(options_.log, strategy);
  if (!is_result(solution, options_)) {
    if (found_.empty()) found_.push_back(std::move(solution));
    return false;
  }
  if (!found_.empty() && !is_result(found_.front(), options_)) found_.clear();
  const bool known = std::ranges::any_of(
      found_, [&](const SpanSolution& other) { return is_same_shape(solution, other); });
  if (known) return false;
  // Keeping the factors of many equilibria would take much memory, and most are not used again.
  if (options_.wants_all()) solution.factor.reset();
  found_.push_back(std::move(solution));
  if (!strategy.empty()) log_found(options_.log, strategy);
  return true;
}

const SpanSolution& Found::best() const { return *std::ranges::min_element(found_, is_better); }

bool Found::has_stable_lowest() const {
  const SpanSolution* lowest = nullptr;
  for (const SpanSolution& solution : found_) {
    if (!solution.is_equilibrium() || solution.missing_turns != 0) continue;
    if (lowest == nullptr || solution.energy < lowest->energy) lowest = &solution;
  }
  return lowest != nullptr && succeeded(lowest->status);
}

std::vector<SpanSolution> Found::take() && {
  std::ranges::stable_sort(found_, is_better);
  if (!options_.wants_all() && found_.size() > 1) {
    const auto stable = [](const SpanSolution& other) { return succeeded(other.status); };
    found_.erase(std::find_if_not(found_.begin() + 1, found_.end(), stable), found_.end());
    for (std::size_t i = 1; i < found_.size(); ++i) found_[i].factor.reset();
  }
  if (!found_.empty()) found_.front().evaluations = evaluations_;
  return std::move(found_);
}

}  // namespace dlo::energy_model
