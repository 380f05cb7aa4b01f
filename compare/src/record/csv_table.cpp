#include "record/csv_table.hpp"

#include <algorithm>

namespace dlo::compare {

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

std::string CsvTable::row(const Json& document) const {
  std::string line;
  for (const Column& column : columns_) {
    if (&column != columns_.data()) line += ",";
    if (!document.contains(column.path)) continue;
    line += csv_value(document.at(column.path), column.digits);
  }
  return line + "\n";
}

std::string CsvTable::text(const Json& documents) const {
  std::string lines = header();
  for (const Json& document : documents) lines += row(document);
  return lines;
}

}  // namespace dlo::compare
