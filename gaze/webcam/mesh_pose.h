// The pose of a head from one mesh of its face. It has no drift and needs no earlier frame, but it
// errs by a degree or two, which differ with pose and expression.
#pragma once

#include <optional>

#include "gaze/webcam/face_networks.h"
#include "gaze/webcam/head_pose.h"

namespace foci {

/// As if the mesh's depth were right, seen along the ray to the head (weak perspective). The head's
/// axes follow the symmetry of the face and its profile from forehead to nose.
/// @return nothing if the mesh has no extent
std::optional<HeadPose> poseOfMesh(const Pinhole& camera, const FaceMesh& mesh);

}  // namespace foci
