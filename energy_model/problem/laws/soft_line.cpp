#include "dlo/energy_model/soft_line.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <iomanip>
#include <numbers>
#include <span>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "base/gsl.hpp"
#include "base/sized_samples.hpp"
#include "dlo/energy_model/balance.hpp"
#include "dlo/energy_model/taut_line.hpp"
#include "laws/catenary.hpp"
#include "problem/rod_law.hpp"

namespace dlo::energy_model {
namespace {

using Vector = Eigen::Vector3d;

/// Largest angle by which a clamp may bend the rod [rad]. The side to which a rod folds at 180 deg
/// is undetermined.
constexpr double largest_clamp_angle = 170 * std::numbers::pi / 180;
/// Distance in layer lengths after which a layer has decayed: exp(-40) = 4e-18.
constexpr double layer_decay_lengths = 40;
/// Largest Equilibrium::error_estimate [-] with which a soft line is returned. The models' own
/// estimates are lower where they succeed.
constexpr double largest_accepted_error = 1e-7;

/// Bending layer of the rod at a grip at one of its ends.
struct Layer {
  std::size_t grip = 0;  // index in Problem::grips
  bool at_end = false;
  bool clamped = false;
  double length = 0;               // decay length lambda [m]
  double turn = 0;                 // angle phi_0 at the grip [rad]; 0 at a pin
  Vector along = Vector::Zero();   // tangent of the catenary, into the rod
  Vector across = Vector::Zero();  // unit vector to the side to which the clamp rotates the rod

  [[nodiscard]] double angle(double sigma) const {
    return 4 * std::atan(std::tan(turn / 4) * std::exp(-sigma / length));
  }
  /// Returns the vector from the asymptote to the rod [m] where the angle is `angle`.
  [[nodiscard]] Vector displacement(double angle) const {
    return 2 * length * ((1 - std::cos(angle / 2)) * along - std::sin(angle / 2) * across);
  }
  [[nodiscard]] Vector axis() const { return along.cross(across); }
};

/// The catenary and the bending layers at its ends.
struct Composite {
  Catenary line;
  std::vector<Layer> layers;
  double length = 0;
  double free_boundary_layer = 0;  // CatenaryLimit::free_boundary_layer()

  struct Place {
    Vector point, tangent, curvature;
  };

  [[nodiscard]] Place at(double s) const {
    Place place{line.point(s), line.tangent(s), line.curvature(s)};
    if (line.lying_length > 0) smooth_free_boundary(s, place.curvature);
    for (const Layer& layer : layers) {
      const double sigma = layer.at_end ? length - s : s;
      if (sigma > layer_decay_lengths * layer.length) continue;
      if (!layer.clamped) {
        place.curvature *= -std::expm1(-sigma / layer.length);
        continue;
      }
      const double angle = layer.angle(sigma);
      const double rate = (layer.at_end ? 2 : -2) * std::sin(angle / 2) / layer.length;
      const Eigen::AngleAxisd turn(angle, layer.axis());
      place.point += layer.displacement(angle);
      place.tangent = turn * place.tangent;
      place.curvature = turn * place.curvature + rate * layer.axis().cross(place.tangent);
    }
    return place;
  }

  /// Makes the curvature grow from zero where the rod lifts off, instead of the jump of the
  /// catenary.
  void smooth_free_boundary(double s, Vector& curvature) const {
    for (const double sign : {-1.0, 1.0}) {
      const double layer_begin = sign < 0 ? line.low + free_boundary_layer
                                          : line.low + line.lying_length - free_boundary_layer;
      const double beyond = sign * (s - layer_begin);
      if (!(beyond > 0) || beyond > layer_decay_lengths * free_boundary_layer) continue;
      const Vector full = line.is_lying(s) ? Vector(line.up / line.a) : curvature;
      curvature = -std::expm1(-beyond / free_boundary_layer) * full;
    }
  }

