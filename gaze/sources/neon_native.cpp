// Neon's native recording folder, as the Companion app writes it (docs.pupil-labs.com/neon) and as
// pl-neon-recording reads it. gaze_200hz.raw with .time where Pupil Cloud has computed it, else
// `gaze psN.raw` for N = 1, 2, ..., begin each sample with x and y as 32-bit floats, pixels of the
// scene camera; .time has nanoseconds as 64-bit integers; `worn` a byte, 0 where nobody wears the
// glasses. `eye_state` has 14 floats and more: the left pupil's diameter (mm), the eyeball's centre
// (mm) and the direction of its optical axis in the frame of the scene camera, then those of the
// right eye. The columns get the names of Neon's exports.

#include <algorithm>
#include <bit>
#include <cstdint>
#include <cstring>
#include <limits>
#include <optional>
#include <utility>

#include "base/file.h"
#include "base/input_error.h"
#include "base/text.h"
#include "gaze/sources/recording_formats.h"

namespace foci {
namespace {

namespace fs = std::filesystem;

static_assert(std::endian::native == std::endian::little);

constexpr std::size_t kMaxSample_B = 256;  // with what later versions add
constexpr std::size_t kEyeNumbers = 14;
constexpr std::int64_t kSameTime_ns = 10'000'000;  // two frames of the eye cameras
constexpr const char* kGaze200 = "gaze_200hz";

bool isFile(const fs::path& file) {
  std::error_code unreadable;
  return fs::is_regular_file(file, unreadable);
}

/// The N of "STREAM psN.ENDING"; 0: another name.
int partIn(const std::string& name) {
  const std::size_t mark = name.rfind(" ps"), end = name.find('.', mark);
  if (end == name.npos) return 0;
  return std::max(parseInteger<int>(name.substr(mark + 3, end - mark - 3)).value_or(0), 0);
}

std::string partName(const char* stream, int part) {
  return std::string(stream) + " ps" + std::to_string(part);
}

/// A recording's folder.
struct Folder {
  fs::path path{};
  int parts = 0;  // of any stream; parts of one that are missing were lost
  bool has_gaze = false;

  explicit Folder(const fs::path& given) {
    std::error_code unreadable;
    const std::string name = given.filename().string();
    const bool is_gaze = name.starts_with("gaze ps") || name.starts_with(kGaze200);
    if (fs::is_directory(given, unreadable)) {
      path = given;
    } else if (is_gaze && given.extension() == ".raw") {
      path = given.parent_path().empty() ? "." : given.parent_path();
    } else {
      return;
    }
    for (const auto& entry : fs::directory_iterator(path, unreadable)) {
      const std::string each = entry.path().filename().string();
      parts = std::max(parts, partIn(each));
      has_gaze |= (each.starts_with("gaze ps") && partIn(each) > 0) ||
                  each.starts_with(std::string(kGaze200) + ".");
    }
  }

  bool hasAny(const std::string& stem) const {
    return isFile(path / (stem + ".raw")) || isFile(path / (stem + ".time"));
  }

  /// The names of a stream's files, without their endings.
  std::vector<std::string> stemsOf(const char* stream) const {
    std::vector<std::string> stems;
    for (int part = 1; part <= parts; ++part) {
      if (hasAny(partName(stream, part))) stems.push_back(partName(stream, part));
    }
    return stems;
  }

