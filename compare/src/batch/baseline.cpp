#include "batch/baseline.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <set>
#include <system_error>

#include "base/input_file.hpp"
#include "base/output_file.hpp"
#include "base/quote.hpp"
#include "dlo/compare/deviation.hpp"
#include "dlo/compare/error.hpp"
#include "dlo/compare/solution.hpp"
#include "toml/strict_table.hpp"

namespace dlo::compare {
namespace {

constexpr const char* schema = "dlo/baseline/1";

BaselineCase read_case(StrictTable& table) {
  BaselineCase result;
  table.only({"bookkeeping", "fingerprint", "law", "max_over_length", "model", "points", "program",
              "rms_over_length", "scene", "tip_over_length"});
  result.scene = table.text("scene");
  if (table.has("program")) {
    result.program = table.text("program");
  } else {
    result.model = from_name<Model>(table.choice("model", {"chain", "force"}));
    result.law = table.choice<BendingLaw>("law");
    result.bookkeeping = table.choice<Bookkeeping>("bookkeeping");
  }
  result.points = table.integer("points", 4, 1'000'000);
  const auto error = [&](const char* key) {
    return table.number(key, Dimension::number, Range::not_negative());
  };
  result.errors.rms = error("rms_over_length");
  if (table.has("max_over_length")) result.errors.max = error("max_over_length");
  if (table.has("tip_over_length")) result.errors.tip = error("tip_over_length");
  if (const auto digits = table.optional_text("fingerprint")) {
    const bool whole =
        digits->size() == 16 && digits->find_first_not_of("0123456789abcdef") == std::string::npos;
    if (!whole) table.fail("fingerprint", "must be 16 hexadecimal digits");
    result.fingerprint = *digits;
  }
  table.finish();
  return result;
}

/// Formats a number as a TOML float with six significant digits. It always has a decimal point, so
/// that 0 is written as 0.00000.
std::string toml_number(double value) { return fmt::format("{:#.6g}", value); }

}  // namespace

std::string BaselineCase::solver() const { return program.empty() ? to_string(model) : program; }

std::string BaselineCase::name() const {
  if (!program.empty()) return fmt::format("{} ({}, N = {})", scene, program, points);
  return fmt::format("{} ({}, law {}, bookkeeping {}, N = {})", scene, to_string(model),
                     to_string(law), to_string(bookkeeping), points);
}

std::vector<BaselineCase> read_baseline(const std::string& text, const std::string& file) {
  const toml::table root = parse_toml(text, file);
  StrictTable table(root, "", file);
  table.only({"case", "schema"});
  (void)table.choice("schema", {schema});
  std::vector<BaselineCase> cases;
  std::set<std::string> names;
  for (StrictTable& entry : table.tables("case")) {
    cases.push_back(read_case(entry));
    if (names.insert(cases.back().name()).second) continue;
    entry.fail("scene",
               "a second case with this scene, model, law, bookkeeping and points "
               "(allowed: one)");
  }
  table.finish();
  return cases;
}

std::vector<BaselineCase> load_baseline(const std::string& path) {
  std::string text;
  try {
    text = read_file(path);
  } catch (const InputError& error) {
    std::error_code unknown;
    const auto type = std::filesystem::status(path, unknown).type();
    if (type != std::filesystem::file_type::not_found) throw;
    throw InputError(fmt::format("{}; --update writes a first baseline", error.what()));
  }
  return read_baseline(text, path);
}

std::vector<BaselineCase> load_baseline_if_exists(const std::string& path) {
  std::error_code unknown;  // ignored: an unusable name is reported when the file is written
  if (!std::filesystem::exists(path, unknown)) return {};
  return load_baseline(path);
}

void replace_baseline(const std::string& path, const std::vector<BaselineCase>& read,
                      const std::vector<BaselineCase>& cases) {
  if (baseline_text(load_baseline_if_exists(path)) != baseline_text(read)) {
    throw OutputError(path +
                      ": left as it is: another process has changed it since it was read "
                      "(allowed: one update at a time)");
  }
  write_file(path, baseline_text(cases), Replaces::own_format);
}

std::string baseline_text(std::vector<BaselineCase> cases) {
  std::sort(cases.begin(), cases.end(),
            [](const BaselineCase& a, const BaselineCase& b) { return a.name() < b.name(); });
  std::string text = fmt::format(
      "# Distances of shapes from the energy model's, as shares of the rod's length. Written by\n"
      "# dlo regress --update; a change of it is a change of a shape.\nschema = \"{}\"\n",
      schema);
  for (const BaselineCase& entry : cases) {
    text += fmt::format("\n[[case]]\nscene = {}\n", toml_string(entry.scene));
    text += entry.program.empty()
                ? fmt::format("model = \"{}\"\nlaw = \"{}\"\nbookkeeping = \"{}\"\n",
                              to_string(entry.model), to_string(entry.law),
                              to_string(entry.bookkeeping))
                : fmt::format("program = {}\n", toml_string(entry.program));
    text += fmt::format("points = {}\nrms_over_length = {}\n", entry.points,
                        toml_number(entry.errors.rms));
    if (entry.errors.max) {
      text += fmt::format("max_over_length = {}\n", toml_number(*entry.errors.max));
    }
    if (entry.errors.tip) {
      text += fmt::format("tip_over_length = {}\n", toml_number(*entry.errors.tip));
    }
    if (!entry.fingerprint.empty()) {
      text += fmt::format("fingerprint = \"{}\"\n", entry.fingerprint);
    }
  }
  return text;
}

}  // namespace dlo::compare
