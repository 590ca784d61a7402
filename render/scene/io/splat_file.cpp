// antimatter15's `.splat`: see gaussian_formats.h. A record: position (3 floats), standard
// deviations (3 floats), red, green, blue and opacity (bytes), and a quaternion w x y z (bytes,
// 128 + 128 q).
#include <algorithm>

#include "base/input_error.h"
#include "render/scene/io/gaussian_formats.h"
#include "render/scene/point_cloud.h"

namespace foci {
namespace {

constexpr std::size_t kRecord = 32;

/// Records that are looked at, from the first on, to recognise a file without a header. Random
/// bytes pass as one record about once in 1000.
constexpr std::size_t kRecordsLookedAt = 64;

RawGaussian gaussianOf(std::span<const unsigned char> record) {
  const auto component = [&](std::size_t at) {
    return (static_cast<float>(record[at]) - 128.0f) / 128.0f;
  };
  return {.position = vec3At(record, 0),
          .sigma = vec3At(record, 12),
          .rotation = {component(29), component(30), component(31), component(28)},
          .opacity = static_cast<float>(record[27]) / 255.0f,
          .color = glm::vec3(record[24], record[25], record[26]) / 255.0f};
}

bool isText(unsigned char byte) {
  return (byte >= ' ' && byte <= '~') || byte == '\n' || byte == '\r' || byte == '\t';
}

/// Whether the values are those of a Gaussian: lengths in range, and a quaternion of length 1
/// within its rounding to bytes.
bool isSound(const RawGaussian& gaussian) {
  constexpr float kMaxSigma = 1e6f, kSlack = 0.05f;
  const auto inRange = [](float value, float low, float high) {
    return value >= low && value <= high;  // false for NaN
  };
  for (int axis = 0; axis < 3; ++axis) {
    if (!inRange(gaussian.position[axis], -kFarthest_m, kFarthest_m)) return false;
    if (!inRange(gaussian.sigma[axis], 0.0f, kMaxSigma)) return false;
  }
  return inRange(glm::length(gaussian.rotation), 1.0f - kSlack, 1.0f + kSlack);
}

}  // namespace

bool isSplatFile(const std::filesystem::path& path) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(path, error)) return false;
  const std::uintmax_t size = std::filesystem::file_size(path, error);
  if (error || size == 0 || size % kRecord != 0) return false;
  const std::vector<unsigned char> bytes = firstBytes(path, kRecordsLookedAt * kRecord);
  bool sound = bytes.size() >= kRecord && !std::ranges::all_of(bytes, isText);
  for (std::size_t at = 0; sound && at + kRecord <= bytes.size(); at += kRecord) {
    sound = isSound(gaussianOf(std::span(bytes).subspan(at, kRecord)));
  }
  return sound;
}

GaussianFile readSplatFile(const std::filesystem::path& path) {
  const FileBytes bytes(path);
  const std::size_t looked_at = std::min(bytes.size() / kRecord, kRecordsLookedAt);
  std::size_t sound = 0;
  for (std::size_t i = 0; i < looked_at; ++i) {
    sound += isSound(gaussianOf(bytes.part(i * kRecord, kRecord))) ? 1 : 0;
  }
  const bool is_text = std::ranges::all_of(bytes.all(), isText);
  if (2 * sound <= looked_at || is_text) {  // of a damaged file, most records are sound
    throw InputError(
        bytes.name(),
        "is no .splat file: expected records of 32 bytes, each with a rotation of length 1");
  }
  if (bytes.size() % kRecord != 0) {
    throw InputError(bytes.name(), "is cut off: ", bytes.size(),
                     " bytes: expected a multiple of 32");
  }
  GaussianFile file{.format = "splat"};
  GaussianCollector collector(file, bytes.size() / kRecord, 0);
  for (std::size_t at = 0; at < bytes.size(); at += kRecord) {
    collector.append(gaussianOf(bytes.part(at, kRecord)), {});
  }
  finishGaussians(file, bytes.name());
  return file;
}

}  // namespace foci
