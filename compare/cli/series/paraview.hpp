#pragma once

#include <string>

#include "motion/dynamic_track.hpp"
#include "series/track_series.hpp"

namespace dlo::cli {

/// Writes frames for ParaView: the series file, which tells the times, and beside it a polyline a
/// frame, as `NAME_0000.vtk` of NAME.vtk.series. The series comes last, when all of it is there.
/// @param dynamic  its moving rod, whose shapes are written then, or null
/// @throws compare::OutputError naming what cannot be written
void write_series(const compare::Track& track, const compare::Scene& scene,
                  const TrackFrames& frames, const std::string& file,
                  const compare::DynamicTrack* dynamic = nullptr);

}  // namespace dlo::cli
