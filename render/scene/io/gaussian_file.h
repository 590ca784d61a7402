// What the readers of 3D Gaussians share: the file as read, and checked values. See
// gaussian_formats.h for the formats.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <glm/glm.hpp>
#include <span>
#include <string>
#include <vector>

#include "render/scene/gaussian_cloud.h"

namespace foci {

/// Gaussians as a file holds them, in its own units.
struct GaussianFile {
  GaussianCloud cloud{};
  std::string format{};                ///< "compressed PLY", as messages name it
  bool y_is_up = false;                ///< else y points down, as in cameras: the usual convention
  std::size_t dropped = 0;             ///< Gaussians left out, because a value was not finite
  std::vector<std::string> remarks{};  ///< what the user should know, a sentence each
};

/// One Gaussian as the formats give it.
struct RawGaussian {
  glm::vec3 position{0.0f};
  glm::vec3 sigma{0.0f};                       ///< standard deviations along its axes
  glm::vec4 rotation{0.0f, 0.0f, 0.0f, 1.0f};  ///< quaternion (x, y, z, w) of any length
  float opacity = 1.0f;                        ///< 0 to 1
  glm::vec3 color{0.5f};                       ///< display value of degree 0
};

/// Appends Gaussians to a file, and leaves out those that no renderer could show.
class GaussianCollector {
 public:
  /// @param degree  of the harmonics, 0 to kMaxHarmonicsDegree (asserted)
  GaussianCollector(GaussianFile& file, std::size_t count, int degree);

  /// @param harmonics  of degree 1 and more: red, green and blue of each coefficient in turn; as
  ///                   many as the degree has
  void append(const RawGaussian& raw, std::span<const float> harmonics);

  /// Adds a remark if floats lose the positions' detail.
  /// @param fine  positions were doubles, taken relative to an origin nearby
  /// @throws InputError if no Gaussian is left
  void finish(const std::string& path, bool fine = false) const;

 private:
  GaussianFile& file_;
};

/// 1 / (1 + exp(-x)): opacities are stored as their logits.
float sigmoid(float x);

/// The 16-bit float of IEEE 754. Infinities and NaN stay so.
float floatOfHalf(std::uint16_t half);

/// A whole file in memory, read with checked bounds. Little endian.
class FileBytes {
 public:
  /// @throws InputError if there is no readable regular file, or it is larger than 4 GiB
  explicit FileBytes(const std::filesystem::path& path);
  /// Bytes that were unpacked from the file of this name.
  FileBytes(std::string name, std::vector<unsigned char> bytes)
      : name_(std::move(name)), bytes_(std::move(bytes)) {}

  const std::string& name() const { return name_; }
  std::size_t size() const { return bytes_.size(); }
  std::span<const unsigned char> all() const { return bytes_; }

  /// The part [at, at + count). @throws InputError if the file is shorter
  std::span<const unsigned char> part(std::uint64_t at, std::uint64_t count) const;

 private:
  std::string name_;
  std::vector<unsigned char> bytes_;
};

/// The first bytes of a file, at most `count`; fewer where the file is shorter or cannot be read.
std::vector<unsigned char> firstBytes(const std::filesystem::path& path, std::size_t count);

/// A value of `bytes`, which are at least as many (asserted).
std::uint16_t u16At(std::span<const unsigned char> bytes, std::size_t at);
std::uint32_t u32At(std::span<const unsigned char> bytes, std::size_t at);
std::uint64_t u64At(std::span<const unsigned char> bytes, std::size_t at);
float floatAt(std::span<const unsigned char> bytes, std::size_t at);

}  // namespace foci
