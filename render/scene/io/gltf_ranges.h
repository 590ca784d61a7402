// Every accessor of a glTF lies inside its view, and every view inside its buffer. Assimp does not
// check all of this, and would read memory that is not the file's. Private to the readers of
// meshes.
#pragma once

#include "render/scene/io/gltf_document.h"

namespace foci {

/// Call it before anything reads an accessor. A buffer whose file is missing counts as it states.
/// @throws InputError for a part that reaches too far, and for attributes of one primitive, or keys
/// and values of an animation, that are not equally many
void refuseOverreachingGltf(const GltfDocument& gltf);

}  // namespace foci
