#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

#include "base/found_equilibria.hpp"
#include "base/gsl.hpp"
#include "base/spin.hpp"
#include "shooting/span_search.hpp"

namespace dlo::energy_model {
namespace {

using std::numbers::pi;

constexpr int most_integrations = 20000;  // number of shots after which no cell is halved
constexpr int deepest_cell = 6;           // maximum number of halvings of a cell of the scan
// Allowed error of the cubic in a cell, divided by the residual there.
constexpr double cell_tolerance = 0.02;
// Residual of a double root: rounding error of a shot.
constexpr double double_root_residual = 1e-11;

/// Tip angle of a shot, its residual at the clamp, and the derivative of the residual by the tip
/// angle. The residual is the sine of half the error of the clamp's angle, which is zero at every
/// winding number; NaN if the shot fails.
struct ScanPoint {
  double start = 0;
  double residual = 0;
  double slope = 0;
};

/// Shots from the tip of a span with one clamp, in the frame whose x axis is the direction of the
/// force nearest to the tip. psi is the angle of the tangent, which points away from the clamp, and
/// sigma the distance from the tip along the rod.
class TipShooter {
 public:
  TipShooter(const RodSpan& span, double tolerance, const Deadline& deadline)
      : span_(span),
        mesh_(make_mesh(span, span.length)),
        tolerance_(tolerance),
        deadline_(deadline),
        clamp_sign_(span.clamps.front().at == 0 ? 1 : -1),
        bending_(span.parts.front().section.bending) {
    const Eigen::Vector3d along = clamp_sign_ * span.clamps.front().direction;
    normal_ = along.cross(span.plane->y);
    const Eigen::Vector3d& weight = span.parts.front().section.weight;
    Eigen::Vector3d last = mesh_.load.col(node(mesh_, 0));
    if (last.isZero(0)) last = weight;
    for (Eigen::Index k = 1; k < mesh_.s.size() && last.isZero(0); ++k) {
      last = mesh_.load.col(node(mesh_, k));
    }
    x_ = last.isZero(0) ? along : Eigen::Vector3d(last.normalized());
    y_ = normal_.cross(x_);
    clamp_angle_ = -std::atan2(x_.dot(span.plane->y), x_.dot(along));
    weight_ = in_frame(weight);
    parallel_ = weight_.y() == 0;
    for (Eigen::Index i = 0; i < mesh_.s.size(); ++i) {
      parallel_ =
          parallel_ && in_frame(mesh_.load.col(i)).y() == 0 && mesh_.couple.col(i).isZero(0);
    }
  }

  int integrations = 0;
  int failures = 0;  // shots that failed, and roots from which no equilibrium resulted
  bool out_of_time = false;

  /// Whether all forces are parallel and no couple acts, so that the tip angle against them may be
  /// exponentially small.
  [[nodiscard]] bool parallel() const { return parallel_; }

  /// Returns the sum of weight and loads over EI/l^2, l the length of the span.
  [[nodiscard]] double load() const {
    return total_load(span_) * span_.length * span_.length / bending_;
  }

  ScanPoint point(double start) {
    ++integrations;
    out_of_time = out_of_time || deadline_.passed();
    std::vector<double> y;
    if (out_of_time ||
        !shoot(mesh_, start, Components::tip_angle_derivatives, y, [](Eigen::Index) {})) {
      ++failures;
      return {start, NAN, NAN};
    }
    const double half = (unit_of(start) * y[0] - clamp_angle_) / 2;
    return {start, std::sin(half), std::cos(half) / 2 * y[2]};
  }

