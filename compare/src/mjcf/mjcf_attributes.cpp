#include "mjcf/mjcf_attributes.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>
#include <sstream>
#include <utility>

#include "base/number.hpp"
#include "base/quote.hpp"
#include "base/text.hpp"

namespace dlo::compare {
namespace {

constexpr double one_degree = std::numbers::pi / 180;
/// Largest number that is accepted. Models have smaller ones, and products of two do not overflow.
constexpr double largest_number = 1e12;

std::vector<std::string> split_words(std::string_view text) {
  std::istringstream words{std::string(text)};
  return {std::istream_iterator<std::string>(words), {}};
}

}  // namespace

std::string toml_vector(const Eigen::Vector3d& v) {
  return fmt::format("[{:.17g}, {:.17g}, {:.17g}]", v.x(), v.y(), v.z());
}

MjcfAttributes::MjcfAttributes(const XmlFile& xml, XmlRefusals& refusals)
    : xml_(xml), refusals_(refusals), angle_(one_degree) {
  const pugi::xml_node root = xml.root();
  if (std::string_view(root.name()) != "mujoco") {
    xml_.fail(root, "is no scene (allowed: a scene as TOML, or MJCF, whose element is <mujoco>)");
  }
  refusals_.attempt([&] { MjcfNode{*this, root}.require_known(); });
  for (const pugi::xml_node& part : root.children()) {
    const std::string_view name = part.name();
    if (part.type() != pugi::node_element || mjcf_without_effect(name)) continue;
    if (name == "contact") continue;  // read together with the obstacles
    refusals_.attempt([&] {
      if (name == "include") {
        xml_.fail(part, "is not followed (allowed: one file, as mj_saveLastXML writes it)");
      }
      const MjcfNode node{*this, part};
      node.require_known();
      if (name == "compiler") read_compiler(node);
      if (name == "default") add_defaults(part, "");
    });
  }
}

void MjcfAttributes::read_compiler(const MjcfNode& compiler) {
  if (compiler.element.attribute("angle")) {
    angle_ = compiler.choice("angle", {"degree", "radian"}) == 1 ? 1 : one_degree;
  }
  (void)compiler.choice("coordinate", {"local"});
  if (const auto order = compiler.text("eulerseq")) {
    const bool known =
        order->size() == 3 && order->find_first_not_of("xyzXYZ") == std::string::npos;
    if (!known) compiler.fail("eulerseq", "(allowed: three of x, y, z, X, Y, Z)");
    euler_order_ = *order;
  }
}

void MjcfAttributes::add_defaults(const pugi::xml_node& node, const std::string& parent) {
  MjcfNode{*this, node}.require_known();
  const std::string name = node.attribute("class").as_string(parent.empty() ? "main" : "");
  if (name.empty()) xml_.fail(node, "class", "missing (allowed: a name)");
  if (parent.empty()) main_ = name;
  if (!classes_.emplace(name, Class{node, parent}).second) {
    xml_.fail(node, "class", "given twice (allowed: once)");
  }
  for (const pugi::xml_node& child : node.children()) {
    const std::string_view tag = child.name();
    if (tag == "default") {
      add_defaults(child, name);
    } else if (tag == "joint" || tag == "geom" || tag == "site") {
      MjcfNode{*this, child}.require_known();
    } else if (tag == "equality" && child.attribute("active")) {
      xml_.fail(child, "active", "is not read in a default");
    }
  }
}

const std::string& MjcfAttributes::known_class(const pugi::xml_node& node, const char* attribute,
                                               const std::string& outside) const {
  const pugi::xml_attribute given = node.attribute(attribute);
  if (!given) return outside;
  const auto found = classes_.find(std::string_view(given.value()));
  if (found == classes_.end()) xml_.fail(node, attribute, "no such default class");
  return found->first;
}

std::optional<std::string> MjcfNode::text(const char* attribute) const {
  if (const pugi::xml_attribute own = element.attribute(attribute)) return own.value();
  const auto& classes = file.classes_;
  std::string name =
      file.known_class(element, "class", childclass.empty() ? file.main_ : childclass);
  for (auto found = classes.find(name); found != classes.end(); found = classes.find(name)) {
    for (const pugi::xml_node& other : found->second.node.children(element.name())) {
      if (const pugi::xml_attribute given = other.attribute(attribute)) return given.value();
    }
    name = found->second.parent;
  }
  return std::nullopt;
}

std::optional<std::vector<double>> MjcfNode::numbers(const char* attribute, std::size_t least,
                                                     std::size_t most) const {
  const std::optional<std::string> given = text(attribute);
  if (!given) return std::nullopt;
  const auto refuse = [&](const std::string& problem) {
    const std::string count =
        least == most ? fmt::format("{}", least) : fmt::format("{} to {}", least, most);
    fail(attribute, fmt::format("{} (allowed: {} number{} within {:g})", problem, count,
                                most == 1 ? "" : "s", largest_number));
  };
  std::vector<double> values;
  for (const std::string& word : split_words(*given)) {
    const std::optional<double> value = shape_number(word);
    // The negated condition also rejects NaN.
    if (!value || !(std::abs(*value) <= largest_number)) {
      refuse(fmt::format("{} is not a number, or out of range", quoted_piece(word)));
    }
    values.push_back(*value);
    if (values.size() > most) refuse("too many numbers");
  }
  if (values.size() < least) refuse("too few numbers");
  return values;
}

std::optional<double> MjcfNode::number(const char* attribute) const {
  const auto values = numbers(attribute, 1, 1);
  return values ? std::optional(values->front()) : std::nullopt;
}

std::optional<Eigen::Vector3d> MjcfNode::vector(const char* attribute) const {
  const auto values = numbers(attribute, 3, 3);
  if (!values) return std::nullopt;
  return Eigen::Vector3d((*values)[0], (*values)[1], (*values)[2]);
}

std::size_t MjcfNode::choice(const char* attribute,
                             const std::vector<std::string_view>& allowed) const {
  const std::optional<std::string> given = text(attribute);
  if (!given) return 0;
  const auto found = std::ranges::find(allowed, std::string_view(*given));
  if (found == allowed.end()) {
    fail(attribute, fmt::format("{}(allowed: {})",
                                element.attribute(attribute)
                                    ? ""
                                    : fmt::format("{} by its default class ", quoted_piece(*given)),
                                fmt::join(allowed, ", ")));
  }
  return static_cast<std::size_t>(found - allowed.begin());
}

Eigen::Quaterniond MjcfAttributes::euler(const std::vector<double>& angles) const {
  Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();
  for (std::size_t i = 0; i < 3; ++i) {
    const char axis = euler_order_[i];
    const bool moving = axis >= 'x';
    const Eigen::Index k = moving ? axis - 'x' : axis - 'X';
    const Eigen::Quaterniond one(Eigen::AngleAxisd(angles[i] * angle_, Eigen::Vector3d::Unit(k)));
    rotation = moving ? rotation * one : one * rotation;
  }
  return rotation;
}

Eigen::Quaterniond MjcfNode::rotation() const {
  const char* given = nullptr;
  for (const char* name : {"quat", "axisangle", "euler", "xyaxes", "zaxis"}) {
    if (!element.attribute(name)) continue;
    if (given != nullptr) fail(name, fmt::format("given besides {}", given));
    given = name;
  }
  if (given == nullptr) {
    for (const char* name : {"quat", "axisangle", "euler", "xyaxes", "zaxis"}) {
      if (given == nullptr && text(name)) given = name;
    }
  }
  if (given == nullptr) return Eigen::Quaterniond::Identity();
  const std::string_view form = given;
  const std::size_t count = form == "quat" || form == "axisangle" ? 4 : form == "xyaxes" ? 6 : 3;
  const std::vector<double> v = *numbers(given, count, count);
  constexpr double least = 1e-10;
  const auto require_direction = [&](double size) {
    if (!(size > least)) fail(given, "has no direction (allowed: vectors that are not 0)");
  };
  if (form == "euler") return file.euler(v);
  const Eigen::Vector3d first(v[0], v[1], v[2]);
  if (form == "quat") {
    const Eigen::Quaterniond q(v[0], v[1], v[2], v[3]);
    require_direction(q.norm());
    return q.normalized();
  }
  require_direction(first.norm());
  if (form == "axisangle") {
    return Eigen::Quaterniond(Eigen::AngleAxisd(v[3] * file.angle_, first.normalized()));
  }
  if (form == "zaxis") {
    return Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitZ(), first);
  }
  const Eigen::Vector3d x = first.normalized();
  const Eigen::Vector3d second(v[3], v[4], v[5]);
  const Eigen::Vector3d y = second - second.dot(x) * x;
  require_direction(y.norm());
  Eigen::Matrix3d axes;
  axes << x, y.normalized(), x.cross(y.normalized());
  return Eigen::Quaterniond(axes);
}

