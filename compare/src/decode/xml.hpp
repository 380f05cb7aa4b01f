#pragma once

#include <pugixml.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "dlo/compare/error.hpp"

namespace dlo::compare {

/// A parsed XML file, which knows the lines of its elements. It has no document type, so that no
/// entity is defined or read from elsewhere, and no element is nested deeper than deepest_xml.
class XmlFile {
 public:
  /// @param text  UTF-8, also with a byte order mark;  @param file  its name, for messages
  /// @throws InputError naming file and line if it is not well-formed, or has a document type
  XmlFile(std::string_view text, std::string file);

  /// The outermost element.
  [[nodiscard]] pugi::xml_node root() const { return document_.document_element(); }
  /// "file:line" of an element.
  [[nodiscard]] std::string where(const pugi::xml_node& node) const;
  /// @throws InputError with where(node), its name, and the problem
  [[noreturn]] void fail(const pugi::xml_node& node, const std::string& problem) const;
  /// The same of an attribute: "file:line: element attribute = "value": problem".
  [[noreturn]] void fail(const pugi::xml_node& node, const char* attribute,
                         const std::string& problem) const;

 private:
  [[nodiscard]] std::string where(std::ptrdiff_t offset) const;

  std::string file_;
  std::string text_;
  pugi::xml_document document_;
};

/// Collects the refusals of a file, so that one message names all of them.
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
  /// @throws InputError with all messages on one line, if there is any
  void throw_if_any() const;

 private:
  void add(const std::string& message);

  std::vector<std::string> messages_;  // each once
};

/// Whether a text, but for blanks, begins as XML does.
[[nodiscard]] bool looks_like_xml(std::string_view text);

/// @throws InputError with the page that shows how to read them if a file of points or markers is
/// a NumPy archive (NPZ) or XML, as VTK's VTU and VTP are
void refuse_archives(std::string_view bytes, const std::string& file);

}  // namespace dlo::compare