  /// Returns the gap between the integral of the unit tangents over the rod and its other end [m].
  [[nodiscard]] double gap() const {
    const auto tangent = [](double s, const double*, double* rate, void* shape) {
      const auto& own = *static_cast<const Composite*>(shape);
      Eigen::Map<Vector>{rate} = own.at(own.length * s).tangent;
      return 0;
    };
    constexpr double tolerance = 1e-14;
    Composite shape = *this;
    std::vector<double> displacement(3, 0.0);
    if (!integrate(tangent, &shape, 1, tolerance, displacement)) return INFINITY;
    return (at(0).point + length * Eigen::Map<const Vector>(displacement.data()) - at(length).point)
        .norm();
  }
};

class CatenaryLimit {
 public:
  explicit CatenaryLimit(const Problem& problem) : problem_(problem) {}

  std::optional<Equilibrium> solve() {
    if (!is_applicable()) return std::nullopt;
    weight_ = problem_.weight_per_length.norm();
    up_ = -problem_.weight_per_length / weight_;
    for (std::size_t i = 0; i < problem_.grips.size(); ++i) {
      const Grip& grip = problem_.grips[i];
      layers_.push_back({.grip = i,
                         .at_end = grip.at > problem_.length / 2,
                         .clamped = grip.direction.has_value()});
    }
    constexpr int most_rounds = 12;  // each reduces the gap by about layer length / rod length
    for (int i = 0; i < most_rounds; ++i) {
      if (!find_catenary()) return std::nullopt;
      for (Layer& layer : layers_) set_layer(layer);
    }
    if (!find_catenary() || !are_layers_separate()) return std::nullopt;
    return result();
  }

 private:
  [[nodiscard]] bool is_applicable() const {
    const double l = problem_.length;
    const auto at_end = [&](const Grip& grip) {
      return grip.at < negligible_length * l || grip.at > l * (1 - negligible_length);
    };
    const std::vector<Grip>& grips = problem_.grips;
    if (problem_.axial_stiffness || problem_.confined_to_plane || !has_dead_loads(problem_) ||
        has_material_directors(problem_) || !problem_.sections.empty() || !problem_.loads.empty() ||
        !problem_.line_loads.empty() || !(problem_.weight_per_length.norm() > 0) ||
        problem_.obstacles.size() > 1 || grips.empty() || grips.size() > 2 ||
        !std::ranges::all_of(grips, at_end) || clamps_with_frames(problem_) > 1) {
      return false;
    }
    if (grips.size() == 1) return grips.front().direction.has_value();
    return std::abs(grips[0].at - grips[1].at) > l / 2;
  }

  /// Returns the height of the floor if the obstacle is a horizontal rigid half-space; std::nullopt
  /// for another obstacle or none.
  [[nodiscard]] std::optional<double> floor() const {
    if (problem_.obstacles.empty()) return std::nullopt;
    const Obstacle& obstacle = problem_.obstacles.front();
    if (!std::isinf(obstacle.stiffness) || !obstacle.body.is_half_space()) return std::nullopt;
    const obstacle::Body& body = obstacle.body;
    if ((body.normal() - up_).norm() > negligible_length) return std::nullopt;
    return (body.centre() + body.radius() * body.normal()).dot(up_);
  }

  [[nodiscard]] const Grip& grip_of(const Layer& layer) const { return problem_.grips[layer.grip]; }

  /// Returns the point at which the catenary begins, where the asymptote of a layer ends [m].
  [[nodiscard]] Vector begin_of(const Layer& layer) const {
    return grip_of(layer).position -
           (layer.length > 0 ? layer.displacement(layer.turn) : Vector::Zero());
  }

  bool find_catenary() {
    const double l = problem_.length;
    if (layers_.size() == 1) {
      if (!problem_.obstacles.empty()) return false;
      const Layer& layer = layers_.front();
      line_ = {.a = 0,
               .low = layer.at_end ? 0.0 : l,
               .lying_length = 0,
               .origin = begin_of(layer) - l * up_,
               .horizontal = up_.unitOrthogonal(),
               .up = up_};
      return true;
    }
    const Vector begin = begin_of(layers_[layers_[0].at_end ? 1 : 0]);
    const Vector end = begin_of(layers_[layers_[0].at_end ? 0 : 1]);
    const std::optional<Catenary> free = hanging_catenary(begin, end, l, up_);
    if (!free) return false;
    line_ = *free;
    if (problem_.obstacles.empty()) return true;
    const std::optional<double> ground = floor();
    if (!ground) return false;
    const double lowest = line_.point(std::clamp(line_.low, 0.0, l)).dot(up_);
    if (lowest > *ground + negligible_length * l) return true;
    const std::optional<Catenary> lying = catenary_on_floor(begin, end, l, up_, *ground);
    if (!lying) return false;
    line_ = *lying;
    return true;
  }

