// The pose of a head from the points of its face that expression and gaze do not move: forehead,
// temples, the bridge of the nose, cheekbones, corners of the eyes.
#pragma once

#include <optional>

#include "gaze/webcam/face_networks.h"
#include "gaze/webcam/webcam_record.h"

namespace foci {

/// The rigid points on the image, in the order of `FaceShape`.
std::vector<glm::dvec2> rigidPoints_px(const FaceMesh& mesh);

/// The shape and the pose that one mesh shows, as if its depth were right: a weak-perspective view.
/// The head's axes follow the symmetry of the face and its profile from forehead to nose.
struct MeshPose {
  FaceShape shape;
  HeadPose pose;
};

/// @return nothing if the mesh has no extent
std::optional<MeshPose> poseOfMesh(const Pinhole& camera, const FaceMesh& mesh);

}  // namespace foci