MjcfPose MjcfNode::pose() const {
  MjcfPose result = MjcfPose::Identity();
  result.linear() = rotation().toRotationMatrix();
  result.translation() = vector("pos").value_or(Eigen::Vector3d::Zero());
  return result;
}

void MjcfNode::require_known() const {
  const MjcfElement* known = mjcf_element(element.name());
  if (known == nullptr) {
    fail("has no counterpart in a rod's scene, or is unknown (allowed: a model without it)");
  }
  const std::vector<std::string> read = split_words(known->read);
  const std::vector<std::string> without_effect = split_words(known->without_effect);
  for (const pugi::xml_attribute& attribute : element.attributes()) {
    const std::string_view name = attribute.name();
    if (std::ranges::count(read, name) + std::ranges::count(without_effect, name) > 0) continue;
    fail(
        fmt::format("{} = {}: has no counterpart in a rod's scene, or is unknown{} "
                    "(allowed: {}, and attributes without effect at rest)",
                    printable_piece(name), quoted_piece(attribute.value()),
                    did_you_mean(name, read), fmt::join(read, ", ")));
  }
}

void MjcfNode::require_zero(const char* attribute, const std::string& why) const {
  constexpr std::size_t most = 100;
  const auto values = numbers(attribute, 1, most);
  if (!values) return;
  if (std::ranges::any_of(*values, [](double value) { return value != 0; })) {
    fail(attribute, why + " (allowed: 0)");
  }
}

}  // namespace dlo::compare
