#include "gaze/webcam/mesh_pose.h"

#include <algorithm>
#include <cmath>

namespace foci {
namespace {

/// Pairs of points that neither expression nor gaze moves much. They mirror each other, at the
/// image's left and right of a face that looks ahead.
constexpr std::array<std::array<std::size_t, 2>, 16> kPairs{{{33, 263},
                                                             {133, 362},
                                                             {127, 356},
                                                             {234, 454},
                                                             {34, 264},
                                                             {21, 251},
                                                             {54, 284},
                                                             {103, 332},
                                                             {67, 297},
                                                             {109, 338},
                                                             {116, 345},
                                                             {117, 346},
                                                             {111, 340},
                                                             {122, 351},
                                                             {193, 417},
                                                             {198, 420}}};

/// The line from the forehead (10) to the base of the nose (2) leans forwards by about this angle
/// in a face that looks ahead. It differs between people by some 0.1 rad, which a calibration
/// removes.
constexpr double kProfile_rad = 0.12;

/// Place of the eyes' corners in the head frame: behind the iris of an eye at rest.
constexpr double kCornerDepth_mm = -5.0;

glm::dvec3 middleOfCorners(const FaceMesh& mesh) {
  glm::dvec3 sum(0.0);
  for (const std::size_t corner : FaceMesh::kEyeCorners) sum += mesh.points[corner];
  return 0.25 * sum;
}

/// A mesh sees the head along the ray to it. Turns that ray's frame to the camera's, by the
/// shortest way.
glm::dmat3 turnTowards(const glm::dvec2& aside) {
  const glm::dvec3 z = glm::normalize(glm::dvec3(aside, 1.0));
  const glm::dvec3 x =
      glm::dvec3(1.0, 0.0, 0.0) - z.x / (1.0 + z.z) * glm::dvec3(z.x, z.y, z.z + 1.0);
  return {x, glm::cross(z, x), z};
}

}  // namespace

std::optional<HeadPose> poseOfMesh(const Pinhole& camera, const FaceMesh& mesh) {
  const auto& corner = FaceMesh::kEyeCorners;
  const glm::dvec3 eyes_px = 0.5 * (mesh.points[corner[2]] + mesh.points[corner[3]] -
                                    mesh.points[corner[0]] - mesh.points[corner[1]]);
  const double px_per_mm = glm::length(eyes_px) / kMeanIpd_mm;
  if (!(px_per_mm > 0.01)) return std::nullopt;
  glm::dvec3 across(0.0);
  for (const auto& pair : kPairs) across += mesh.points[pair[1]] - mesh.points[pair[0]];
  const glm::dvec3 x = glm::normalize(across);
  glm::dvec3 down = mesh.points[2] - mesh.points[10];
  down = glm::normalize(down - glm::dot(down, x) * x);
  const glm::dvec3 into = glm::cross(x, down);
  const glm::dvec3 y = std::cos(kProfile_rad) * down + std::sin(kProfile_rad) * into;
  const glm::dvec3 middle = middleOfCorners(mesh);
  const glm::dvec2 aside = (glm::dvec2(middle) - camera.principal_px) / camera.focal_px;
  HeadPose pose;
  pose.camera_from_head = turnTowards(aside) * glm::dmat3(x, y, glm::cross(x, y));
  if (!std::isfinite(glm::determinant(pose.camera_from_head))) return std::nullopt;
  pose.position_mm = camera.focal_px.x / px_per_mm * glm::dvec3(aside, 1.0) -
                     pose.camera_from_head * glm::dvec3(0.0, 0.0, kCornerDepth_mm);
  return pose;
}

}  // namespace foci
