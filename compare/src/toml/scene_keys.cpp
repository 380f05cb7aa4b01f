#include "toml/scene_keys.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>
#include <stdexcept>

#include "base/builtin_data.hpp"
#include "base/number.hpp"
#include "base/text.hpp"

namespace dlo::compare {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

/// Splits a text at a separator and removes the blanks around each part.
std::vector<std::string> parts_of(std::string_view text, char separator) {
  std::vector<std::string> parts;
  while (true) {
    const std::size_t end = text.find(separator);
    parts.emplace_back(trimmed(text.substr(0, end)));
    if (end == std::string_view::npos) return parts;
    text.remove_prefix(end + 1);
  }
}

SceneKey key_of(const std::string& line) {
  std::vector<std::string> columns = parts_of(line, '|');
  columns.resize(std::max<std::size_t>(columns.size(), 8));
  SceneKey key{columns.at(0), columns.at(1), columns.at(3),
               columns.at(4), columns.at(5), Range::parse(columns.at(2))};
  const auto words_of = [](const std::string& words) {
    return words.empty() ? std::vector<std::string>() : parts_of(words, ' ');
  };
  key.excludes = words_of(columns[6]);
  key.needs = words_of(columns[7]);
  for (const std::string& word : words_of(key.value)) {
    const auto dimension = dimension_named(word);
    if (dimension && *dimension != Dimension::number) key.dimension = *dimension;
  }
  return key;
}

std::vector<SceneTable> read_tables(std::string_view text) {
  std::vector<SceneTable> tables;
  std::istringstream lines{std::string(text)};
  for (std::string line; std::getline(lines, line);) {
    if (line.empty() || line.front() == '#') continue;
    if (line.front() != '[') {
      tables.back().keys.push_back(key_of(line));
      tables.back().names.push_back(tables.back().keys.back().name);
      continue;
    }
    const std::size_t end = line.find(' ');
    const std::string header = line.substr(0, end);
    const std::size_t begin = header.find_first_not_of('[');
    const std::string name = header.substr(begin, header.find(']') - begin);
    tables.push_back({header, name, line.substr(end + 1), {}, {}});
  }
  for (SceneTable& table : tables) std::ranges::sort(table.names);
  return tables;
}

template <typename Element>
const Element& find_named(const std::vector<Element>& all, std::string_view name) {
  const auto found = std::ranges::find(all, name, &Element::name);
  if (found == all.end()) throw std::out_of_range(fmt::format("no table or key {}", name));
  return *found;
}

}  // namespace

Range Range::any() { return {-infinity, infinity, false, "any number"}; }
Range Range::positive() { return {0, infinity, true, "> 0"}; }
Range Range::not_negative() { return {0, infinity, false, ">= 0"}; }
Range Range::between(double low, double high, const std::string& unit) {
  return {low, high, false, fmt::format("{} to {}{}", low, high, unit)};
}
Range Range::parse(const std::string& text) {
  Range range = text == "> 0" ? positive() : text == ">= 0" ? not_negative() : any();
  range.text = text;
  const LeadingNumber<double> low = leading_number<double>(text);
  constexpr std::string_view to = " to ";
  std::string_view rest = std::string_view(text).substr(low.length);
  if (low.length == 0 || !rest.starts_with(to)) return range;
  rest.remove_prefix(to.size());
  const bool open = rest.starts_with("< ");
  if (open) rest.remove_prefix(2);
  const LeadingNumber<double> high = leading_number<double>(rest);
  if (high.length == 0) return range;
  return {low.value, open ? std::nextafter(high.value, low.value) : high.value, false, text};
}
bool Range::holds(double value) const {
  return (low_open ? value > low : value >= low) && value <= high;
}

std::vector<std::string> SceneKey::choices() const { return parts_of(range.text, ','); }

const SceneKey& SceneTable::key(std::string_view name) const { return find_named(keys, name); }

const std::vector<SceneTable>& scene_tables() {
  static const std::vector<SceneTable> tables = read_tables(builtin::scene_keys_txt);
  return tables;
}

const SceneTable& scene_table(std::string_view name) { return find_named(scene_tables(), name); }

}  // namespace dlo::compare
