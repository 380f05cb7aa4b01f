#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "decode/xml.hpp"

namespace dlo::compare {

/// Position and orientation.
using MjcfPose = Eigen::Isometry3d;

/// Returns a vector as in TOML, with all digits.
[[nodiscard]] std::string toml_vector(const Eigen::Vector3d& v);

struct MjcfNode;

/// Elements of an MJCF file with the attributes of their default classes, and the file's units of
/// angles. All readers throw InputErrors of the form "file:line: <element> attribute = "value":
/// ...".
class MjcfAttributes {
 public:
  /// Reads units and default classes.
  /// @param refusals  receives the parts of the file that a rod's scene cannot represent
  /// @throws InputError if the file is not MJCF
  MjcfAttributes(const XmlFile& xml, XmlRefusals& refusals);

  [[nodiscard]] const XmlFile& xml() const { return xml_; }
  /// Refusals of the whole file, to which all its readers add.
  [[nodiscard]] XmlRefusals& refusals() const { return refusals_; }
  /// Returns the default class that an element's attribute names (class or childclass), `outside`
  /// if the element lacks the attribute. @throws InputError if there is no such class
  [[nodiscard]] const std::string& known_class(const pugi::xml_node& node, const char* attribute,
                                               const std::string& outside) const;

 private:
  friend struct MjcfNode;
  void read_compiler(const MjcfNode& compiler);
  void add_defaults(const pugi::xml_node& node, const std::string& parent);
  [[nodiscard]] Eigen::Quaterniond euler(const std::vector<double>& angles) const;

  struct Class {
    pugi::xml_node node;
    std::string parent;
  };
  const XmlFile& xml_;
  XmlRefusals& refusals_;
  std::map<std::string, Class, std::less<>> classes_;
  std::string main_ = "main";
  double angle_ = 0;  ///< unit of angles [rad]
  std::string euler_order_ = "xyz";
};

/// An element whose attributes are completed by its default classes.
struct MjcfNode {
  const MjcfAttributes& file;
  pugi::xml_node element;
  std::string childclass = {};  ///< class that surrounding elements set

  /// Returns the text of an attribute, from the element or its class; std::nullopt if neither has
  /// it.
  [[nodiscard]] std::optional<std::string> text(const char* attribute) const;
  /// Reads `least` to `most` numbers, finite and within 1e12; std::nullopt if the attribute is not
  /// given.
  [[nodiscard]] std::optional<std::vector<double>> numbers(const char* attribute, std::size_t least,
                                                           std::size_t most) const;
  [[nodiscard]] std::optional<double> number(const char* attribute) const;
  [[nodiscard]] std::optional<Eigen::Vector3d> vector(const char* attribute) const;
  /// Reads one of several words. @return its index, 0 if not given
  [[nodiscard]] std::size_t choice(const char* attribute,
                                   const std::vector<std::string_view>& allowed) const;
  /// Reads pos and one of quat, axisangle, euler, xyaxes, zaxis.
  [[nodiscard]] MjcfPose pose() const;

  /// Checks that the element and all its attributes are known (MjcfElement).
  /// @throws InputError for an unknown element or attribute
  void require_known() const;
  /// Checks that an attribute that a rod's scene cannot represent has no effect.
  /// @throws InputError with `why` if it has one
  void require_zero(const char* attribute, const std::string& why) const;
  /// Throws an InputError about the element, or about one of its attributes (XmlFile::fail).
  [[noreturn]] void fail(const std::string& problem) const { file.xml().fail(element, problem); }
  [[noreturn]] void fail(const char* attribute, const std::string& problem) const {
    file.xml().fail(element, attribute, problem);
  }

 private:
  [[nodiscard]] Eigen::Quaterniond rotation() const;
};

/// Known attributes of an element: those that are read, and those without effect on the equilibrium
/// of a chain of segments.
struct MjcfElement {
  std::string_view name;
  std::string_view read;  ///< separated by blanks
  std::string_view without_effect;
};

/// Returns an element by its name; null if a rod's scene has no such element.
[[nodiscard]] const MjcfElement* mjcf_element(std::string_view name);

/// Whether elements of this name, in the file or in a body, have no effect on an equilibrium.
[[nodiscard]] bool mjcf_without_effect(std::string_view name);

}  // namespace dlo::compare
