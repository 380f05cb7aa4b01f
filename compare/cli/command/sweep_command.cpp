#include <fmt/format.h>

#include <cstdlib>
#include <memory>

#include "base/output_file.hpp"
#include "base/words.hpp"
#include "batch/read_sweep.hpp"
#include "batch/sweep_file.hpp"
#include "batch/sweep_merge.hpp"
#include "command/commands.hpp"
#include "dlo/compare/error.hpp"
#include "option/output.hpp"
#include "option/plot.hpp"
#include "option/scene_options.hpp"
#include "option/terminal.hpp"
#include "picture/sweep_figure.hpp"
#include "polygon/natural_plane.hpp"
#include "scene/reach.hpp"

namespace dlo::cli {
namespace {

struct SweepOptions {
  std::vector<std::string> files;
  std::vector<std::string> vary;
  std::string model = "energy";
  std::string format = "csv";
  std::string shard;
  std::string output;
  int threads = 0;
  bool restart = false;
  bool merge = false;
  SceneOptions scene;
  PlotOptions plot;
};

/// What a sweep's picture shows of its results.
std::vector<std::string> drawn_results(const std::string& model) {
  if (model.starts_with("compare")) return {"rms_over_length", "effective_modulus_ratio"};
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

void plot(const SweepOptions& options, const compare::Sweep& sweep,
          const std::vector<std::string>& rows) {
  options.plot.draw([&] {
    return compare::sweep_picture(swept_fields(sweep.grid()), sweep.header(), rows,
                                  drawn_results(options.model));
  });
}

/// Rows of a finished sweep's file, behind its header.
std::vector<std::string> rows_of_file(const std::string& path, const std::string& header) {
  std::vector<std::string> rows;
  compare::LineReader reader(path);
  bool behind_header = false;
  for (std::string line; reader.next(line);) {
    if (behind_header) rows.push_back(line + "\n");
    behind_header = behind_header || line + "\n" == header;
  }
  return rows;
}

std::optional<compare::Shard> chosen_shard(const std::string& text) {
  if (text == "none") return std::nullopt;
  if (!text.empty()) return compare::parse_shard(text);
  std::optional<compare::Shard> shard =
      compare::shard_from_environment([](const char* name) { return std::getenv(name); });
  if (shard) say("shard {} (from {})", shard->name(), shard->source);
  return shard;
}

/// {shard} in a file's name becomes 2-of-4, or "all" without shards.
std::string output_path(const std::string& path, const std::optional<compare::Shard>& shard) {
  return compare::with_places(
      path, {{"{shard}", shard ? fmt::format("{}-of-{}", shard->index, shard->count) : "all"}});
}

compare::Sweep sweep_of(const SweepOptions& options) {
  std::vector<compare::Axis> axes;
  axes.reserve(options.vary.size());
  for (const std::string& text : options.vary) axes.push_back(compare::parse_axis(text));
  return {compare::load_scene_template(options.files.front(), options.scene.materials()),
          compare::Grid(std::move(axes)), compare::from_name<compare::SweepModel>(options.model),
          options.scene.solve()};
}

/// By the first scene of the grid of which the model leaves something out, of its two ends; one
/// that cannot be read says so in its row.
void warn_of_polygons_in(const compare::Sweep& sweep, const std::string& model) {
  const bool is_rod = model == "energy" || model == "exact";
  for (const std::int64_t row : {std::int64_t{0}, sweep.grid().size() - 1}) {
    try {
      const compare::Scene scene = sweep.scene(row);
      const bool lacks =
          !is_rod && !compare::neglected_by_polygon(scene, scene.force_model).empty();
      if (lacks) return warn_of_polygons(scene);
      if (compare::friction_in_reach(scene)) return warn_of_friction(scene);
    } catch (const compare::InputError&) {
      continue;
    }
  }
}

void warn_of_rows_without_result(const compare::SweepOutcome& outcome, const std::string& file) {
  if (outcome.without_result == 0) return;
  say("{}: {} of {} scenes have no result, the column status says why", file,
      outcome.without_result, outcome.rows);
}

void print_sweep(const SweepOptions& options, const compare::Sweep& sweep,
                 const std::optional<compare::Shard>& shard) {
  if (shard) write_standard_output(compare::sweep_identity(sweep, shard));
  write_standard_output(sweep.header());
  const std::int64_t rows = sweep.grid().size();
  compare::SweepOutcome outcome;
  std::vector<std::string> drawn;
  const auto print_row = [&](const std::string& line) {
    write_standard_output(line);
    if (options.plot.draws()) drawn.push_back(line);
    ++outcome.rows;
    if (!line.ends_with(",ok\n")) ++outcome.without_result;
  };
  sweep.run(shard ? compare::rows_of(*shard, rows) : compare::RowRange{0, rows}, options.threads,
            print_row);
  plot(options, sweep, drawn);
  warn_of_rows_without_result(outcome, "sweep");
}

void run_merge(const SweepOptions& options) {
  if (options.output.empty()) throw compare::InputError("--merge: -o FILE is required");
  if (!options.vary.empty() || !options.shard.empty()) {
    throw compare::InputError("--merge: takes the shards' files only (allowed: -o)");
  }
  warn_of_rows_without_result(compare::merge_sweep(options.files, options.output), options.output);
}

/// One --vary may be followed by several fields; what has a "=" is one of them, not a file.
void sort_words(SweepOptions& options) {
  const auto fields = std::stable_partition(
      options.files.begin(), options.files.end(),
      [](const std::string& word) { return word.find('=') == std::string::npos; });
  options.vary.insert(options.vary.end(), fields, options.files.end());
  options.files.erase(fields, options.files.end());
}

/// What a picture cannot be made of, before anything is computed.
void require_drawable(const SweepOptions& options) {
  options.plot.require_drawable({.format = "csv"});
  if (!options.plot.draws()) return;
  if (options.merge) {
    throw compare::InputError("--plot: not with --merge (allowed: with the sweep itself)");
  }
  if (options.vary.size() > 2) {
    throw compare::InputError(
        fmt::format("--plot: {} fields are varied (allowed: one or two)", options.vary.size()));
  }
}

void run(SweepOptions options, const std::vector<std::string>& inputs) {
  if (options.merge) {
    require_drawable(options);
    return run_merge(options);
  }
  if (!options.vary.empty()) sort_words(options);
  require_drawable(options);
  if (options.files.size() != 1) {
    throw compare::InputError(
        fmt::format("sweep: {} scene files given (allowed: 1)", options.files.size()));
  }
  if (options.vary.empty()) {
    throw compare::InputError(
        "sweep: no --vary FIELD=VALUES given (allowed: such as --vary gamma=1,10)");
  }
  const compare::Sweep sweep = sweep_of(options);
  if (options.plot.draws()) compare::require_drawable(swept_fields(sweep.grid()));
  warn_of_polygons_in(sweep, options.model);
  const std::optional<compare::Shard> shard = chosen_shard(options.shard);
  if (shard && options.plot.draws()) {
    throw compare::InputError(fmt::format(
        "--plot: shard {} has a part of the rows (allowed: the whole sweep)", shard->name()));
  }
  if (options.output.empty()) return print_sweep(options, sweep, shard);
  const std::string path = output_path(options.output, shard);
  check_output("--output", path, inputs);
  const compare::OutputTarget target = compare::output_target(path);
  if (target.kind == compare::OutputTarget::Kind::file) {
    check_output("--output", target.path + ".part", inputs);
  }
  bool was_resumed = false;
  const compare::SweepOutcome outcome = [&] {
    ProgressBar bar("sweep");
    const compare::SweepFileOptions file_options{
        .threads = options.threads,
        .restart = options.restart,
        .progress =
            [&](std::int64_t done, std::int64_t rows) {
              const std::int64_t rarely = rows / 1000 + 1;
              if (done % rarely == 0 || done == rows) bar.show(done, rows);
            },
        .resumed =
            [&](std::int64_t rows) {
              was_resumed = true;
              bar.remark(fmt::format("{}: resumed: {} rows kept", path, rows));
            }};
    return compare::write_sweep(sweep, shard, path, file_options);
  }();
  if (shard && outcome.rows > 0 && outcome.found == outcome.rows && !was_resumed) {
    say("{}: finished already, {} rows", path, outcome.rows);
  }
  warn_of_rows_without_result(outcome, path);
  if (options.plot.draws()) plot(options, sweep, rows_of_file(path, sweep.header()));
}

}  // namespace

void add_sweep(CLI::App& app) {
  CLI::App* command =
      app.add_subcommand("sweep", "a grid over any fields of a scene, as a table (CSV)");
  const auto options = std::make_shared<SweepOptions>();
  command->add_option("FILE", options->files, "scene file (TOML); with --merge the shards' files")
      ->required();
  command
      ->add_option("--vary", options->vary,
                   "a field and its values, once for each field: a dotted path such as "
                   "rod.length or gripper.0.direction, or gamma, which scales gravity; values "
                   "a,b,c or lin:a:b:n or log:a:b:n, with units as in scene files. The last field "
                   "changes fastest")
      ->type_name("FIELD=VALUES")
      ->allow_extra_args(false);
  command->add_option("--format", options->format, "csv")
      ->check(CLI::IsMember({"csv"}))
      ->capture_default_str();
  command->add_option("--model", options->model, compare::meanings<compare::SweepModel>())
      ->check(CLI::IsMember(compare::names<compare::SweepModel>()))
      ->capture_default_str();
  command
      ->add_option("-o,--output", options->output,
                   "write to FILE (FILE.part until it is finished; after a kill the same command "
                   "goes on there) instead of standard output; {shard} in it becomes 2-of-4")
      ->type_name("FILE");
  command->add_flag("--restart", options->restart, "throw away what an earlier run has left");
  command->add_option("--threads", options->threads, "0: all cores")
      ->check(CLI::Range(0, 4096))
      ->capture_default_str();
  command
      ->add_option("--shard", options->shard,
                   "compute part i of n, or none; default: what SLURM_ARRAY_TASK_ID and "
                   "OMPI_COMM_WORLD_RANK say")
      ->type_name("i/n");
  command->add_flag("--merge", options->merge, "put finished shards together");
  options->plot.add_to(*command, "the results over one field, or over two,", Sketches::none);
  options->scene.add_solvers_to(*command);
  // It varies what a file says, before that is a scene.
  command->remove_option(command->get_option("--calibrated"));
  command->footer(
      "Exit status is 0 also if rows have no result: a line on standard error counts them, their\n"
      "column status says why.\n"
      "Example:\n"
      "  dlo sweep data/scenes/spring_steel_175.toml --vary gamma=log:0.1:10:5 \\\n"
      "      --vary gripper.0.direction=\"-90 deg\",\"0 deg\" -o map.csv --plot map.svg\n"
      "In parts, then merged (mpirun and Slurm arrays choose --shard by themselves):\n"
      "  dlo sweep data/scenes/cable.toml --vary gamma=log:1:10:9 --shard 1/2 -o "
      "'part.{shard}.csv'\n"
      "  dlo sweep data/scenes/cable.toml --vary gamma=log:1:10:9 --shard 2/2 -o "
      "'part.{shard}.csv'\n"
      "  dlo sweep --merge part.*-of-*.csv -o all.csv");
  command->callback([options, command] { run(*options, input_files(*command)); });
}

}  // namespace dlo::cli
