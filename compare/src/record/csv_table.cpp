#include "record/csv_table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "base/number.hpp"
#include "base/quote.hpp"
#include "base/text.hpp"

namespace dlo::compare {
namespace {

/// Name and unit of a key of a document.
struct KeyName {
  std::string words;
  std::string unit;
  double factor = 1;  ///< factor that converts the value in the document to `unit`
};

/// Returns a unit from the end of a key, such as "N s/m^2" for "N_s_per_m2".
std::string unit_text(std::string_view key) {
  std::string unit;
  while (!key.empty()) {
    const std::string_view word = key.substr(0, key.find('_'));
    key.remove_prefix(std::min(word.size() + 1, key.size()));
    if (word == "per") {
      unit += unit.empty() ? "1/" : "/";
      continue;
    }
    if (!unit.empty() && unit.back() != '/') unit += " ";
    std::string text(word == "Nm2" ? "N m2" : word);
    if (text.size() > 1 && text.back() >= '2' && text.back() <= '4')
      text.insert(text.size() - 1, "^");
    unit += text;
  }
  return unit == "rad s" ? "rad/s" : unit;
}

/// Returns the words of a key; symbols such as c_F keep their underscore.
std::string key_words(std::string_view key) {
  std::string words(key);
  std::size_t begin = 0;
  for (std::size_t i = 0; i < words.size(); ++i) {
    const bool is_symbol =
        i == begin + 1 && i + 2 <= words.size() && (i + 2 == words.size() || words[i + 2] == '_');
    if (words[i] != '_' || is_symbol) continue;
    words[i] = ' ';
    begin = i + 1;
  }
  return words;
}

KeyName name_of_key(std::string_view key) {
  constexpr std::string_view over_length = "_over_length";
  static const std::set<std::string_view> units = {"m",   "m2", "m3", "m4", "s",  "s2",  "N",  "Nm",
                                                   "Nm2", "J",  "Hz", "Pa", "kg", "rad", "per"};
  const bool share = key.ends_with(over_length);
  std::string_view name = key.substr(0, key.size() - (share ? over_length.size() : 0));
  while (!share && name.find('_') != std::string_view::npos) {
    const std::size_t last = name.rfind('_');
    const bool is_symbol = name == "l_s" || name.ends_with("_l_s");
    if (is_symbol || !units.contains(name.substr(last + 1))) break;
    name = name.substr(0, last);
  }
  const std::string words = key_words(name);
  if (share) return {words, "% of l", 100};
  return {words, unit_text(key.substr(std::min(name.size() + 1, key.size())))};
}

/// @param scale  magnitude of such values, of which small fractions are rounding (shown())
std::string value_text(const Json& value, const KeyName& key, double scale) {
  if (value.is_string()) return display(value.get<std::string>());
  if (value.is_boolean()) return value.get<bool>() ? "yes" : "no";
  if (value.is_array()) {
    std::string list;
    for (const Json& one : value) {
      if (one.is_number_float()) scale = std::max(scale, std::abs(one.get<double>()));
    }
    for (const Json& one : value) {
      const std::string text = value_text(one, key, scale);
      append(list, "{}{}", list.empty() ? "" : ", ", text.empty() ? "-" : text);
    }
    return "[" + list + "]";
  }
  if (!value.is_number_float()) return value.is_null() ? "" : value.dump();
  const auto number = value.get<double>();
  if (!std::isfinite(number)) return "";
  const double value_shown = key.factor * shown(number, key.factor > 1 ? 1 : scale);
  // A share such as c_h that is not quite 1 is not printed as 1, and 30000 not as 3e+04.
  constexpr double nearly_one = 0.9995;
  constexpr double most_digits = 1e9;
  const bool counts = std::trunc(value_shown) == value_shown && std::abs(value_shown) < most_digits;
  const bool exact = counts || (value_shown > nearly_one && value_shown < 1);
  return formatted("{:.{}g}", value_shown, exact ? 9 : 4);
}

/// Whether a value has a text of one line: it neither is nor contains null, an object or an empty
/// list, and has at most nine values.
bool fits_on_one_line(const Json& value) {
  constexpr std::size_t most_numbers = 9;
  if (!value.is_array()) return !value.is_object() && !value.is_null();
  return !value.empty() && value.size() <= most_numbers && value.flatten().size() <= most_numbers &&
         std::ranges::all_of(value, fits_on_one_line);
}

bool is_list_of_objects(const Json& value) {
  return value.is_array() && !value.empty() && value.front().is_object();
}

/// Returns the columns of a list of objects: all values that fit on one line, also those of objects
/// directly in them.
std::string all_columns(const Json& rows) {
  std::string columns;
  std::set<std::string> known;
  const auto add = [&](const std::string& name, const std::string& path, const Json& value) {
    if (fits_on_one_line(value) && known.insert(path).second) {
      append(columns, "{}{}={}", columns.empty() ? "" : ",", name, path);
    }
  };
  for (const Json& row : rows) {
    for (const auto& [key, value] : row.items()) {
      add(key, key, value);
      if (!value.is_object()) continue;
      for (const auto& [inner, part] : value.items()) {
        add(fmt::format("{}_{}", key, inner), fmt::format("{}/{}", key, inner), part);
      }
    }
  }
  return columns;
}

void add_values(std::string& out, const Json& object, const std::string& indent,
                const Magnitudes& large, const std::string& unit = {}) {
  std::size_t width = 0;
  for (const auto& [key, value] : object.items()) {
    if (fits_on_one_line(value)) width = std::max(width, name_of_key(key).words.size());
  }
  for (const auto& [key, value] : object.items()) {
    KeyName name = name_of_key(key);
    if (key == "schema" || is_list_of_objects(value)) continue;
    if (value.is_object()) {
      std::string inner;
      add_values(inner, value, indent + "  ", large, name.unit);
      if (!inner.empty()) append(out, "{}{}\n{}", indent, name.words, inner);
      continue;
    }
    if (name.unit.empty() && value.is_number_float()) name.unit = unit;
    const bool lines = value.is_array() && !value.empty() && value.front().is_string();
    if (!lines && !fits_on_one_line(value)) continue;
    for (const Json& line : lines ? value : Json::array({value})) {
      const std::string text = value_text(line, name, large.of(name.unit));
      if (text.empty()) continue;
      append(out, "{}{:<{}}  {}{}{}\n", indent, name.words, width, text,
             name.unit.empty() ? "" : " ", name.unit);
      name.words.clear();
    }
  }
}

/// Adds the lists of objects within a part of a document.
/// @param path  path of the part, such as "dynamic/";  @param title  title of the part, in words
void add_tables(std::string& out, const Document& document, const Json& part,
                const std::string& path, const std::string& title) {
  for (const auto& [key, value] : part.items()) {
    const std::string here = path + key;
    const std::string words = title + name_of_key(key).words;
    if (value.is_object()) add_tables(out, document, value, here + "/", words + " ");
    if (!is_list_of_objects(value)) continue;
    const auto chosen = document.columns.find(here);
    const bool all = chosen == document.columns.end();
    const bool within = path.find('#') != std::string::npos;
    if (all ? !within : !chosen->second.empty()) {
      const CsvTable table(all ? all_columns(value) : chosen->second);
      append(out, "\n{}\n{}", words, table.aligned(value, document.large));
    }
    for (std::size_t i = 0; i < value.size(); ++i) {
      add_tables(out, document, value[i], here + "/#/",
                 fmt::format("{} {}, {}: ", words, i + 1, display(value[i].value("scene", ""))));
    }
  }
}

}  // namespace

CsvTable::CsvTable(std::string_view columns) { add(columns); }

void CsvTable::add(std::string_view columns) {
  while (!columns.empty()) {
    const std::string_view column = columns.substr(0, columns.find(','));
    columns.remove_prefix(std::min(column.size() + 1, columns.size()));
    const std::string_view place = column.substr(0, column.find(':'));
    const std::string_view name = place.substr(0, place.find('='));
    const std::string path(name == place ? name : place.substr(name.size() + 1));
    columns_.push_back({std::string(name), Json::json_pointer("/" + path)});
    if (place != column) columns_.back().digits = column.back() - '0';
  }
}

std::string CsvTable::header() const {
  std::string line;
  for (const Column& column : columns_) line += (line.empty() ? "" : ",") + column.name;
  return line + "\n";
}

Json CsvTable::cell(const Column& column, const Json& document, std::size_t number) {
  if (column.path.to_string() == "/#") return number;
  return document.contains(column.path) ? document.at(column.path) : Json(nullptr);
}

std::string CsvTable::row(const Json& document, std::size_t number) const {
  std::string line;
  for (const Column& column : columns_) {
    if (&column != columns_.data()) line += ",";
    line += csv_value(cell(column, document, number), column.digits);
  }
  return line + "\n";
}

std::string CsvTable::text(const Json& documents) const {
  std::string lines = header();
  for (std::size_t i = 0; i < documents.size(); ++i) lines += row(documents[i], i + 1);
  return lines;
}

std::string CsvTable::aligned(const Json& documents, const Magnitudes& large) const {
  std::vector<std::string> lines(documents.size() + 1);
  for (const Column& column : columns_) {
    const KeyName name = name_of_key(column.name);
    std::vector<std::string> cells = {
        name.unit.empty() ? name.words : fmt::format("{} [{}]", name.words, name.unit)};
    std::size_t width = cells.front().size();
    bool numbers = true;
    bool empty = true;
    for (std::size_t i = 0; i < documents.size(); ++i) {
      const Json value = cell(column, documents[i], i + 1);
      std::string text = value_text(value, name, large.of(name.unit));
      numbers = numbers && (value.is_number() || text.empty());
      empty = empty && text.empty();
      cells.push_back(text.empty() ? "-" : std::move(text));
      width = std::max(width, cells.back().size());
    }
    for (std::size_t i = 0; !empty && i < cells.size(); ++i) {
      lines[i] += numbers ? fmt::format("  {:>{}}", cells[i], width)
                          : fmt::format("  {:<{}}", cells[i], width);
    }
  }
  for (std::string& line : lines) line.erase(line.find_last_not_of(' ') + 1);
  return fmt::format("{}\n", fmt::join(lines, "\n"));
}

std::string Document::text() const {
  const Json& values = shown.is_null() ? json : shown;
  std::string out;
  add_values(out, values, "", large);
  add_tables(out, *this, values, "", "");
  return head + (out.starts_with('\n') ? out.substr(1) : out);
}

std::string Document::csv() const {
  const CsvTable rows(columns.at(table));
  return rows.text(table.empty() ? Json::array({json}) : json.at(Json::json_pointer("/" + table)));
}

}  // namespace dlo::compare
