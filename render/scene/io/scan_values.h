// What readers of scans share: coordinates far from the origin, and intensity. Private to the
// readers.
#pragma once

#include <glm/glm.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "render/scene/point_cloud.h"

namespace foci {

/// Light of a point without a colour: sRGB 0.5.
inline constexpr float kUncolouredLight = 0.2140f;

/// An alpha of at most 1 of 255 everywhere is none: some exporters write 1 for opaque.
inline constexpr float kNoOpacity = 1.5f / 255.0f;

/// A remark on colours that are all 0, where the file has intensities, too.
inline constexpr const char* kGreyInstead = "all colours are 0: shown in grey";
inline constexpr const char* kIntensityInstead = "all colours are 0: intensity is shown as grey";

/// Linear light of an sRGB colour, which is clamped to 0 to 1; NaN becomes 0.
glm::vec3 linearColor(const glm::vec3& srgb);

/// A normal of length 1; 0 for one that has no length, or is not finite.
glm::vec3 unitNormal(const glm::dvec3& normal);

/// Whether a place is finite and no farther out than kFarthest_m.
bool isNearEnough(const glm::dvec3& p);

/// The origin for points near `p`: in whole thousands on each axis where `p` is 10,000 or farther
/// out, since a float at 10,000 has steps of 1 mm; 0 on others.
glm::dvec3 originNear(const glm::dvec3& p);

/// Adds a remark if the origin was moved.
void remarkOrigin(const glm::dvec3& origin, std::vector<std::string>& remarks);

/// Appends points whose coordinates may be as large as those of a map projection. The first
/// point decides the origin (`originNear`), and positions are relative to it.
class ScanPositions {
 public:
  explicit ScanPositions(PointCloud& points) : points_(points) {}

  /// @return false, with the point counted as dropped, if it is not finite or too far away
  bool append(const glm::dvec3& p);

  /// The same with the file's own origin.
  bool appendInPlace(const glm::dvec3& p);

  /// Adds a remark to the points if the origin was moved.
  /// @throws InputError if there are no points
  void finish(const std::string& file) const;

 private:
  PointCloud& points_;
  std::optional<glm::dvec3> origin_;
};

/// Whether places, not empty, are so far from the origin that the steps between floats there are
/// wider than what a screen shows of them.
bool losesDetail(std::span<const glm::vec3> position);

/// Adds a remark if x and y may be longitude and latitude in degrees: within 180, and a thousandth
/// of the range of z or less apart. A degree is 111 km, so a site is far wider than it is high.
void remarkDegrees(PointCloud& points);

/// Empties opacities that are all 1, or, with a remark, all 0: nobody saves points to hide them
/// all.
void dropPlainOpacity(PointCloud& points);

/// Adds a remark if the colours use a small part of their range only, and so are nearly black.
void remarkDark(PointCloud& points);

/// Shows intensities as grey. The 1 % quantile becomes black and the 99 % quantile white, in sRGB
/// code values. Equal intensities become the colour of points without one.
std::vector<glm::vec3> greyOf(const std::vector<float>& intensity);

}  // namespace foci
