// Built-in scenes, made of parametric surfaces sampled evenly. The same bytes on every run.
#pragma once

#include <cstddef>
#include <glm/glm.hpp>
#include <string>
#include <vector>

#include "render/scene/surfel_cloud.h"

namespace foci {

/// Where an eye stands and looks; what `eyeFromWorld` takes.
struct EyePose {
  glm::vec3 position_m;
  glm::vec3 target_m;
  glm::vec3 up{0.0f, 1.0f, 0.0f};
};

/// The paper's textured plane (Table 1, Figure 6): a square of `samples` x `samples` surfels,
/// `side_m` long, in the plane y = 0, its centre at the origin. @param samples  > 0
SurfelCloud makePlane(int samples = 512, float side_m = 2.0f);

/// A pose that sees the plane tilted away, as in the paper's Figure 6.
EyePose planeEyePose();

/// A gallery: things from 0.25 to 6 m from the eye, fine texture everywhere, thin structures in
/// front, a half-transparent mask before a figure (the paper's Figure 1). y up, floor at y = 0,
/// sampled for an eye near `galleryEyePose()`.
/// @param step_px  distance of surfels for that eye, of pixels of 0.39 mm 0.6 m away, > 0: half a
///                 million at 1.8, two million at 0.9
SurfelCloud makeGallery(float step_px = 1.8f);

EyePose galleryEyePose();

/// As many as the paper's lion has.
inline constexpr std::size_t kStatueSurfels = 81458;

/// A stone lion, about a metre tall, with its plinth on y = 0 and its face towards +z, where the
/// paper has a scanned one: sampled evenly, normals outwards, weights solved.
SurfelCloud makeStatue();

/// A pose that sees the statue from its left front.
EyePose statueEyePose();

/// Wires and slats 0.5 to 4 mm wide, half a metre from the eye, before a textured wall 1.5 m away.
SurfelCloud makeFence();

/// The eye at the origin, looking at the wall's middle along -z.
EyePose fenceEyePose();

struct PointOfInterest {
  std::string name;   ///< "lattice", "bust", ...
  glm::vec3 p_world;  ///< on a surface that the gallery's eye sees
};

/// Places in the gallery that draw the gaze, from near to far.
std::vector<PointOfInterest> galleryPointsOfInterest();

}  // namespace foci
