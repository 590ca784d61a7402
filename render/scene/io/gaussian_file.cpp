#include "render/scene/io/gaussian_file.h"

#include <algorithm>
#include <bit>
#include <cassert>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <limits>

#include "base/input_error.h"
#include "render/scene/io/scan_values.h"
#include "render/scene/point_cloud.h"

namespace foci {
namespace {

static_assert(std::endian::native == std::endian::little);

constexpr std::uint64_t kMaxFile = std::uint64_t{1} << 32;

/// Standard deviations outside of these are no part of a scene, and their squares must stay finite.
constexpr float kMinSigma = 1e-9f, kMaxSigma = 1e6f;

bool isFinite(const glm::vec3& v) {
  return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

bool isNear(const glm::vec3& p) {  // false for NaN
  return std::abs(p.x) <= kFarthest_m && std::abs(p.y) <= kFarthest_m &&
         std::abs(p.z) <= kFarthest_m;
}

template <typename T>
T loadAt(std::span<const unsigned char> bytes, std::size_t at) {
  assert(at + sizeof(T) <= bytes.size());
  T value;
  std::memcpy(&value, bytes.data() + at, sizeof(T));
  return value;
}

}  // namespace

GaussianCollector::GaussianCollector(GaussianFile& file, std::size_t count, int degree)
    : file_(file) {
  assert(degree >= 0 && degree <= kMaxHarmonicsDegree);
  GaussianCloud& cloud = file.cloud;
  cloud.degree = degree;
  cloud.position_m.reserve(count);
  cloud.covariance_m2.reserve(count);
  cloud.opacity.reserve(count);
  cloud.color.reserve(count);
  cloud.harmonics.reserve(count * cloud.harmonicsPerGaussian());
}

void GaussianCollector::append(const RawGaussian& raw, std::span<const float> harmonics) {
  GaussianCloud& cloud = file_.cloud;
  assert(harmonics.size() == cloud.harmonicsPerGaussian());
  const bool sound = isNear(raw.position) && isFinite(raw.sigma) && std::isfinite(raw.opacity) &&
                     isFinite(raw.color) &&
                     std::all_of(harmonics.begin(), harmonics.end(),
                                 [](float value) { return std::isfinite(value); });
  if (!sound) {
    ++file_.dropped;
    return;
  }
  const float length2 = glm::dot(raw.rotation, raw.rotation);
  const bool rotated = length2 > 1e-12f && std::isfinite(length2);
  const glm::vec4 rotation =
      rotated ? raw.rotation / std::sqrt(length2) : glm::vec4(0.0f, 0.0f, 0.0f, 1.0f);
  cloud.position_m.push_back(raw.position);
  cloud.covariance_m2.push_back(
      covarianceOf(glm::clamp(raw.sigma, kMinSigma, kMaxSigma), rotation));
  cloud.opacity.push_back(std::clamp(raw.opacity, 0.0f, 1.0f));
  // Far beyond what a display shows, and small enough for sums to stay finite.
  constexpr float kMaxColor = 1000.0f;
  cloud.color.push_back(glm::clamp(raw.color, -kMaxColor, kMaxColor));
  constexpr float kMaxStep = std::numeric_limits<std::int16_t>::max();
  for (const float value : harmonics) {
    const float steps = std::clamp(value / kHarmonicsStep, -kMaxStep, kMaxStep);
    cloud.harmonics.push_back(static_cast<std::int16_t>(std::lrint(steps)));
  }
}

void GaussianCollector::finish(const std::string& path, bool fine) const {
  if (!file_.cloud.empty()) {
    if (!fine && file_.cloud.size() > 1 && losesDetail(file_.cloud.position_m)) {
      file_.remarks.emplace_back(
          "the Gaussians are so far from the origin that floats lose their detail: save them "
          "nearer to the origin, or as a PLY with coordinates in doubles");
    }
    if (std::all_of(file_.cloud.opacity.begin(), file_.cloud.opacity.end(),
                    [](float opacity) { return opacity <= kMinAlpha; })) {
      file_.remarks.emplace_back(
          "the opacity of all Gaussians is below 1/255, so none is seen: in a PLY, opacity is a "
          "logit");
    }
    return;
  }
  if (file_.dropped == 0) throw InputError(path, "has no Gaussians");
  throw InputError(path, file_.dropped == 1 ? "its only Gaussian has a value that is not finite"
                                            : "none of its " + std::to_string(file_.dropped) +
                                                  " Gaussians has finite values");
}

float sigmoid(float x) { return 1.0f / (1.0f + std::exp(-x)); }

float floatOfHalf(std::uint16_t half) {
  const unsigned exponent = (half >> 10) & 0x1fu, mantissa = half & 0x3ffu;
  float value = 0.0f;
  if (exponent == 0x1fu) {
    value = mantissa == 0 ? std::numeric_limits<float>::infinity()
                          : std::numeric_limits<float>::quiet_NaN();
  } else if (exponent == 0) {
    value = std::ldexp(static_cast<float>(mantissa), -24);
  } else {
    value = std::ldexp(static_cast<float>(mantissa | 0x400u), static_cast<int>(exponent) - 25);
  }
  return (half & 0x8000u) != 0 ? -value : value;
}

FileBytes::FileBytes(const std::filesystem::path& path) : name_(path.string()) {
  std::error_code error;
  if (!std::filesystem::exists(path, error)) throw InputError(name_, "no such file");
  requireRegularFile(path);
  const std::uint64_t size = std::filesystem::file_size(path, error);
  std::ifstream file(path, std::ios::binary);
  if (error || !file) throw InputError(name_, "cannot be read");
  if (size > kMaxFile) throw InputError(name_, "is larger than 4 GiB");
  bytes_.resize(size);
  file.read(reinterpret_cast<char*>(bytes_.data()), static_cast<std::streamsize>(size));
  if (static_cast<std::uint64_t>(file.gcount()) != size) throw InputError(name_, "cannot be read");
}

std::span<const unsigned char> FileBytes::part(std::uint64_t at, std::uint64_t count) const {
  if (at > bytes_.size() || count > bytes_.size() - at) {
    throw InputError(
        name_, "ends at byte " + std::to_string(bytes_.size()) + ", earlier than its header says");
  }
  return std::span(bytes_).subspan(at, count);
}

std::vector<unsigned char> firstBytes(const std::filesystem::path& path, std::size_t count) {
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(path, ignored)) return {};
  std::vector<unsigned char> bytes(count);
  std::ifstream file(path, std::ios::binary);
  file.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(count));
  bytes.resize(static_cast<std::size_t>(std::max<std::streamsize>(file.gcount(), 0)));
  return bytes;
}

std::uint16_t u16At(std::span<const unsigned char> bytes, std::size_t at) {
  return loadAt<std::uint16_t>(bytes, at);
}
std::uint32_t u32At(std::span<const unsigned char> bytes, std::size_t at) {
  return loadAt<std::uint32_t>(bytes, at);
}
std::uint64_t u64At(std::span<const unsigned char> bytes, std::size_t at) {
  return loadAt<std::uint64_t>(bytes, at);
}
float floatAt(std::span<const unsigned char> bytes, std::size_t at) {
  return loadAt<float>(bytes, at);
}

}  // namespace foci
