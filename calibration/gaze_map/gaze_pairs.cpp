#include "calibration/gaze_map/gaze_pairs.h"

#include "base/input_error.h"
#include "gaze/sources/rows.h"

namespace foci {
namespace {

constexpr std::size_t kMaxRows = 2'000'000;
constexpr double kMaxGaze = 1e6;

struct Range {
  double low, high;
};

Range targetRange(MapUnits units) {
  switch (units) {
    case MapUnits::deg:
      return {-80.0, 80.0};
    case MapUnits::norm:
      return {-1.0, 2.0};
    case MapUnits::direction:
      return {-6.0, 6.0};
  }
  return {0.0, 0.0};
}

}  // namespace

std::vector<GazePair> readGazePairs(const std::filesystem::path& file, MapUnits units) {
  NamedTable table(file, "a header row x y x_target y_target");
  const std::size_t x = table.column("x"), y = table.column("y");
  const std::size_t x_target = table.column("x_target"), y_target = table.column("y_target");
  const auto time = table.find("time_s"), weight = table.find("weight");
  const auto [low, high] = targetRange(units);
  std::vector<GazePair> pairs;
  while (table.next()) {
    if (pairs.size() == kMaxRows) {
      throw table.error("more than 2 million rows: not a calibration");
    }
    const auto gaze_x = table.position(x, 0, -kMaxGaze, kMaxGaze);
    const auto gaze_y = table.position(y, 1, -kMaxGaze, kMaxGaze);
    const auto target_x = table.number(x_target, low, high);
    const auto target_y = table.number(y_target, low, high);
    if (!target_x || !target_y) throw table.error("a row without a target");
    GazePair pair{.target = {*target_x, *target_y}};
    if (gaze_x && gaze_y) pair.gaze = glm::dvec2(*gaze_x, *gaze_y);
    if (time) pair.time_s = table.number(*time, -1e12, 1e12);
    if (weight) pair.weight = table.number(*weight, 0.0, 1e9).value_or(1.0);
    pairs.push_back(pair);
  }
  if (pairs.empty()) throw InputError(table.fileName(), "no rows below the header");
  return pairs;
}

}  // namespace foci
