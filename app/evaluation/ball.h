// A closed, textured mesh made in code: a scene whose truth is known apart from its surfels.
#pragma once

#include "app/evaluation/scene_in_view.h"
#include "render/scene/mesh/triangle_mesh.h"

namespace foci {

/// A ball around the origin, closed, with a texture of checks over a gradient. Every run makes the
/// same bytes.
/// @param lump  height of its lumps, as a share of the radius; 0: smooth
TriangleMesh makeBallMesh(float radius_m, float lump);

/// The smooth ball sampled as any mesh is, before a light background. Its nearest point is in
/// focus. `SurfelCloud::mesh` holds its triangles.
/// @param size_px  side of the square image
SceneInView ballInView(int size_px);

}  // namespace foci
