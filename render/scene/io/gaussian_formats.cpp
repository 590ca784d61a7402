#include "render/scene/io/gaussian_formats.h"

#include "base/file.h"

namespace foci {

std::optional<GaussianFile> readGaussians(const std::filesystem::path& path) {
  if (isGaussianPly(path)) return readGaussianPly(path);
  if (isCompressedGaussianPly(path)) return readCompressedGaussianPly(path);
  if (isSpzFile(path)) return readSpzFile(path);
  if (isKsplatFile(path)) return readKsplatFile(path);
  if (isSogFile(path)) return readSogFile(path);
  if (isSplatFile(path)) return readSplatFile(path);
  // Damaged: its reader says how.
  const std::string extension = lowerExtension(path);
  if (extension == ".splat") return readSplatFile(path);
  if (extension == ".spz") return readSpzFile(path);
  if (extension == ".ksplat") return readKsplatFile(path);
  if (extension == ".sog") return readSogFile(path);
  return std::nullopt;
}

}  // namespace foci
