// Meshes: the first byte chooses the format, as a name does.
#include "render/scene/io/mesh.h"
#include "tests/fuzz/harness.h"

// What Assimp loses of a file that it refuses (about 2 kB an ASCII STL) is not ours to free.
extern "C" const char* __lsan_default_suppressions() { return "leak:libassimp"; }

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  if (size == 0) return 0;
  constexpr const char* kNames[] = {"input.obj", "input.stl", "input.gltf", "input.glb",
                                    "input.ply"};
  const auto file = foci::fuzz::asFile(kNames[bytes[0] % 5], bytes + 1, size - 1);
  foci::fuzz::readWithinLimits(size, [&] {
    if (foci::isMeshFile(file)) foci::sampleMesh(file, {.points = 1000});
  });
  return 0;
}
