// The formats of recordings that are more than one table: how a file is recognised, what reads it,
// and which other files belong to it. A table of a vendor is a row in vendor_tables.cpp or
// space_formats.cpp instead.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "gaze/sources/rows.h"
#include "gaze/sources/trace_reader.h"

namespace foci {

/// A recording, and what the study says of its columns.
class RecordingFile {
 public:
  /// @param columns  outlives the object
  RecordingFile(std::filesystem::path path, const TraceColumns& columns)
      : path_(std::move(path)), columns_(columns) {}

  const std::filesystem::path& path() const { return path_; }
  const TraceColumns& columns() const { return columns_; }
  /// The first line that is not empty. @throws InputError
  const std::string& firstLine() const;
  /// Whether the study leaves it to the file which columns hold time and gaze.
  bool isUndescribed() const {
    return columns_.time.empty() && columns_.x.empty() && !columns_.space.hasSight();
  }

 private:
  std::filesystem::path path_;
  const TraceColumns& columns_;
  mutable std::optional<std::string> first_line_{};
};

struct RecordingFormat {
  const char* name = nullptr;  ///< null: a plain table
  /// @throws InputError if the file cannot be read
  bool (*is)(const RecordingFile& file) = nullptr;
  /// Reads as `streamTrace`. @throws InputError
  TraceHeader (*read)(const RecordingFile& file, const Screen& fallback_screen,
                      const TakeSample& take) = nullptr;
  /// As `companionsOf`; null: none.
  std::vector<std::filesystem::path> (*companions)(const std::filesystem::path& file) = nullptr;
  /// As `previewSpace`; null: no head.
  SpacePreview (*preview)(const std::filesystem::path& file) = nullptr;
};

extern const RecordingFormat kNeonNative, kTobiiGlasses, kBids, kXdf, kEyeLinkAsc, kEyeNavGs,
    kHoloLens, kAria;

/// What the file is and what to do with it; nothing if it may be a recording as text.
/// @param start  the first bytes of the file, unpacked; 64 are enough
/// @param name   its ending distinguishes formats without a magic number
std::optional<std::string> otherFileKind(std::string_view start, const std::filesystem::path& name);

/// The first bytes of a file, unpacked; empty if it cannot be read.
std::string unpackedStart(const std::filesystem::path& file, std::size_t count);

/// @throws InputError if the file is no text that may hold gaze; a file that cannot be read passes
void requireGazeText(const std::filesystem::path& file);

/// Whether all of the screen's quantities are known.
bool isMetric(const Screen& screen);

/// What the recording states of the screen; the rest from the fallback.
Screen screenInForce(Screen screen, const Screen& fallback);

/// The columns of a recording of gaze in the world, y up, z back: "time", "head x" ... "head qw".
std::vector<std::string> worldColumnNames();
/// With these, what the study says of the rest.
TraceColumns worldColumns(TraceColumns columns, double time_scale_s);

/// The warning of positions on the image of a scene camera.
inline constexpr const char* kOfSceneCamera =
    "positions are those of a scene camera on the head: foci takes its view for the screen, "
    "which holds only for a head at rest; a gaze map (foci calibrate gaze) corrects this";

/// Reads rows as `streamTrace` describes.
/// @param fallback_screen  for what `rows.before()` does not state
/// @throws InputError; SeveralPeople
TraceHeader readRows(Rows& rows, const TraceColumns& columns, const Screen& fallback_screen,
                     const TakeSample& take);

}  // namespace foci
