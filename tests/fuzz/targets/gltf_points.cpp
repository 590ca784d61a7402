// Points and Gaussians of glTF, as text or binary.
#include "render/scene/io/mesh_formats.h"
#include "tests/fuzz/harness.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  const bool binary = size > 0 && bytes[0] == 'g';
  const auto file = foci::fuzz::asFile(binary ? "input.glb" : "input.gltf", bytes, size);
  foci::fuzz::readWithinLimits(size, [&] { foci::readGltfPoints(foci::GltfDocument(file)); });
  return 0;
}
