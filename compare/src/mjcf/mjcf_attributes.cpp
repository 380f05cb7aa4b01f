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

std::vector<std::string> words_of(std::string_view text) {
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
  refusals_.attempt([&] { require_known(root); });
  for (const pugi::xml_node& part : root.children()) {
    const std::string_view name = part.name();
    if (part.type() != pugi::node_element || mjcf_without_effect(name)) continue;
    if (name == "contact") continue;  // read together with the obstacles
    refusals_.attempt([&] {
      if (name == "include") {
        xml_.fail(part, "is not followed (allowed: one file, as mj_saveLastXML writes it)");
      }
      require_known(part);
      if (name == "compiler") read_compiler(part);
      if (name == "default") add_defaults(part, "");
    });
  }
}

void MjcfAttributes::read_compiler(const pugi::xml_node& compiler) {
  if (compiler.attribute("angle")) {
    angle_ = choice(compiler, "angle", {"degree", "radian"}, "") == 1 ? 1 : one_degree;
  }
  (void)choice(compiler, "coordinate", {"local"}, "");
  if (const auto order = text(compiler, "eulerseq", "")) {
    const bool known =
        order->size() == 3 && order->find_first_not_of("xyzXYZ") == std::string::npos;
    if (!known) xml_.fail(compiler, "eulerseq", "(allowed: three of x, y, z, X, Y, Z)");
    euler_order_ = *order;
  }
}

