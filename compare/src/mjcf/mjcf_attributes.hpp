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

/// Where something is, and how it is turned.
using MjcfPose = Eigen::Isometry3d;

/// A vector as TOML has it, to the last digit.
[[nodiscard]] std::string toml_vector(const Eigen::Vector3d& v);

/// An MJCF file's elements with the attributes of their default classes, and its units of angles.
/// All that reads throws InputErrors of the form "file:line: <element> attribute = "value": ...".
class MjcfAttributes {
 public:
  /// Reads units and default classes.
  /// @param refusals  receives the parts of the file that a rod's scene cannot represent
  /// @throws InputError if the file is not MJCF
  MjcfAttributes(const XmlFile& xml, XmlRefusals& refusals);

  [[nodiscard]] const XmlFile& xml() const { return xml_; }
  /// Refusals of the whole file, added to by all readers of it.
  [[nodiscard]] XmlRefusals& refusals() const { return refusals_; }
  /// What the file's own defaults say of elements below one that has a childclass.
  [[nodiscard]] const std::string& known_class(const pugi::xml_node& node, const char* attribute,
                                               const std::string& outside) const;

  /// Text of an attribute, its own or its class's. @param childclass  around the element
  [[nodiscard]] std::optional<std::string> text(const pugi::xml_node& node, const char* attribute,
                                                const std::string& childclass) const;
  /// `least` to `most` numbers, finite and within 1e12.
  [[nodiscard]] std::optional<std::vector<double>> numbers(const pugi::xml_node& node,
                                                           const char* attribute, std::size_t least,
                                                           std::size_t most,
                                                           const std::string& childclass) const;
  [[nodiscard]] std::optional<double> number(const pugi::xml_node& node, const char* attribute,
                                             const std::string& childclass) const;
  [[nodiscard]] std::optional<Eigen::Vector3d> vector(const pugi::xml_node& node,
                                                      const char* attribute,
                                                      const std::string& childclass) const;
  /// One of some words. @return its place among them, 0 if not given
  [[nodiscard]] std::size_t choice(const pugi::xml_node& node, const char* attribute,
                                   const std::vector<std::string_view>& allowed,
                                   const std::string& childclass) const;
  /// pos and one of quat, axisangle, euler, xyaxes, zaxis.
  [[nodiscard]] MjcfPose pose(const pugi::xml_node& node, const std::string& childclass) const;

  /// @throws InputError for an attribute that nobody reads, or an element that has no place
  void require_known(const pugi::xml_node& node) const;
  /// The same for an attribute that a rod cannot say, unless it has a value of no effect.
  void require_zero(const pugi::xml_node& node, const char* attribute, const std::string& why,
                    const std::string& childclass) const;

 private:
  void read_compiler(const pugi::xml_node& compiler);
  void add_defaults(const pugi::xml_node& node, const std::string& parent);
  [[nodiscard]] Eigen::Quaterniond rotation(const pugi::xml_node& node,
                                            const std::string& childclass) const;
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

/// What may be said of an element: attributes that are read, and such as have no effect on the
/// shape at rest of a chain of segments.
struct MjcfElement {
  std::string_view name;
  std::string_view read;  ///< with blanks between
  std::string_view without_effect;
};

/// Nothing of an element that has no place in a rod's scene.
[[nodiscard]] const MjcfElement* mjcf_element(std::string_view name);

/// Parts of the file beside the bodies that have no effect on a shape at rest.
[[nodiscard]] bool mjcf_without_effect(std::string_view name);

}  // namespace dlo::compare
