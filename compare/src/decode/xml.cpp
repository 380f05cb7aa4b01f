#include "decode/xml.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "base/input_file.hpp"
#include "base/quote.hpp"

namespace dlo::compare {
namespace {

/// Largest nesting depth, which is the longest chain, since bodies of a chain are nested. The limit
/// protects functions that visit elements by recursion.
constexpr int deepest_xml = 1000;

/// Finds a document type, or an element that is nested too deep.
struct Inspector : pugi::xml_tree_walker {
  bool for_each(pugi::xml_node& node) override {
    const bool deep = depth() > deepest_xml;
    if (node.type() != pugi::node_doctype && !deep) return true;
    refused = node;
    too_deep = deep;
    return false;
  }
  pugi::xml_node refused;
  bool too_deep = false;
};

/// Returns the element's name for a message.
std::string tag_of(const pugi::xml_node& node) {
  return fmt::format("<{}>", printable_piece(node.name()));
}

}  // namespace

XmlFile::XmlFile(std::string_view text, std::string file)
    : file_(std::move(file)), text_(after_byte_order_mark(text)) {
  const pugi::xml_parse_result result = document_.load_buffer(
      text_.data(), text_.size(), pugi::parse_default | pugi::parse_doctype, pugi::encoding_utf8);
  if (!result) {
    throw InputError(fmt::format("{}: not well-formed XML: {}", where(result.offset),
                                 quoted_piece(result.description())));
  }
  Inspector inspector;
  document_.traverse(inspector);
  if (inspector.too_deep) {
    throw InputError(fmt::format("{}: elements within elements (allowed: {} levels)",
                                 where(inspector.refused), deepest_xml));
  }
  if (inspector.refused) {
    throw InputError(
        fmt::format("{}: a document type, which could define entities (allowed: elements only)",
                    where(inspector.refused)));
  }
}

std::string XmlFile::where(std::ptrdiff_t offset) const {
  const auto size = static_cast<std::ptrdiff_t>(text_.size());
  const auto end = text_.begin() + std::clamp<std::ptrdiff_t>(offset, 0, size);
  return fmt::format("{}:{}", file_, 1 + std::count(text_.begin(), end, '\n'));
}

std::string XmlFile::where(const pugi::xml_node& node) const { return where(node.offset_debug()); }

void XmlFile::fail(const pugi::xml_node& node, const std::string& problem) const {
  throw InputError(fmt::format("{}: {} {}", where(node), tag_of(node), problem));
}

void XmlFile::fail(const pugi::xml_node& node, const char* attribute,
                   const std::string& problem) const {
  const pugi::xml_attribute given = node.attribute(attribute);
  throw InputError(fmt::format("{}: {} {}{}: {}", where(node), tag_of(node), attribute,
                               given ? " = " + quoted_piece(given.value()) : "", problem));
}

void XmlRefusals::add(const std::string& message) {
  if (std::ranges::find(messages_, message) == messages_.end()) messages_.push_back(message);
}

void XmlRefusals::throw_if_any() const {
  if (messages_.empty()) return;
  constexpr std::size_t most_shown_messages = 10;
  const std::size_t shown = std::min(messages_.size(), most_shown_messages);
  std::string text = fmt::format(
      "{}",
      fmt::join(messages_.begin(), messages_.begin() + static_cast<std::ptrdiff_t>(shown), "; "));
  if (shown < messages_.size()) text += fmt::format("; and {} more", messages_.size() - shown);
  throw InputError(text);
}

bool looks_like_xml(std::string_view text) {
  text = after_byte_order_mark(text);
  const std::size_t start = text.find_first_not_of(" \t\r\n");
  return start != std::string_view::npos && text[start] == '<';
}

void refuse_archives(std::string_view bytes, const std::string& file) {
  const bool is_zip = bytes.starts_with("PK\x03\x04");
  if (!is_zip && !looks_like_xml(bytes)) return;
  throw InputError(fmt::format(
      "{}: {}, which is not read (allowed: CSV; of shapes JSON, .npy and legacy VTK too; "
      "doc/howto/read_nodes.md shows how Python converts it)",
      file, is_zip ? "a zip archive such as NPZ" : "XML such as VTU or VTP"));
}

}  // namespace dlo::compare
