#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/number.hpp"
#include "base/output_file.hpp"
#include "batch/sweep.hpp"
#include "command/commands.hpp"
#include "dlo/compare/error.hpp"
#include "option/command_line.hpp"
#include "option/output.hpp"
#include "option/plot.hpp"
#include "option/scene_options.hpp"
#include "option/terminal.hpp"
#include "picture/figures.hpp"
#include "polygon/natural_plane.hpp"
#include "scene/scene_problem.hpp"

namespace dlo::cli {
namespace {

struct SweepOptions {
  std::vector<std::string> files;
  std::vector<std::string> vary;
  compare::SweepModel model = compare::SweepModel::energy;
  std::string format = "csv";
  std::string part;
  std::string output;
  int threads = 0;
  SceneOptions scene;
  PlotOptions plot;
};

/// Returns the result columns that the picture of a sweep shows.
std::vector<std::string> plotted_columns(compare::SweepModel model) {
  if (model == compare::SweepModel::compare || model == compare::SweepModel::compare_chain)
    return {"rms_over_length", "effective_modulus_ratio"};
  return {"tip_x_m", "tip_y_m", "energy_J"};
}

std::vector<compare::SweptField> swept_fields(const compare::Grid& grid) {
  std::vector<compare::SweptField> fields;
  for (const compare::Axis& axis : grid.axes()) {
    compare::SweptField field{.column = axis.column(),
                              .values = {},
                              .logarithmic = axis.spacing == compare::Spacing::logarithmic};
    for (std::int64_t i = 0; i < axis.count; ++i) field.values.push_back(axis.number(i));
    fields.push_back(std::move(field));
  }
  return fields;
}

/// Returns the rows I, I + N, ... of --part I/N, counted from 1; all rows without --part.
compare::RowRange chosen_rows(const std::string& part, std::int64_t rows) {
  if (part.empty()) return {0, rows};
  constexpr std::int64_t most_parts = 1'000'000'000;
  const std::size_t slash = std::min(part.find('/'), part.size());
  const auto index = compare::as_number<std::int64_t>(std::string_view(part).substr(0, slash));
  const auto count = compare::as_number<std::int64_t>(
      std::string_view(part).substr(std::min(slash + 1, part.size())));
  if (!index || !count || *index < 1 || *index > *count || *count > most_parts) {
    throw compare::InputError(
        fmt::format("--part {}: must be I/N (allowed: 1 <= I <= N <= {})", part, most_parts));
  }
  return {*index - 1, rows, *count};
}

compare::Sweep make_sweep(const SweepOptions& options) {
  std::vector<compare::Axis> axes;
  axes.reserve(options.vary.size());
  for (const std::string& text : options.vary) axes.push_back(compare::parse_axis(text));
  return {compare::load_scene_template(options.files.front(), options.scene.materials()),
          compare::Grid(std::move(axes)), options.model, options.scene.solve()};
}

/// Reports the properties that a model neglects, for the first or the last scene of the grid that
/// has any. A scene that cannot be read is reported in its row.
void warn_of_neglected_in_sweep(const compare::Sweep& sweep, compare::SweepModel model) {
  const bool is_rod = model == compare::SweepModel::energy || model == compare::SweepModel::exact;
  for (const std::int64_t row : {std::int64_t{0}, sweep.grid().size() - 1}) {
    try {
      const compare::Scene scene = sweep.scene(row);
      const bool lacks =
          !is_rod && !compare::neglected_by_polygon(scene, scene.force_model).empty();
      if (lacks) return warn_of_neglected_by_polygon(scene);
      if (compare::is_friction_in_reach(scene)) return warn_of_friction(scene);
    } catch (const compare::InputError&) {
      continue;
    }
  }
}

/// Computes and writes rows, each as soon as the previous ones are written.
void write_rows(const SweepOptions& options, const compare::Sweep& sweep,
                const compare::RowRange& rows) {
  std::optional<compare::OutputFile> file;
  std::optional<ProgressBar> bar;
  if (!options.output.empty()) {
    file.emplace(options.output);
    bar.emplace("sweep");
  }
  const auto write = [&](const std::string& text) {
    file ? file->append(text) : write_standard_output(text);
  };
  write(sweep.header());
  const std::int64_t count =
      (std::max(rows.last - rows.first, std::int64_t{0}) + rows.step - 1) / rows.step;
  const std::int64_t rarely = count / 1000 + 1;
  std::int64_t done = 0;
  std::int64_t without_result = 0;
  std::vector<std::string> drawn;
  sweep.run(rows, options.threads, [&](const std::vector<compare::SweepCell>& cells) {
    const std::string line = sweep.line(cells);
    write(line);
    if (options.plot.draws()) drawn.push_back(line);
    if (!line.ends_with(",ok\n")) ++without_result;
    ++done;
    if (bar && (done % rarely == 0 || done == count)) bar->show(done, count);
  });
  if (file) file->finish();
  bar.reset();
  if (without_result > 0) {
    print_message("{}: {} of {} scenes have no result; the column status states the reason",
                  file ? options.output : "sweep", without_result, done);
  }
  options.plot.draw([&] {
    return compare::sweep_picture(swept_fields(sweep.grid()), sweep.header(), drawn,
                                  plotted_columns(options.model));
  });
}

/// Separates fields from files. One --vary may be followed by several fields; a word with "=" is a
/// field.
void separate_fields_from_files(SweepOptions& options) {
  const auto fields = std::stable_partition(
      options.files.begin(), options.files.end(),
      [](const std::string& word) { return word.find('=') == std::string::npos; });
  options.vary.insert(options.vary.end(), fields, options.files.end());
  options.files.erase(fields, options.files.end());
}

/// Checks the picture before anything is computed. @throws InputError if it cannot be drawn
void require_drawable(const SweepOptions& options) {
  options.plot.require_drawable();
  if (!options.plot.draws()) return;
  if (!options.part.empty()) {
    throw compare::InputError(fmt::format(
        "--plot: --part {} computes a part of the rows (allowed: all rows)", options.part));
  }
  if (options.vary.size() > 2) {
    throw compare::InputError(
        fmt::format("--plot: {} fields are varied (allowed: one or two)", options.vary.size()));
  }
}

void run(const SweepOptions& given) {
  SweepOptions options = given;
  if (!options.vary.empty()) separate_fields_from_files(options);
  require_drawable(options);
  if (options.files.size() != 1) {
    throw compare::InputError(
        fmt::format("sweep: {} scene files given (allowed: 1)", options.files.size()));
  }
  if (options.vary.empty()) {
    throw compare::InputError(
        "sweep: no --vary FIELD=VALUES given (allowed: such as --vary gamma=1,10)");
  }
  const compare::Sweep sweep = make_sweep(options);
  if (options.plot.draws()) compare::require_drawable(swept_fields(sweep.grid()));
  warn_of_neglected_in_sweep(sweep, options.model);
  const compare::RowRange rows = chosen_rows(options.part, sweep.grid().size());
  write_rows(options, sweep, rows);
}

}  // namespace

void add_sweep_command(CLI::App& app) {
  add_command<SweepOptions>(app, "sweep", run, [](Command& command, SweepOptions& o) {
    command.bind("FILE", o.files, "--vary", o.vary, "--format", o.format, "--model", o.model,
                 "--output", o.output, "--threads", o.threads, "--part", o.part, o.plot, o.scene);
  });
}

}  // namespace dlo::cli