  /// Returns the cross-sections at the nodes of a mesh; those at the last node are just after it.
  /// Empty if the shot fails.
  [[nodiscard]] std::vector<RodState> states(const RodMesh& mesh, double start) const {
    std::vector<RodState> states(static_cast<std::size_t>(mesh.s.size()));
    const Eigen::Matrix3Xd carried = internal_force(span_, mesh).after_node;
    std::vector<double> y;
    const double unit = unit_of(start);
    const auto set_state = [&](Eigen::Index i) {
      RodState& state = states[static_cast<std::size_t>(i)];
      const double psi = unit * y[0];
      const Eigen::Vector3d tangent = clamp_sign_ * (std::cos(psi) * x_ + std::sin(psi) * y_);
      state.r = y[2] * x_ + y[3] * y_;
      state.R = frame_along(tangent, normal_);
      // The derivative of psi by sigma is minus the curvature.
      state.m = -clamp_sign_ * bending_ * unit * y[1] * normal_;
      state.n = carried.col(i);
    };
    if (!shoot(mesh, start, Components::position, y, set_state)) return {};
    states.back().m.setZero();
    states.back().n.setZero();
    const Eigen::Vector3d clamp = (clamp_sign_ > 0 ? states.front() : states.back()).r;
    for (RodState& state : states) state.r += span_.holds.front().position - clamp;
    return states;
  }

 private:
  /// Third and fourth component of a shot: the derivatives of the first two by the tip angle, or
  /// the position.
  enum class Components { tip_angle_derivatives, position };

  struct ShotData {
    Eigen::Vector2d weight;
    Eigen::Vector2d loads;  // sum of the loads between the tip and sigma
    double begin = 0;       // sigma
    double unit = 1;
    Components components = Components::tip_angle_derivatives;
  };

  /// Returns the node k from the tip.
  [[nodiscard]] Eigen::Index node(const RodMesh& mesh, Eigen::Index k) const {
    return clamp_sign_ > 0 ? mesh.intervals() - k : k;
  }

  [[nodiscard]] Eigen::Vector2d in_frame(const Eigen::Vector3d& force) const {
    Eigen::Vector2d local_force = Eigen::Vector2d(x_.dot(force), y_.dot(force)) / bending_;
    // A force that is parallel up to rounding is made parallel, because it must not disturb an
    // exponentially small psi.
    if (std::abs(local_force.y()) < 1e-14 * local_force.norm()) local_force.y() = 0;
    return local_force;
  }

  /// Returns the unit of psi in a shot. If psi may be exponentially small at the tip, its relative
  /// error has to be controlled.
  [[nodiscard]] double unit_of(double start) const {
    return parallel_ ? std::max(std::min(std::abs(start), 1.0), 1e-300) : 1.0;
  }

  static int rates(double at, const double* y, double* rate, void* data) {
    const auto& piece = *static_cast<const ShotData*>(data);
    const Eigen::Vector2d n = (piece.begin + at) * piece.weight + piece.loads;
    const double sine = std::sin(piece.unit * y[0]);
    const double cosine = std::cos(piece.unit * y[0]);
    const bool changes = piece.components == Components::tip_angle_derivatives;
    rate[0] = y[1];
    rate[1] = (n.x() * sine - n.y() * cosine) / piece.unit;
    rate[2] = changes ? y[3] : -cosine;
    rate[3] = changes ? (n.x() * cosine + n.y() * sine) * y[2] : -sine;
    return 0;
  }

  /// Integrates psi and its derivative by sigma, both over unit_of(start), and two further
  /// components from the tip, where psi = start, to the clamp.
  /// @param at_node  called for each node with the components just after it along the rod
  /// @return false if the integrator failed
  template <typename Visit>
  bool shoot(const RodMesh& mesh, double start, Components components, std::vector<double>& y,
             const Visit& at_node) const {
    ShotData piece{weight_, Eigen::Vector2d::Zero(), 0, unit_of(start), components};
    y = {start / piece.unit, 0, components == Components::tip_angle_derivatives ? 1.0 : 0.0, 0};
    for (Eigen::Index k = 0;; ++k) {
      const Eigen::Index i = node(mesh, k);
      if (clamp_sign_ > 0) at_node(i);
      piece.loads += in_frame(mesh.load.col(i));
      y[1] -= normal_.dot(mesh.couple.col(i)) / bending_ / piece.unit;
      if (clamp_sign_ < 0) at_node(i);
      if (k == mesh.intervals()) return true;
      const double width = mesh.width(clamp_sign_ > 0 ? i - 1 : i);
      if (!integrate(rates, &piece, width, tolerance_, y)) return false;
      piece.begin += width;
    }
  }

