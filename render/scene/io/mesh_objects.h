// The objects of a mesh file: its nodes, or its materials if it has but one node.
#pragma once

#include "render/scene/scene_objects.h"

struct aiScene;

namespace foci {

/// By mesh of the scene, whose nodes must still be there. A name that several nodes have gets a
/// number: "chair", "chair (2)". Empty if there is but one object.
SceneObjects objectsOf(const aiScene& scene);

}  // namespace foci
