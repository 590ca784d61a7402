// PLY point clouds, up to surfels. Files with faces are meshes, and sampling them would take too
// long; mesh.cpp reads them.
#include "render/scene/io/open_scene.h"
#include "tests/fuzz/harness.h"

FOCI_FUZZ(ply) {
  const auto file = foci::fuzz::asFile("input.ply", bytes, size);
  foci::fuzz::readWithinLimits(size, [&] {
    foci::SceneFile scene = foci::readScene(file);
    if (!std::holds_alternative<foci::MeshFile>(scene.content)) {
      foci::openScene(std::move(scene), 1.0, {});
    }
  });
  return 0;
}
