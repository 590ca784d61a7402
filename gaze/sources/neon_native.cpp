#include "gaze/sources/neon_native.h"

#include <bit>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <iterator>

#include "base/input_error.h"
#include "base/text.h"

namespace foci {
namespace {

namespace fs = std::filesystem;

static_assert(std::endian::native == std::endian::little);

constexpr int kMaxParts = 99;
constexpr std::size_t kMaxSample_B = 256;  // x, y and what later versions add

fs::path partOf(const fs::path& folder, const char* stream, int part, const char* ending) {
  return folder / (std::string(stream) + " ps" + std::to_string(part) + ending);
}

fs::path folderOf(const fs::path& path) {
  std::error_code unreadable;
  if (fs::is_directory(path, unreadable)) return path;
  return path.filename() == "gaze ps1.raw" ? path.parent_path() : fs::path();
}

bool isFile(const fs::path& file) {
  std::error_code unreadable;
  return fs::is_regular_file(file, unreadable);
}

std::string bytesIn(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

template <class Number>
Number numberAt(const std::string& bytes, std::size_t at) {
  Number value;
  std::memcpy(&value, bytes.data() + at, sizeof value);
  return value;
}

void appendPart(const fs::path& folder, int part, std::string& table) {
  const fs::path raw_file = partOf(folder, "gaze", part, ".raw");
  const std::string raw = bytesIn(raw_file);
  const std::string times = bytesIn(partOf(folder, "gaze", part, ".time"));
  const std::string worn = bytesIn(partOf(folder, "worn", part, ".raw"));
  const std::size_t count = times.size() / sizeof(std::int64_t);
  const std::size_t sample_B = count > 0 ? raw.size() / count : 0;
  if (count == 0 || times.size() % sizeof(std::int64_t) != 0 || raw.size() % count != 0 ||
      sample_B < 2 * sizeof(float) || sample_B > kMaxSample_B) {
    throw InputError(raw_file.string(), std::to_string(raw.size()) + " bytes of gaze for " +
                                            std::to_string(count) +
                                            " times: expected 8 or more for each");
  }
  for (std::size_t i = 0; i < count; ++i) {
    const auto x_px = numberAt<float>(raw, i * sample_B);
    const auto y_px = numberAt<float>(raw, i * sample_B + sizeof(float));
    table += ",," + std::to_string(numberAt<std::int64_t>(times, i * sizeof(std::int64_t))) + ',' +
             exactText(static_cast<double>(x_px)) + ',' + exactText(static_cast<double>(y_px)) +
             (i < worn.size() && worn[i] == 0 ? ",0\n" : ",1\n");
  }
}

}  // namespace

std::vector<fs::path> neonNativeFiles(const fs::path& path) {
  std::vector<fs::path> files;
  const fs::path folder = folderOf(path);
  for (int part = 1; part <= kMaxParts; ++part) {
    const fs::path raw = partOf(folder, "gaze", part, ".raw");
    const fs::path time = partOf(folder, "gaze", part, ".time");
    if (folder.empty() || !isFile(raw) || !isFile(time)) break;
    files.push_back(raw);
    files.push_back(time);
    if (const fs::path worn = partOf(folder, "worn", part, ".raw"); isFile(worn)) {
      files.push_back(worn);
    }
  }
  return files;
}

std::string neonNativeTable(const fs::path& path) {
  std::string table = "section id,recording id,timestamp [ns],gaze x [px],gaze y [px],worn\n";
  const fs::path folder = folderOf(path);
  for (int part = 1; part <= kMaxParts; ++part) {
    if (!isFile(partOf(folder, "gaze", part, ".raw"))) break;
    appendPart(folder, part, table);
  }
  return table;
}

}  // namespace foci
