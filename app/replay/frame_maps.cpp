#include "app/replay/frame_maps.h"

#include <limits>

#include "app/study/study_words.h"
#include "base/text.h"
#include "render/image/image_file.h"

namespace foci {

std::vector<float> defocusMap_D(const Frame& frame, double focus_D) {
  std::vector<float> map_D(frame.depth_m.size());
  for (std::size_t p = 0; p < map_D.size(); ++p) {
    map_D[p] = frame.depth_m[p] > 0.0f
                   ? static_cast<float>(1.0 / static_cast<double>(frame.depth_m[p]) - focus_D)
                   : std::numeric_limits<float>::quiet_NaN();
  }
  return map_D;
}

namespace {

void write(const std::filesystem::path& file, FrameMap map, const Frame& frame, double focus_D) {
  if (map == FrameMap::light) return writeImage(file, frame);
  writeMap(file, frame.size_px,
           map == FrameMap::depth ? frame.depth_m : defocusMap_D(frame, focus_D));
}

}  // namespace

std::string mapFileName(FrameMap map, std::size_t frame) {
  return std::string(studyWord(map)) + printed("-%06zu.exr", frame);
}

std::vector<std::filesystem::path> stageMaps(const std::vector<FrameMap>& maps, std::size_t frame,
                                             const Frame& rendered, double focus_D,
                                             OutputFolder& folder) {
  std::vector<std::filesystem::path> staged;
  staged.reserve(maps.size());
  for (const FrameMap map : maps) {
    staged.push_back(folder.stage(mapFileName(map, frame)));
    write(staged.back(), map, rendered, focus_D);
  }
  return staged;
}

}  // namespace foci