void MjcfAttributes::add_defaults(const pugi::xml_node& node, const std::string& parent) {
  require_known(node);
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
      require_known(child);
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

std::optional<std::string> MjcfAttributes::text(const pugi::xml_node& node, const char* attribute,
                                                const std::string& childclass) const {
  if (const pugi::xml_attribute own = node.attribute(attribute)) return own.value();
  std::string name = known_class(node, "class", childclass.empty() ? main_ : childclass);
  for (auto found = classes_.find(name); found != classes_.end(); found = classes_.find(name)) {
    for (const pugi::xml_node& element : found->second.node.children(node.name())) {
      if (const pugi::xml_attribute given = element.attribute(attribute)) return given.value();
    }
    name = found->second.parent;
  }
  return std::nullopt;
}

std::optional<std::vector<double>> MjcfAttributes::numbers(const pugi::xml_node& node,
                                                           const char* attribute, std::size_t least,
                                                           std::size_t most,
                                                           const std::string& childclass) const {
  const std::optional<std::string> given = text(node, attribute, childclass);
  if (!given) return std::nullopt;
  constexpr const char* blanks = " \t\r\n";
  std::vector<double> values;
  const auto fail = [&](const std::string& problem) {
    const std::string count =
        least == most ? fmt::format("{}", least) : fmt::format("{} to {}", least, most);
    xml_.fail(node, attribute,
              fmt::format("{} (allowed: {} number{} within {:g})", problem, count,
                          most == 1 ? "" : "s", largest_number));
  };
  std::string_view rest = *given;
  while (true) {
    rest.remove_prefix(std::min(rest.find_first_not_of(blanks), rest.size()));
    if (rest.empty()) break;
    const std::string_view word = rest.substr(0, rest.find_first_of(blanks));
    const std::optional<double> value = shape_number(word);
    // The negated condition also rejects NaN.
    if (!value || !(std::abs(*value) <= largest_number)) {
      fail(fmt::format("{} is not a number, or out of range", quoted_piece(word)));
    }
    values.push_back(*value);
    if (values.size() > most) fail("too many numbers");
    rest.remove_prefix(word.size());
  }
  if (values.size() < least) fail("too few numbers");
  return values;
}

std::optional<double> MjcfAttributes::number(const pugi::xml_node& node, const char* attribute,
                                             const std::string& childclass) const {
  const auto values = numbers(node, attribute, 1, 1, childclass);
  return values ? std::optional(values->front()) : std::nullopt;
}

std::optional<Eigen::Vector3d> MjcfAttributes::vector(const pugi::xml_node& node,
                                                      const char* attribute,
                                                      const std::string& childclass) const {
  const auto values = numbers(node, attribute, 3, 3, childclass);
  if (!values) return std::nullopt;
  return Eigen::Vector3d((*values)[0], (*values)[1], (*values)[2]);
}

std::size_t MjcfAttributes::choice(const pugi::xml_node& node, const char* attribute,
                                   const std::vector<std::string_view>& allowed,
                                   const std::string& childclass) const {
  const std::optional<std::string> given = text(node, attribute, childclass);
  if (!given) return 0;
  const auto found = std::ranges::find(allowed, std::string_view(*given));
  if (found == allowed.end()) {
    xml_.fail(node, attribute,
              fmt::format("{}(allowed: {})",
                          node.attribute(attribute)
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

Eigen::Quaterniond MjcfAttributes::rotation(const pugi::xml_node& node,
                                            const std::string& childclass) const {
  const char* given = nullptr;
  for (const char* name : {"quat", "axisangle", "euler", "xyaxes", "zaxis"}) {
    if (!node.attribute(name)) continue;
    if (given != nullptr) xml_.fail(node, name, fmt::format("given besides {}", given));
    given = name;
  }
  if (given == nullptr) {
    for (const char* name : {"quat", "axisangle", "euler", "xyaxes", "zaxis"}) {
      if (given == nullptr && text(node, name, childclass)) given = name;
    }
  }
  if (given == nullptr) return Eigen::Quaterniond::Identity();
  const std::string_view form = given;
  const std::size_t count = form == "quat" || form == "axisangle" ? 4 : form == "xyaxes" ? 6 : 3;
  const std::vector<double> v = *numbers(node, given, count, count, childclass);
  constexpr double least = 1e-10;
  const auto require_direction = [&](double size) {
    if (!(size > least))
      xml_.fail(node, given, "has no direction (allowed: vectors that are not 0)");
  };
  if (form == "euler") return euler(v);
  const Eigen::Vector3d first(v[0], v[1], v[2]);
  if (form == "quat") {
    const Eigen::Quaterniond q(v[0], v[1], v[2], v[3]);
    require_direction(q.norm());
    return q.normalized();
  }
  require_direction(first.norm());
  if (form == "axisangle") {
    return Eigen::Quaterniond(Eigen::AngleAxisd(v[3] * angle_, first.normalized()));
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

MjcfPose MjcfAttributes::pose(const pugi::xml_node& node, const std::string& childclass) const {
  MjcfPose result = MjcfPose::Identity();
  result.linear() = rotation(node, childclass).toRotationMatrix();
  result.translation() = vector(node, "pos", childclass).value_or(Eigen::Vector3d::Zero());
  return result;
}

void MjcfAttributes::require_known(const pugi::xml_node& node) const {
  const MjcfElement* element = mjcf_element(node.name());
  if (element == nullptr) {
    xml_.fail(node,
              "has no counterpart in a rod's scene, or is unknown (allowed: a model without it)");
  }
  const std::vector<std::string> read = words_of(element->read);
  const std::vector<std::string> without_effect = words_of(element->without_effect);
  for (const pugi::xml_attribute& attribute : node.attributes()) {
    const std::string_view name = attribute.name();
    if (std::ranges::count(read, name) + std::ranges::count(without_effect, name) > 0) continue;
    xml_.fail(node, fmt::format("{} = {}: has no counterpart in a rod's scene, or is unknown{} "
                                "(allowed: {}, and attributes without effect at rest)",
                                printable_piece(name), quoted_piece(attribute.value()),
                                did_you_mean(name, read), fmt::join(read, ", ")));
  }
}

void MjcfAttributes::require_zero(const pugi::xml_node& node, const char* attribute,
                                  const std::string& why, const std::string& childclass) const {
  constexpr std::size_t most = 100;
  const auto values = numbers(node, attribute, 1, most, childclass);
  if (!values) return;
  if (std::ranges::any_of(*values, [](double value) { return value != 0; })) {
    xml_.fail(node, attribute, why + " (allowed: 0)");
  }
}

}  // namespace dlo::compare