  [[nodiscard]] double at(const Layer& layer) const { return layer.at_end ? problem_.length : 0; }

  void set_layer(Layer& layer) const {
    const double sign = layer.at_end ? -1 : 1;
    layer.along = sign * line_.tangent(at(layer));
    layer.length = std::sqrt(problem_.bending_stiffness / (weight_ * line_.height(at(layer))));
    layer.turn = 0;
    layer.across = layer.along.unitOrthogonal();
    if (!layer.clamped) return;
    const Vector direction = sign * grip_of(layer).direction->normalized();
    const Vector across = direction - direction.dot(layer.along) * layer.along;
    layer.turn = std::atan2(across.norm(), direction.dot(layer.along));
    if (across.norm() > 0) layer.across = across.normalized();
  }

  /// Returns the length of the layer in which the rod bends where it lifts off [m].
  [[nodiscard]] double free_boundary_layer() const {
    return line_.a > 0 ? std::sqrt(problem_.bending_stiffness / (weight_ * line_.a)) : 0.0;
  }

  /// Whether layers decay before others begin and above the floor, and each bends to a definite
  /// side.
  [[nodiscard]] bool are_layers_separate() const {
    const std::optional<double> ground = floor();
    for (const Layer& layer : layers_) {
      if (!(layer.turn < largest_clamp_angle)) return false;
      if (!(2 * layer_decay_lengths * layer.length < problem_.length)) return false;
      const double above = ground ? grip_of(layer).position.dot(up_) - *ground : 1.0;
      if (!ground) continue;
      const bool is_lying = line_.is_lying(layer.at_end ? problem_.length * (1 - 1e-15) : 1e-300) ||
                            line_.hanging_arc_length(at(layer)) == 0;
      if (is_lying) {
        // The end has to be on the floor and along it.
        if (std::abs(above) > negligible_length * problem_.length || layer.turn > negligible_length)
          return false;
      } else if (!(above > layer_decay_lengths * layer.length)) {
        return false;
      }
    }
    const bool lies = line_.lying_length > 0;
    if (lies) return line_.lying_length > 2 * layer_decay_lengths * free_boundary_layer();
    if (!ground) return true;
    const double l = problem_.length;
    return line_.point(std::clamp(line_.low, 0.0, l)).dot(up_) >
           *ground + 10 * free_boundary_layer();
  }

  [[nodiscard]] double error() const {
    const double l = problem_.length;
    double sum = line_.a > 0 ? 2 * free_boundary_layer() * free_boundary_layer() / line_.a : 0.0;
    for (const Layer& layer : layers_) {
      sum += 2 * layer.length * layer.length * (1 + layer.turn) / line_.height(at(layer));
    }
    if (layers_.size() == 1) return sum / l;
    const double slack = 1 - (problem_.grips[0].position - problem_.grips[1].position).norm() / l;
    return (1 + 1 / std::sqrt(slack)) * sum / l;
  }

