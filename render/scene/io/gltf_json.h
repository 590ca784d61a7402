// The JSON of glTF files, text (.gltf) or binary (.glb).
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>

namespace foci {

/// Bytes before the first chunk of a binary file, and before the content of each chunk.
inline constexpr std::size_t kGlbHeader = 12, kChunkHeader = 8;

/// Whether the extension is that of glTF.
bool isGltf(const std::filesystem::path& path);

/// The JSON of a glTF file, without the bytes of its buffers.
/// @throws InputError if the file cannot be read, is cut off, is binary glTF of version 1, or is
/// binary under a name of text or the reverse
std::string gltfJson(const std::filesystem::path& path);

/// How deep the brackets of a JSON text nest, whether or not it is well formed.
int jsonDepth(std::string_view json);

}  // namespace foci
