// Maps of a frame: its light, and what each pixel's surface is to the eye.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "app/platform/output_files.h"
#include "app/study/study.h"
#include "render/image/frame.h"

namespace foci {

/// `FrameMap::defocus` by pixel. @param frame  with depth along the line of sight
std::vector<float> defocusMap_D(const Frame& frame, double focus_D);

/// "depth-000012.exr"
std::string mapFileName(FrameMap map, std::size_t frame);

/// Stages the maps of a frame. @return where they are staged, in the order of `maps`
std::vector<std::filesystem::path> stageMaps(const std::vector<FrameMap>& maps, std::size_t frame,
                                             const Frame& rendered, double focus_D,
                                             OutputFolder& folder);

}  // namespace foci
