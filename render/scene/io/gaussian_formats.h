// The file formats of 3D Gaussians, one reader each. Every reader recognises its format from the
// file's content, checks each length before it uses it, and throws InputError with one line for a
// file that is damaged, empty, or of another version.
#pragma once

#include <filesystem>
#include <optional>

#include "render/scene/io/gaussian_file.h"

namespace foci {

/// The PLY of the original implementation (graphdeco-inria/gaussian-splatting), in any of a PLY's
/// formats: element vertex with x y z, f_dc_0 to 2, opacity (logit), scale_0 to 2 (natural
/// logarithm), rot_0 to 3 (w x y z), and f_rest_0 to 8, 23 or 44 for harmonics of degree 1 to 3 (by
/// channel). Other properties and elements are skipped. Positions in doubles may be as large as
/// those of a map projection (`originNear`).
bool isGaussianPly(const std::filesystem::path& path);
GaussianFile readGaussianPly(const std::filesystem::path& path);

/// SuperSplat's compressed PLY (playcanvas/engine): an element `chunk` with the ranges of each 256
/// vertices, an element `vertex` of four packed integers, and with harmonics an element `sh` of
/// bytes.
bool isCompressedGaussianPly(const std::filesystem::path& path);
GaussianFile readCompressedGaussianPly(const std::filesystem::path& path);

/// antimatter15's `.splat`: records of 32 bytes without a header. A file counts as one if its
/// length is a multiple of 32 and all records looked at are sound.
bool isSplatFile(const std::filesystem::path& path);
GaussianFile readSplatFile(const std::filesystem::path& path);

/// Niantic's `.spz`, versions 1 to 4: 1 to 3 plain or by gzip, 4 by Zstandard.
bool isSpzFile(const std::filesystem::path& path);
GaussianFile readSpzFile(const std::filesystem::path& path);

/// mkkellogg's `.ksplat` (GaussianSplats3D), version 0.1, compression modes 0 to 2.
bool isKsplatFile(const std::filesystem::path& path);
GaussianFile readKsplatFile(const std::filesystem::path& path);

/// PlayCanvas' SOG, versions 1 and 2: meta.json and WebP images, in a ZIP archive (`.sog`), or in a
/// folder, of which meta.json is read.
bool isSogFile(const std::filesystem::path& path);
GaussianFile readSogFile(const std::filesystem::path& path);

/// Reads a file of any of these formats, also one that is damaged and has the extension `.splat`,
/// `.spz`, `.ksplat` or `.sog`. Nothing for another file.
std::optional<GaussianFile> readGaussians(const std::filesystem::path& path);

}  // namespace foci
