// A closed, textured mesh made in code: a scene whose truth is known apart from its surfels.
#pragma once

#include "app/evaluation/scene_in_view.h"
#include "render/scene/mesh/triangle_mesh.h"

namespace foci {

/// A lumpy ball of about `radius_m` around the origin, closed, with a texture of checks over a
/// gradient. Every run makes the same bytes.
TriangleMesh makeBallMesh(float radius_m);

/// The ball sampled as any mesh is, before a light background. Its nearest point is in focus.
/// `SurfelCloud::mesh` holds its triangles.
/// @param size_px  side of the square image
SceneInView ballInView(int size_px);

}  // namespace foci
