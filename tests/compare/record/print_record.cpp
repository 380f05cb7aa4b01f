// Prints the fields of a solution's record and the keys of a scene file, for tests/record, as JSON.

#include <cstdio>
#include <exception>
#include <span>
#include <string>
#include <variant>

#include "record/solution_fields.hpp"
#include "toml/scene_keys.hpp"

namespace {

using dlo::compare::Field;
using dlo::compare::Json;
using dlo::compare::SolvedShape;

void add(Json& list, std::span<const Field<SolvedShape>> fields, bool everywhere) {
  for (const Field<SolvedShape>& field : fields) {
    const auto in = [&](unsigned place, const std::string& name) {
      return (field.places & place) != 0 ? name : "";
    };
    list.push_back({{"key", field.key()},
                    {"list", std::holds_alternative<Json (*)(const SolvedShape&)>(field.get)},
                    {"words", field.python_words()},
                    {"json", in(dlo::compare::in_json, field.json_path())},
                    {"csv", in(dlo::compare::in_csv, field.key())},
                    {"python", in(dlo::compare::in_python, std::string(field.name))},
                    {"everywhere", everywhere}});
  }
}

Json scene_keys() {
  Json tables = Json::array();
  for (const dlo::compare::SceneTable& table : dlo::compare::scene_tables()) {
    Json keys = Json::array();
    for (const dlo::compare::SceneKey& key : table.keys) {
      keys.push_back({{"name", key.name},
                      {"example", key.example},
                      {"units", dlo::compare::known_units(key.dimension)},
                      {"allowed", key.range.text},
                      {"missing", key.missing},
                      {"words", key.words}});
    }
    tables.push_back({{"header", table.header}, {"words", table.words}, {"keys", keys}});
  }
  return tables;
}

}  // namespace

int main() {
  try {
    Json list = Json::array();
    add(list, dlo::compare::solution_fields(), false);
    add(list, dlo::compare::shape_numbers(), true);
    const Json record{{"fields", list}, {"tables", scene_keys()}};
    return std::puts(record.dump(1).c_str()) < 0 ? 1 : 0;
  } catch (const std::exception& error) {
    std::fputs(error.what(), stderr);
    return 1;
  }
}