  const RodSpan& span_;
  RodMesh mesh_;  // mesh with no other nodes than ends and loads
  double tolerance_;
  Deadline deadline_;
  double clamp_sign_;  // 1: the clamp is at the begin; -1: at the end
  double bending_;
  Eigen::Vector3d normal_, x_, y_;
  double clamp_angle_ = 0;  // psi at the clamp, up to whole turns
  Eigen::Vector2d weight_;
  bool parallel_ = true;
};

/// Returns the tip angles psi of the scan, growing from -pi to pi. If all forces are parallel, the
/// tip angle against them may be exponentially small, and the grid includes such angles. Otherwise
/// the tip angle has no known limit and is found only to rounding, so the rod must not amplify its
/// error too much.
std::vector<double> scan_grid(const TipShooter& shooter) {
  std::vector<double> positive;
  const double smallest = std::exp(-std::sqrt(shooter.load()) - 6);
  for (double start = smallest; start < 0.1; start *= 1.5) positive.push_back(start);
  const int uniform = shooter.parallel() ? 120 : 600;
  for (int i = 0; i <= uniform; ++i) positive.push_back(0.1 + (pi - 0.1) * i / uniform);
  std::vector<double> grid;
  for (auto start = positive.rbegin(); start != positive.rend(); ++start) grid.push_back(-*start);
  grid.push_back(0);
  grid.insert(grid.end(), positive.begin(), positive.end());
  return grid;
}

/// Finds the roots of the residual, cell by cell.
class TipScan {
 public:
  explicit TipScan(TipShooter& shooter) : shooter_(shooter) {}

  std::vector<ScanPoint> run() {
    ScanPoint previous{0, NAN, NAN};
    for (const double start : scan_grid(shooter_)) {
      const ScanPoint next = shooter_.point(start);
      subdivide(previous, next, 0);
      // A root without a change of sign is only possible for a rod that is straight at this tip
      // angle.
      const bool straight = next.start == 0 || std::abs(next.start) == pi;
      if (straight && is_zero(next)) roots_.push_back(next);
      previous = next;
    }
    // The tip angles -pi and pi are the same.
    if (roots_.size() > 1 && roots_.front().start == -pi && roots_.back().start == pi) {
      roots_.pop_back();
    }
    return roots_;
  }

 private:
  static bool is_zero(const ScanPoint& point) { return std::abs(point.residual) < 1e-15; }

  /// Halves a cell until a cubic through its ends predicts the residual in its middle.
  void subdivide(const ScanPoint& low, const ScanPoint& high, int depth) {
    if (!std::isfinite(low.residual) || !std::isfinite(high.residual)) return;
    const ScanPoint middle = shooter_.point((low.start + high.start) / 2);
    if (!std::isfinite(middle.residual)) return;
    const double cubic = (low.residual + high.residual) / 2 +
                         (high.start - low.start) / 8 * (low.slope - high.slope);
    const double size = std::max(
        {std::abs(low.residual), std::abs(middle.residual), std::abs(high.residual), 1e-12});
    const bool resolved = std::abs(middle.residual - cubic) <= cell_tolerance * size;
    if (resolved || depth == deepest_cell || shooter_.integrations > most_integrations) {
      find_roots(low, middle);
      find_roots(middle, high);
    } else {
      subdivide(low, middle, depth + 1);
      subdivide(middle, high, depth + 1);
    }
  }

