#pragma once

#include <pugixml.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "dlo/compare/error.hpp"

namespace dlo::compare {

/// A parsed XML file with the line of each element. A document type is rejected, so that no entity
/// is defined or read from another file, and no element is nested deeper than deepest_xml.
class XmlFile {
 public:
  /// @param text  UTF-8, also with a byte order mark;  @param file  name of the file, for messages
  /// @throws InputError that names file and line if it is not well-formed, has a document type, or
  /// is nested too deep
  XmlFile(std::string_view text, std::string file);

  [[nodiscard]] pugi::xml_node root() const { return document_.document_element(); }
  /// Returns "file:line" of an element.
  [[nodiscard]] std::string where(const pugi::xml_node& node) const;
  /// Throws an InputError with where(node), the element's name, and the problem.
  [[noreturn]] void fail(const pugi::xml_node& node, const std::string& problem) const;
  /// Throws an InputError about an attribute: "file:line: element attribute = "value": problem".
  [[noreturn]] void fail(const pugi::xml_node& node, const char* attribute,
                         const std::string& problem) const;

 private:
  [[nodiscard]] std::string where(std::ptrdiff_t offset) const;

  std::string file_;
  std::string text_;
  pugi::xml_document document_;
};

/// Collects the refusals of a file, so that one message names the first ten and the number of
/// others.
class XmlRefusals {
 public:
  /// Calls a reader and keeps the message of an InputError that it throws.
  template <class Reader>
  void attempt(const Reader& reader) {
    try {
      reader();
    } catch (const InputError& error) {
      add(error.what());
    }
  }
  /// Throws the first ten messages and the number of others on one line.
  /// @throws InputError if there is any
  void throw_if_any() const;

 private:
  void add(const std::string& message);

  std::vector<std::string> messages_;  // without repetitions
};

/// Whether a text, ignoring blanks, begins like XML.
[[nodiscard]] bool looks_like_xml(std::string_view text);

/// Refuses a file of points or markers that is a NumPy archive (NPZ) or XML, such as VTK's VTU and
/// VTP.
/// @throws InputError with the page that shows how to read such files
void refuse_archives(std::string_view bytes, const std::string& file);

}  // namespace dlo::compare
