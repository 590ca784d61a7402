// What the readers of 3D Gaussians share: the file as read, and checked values. See
// gaussian_formats.h for the formats.
#pragma once

#include <array>
#include <cstddef>
#include <glm/glm.hpp>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "render/scene/gaussian_cloud.h"
#include "render/scene/io/file_bytes.h"

namespace foci {

struct PointCloud;
struct TriangleMesh;

/// Gaussians as a file holds them, in its own units.
struct GaussianFile {
  GaussianCloud cloud{};
  std::string format{};                ///< "compressed PLY", as messages name it
  bool y_is_up = false;                ///< else y points down, as in cameras: the usual convention
  std::size_t dropped = 0;             ///< Gaussians left out, because a value was not finite
  std::vector<std::string> remarks{};  ///< what the user should know, a sentence each
  std::optional<double> unit_m{};      ///< metres a unit, if the format says so
  /// Beside the Gaussians, in the same frame; null: none.
  std::shared_ptr<TriangleMesh> mesh{};
  std::shared_ptr<PointCloud> points{};
};

/// What the user should know of a file of degree 4, of which foci shows kMaxHarmonicsDegree.
inline constexpr const char* kDegree4 = "has harmonics of degree 4: degrees 0 to 3 are shown";

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

 private:
  GaussianFile& file_;
};

struct KnownGaussians {
  bool fine = false;          ///< positions were doubles, taken relative to an origin nearby
  bool knows_scales = false;  ///< a remark names what is odd in the scales
};

/// Adds remarks: on positions whose detail floats lose, on Gaussians that nobody sees, and on
/// Gaussians that are far larger than the distance to their neighbours.
/// @throws InputError if no Gaussian is left
void finishGaussians(GaussianFile& file, const std::string& path, const KnownGaussians& known = {});

/// The degree whose harmonics have so many values in all channels; 5 if none of 0 to 4 has.
int degreeOf(int values);

/// A quaternion of length 1 from three of its components. The one that is left out is positive.
std::array<float, 4> quaternionOf(const std::array<float, 3>& three, std::size_t left_out);

/// 1 / (1 + exp(-x)): opacities are stored as their logits.
float sigmoid(float x);

}  // namespace foci
