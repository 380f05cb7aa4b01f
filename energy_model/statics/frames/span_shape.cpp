#include "frames/span_shape.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "base/legendre.hpp"
#include "frames/rod_frames.hpp"
#include "problem/segments.hpp"

namespace dlo::energy_model {
namespace {

/// An element with the Legendre series that give any point of it.
struct PlacedElement {
  Element element;
  Eigen::Vector3d point = Eigen::Vector3d::Zero();  // position of its begin
  Eigen::Matrix3Xd tangent;                         // 3 x Q
  double theta = 0;        // in the plane: angle at its begin, without natural curvature
  Eigen::Matrix4Xd frame;  // in space: quaternions w, x, y, z, 4 x Q
};

class Sampler {
 public:
  explicit Sampler(const SpanShape& shape)
      : shape_(shape),
        table_(shape.planar ? legendre_table(shape.terms) : director_table(shape.terms)),
        values_(table_.nodes.size()),
        integrals_(table_.nodes.size()) {
    if (shape.planar) {
      place_planar();
    } else {
      place_spatial();
    }
    Eigen::Vector3d point = Eigen::Vector3d::Zero();
    for (PlacedElement& placed : elements_) {
      placed.point = point;
      // Only p_0 contributes to the integral over a whole element.
      point += placed.element.length * placed.tangent.col(0);
      if (std::abs(placed.element.end() - shape.anchor) < closest_cuts) anchor_ = point;
    }
  }

  void evaluate_at(double at, Eigen::Index i, Samples& samples) {
    std::size_t e = 0;
    while (e + 1 < elements_.size() && at > elements_[e].element.end()) ++e;
    const PlacedElement& placed = elements_[e];
    const double length = placed.element.length;
    legendre(std::clamp((at - placed.element.begin) / length, 0.0, 1.0), values_, integrals_);
    samples.points.col(i) = placed.point + length * (placed.tangent * integrals_) - anchor_;
    const auto values = values_.head(shape_.terms);
    if (shape_.planar) {
      const auto theta = coefficients(0, e);
      double angle =
          placed.theta + placed.element.angle(0) * integrals_.head(shape_.terms).dot(theta);
      double rate = placed.element.strain(0) * values.dot(theta);
      if (!shape_.natural.empty()) {
        angle += shape_.natural.integral(at).x();
        rate += shape_.natural.at(at).x();
      }
      samples.tangents.col(i) << std::cos(angle), std::sin(angle), 0;
      samples.curvature.col(i) << -rate * std::sin(angle), rate * std::cos(angle), 0;
      samples.d1.col(i) = Eigen::Vector3d::UnitZ();  // Span::d1()
      return;
    }
    const Eigen::Vector4d q = placed.frame * values_;
    const Eigen::Matrix3d frame =
        Eigen::Quaterniond(q[0], q[1], q[2], q[3]).normalized().toRotationMatrix();
    samples.d1.col(i) = frame.col(0);
    samples.tangents.col(i) = frame.col(2);
    double u1 = placed.element.strain(0) * values.dot(coefficients(0, e));
    double u2 = placed.element.strain(1) * values.dot(coefficients(1, e));
    if (!shape_.natural.empty()) {
      const Eigen::Vector3d natural = shape_.natural.at(at);
      u1 += natural.x();
      u2 += natural.y();
    }
    samples.curvature.col(i) = u2 * frame.col(0) - u1 * frame.col(1);
  }

 private:
  /// Returns the coefficients of a strain on an element.
  [[nodiscard]] Eigen::VectorXd::ConstSegmentReturnType coefficients(Eigen::Index field,
                                                                     std::size_t e) const {
    const Eigen::Index columns = shape_.strains.size() / (shape_.natural.empty() ? 2 : 3);
    const Eigen::Index first = field * columns + (shape_.free_start ? 1 : 0);
    return shape_.strains.segment(first + static_cast<Eigen::Index>(e) * shape_.terms,
                                  shape_.terms);
  }

