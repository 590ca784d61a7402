// Meshes. The first byte chooses the format.
#include "render/scene/io/open_scene.h"
#include "render/scene/mesh/sample_mesh.h"
#include "tests/fuzz/harness.h"

// Assimp leaks memory of FBX files that it refuses.
extern "C" const char* __lsan_default_suppressions() { return "leak:libassimp"; }

FOCI_FUZZ(mesh) {
  if (size == 0) return 0;
  constexpr const char* kNames[] = {"input.obj", "input.stl", "input.gltf",
                                    "input.glb", "input.ply", "input.fbx"};
  const auto file = foci::fuzz::asFile(kNames[bytes[0] % 6], bytes + 1, size - 1);
  foci::fuzz::readWithinLimits(size, [&] {
    const foci::SceneFile scene = foci::readScene(file);
    const auto* const mesh = std::get_if<foci::MeshFile>(&scene.content);
    if (mesh != nullptr) foci::sampleMesh(mesh->mesh, file, {.points = 1000});
  });
  return 0;
}
