// HoloLens 2: *_head_hand_eye.csv of Microsoft's Stream Recorder (HoloLens2ForCV). A row has the
// time in 100 ns and the head's transform to the world (4 x 4, row by row). For each hand a flag
// and 26 transforms follow. Then come a flag for gaze, its origin and direction (4 numbers each),
// and its distance. The world is right-handed with y up, in metres; gaze is in the world.

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

#include "base/text.h"
#include "gaze/sources/recording_formats.h"

namespace foci {
namespace {

constexpr std::size_t kTransform = 16, kHand = 1 + 26 * kTransform;
constexpr std::size_t kHeadAt = 1, kGazeAt = kHeadAt + kTransform + 2 * kHand;
constexpr std::size_t kFields = kGazeAt + 1 + 4 + 4 + 1;
constexpr double kTick_s = 1e-7, kRigid = 1e-3;

/// The time from 0 in ticks, the head in the world and the direction of gaze there.
using HoloLensRow = std::array<double, 11>;

/// Takes the head into a row. A transform of zeros: the head was not tracked.
void takeHoloLensHead(NamedTable& table, HoloLensRow& row) {
  glm::dmat3 turn(0.0);
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) {
      turn[static_cast<int>(j)][static_cast<int>(i)] = table.needed(kHeadAt + 4 * i + j);
    }
  }
  if (turn == glm::dmat3(0.0)) return;
  const glm::dmat3 product = glm::transpose(turn) * turn;
  double error = std::abs(glm::determinant(turn) - 1.0);
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) error = std::max(error, std::abs(product[i][j] - (i == j)));
  }
  if (!(error <= kRigid)) {
    throw table.error("columns 2 to 17: expected a rigid transform of the head, row by row");
  }
  const glm::dquat q = glm::quat_cast(turn);
  for (std::size_t i = 0; i < 3; ++i) row[1 + i] = table.needed(kHeadAt + 4 * i + 3);
  row[4] = q.x, row[5] = q.y, row[6] = q.z, row[7] = q.w;
}

NumberRows holoLensRows(NamedTable& table) {
  std::vector<double> values;
  std::optional<double> start_ticks;
  while (table.next()) {
    HoloLensRow row;
    row.fill(std::numeric_limits<double>::quiet_NaN());
    const double ticks = table.needed(0);
    if (!start_ticks) start_ticks = ticks;
    row[0] = ticks - *start_ticks;
    takeHoloLensHead(table, row);
    for (std::size_t i = 0; table.needed(kGazeAt) == 1.0 && i < 3; ++i)
      row[8 + i] = table.needed(kGazeAt + 5 + i);
    values.insert(values.end(), row.begin(), row.end());
  }
  std::vector<std::string> names = worldColumnNames();
  for (const char* axis : {"gaze x", "gaze y", "gaze z"}) names.emplace_back(axis);
  return {table.fileName(), std::move(names), std::move(values)};
}

TraceHeader readHoloLens(const RecordingFile& file, const Screen& fallback_screen,
                         const TakeSample& take) {
  NamedTable table(file.path(), kFields);
  NumberRows rows = holoLensRows(table);
  TraceColumns columns = worldColumns(file.columns(), kTick_s);
  if (!columns.space.from_head) columns.space.both.direction = {"gaze x", "gaze y", "gaze z"};
  columns.space.head_scale_m = columns.space.origin_scale_m = 1.0;
  TraceHeader header = readRows(rows, columns, fallback_screen, take);
  const std::string sure = "certain: a column of Stream Recorder";
  header.format = "HoloLens 2, Stream Recorder";
  header.columns = {{"#1", "time, a unit is 1e-07 s, here from 0", sure},
                    {"#2 to #17", "transform of the head to the world, m", sure},
                    {"#18 to #851", "unused", ""},
                    {"#852", "whether there is gaze", sure},
                    {"#853 to #856", "unused", ""},
                    {"#857 to #860", "direction of gaze in the world", sure},
                    {"#861", "unused", ""}};
  if (table.isCut()) header.warnings.emplace_back(kCutOff);
  return header;
}

/// The table has no header: its 861 numbers a row tell it.
bool isHoloLens(const RecordingFile& file) {
  std::vector<std::string_view> fields;
  splitFields(file.firstLine(), ',', fields);
  return file.isUndescribed() && fields.size() == kFields && parseNumber(fields[0]) &&
         parseNumber(fields[kGazeAt]);
}

}  // namespace

const RecordingFormat kHoloLens{
    .name = "HoloLens 2",
    .is = isHoloLens,
    .read = readHoloLens,
    .preview = [](const std::filesystem::path&) { return SpacePreview{.has_head = true}; }};

}  // namespace foci
