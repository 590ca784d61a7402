// The file formats of 3D Gaussians, one reader each. Every reader recognises its format from the
// file's content, checks each length before it uses it, and throws InputError with one line for a
// file that is damaged, empty, or of another version.
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <glm/glm.hpp>
#include <memory>
#include <span>
#include <vector>

#include "render/scene/io/file_bytes.h"
#include "render/scene/io/gaussian_file.h"
#include "render/scene/io/ply_header.h"

namespace foci {

/// The PLY of the original implementation (graphdeco-inria/gaussian-splatting), in any of a PLY's
/// formats: element vertex with x y z, f_dc_0 to 2, opacity (logit), scale_0 to 2 (natural
/// logarithm), rot_0 to 3 (w x y z), and f_rest_0 to 8, 23 or 44 for harmonics of degree 1 to 3 (by
/// channel). Other properties and elements are skipped. Positions in doubles may be as large as
/// those of a map projection (`originNear`).
///
/// Variants: without scale_2 a disc (2D Gaussian Splatting); red green blue instead of f_dc
/// (nerfstudio); filter_3D (Mip-Splatting); 72 f_rest for degree 4, of which 3 are shown.
bool isGaussianPly(const ply::Header& header);

/// Whether the comments of a PLY say that it was trained with a low-pass that preserves light:
/// "SplatRenderMode: mip" (Brush), "antialiased 1" (Postshot). The last one counts.
bool preservesLight(const ply::Header& header);

GaussianFile readGaussianPly(const std::filesystem::path& path);

/// SuperSplat's compressed PLY (playcanvas/engine): an element `chunk` with the ranges of each 256
/// vertices, an element `vertex` of four packed integers, and with harmonics an element `sh` of
/// bytes.
bool isCompressedGaussianPly(const ply::Header& header);
GaussianFile readCompressedGaussianPly(const std::filesystem::path& path);

/// antimatter15's `.splat`: records of 32 bytes without a header. A file counts as one if its
/// length is a multiple of 32 and all records looked at are sound.
bool isSplatFile(const std::filesystem::path& path);
GaussianFile readSplatFile(const std::filesystem::path& path);

/// Niantic's `.spz`, versions 1 to 4: 1 to 3 plain or by gzip, 4 by Zstandard.
/// Files may state the way of their axes (0xADBE0003); they are turned to SPZ's own: x right, y up.
/// @param first  at least 4 bytes of the file, unpacked
bool isSpz(std::span<const unsigned char> first);
GaussianFile readSpz(const FileBytes& bytes);

/// mkkellogg's `.ksplat` (GaussianSplats3D), version 0.1, compression modes 0 to 2.
bool isKsplatFile(const std::filesystem::path& path);
GaussianFile readKsplatFile(const std::filesystem::path& path);

/// PlayCanvas' SOG, versions 1 and 2: meta.json and WebP images, in a ZIP archive (`.sog`), or in a
/// folder, of which meta.json is read.
bool isSogFile(const std::filesystem::path& path);
GaussianFile readSogFile(const std::filesystem::path& path);

/// How fine a scene has to be in a box, low to high: a distance between Gaussians, units of the
/// file. 0: as fine as it is.
using Fineness = std::function<float(const glm::vec3& low, const glm::vec3& high)>;

/// Gaussians that are read at once of a streamed scene, at most, if the view decides.
inline constexpr std::size_t kMostStreamed = 1'500'000;

/// PlayCanvas' streamed SOG: lod-meta.json in a folder of chunks, or both in a ZIP archive
/// (`.ssog`). Only the tree of boxes is read at once.
class StreamedGaussians {
 public:
  /// @throws InputError
  explicit StreamedGaussians(const std::filesystem::path& path);

  std::size_t size() const;                ///< Gaussians of the finest level
  std::vector<glm::vec3> corners() const;  ///< of all boxes

  /// Reads the level of each box that is fine enough, and the environment. If that is more than
  /// kMostStreamed, all are coarser. Without `fineness`, the finest level of all.
  /// @throws InputError
  GaussianFile read(const Fineness& fineness) const;

 private:
  struct Content;
  std::shared_ptr<const Content> content_;
};

bool isStreamedSog(const std::filesystem::path& path);

}  // namespace foci
