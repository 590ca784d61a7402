// EXT_meshopt_compression, appendices A and B; KHR_draco_mesh_compression (Khronos); Zstandard (RFC
// 8878).
#include "render/scene/io/compression.h"

#ifdef FOCI_COMPRESSION

// Draco's headers compare signs and shadow names.
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wall"
#pragma GCC diagnostic ignored "-Wextra"
#pragma GCC diagnostic ignored "-Wshadow"
#pragma GCC diagnostic ignored "-Wconversion"
#pragma GCC diagnostic ignored "-Wpedantic"
#include <draco/compression/decode.h>
#pragma GCC diagnostic pop
#include <meshoptimizer.h>
#include <zstd.h>

#include <utility>

namespace foci {

bool readsCompressed() { return true; }

bool decodeZstd(std::span<const unsigned char> bytes, std::span<unsigned char> out) {
  const std::size_t unpacked = ZSTD_decompress(out.data(), out.size(), bytes.data(), bytes.size());
  return ZSTD_isError(unpacked) == 0 && unpacked == out.size();
}

bool decodeMeshopt(const MeshoptView& view, std::span<const unsigned char> bytes,
                   std::span<unsigned char> out) {
  const std::size_t count = view.count, stride = view.stride;
  const bool index_stride = stride == 2 || stride == 4,
             vertex_stride = stride > 0 && stride % 4 == 0 && stride <= 256;
  bool decoded = false;
  if (view.mode == "ATTRIBUTES" && vertex_stride) {
    decoded =
        meshopt_decodeVertexBuffer(out.data(), count, stride, bytes.data(), bytes.size()) == 0;
  } else if (view.mode == "TRIANGLES" && index_stride && count % 3 == 0) {
    decoded = meshopt_decodeIndexBuffer(out.data(), count, stride, bytes.data(), bytes.size()) == 0;
  } else if (view.mode == "INDICES" && index_stride) {
    decoded =
        meshopt_decodeIndexSequence(out.data(), count, stride, bytes.data(), bytes.size()) == 0;
  }
  if (!decoded || view.filter == "NONE") return decoded;
  if (view.filter == "OCTAHEDRAL" && (stride == 4 || stride == 8)) {
    meshopt_decodeFilterOct(out.data(), count, stride);
  } else if (view.filter == "QUATERNION" && stride == 8) {
    meshopt_decodeFilterQuat(out.data(), count, stride);
  } else if (view.filter == "EXPONENTIAL" && vertex_stride) {
    meshopt_decodeFilterExp(out.data(), count, stride);
  } else {
    return false;
  }
  return true;
}

std::optional<DracoPrimitive> decodeDraco(std::span<const unsigned char> bytes,
                                          const std::map<std::string, std::uint32_t>& ids) {
  draco::DecoderBuffer buffer;
  buffer.Init(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  draco::Decoder decoder;
  const auto decoded = decoder.DecodeMeshFromBuffer(&buffer);
  if (!decoded.ok()) return std::nullopt;
  const draco::Mesh& mesh = *decoded.value();
  DracoPrimitive primitive{.vertices = mesh.num_points(), .indices = {}, .attributes = {}};
  for (draco::FaceIndex face(0); face < mesh.num_faces(); ++face) {
    for (const draco::PointIndex& point : mesh.face(face)) {
      if (point.value() >= primitive.vertices) return std::nullopt;
      primitive.indices.push_back(point.value());
    }
  }
  for (const auto& [name, id] : ids) {
    const draco::PointAttribute* const from = mesh.GetAttributeByUniqueId(id);
    if (from == nullptr) return std::nullopt;
    DracoPrimitive::Attribute to{.components = static_cast<std::size_t>(from->num_components()),
                                 .values = {},
                                 .scaled = from->normalized()};
    to.values.resize(primitive.vertices * to.components);
    for (draco::PointIndex point(0); point < mesh.num_points(); ++point) {
      float* const values = to.values.data() + point.value() * to.components;
      const draco::AttributeValueIndex value = from->mapped_index(point);
      if (value.value() >= from->size() || !from->ConvertValue<float>(value, values))
        return std::nullopt;
    }
    primitive.attributes.emplace(name, std::move(to));
  }
  return primitive;
}

}  // namespace foci

#else

namespace foci {

bool readsCompressed() { return false; }

bool decodeZstd(std::span<const unsigned char>, std::span<unsigned char>) { return false; }

bool decodeMeshopt(const MeshoptView&, std::span<const unsigned char>, std::span<unsigned char>) {
  return false;
}

std::optional<DracoPrimitive> decodeDraco(std::span<const unsigned char>,
                                          const std::map<std::string, std::uint32_t>&) {
  return std::nullopt;
}

}  // namespace foci

#endif
