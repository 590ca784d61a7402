// Unpacks the compressed parts of a glTF, and Zstandard. Private to the readers of scenes.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace foci {

/// Whether foci was built with Draco, meshoptimizer, Zstandard and WebP. Else the functions below
/// fail.
bool readsCompressed();

/// @return whether the bytes are a stream that fills `out`
bool decodeZstd(std::span<const unsigned char> bytes, std::span<unsigned char> out);

/// What EXT_meshopt_compression says of a view.
struct MeshoptView {
  std::string mode, filter;
  std::size_t count = 0, stride = 0;
};

/// @param out  count x stride bytes
/// @return whether the bytes are sound, and of a kind that is known
bool decodeMeshopt(const MeshoptView& view, std::span<const unsigned char> bytes,
                   std::span<unsigned char> out);

/// A primitive of KHR_draco_mesh_compression.
struct DracoPrimitive {
  struct Attribute {
    std::size_t components = 0;
    std::vector<float> values;  // by vertex; those of normalised integers are 0 to 1, or -1 to 1
    bool scaled = false;        // by Draco, from integers
  };
  std::size_t vertices = 0;
  std::vector<std::uint32_t> indices;  ///< three a triangle
  std::map<std::string, Attribute> attributes;
};

/// @param ids  Draco's number of each attribute
/// @return nothing if the bytes are not sound, or an attribute is not there
std::optional<DracoPrimitive> decodeDraco(std::span<const unsigned char> bytes,
                                          const std::map<std::string, std::uint32_t>& ids);

}  // namespace foci
