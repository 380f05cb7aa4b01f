#include "series/paraview.hpp"

#include <fmt/format.h>

#include <filesystem>

#include "base/output_file.hpp"
#include "format/json.hpp"
#include "option/output.hpp"
#include "shape/write_vtk.hpp"
#include "trajectory/series_files.hpp"

namespace dlo::cli {

void write_series(const compare::Track& track, const compare::Scene& scene,
                  const TrackFrames& frames, const std::string& file,
                  const compare::DynamicTrack* dynamic) {
  namespace fs = std::filesystem;
  const std::string stem = compare::series_stem(file);
  const fs::path folder = fs::path(file).parent_path();
  Json files = Json::array();
  for (const std::size_t i : frames.of(track)) {
    if (dynamic != nullptr && i >= dynamic->frames.size()) break;
    const compare::TrackFrame& frame = track.frames[i];
    const Eigen::Matrix3Xd& points =
        dynamic != nullptr ? dynamic->frames[i].points : frame.shape.points;
    const std::string name = fmt::format("{}_{:05}.vtk", stem, i);
    compare::write_file(
        (folder / name).string(),
        compare::vtk_polyline({track.arc_length, points}, {},
                              fmt::format("{}, t = {:.9g} s", scene.name, frame.time)));
    files.push_back({{"name", name}, {"time", frame.time}});
  }
  compare::write_file(file,
                      json_text({{"file-series-version", "1.0"}, {"files", std::move(files)}}));
}

}  // namespace dlo::cli