  [[nodiscard]] std::optional<Equilibrium> result() const {
    const double l = problem_.length;
    const double EI = problem_.bending_stiffness;
    const Composite shape{line_, layers_, l, free_boundary_layer()};
    Equilibrium result;
    result.error_estimate = error();
    result.residual = shape.gap() / l;
    constexpr double rounding = 1e-12;
    if (!(result.residual <= result.error_estimate + rounding)) return std::nullopt;
    result.status = SolveStatus::converged;
    std::ostringstream message;
    message << std::setprecision(1) << std::scientific
            << "converged: a catenary with bending layers at its ends, the limit of small EI / (w "
               "l^3); neglected terms move points by about "
            << result.error_estimate << " of l";
    result.message = message.str();
    const double first = line_.hanging_arc_length(0);
    const double last = line_.hanging_arc_length(l);
    const double offset = (line_.origin - problem_.grips.front().position).dot(up_);
    result.energy.bending =
        EI / 2 * (line_.squared_curvature_integral(last) - line_.squared_curvature_integral(first));
    result.energy.gravity =
        weight_ * (offset * l + line_.height_integral(last) - line_.height_integral(first));
    result.grips.resize(problem_.grips.size());
    for (const Layer& layer : layers_) {
      const double half = layer.turn / 2;
      result.energy.bending += 2 * EI / layer.length * (1 - std::cos(half));
      const double area = layer.length * layer.length;
      result.energy.gravity +=
          weight_ * area *
          (-4 * std::log(std::cos(half / 2)) * layer.along - 2 * half * layer.across).dot(up_);
      Reaction& reaction = result.grips[layer.grip];
      reaction.force = -weight_ * line_.height(at(layer)) * layer.along;
      if (!layer.clamped) continue;
      const Composite::Place place = shape.at(at(layer));
      reaction.torque = (layer.at_end ? EI : -EI) * place.tangent.cross(place.curvature);
    }
    result.obstacles.assign(problem_.obstacles.size(), Vector::Zero());
    if (line_.lying_length > 0) add_contact(result);
    result.sample = [shape](std::span<const double> arc_lengths) {
      Samples samples = sized_samples(arc_lengths, shape.length);
      for (Eigen::Index i = 0; i < samples.points.cols(); ++i) {
        const Composite::Place place = shape.at(arc_lengths[static_cast<std::size_t>(i)]);
        samples.points.col(i) = place.point;
        samples.tangents.col(i) = place.tangent;
        samples.curvature.col(i) = place.curvature;
      }
      return samples;
    };
    return result;
  }

  /// Adds the contact with the floor. The rod lifts off one layer length before the line does.
  void add_contact(Equilibrium& result) const {
    const double pressed = weight_ * free_boundary_layer();
    const double end = line_.low + line_.lying_length;
    const bool rises_at_begin = line_.low > 0;
    const bool rises_at_end = end < problem_.length * (1 - negligible_length);
    result.obstacles.front() = weight_ * line_.lying_length * up_;
    ContactPart part;
    part.kind = ContactKind::lying;
    part.begin = rises_at_begin ? line_.low + free_boundary_layer() : 0.0;
    part.end = rises_at_end ? end - free_boundary_layer() : problem_.length;
    part.force = result.obstacles.front();
    part.moment = (line_.point(line_.low + line_.lying_length / 2) - line_.point(part.begin))
                      // The force acts in the middle of the line's part that lies.
                      .cross(part.force);
    part.begin_force = rises_at_begin ? pressed : 0.0;
    part.end_force = rises_at_end ? pressed : 0.0;
    part.largest_pressure = weight_;
    result.contacts = {part};
  }

  const Problem& problem_;
  double weight_ = 0;
  Vector up_;
  std::vector<Layer> layers_;
  Catenary line_;
};

}  // namespace

bool is_catenary_limit(const Problem& problem) {
  const double l = problem.length;
  return l > 0 && problem.bending_stiffness <
                      catenary_limit_stiffness * problem.weight_per_length.norm() * l * l * l;
}

std::optional<Equilibrium> catenary_limit(const Problem& problem) {
  check(problem);
  return CatenaryLimit(problem).solve();
}

std::optional<Equilibrium> shape_without_search(const Problem& problem) {
  std::optional<Equilibrium> line = taut_line(problem);
  if (!line && is_catenary_limit(problem)) {
    line = catenary_limit(problem);
    if (line && !(line->error_estimate <= largest_accepted_error)) line.reset();
  }
  if (line) judge_balance(problem, *line, std::max(allowed_imbalance, line->error_estimate));
  return line;
}

}  // namespace dlo::energy_model