  void place_planar() {
    PlacedElement placed;
    placed.theta = shape_.start_theta;
    for (std::size_t e = 0; e < shape_.elements.size(); ++e) {
      placed.element = shape_.elements[e];
      const double turn = placed.element.angle(0);
      const Eigen::VectorXd theta = coefficients(0, e);
      Eigen::ArrayXd angle =
          placed.theta + turn * (table_.integrals.leftCols(shape_.terms) * theta).array();
      for (Eigen::Index q = 0; q < angle.size() && !shape_.natural.empty(); ++q) {
        const double s = placed.element.begin + placed.element.length * table_.nodes[q];
        angle[q] += shape_.natural.integral(s).x();
      }
      Eigen::Matrix3Xd weighted = Eigen::Matrix3Xd::Zero(3, table_.nodes.size());
      weighted.row(0) = (table_.weights.array() * angle.cos()).matrix().transpose();
      weighted.row(1) = (table_.weights.array() * angle.sin()).matrix().transpose();
      placed.tangent = weighted * table_.values;
      elements_.push_back(placed);
      placed.theta += turn * theta[0];
    }
  }

  void place_spatial() {
    const RodFrames frames(shape_.elements, shape_.terms, shape_.start_frame, shape_.free_start,
                           shape_.natural);
    RodFrames::State state;
    frames.resize(state);
    frames.evaluate(shape_.strains, state);
    const Eigen::Index Q = table_.nodes.size();
    const Eigen::MatrixXd weighted = table_.weights.asDiagonal() * table_.values;
    for (std::size_t e = 0; e < shape_.elements.size(); ++e) {
      const Eigen::Index node = frames.turn_nodes() + static_cast<Eigen::Index>(e) * Q;
      PlacedElement placed;
      placed.element = shape_.elements[e];
      placed.tangent = state.t.middleRows(node, Q).transpose() * weighted;
      placed.frame = state.q.middleRows(node, Q).transpose() * weighted;
      elements_.push_back(std::move(placed));
    }
  }

