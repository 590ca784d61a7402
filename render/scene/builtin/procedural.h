// Built-in scenes, sampled evenly from parametric surfaces. Every run makes the same bytes.
#pragma once

#include <cstddef>
#include <glm/glm.hpp>
#include <string>
#include <vector>

#include "render/scene/scene.h"

namespace foci {

/// Place and direction of an eye, the arguments of `eyeFromWorld`.
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

/// A gallery with exhibits from 0.25 to 6 m from the eye. It has fine texture everywhere, thin
/// structures in front, and a half-transparent mask before a figure (the paper's Figure 1). y is
/// up, the floor at y = 0. It is sampled for an eye near `galleryEyePose()`.
/// @param step_px  distance of surfels for that eye, > 0, in pixels of 0.39 mm 0.6 m away. At 1.8
///                 there are half a million surfels, at 0.9 two million
SurfelCloud makeGallery(float step_px = 1.8f);

EyePose galleryEyePose();

/// The number of surfels of the paper's lion.
inline constexpr std::size_t kStatueSurfels = 81458;

/// A stone lion in place of the paper's scan, about a metre tall, its plinth on y = 0, its face
/// towards +z. It is sampled evenly, with outward normals and solved weights.
SurfelCloud makeStatue();

/// A pose that sees the statue from its left front.
EyePose statueEyePose();

/// Wires and slats 0.5 to 4 mm wide, half a metre from the eye, before a textured wall 1.5 m away.
SurfelCloud makeFence();

/// The eye at the origin, looking at the wall's middle along -z.
EyePose fenceEyePose();

/// A scene of Gaussians in place of surfels: wall, ground, ball and boards, blades thinner than a
/// pixel, a veil and floaters, from 0.65 to 3 m from the eye.
GaussianCloud makeGarden();

/// The eye looks past the veil and the blades at the ball.
EyePose gardenEyePose();

struct PointOfInterest {
  std::string name;   ///< "lattice", "bust", ...
  glm::vec3 p_world;  ///< on a surface that is visible from `galleryEyePose()`
};

/// Places in the gallery that draw the gaze, from near to far.
std::vector<PointOfInterest> galleryPointsOfInterest();

}  // namespace foci
