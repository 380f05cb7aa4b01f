#pragma once

#include <string>

#include "series/track.hpp"

namespace dlo::cli {

/// Writes frames for ParaView: the series file, which tells the times, and beside it a polyline a
/// frame, as `NAME_0000.vtk` of NAME.vtk.series. The series comes last, when all of it is there.
/// @throws compare::OutputError naming what cannot be written
void write_series(const compare::Track& track, const compare::Scene& scene,
                  const TrackFrames& frames, const std::string& file);

}  // namespace dlo::cli