  const SpanShape& shape_;
  const LegendreTable& table_;
  Eigen::VectorXd values_, integrals_;
  std::vector<PlacedElement> elements_;
  Eigen::Vector3d anchor_ = Eigen::Vector3d::Zero();
};

/// Distances from a layer's origin at which elements end, divided by the layer's length (EI /
/// force)^(1/2): the layer has decayed by exp(-6) and exp(-24) there.
constexpr std::array<double, 2> layer_end_distances = {6, 24};

/// Adds cuts where the layers at the grips and loads of a taut segment have decayed.
void cut_taut(const Segment& segment, const Span& span, std::vector<double>& cuts) {
  const double layer = 1 / std::sqrt(segment.tension);
  std::vector<double> kinks = {segment.begin};
  for (const Span::Load& load : span.loads) {
    if (load.at > segment.begin && load.at < segment.end) kinks.push_back(load.at);
  }
  kinks.push_back(segment.end);
  for (std::size_t i = 0; i + 1 < kinks.size(); ++i) {
    add_cut_beside(kinks[i], 1, layer, kinks[i + 1] - kinks[i], cuts);
    add_cut_beside(kinks[i + 1], -1, layer, kinks[i + 1] - kinks[i], cuts);
  }
}

/// Adds cuts where the layers next to contacts have decayed.
void cut_free_boundaries(const Span& span, double layer, std::vector<double>& cuts) {
  if (span.contacts.empty()) return;
  const std::vector<double> others = cuts;
  const auto cut = [&](double from, double sense) {
    double room = std::numeric_limits<double>::infinity();
    for (const double other : others) {
      const double distance = sense * (other - from);
      if (distance > closest_cuts) room = std::min(room, distance);
    }
    if (std::isfinite(room)) add_cut_beside(from, sense, layer, room, cuts);
  };
  for (const Span::Contact& contact : span.contacts) {
    cut(contact.begin, -1);
    cut(contact.end, 1);
  }
}

/// Adds cuts where boundary layers are expected.
void cut_layers(const Span& span, std::vector<double>& cuts) {
  const double layer = 1 / std::sqrt(std::max(1.0, span.total_load()));
  const double room = span.end_direction ? 0.4 : 0.7;
  if (layer_end_distances[1] * layer < room * span.length) {
    for (const double depth : layer_end_distances) {
      cuts.push_back(depth * layer);
      if (span.end_direction) cuts.push_back(span.length - depth * layer);
    }
  }
  for (const Segment& segment : segments_of(span)) {
    if (segment.taut()) cut_taut(segment, span, cuts);
  }
  cut_free_boundaries(span, layer, cuts);
}

}  // namespace

void add_cut_beside(double origin, double sense, double layer, double room,
                    std::vector<double>& cuts) {
  for (const double depth : layer_end_distances) {
    const double away = depth * layer;
    if (away > 0 && 2.5 * away < room) cuts.push_back(origin + sense * away);
  }
}

std::vector<double> kink_positions(const Span& span) {
  std::vector<double> kinks = {0, span.length, span.anchor};
  for (const Span::Hold& hold : span.holds) kinks.push_back(hold.at);
  for (const Span::Load& load : span.loads) kinks.push_back(load.at);
  for (const Span::Part& part : span.parts) kinks.insert(kinks.end(), {part.begin, part.end});
  for (const LineLoad& on : span.line_loads) kinks.insert(kinks.end(), {on.begin, on.end});
  std::sort(kinks.begin(), kinks.end());
  const auto close = [](double a, double b) { return b - a < closest_cuts; };
  kinks.erase(std::unique(kinks.begin(), kinks.end(), close), kinks.end());
  return kinks;
}

std::vector<Element> elements_of(const Span& span) {
  std::vector<double> cuts = kink_positions(span);
  for (const Span::Contact& contact : span.contacts) {
    cuts.insert(cuts.end(), {contact.begin, contact.end});
  }
  cuts.insert(cuts.end(), span.contact_ends.begin(), span.contact_ends.end());
  if (span.cuts.empty()) {
    cut_layers(span, cuts);
  } else {
    cuts.insert(cuts.end(), span.cuts.begin(), span.cuts.end());
  }
  std::sort(cuts.begin(), cuts.end());
  std::vector<Element> elements;
  double begin = 0;
  for (const double c : cuts) {
    if (c - begin < closest_cuts) continue;
    const double end = span.length - c < closest_cuts ? span.length : c;
    elements.push_back({begin, end - begin, span.stiffness});
    begin = end;
  }
  for (Element& element : elements) {
    const double middle = element.begin + element.length / 2;
    for (const Span::Part& part : span.parts) {
      if (middle < part.begin || middle > part.end) continue;
      element.stiffness = part.stiffness;
    }
  }
  return elements;
}

Eigen::VectorXd roll_of(const Eigen::Matrix3Xd& tangents, const Eigen::Matrix3Xd& d1) {
  Eigen::VectorXd roll = Eigen::VectorXd::Zero(tangents.cols());
  for (Eigen::Index q = 1; q < tangents.cols(); ++q) {
    const Eigen::Vector3d t = tangents.col(q);
    const Eigen::Vector3d carried =
        Eigen::Quaterniond::FromTwoVectors(tangents.col(q - 1), t) * d1.col(q - 1);
    const Eigen::Vector3d own = d1.col(q);
    roll[q] = roll[q - 1] + std::atan2(t.dot(carried.cross(own)), carried.dot(own));
  }
  return roll;
}

Samples SpanShape::sample(std::span<const double> s) const {
  const auto count = static_cast<Eigen::Index>(s.size());
  Samples samples;
  for (auto* m : {&samples.points, &samples.tangents, &samples.curvature, &samples.d1}) {
    m->resize(3, count);
  }
  Sampler sampler(*this);
  for (Eigen::Index i = 0; i < count; ++i) {
    sampler.evaluate_at(s[static_cast<std::size_t>(i)], i, samples);
  }
  return samples;
}

}  // namespace dlo::energy_model
