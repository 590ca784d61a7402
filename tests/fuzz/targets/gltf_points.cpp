// Points and Gaussians of glTF, as text or binary.
#include "render/scene/io/mesh_formats.h"
#include "tests/fuzz/harness.h"

FOCI_FUZZ(gltf_points) {
  const bool binary = size > 0 && bytes[0] == 'g';
  const auto file = foci::fuzz::asFile(binary ? "input.glb" : "input.gltf", bytes, size);
  foci::fuzz::readWithinLimits(size, [&] { foci::readGltfPoints(foci::GltfDocument(file)); });
  return 0;
}