  /// Of gaze: parts that are missing are among them.
  std::vector<std::string> gazeStems() const {
    if (hasAny(kGaze200)) return {kGaze200};
    std::vector<std::string> stems;
    for (int part = 1; part <= parts; ++part) stems.push_back(partName("gaze", part));
    return stems;
  }
};

std::string bytesIn(const fs::path& file) {
  if (!fs::exists(file)) {
    throw InputError(file.string(), "is missing: expected all files of the recording's folder");
  }
  return bytesOfFile(file, std::numeric_limits<std::uintmax_t>::max());
}

template <class Number>
Number numberAt(const std::string& bytes, std::size_t at) {
  Number value;
  std::memcpy(&value, bytes.data() + at, sizeof value);
  return value;
}

/// Samples of a stream, with their times.
struct NeonSamples {
  std::vector<std::int64_t> times_ns{};
  std::vector<float> numbers{};  // the first ones of each sample
};

void appendPart(const Folder& folder, const std::string& stem, std::size_t numbers,
                NeonSamples& samples) {
  const fs::path raw_file = folder.path / (stem + ".raw");
  const std::string raw = bytesIn(raw_file);
  const std::string times = bytesIn(folder.path / (stem + ".time"));
  const std::size_t count = times.size() / sizeof(std::int64_t);
  const std::size_t sample_B = count > 0 ? raw.size() / count : 0;
  if (count == 0 || times.size() % sizeof(std::int64_t) != 0 || raw.size() % count != 0 ||
      sample_B < numbers * sizeof(float) || sample_B > kMaxSample_B) {
    throw InputError(raw_file.string(), std::to_string(raw.size()) + " bytes for " +
                                            std::to_string(count) + " times: expected " +
                                            std::to_string(numbers * sizeof(float)) +
                                            " or more for each");
  }
  for (std::size_t i = 0; i < count; ++i) {
    samples.times_ns.push_back(numberAt<std::int64_t>(times, i * sizeof(std::int64_t)));
    for (std::size_t k = 0; k < numbers; ++k) {
      samples.numbers.push_back(numberAt<float>(raw, i * sample_B + k * sizeof(float)));
    }
  }
}

/// A byte for each sample of a part; an empty one where there is no file.
std::string wornIn(const Folder& folder, const std::string& stem, std::size_t count) {
  const std::string name =
      stem == kGaze200 ? "worn_200hz.raw" : "worn" + stem.substr(stem.find(' ')) + ".raw";
  const fs::path file = folder.path / name;
  std::string worn = isFile(file) ? bytesIn(file) : std::string(count, '\xff');
  if (worn.size() != count) {
    throw InputError(file.string(), std::to_string(worn.size()) + " bytes for " +
                                        std::to_string(count) + " times of gaze");
  }
  return worn;
}

/// The number of the sample nearest in time; nothing if it is of another moment.
std::optional<std::size_t> nearestTo(const std::vector<std::int64_t>& times_ns,
                                     std::int64_t time_ns) {
  if (times_ns.empty()) return std::nullopt;
  auto at = std::ranges::lower_bound(times_ns, time_ns);
  if (at == times_ns.end() || (at != times_ns.begin() && time_ns - *(at - 1) < *at - time_ns)) --at;
  if (std::max(*at, time_ns) - std::min(*at, time_ns) > kSameTime_ns) return std::nullopt;
  return static_cast<std::size_t>(at - times_ns.begin());
}

std::vector<std::string> eyeColumns() {
  std::vector<std::string> columns;
  for (const std::string side : {"left", "right"}) {
    columns.push_back("pupil diameter " + side + " [mm]");
    for (const char* axis : {"x", "y", "z"}) {
      columns.push_back("eyeball center " + side + ' ' + axis + " [mm]");
    }
    for (const char* axis : {"x", "y", "z"}) {
      columns.push_back("optical axis " + side + ' ' + axis);
    }
  }
  return columns;
}

/// The files that are read; none if `path` is no such folder, nor one of its files of gaze.
std::vector<fs::path> neonNativeFiles(const fs::path& path) {
  const Folder folder(path);
  std::vector<fs::path> files;
  if (!folder.has_gaze) return files;
  std::vector<std::string> stems = folder.gazeStems();
  for (const char* stream : {"eye_state", "worn"}) {
    for (std::string& stem : folder.stemsOf(stream)) stems.push_back(std::move(stem));
  }
  if (stems.front() == kGaze200) stems.emplace_back("worn_200hz");
  for (const std::string& stem : stems) {
    for (const char* ending : {".raw", ".time"}) {
      if (isFile(folder.path / (stem + ending))) files.push_back(folder.path / (stem + ending));
    }
  }
  return files;
}

NumberRows neonRows(const fs::path& path) {
  const Folder folder(path);
  std::vector<std::string> columns{"timestamp [ns]", "gaze x [px]", "gaze y [px]", "worn"};
  std::vector<double> values;
  NeonSamples eyes;
  for (const std::string& stem : folder.stemsOf("eye_state")) {
    appendPart(folder, stem, kEyeNumbers, eyes);
  }
  const bool has_eyes = std::ranges::is_sorted(eyes.times_ns) && !eyes.times_ns.empty();
  if (has_eyes) {
    for (std::string& column : eyeColumns()) columns.push_back(std::move(column));
  }
  for (const std::string& stem : folder.gazeStems()) {
    NeonSamples gaze;
    appendPart(folder, stem, 2, gaze);
    const std::string worn = wornIn(folder, stem, gaze.times_ns.size());
    for (std::size_t i = 0; i < gaze.times_ns.size(); ++i) {
      const std::int64_t time_ns = gaze.times_ns[i];
      values.push_back(static_cast<double>(time_ns));
      values.push_back(static_cast<double>(gaze.numbers[2 * i]));
      values.push_back(static_cast<double>(gaze.numbers[2 * i + 1]));
      values.push_back(worn[i] == 0 ? 0.0 : 1.0);
      if (!has_eyes) continue;
      const auto eye = nearestTo(eyes.times_ns, time_ns);
      for (std::size_t k = 0; k < kEyeNumbers; ++k) {
        values.push_back(eye ? static_cast<double>(eyes.numbers[*eye * kEyeNumbers + k])
                             : std::numeric_limits<double>::quiet_NaN());
      }
    }
  }
  return {path.string(), std::move(columns), std::move(values)};
}

TraceHeader readNeonNative(const RecordingFile& file, const Screen& fallback_screen,
                           const TakeSample& take) {
  NumberRows rows = neonRows(file.path());
  TraceHeader header = readRows(rows, file.columns(), fallback_screen, take);
  header.format = "Neon, native recording";
  return header;
}

}  // namespace

const RecordingFormat kNeonNative{
    .name = "Neon",
    .is = [](const RecordingFile& file) { return !neonNativeFiles(file.path()).empty(); },
    .read = readNeonNative,
    .companions =
        [](const fs::path& file) {
          std::vector<fs::path> files = neonNativeFiles(file);
          std::erase(files, file);
          return files;
        }};

}  // namespace foci