  void find_roots(const ScanPoint& low, const ScanPoint& high) {
    if (is_zero(low) || is_zero(high)) return;
    if (low.residual * high.residual < 0) {
      add(root(&ScanPoint::residual, low, high));
      return;
    }
    // If the residual approaches zero from both ends, the cell contains two roots or none.
    if (low.residual * low.slope >= 0 || high.residual * high.slope <= 0) return;
    const ScanPoint extremum = root(&ScanPoint::slope, low, high);
    if (!std::isfinite(extremum.residual) || std::abs(extremum.residual) < double_root_residual) {
      add(extremum);
    } else if (extremum.residual * low.residual < 0) {
      add(root(&ScanPoint::residual, low, extremum));
      add(root(&ScanPoint::residual, extremum, high));
    }
  }

  /// Finds a root of the residual or of its slope between two tip angles at which its signs differ,
  /// by the secant method with a bracket (Illinois).
  ScanPoint root(double ScanPoint::*value, ScanPoint a, ScanPoint b) {
    for (int i = 0; i < 200 && b.*value != 0; ++i) {
      const double start = b.start - b.*value * (b.start - a.start) / (b.*value - a.*value);
      if (start == a.start || start == b.start) break;
      const ScanPoint next = shooter_.point(start);
      if (next.*value * b.*value < 0) {
        a = b;
      } else {
        a.*value /= 2;
      }
      b = next;
      if (!std::isfinite(b.*value)) break;
    }
    return b;
  }

  /// Adds a root, unless its shot failed, which TipShooter counts, or the search did not converge.
  void add(const ScanPoint& root) {
    if (std::abs(root.residual) < 5e-9) roots_.push_back(root);
  }

  TipShooter& shooter_;
  std::vector<ScanPoint> roots_;
};

}  // namespace

bool tip_can_be_scanned(const RodSpan& span) {
  const RodSpan::Part& part = span.parts.front();
  if (!span.round() || !span.plane || span.holds.size() != 1 || span.clamps.size() != 1 ||
      span.parts.size() != 1 || !part.section.slope.isZero(0) || part.section.stretch > 0) {
    return false;
  }
  const TipShooter shooter(span, 0, Deadline());
  return shooter.load() <= (shooter.parallel() ? 4e5 : 60);
}

SpanSearchResult scan_tip(const RodSpan& span, double tolerance, const Deadline& deadline) {
  TipShooter shooter(span, tolerance, deadline);
  const RodMesh mesh =
      make_mesh(span, resolving_interval(span, total_load(span) / least_bending_stiffness(span)));
  const bool from_begin = span.clamps.front().at == 0;
  SpanSearchResult result;
  for (const ScanPoint& root : TipScan(shooter).run()) {
    SpanEquilibrium found;
    found.nodes = shooter.states(mesh, root.start);
    found.converged = !found.nodes.empty();
    found.message = to_string(SolveStatus::converged);
    found.s = mesh.s;
    found.frames = released_frames(span);
    if (found.converged) complete(span, tolerance, found);
    if (!found.converged) {
      ++shooter.failures;
      continue;
    }
    const RodState& clamped_end = from_begin ? found.nodes.front() : found.nodes.back();
    found.residual = (clamped_end.t() - span.clamps.front().direction).norm();
    result.found.push_back(std::move(found));
  }
  result.complete = !shooter.out_of_time;
  if (shooter.failures > 0 || shooter.integrations > most_integrations) {
    result.not_searched = "some shots from the tip failed or were omitted";
  }
  if (result.found.empty()) {
    result.found.emplace_back();
    result.found.front().message = "no shot from the tip met the clamp's direction";
  }
  // Mirror images have equal energies up to rounding; the one that bends towards the plane's y
  // comes first.
  const auto height_of_tip = [&](const SpanEquilibrium& shape) {
    if (shape.nodes.empty()) return 0.0;
    return span.plane->y.dot((from_begin ? shape.nodes.back() : shape.nodes.front()).r);
  };
  std::ranges::stable_sort(result.found, std::ranges::greater{}, height_of_tip);
  sort_by_stability(result.found);
  for (SpanEquilibrium& found : result.found) found.integrations = shooter.integrations;
  return result;
}

}  // namespace dlo::energy_model
