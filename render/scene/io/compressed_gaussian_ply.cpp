// SuperSplat's compressed PLY: see gaussian_formats.h. A position and a scale have 11, 10 and 11
// bits between the least and the greatest of their chunk; a rotation has the index of its largest
// component and three components of 10 bits; colour and opacity have 8 bits each.
#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <span>
#include <string>
#include <string_view>

#include "base/input_error.h"
#include "render/scene/io/gaussian_formats.h"
#include "render/scene/io/ply_items.h"

namespace foci {
namespace {

using ply::Element;
using ply::Scalar;

constexpr std::size_t kChunk = 256;  // vertices of a chunk

/// Harmonics are stored in 8 bits, over this range.
constexpr float kHarmonicsRange = 8.0f;

bool isOfType(const Element& element, Scalar type) {
  return std::ranges::all_of(element.properties, [&](const ply::Property& each) {
    return !each.list && each.type == type;
  });
}

/// Whether these are the names of all properties, or of the first ones.
bool hasNames(const Element& element, std::span<const std::string_view> names) {
  return element.properties.size() <= names.size() &&
         std::ranges::equal(element.properties, names.first(element.properties.size()), {},
                            &ply::Property::name);
}

constexpr std::array<std::string_view, 18> kRanges = {
    "min_x",       "min_y",       "min_z",       "max_x",       "max_y",       "max_z",
    "min_scale_x", "min_scale_y", "min_scale_z", "max_scale_x", "max_scale_y", "max_scale_z",
    "min_r",       "min_g",       "min_b",       "max_r",       "max_g",       "max_b"};
constexpr std::size_t kRangesWithoutColor = 12;
constexpr std::array<std::string_view, 4> kPacked = {"packed_position", "packed_rotation",
                                                     "packed_scale", "packed_color"};

/// The ranges of one chunk, in the order of the file.
struct Chunk {
  glm::vec3 low{0.0f}, high{0.0f}, low_scale{0.0f}, high_scale{0.0f};
  glm::vec3 low_color{0.0f}, high_color{1.0f};
};

struct Packed {
  std::uint32_t position, rotation, scale, color;
};

float unit(std::uint32_t value, unsigned bits) {
  const std::uint32_t most = (1u << bits) - 1u;
  return static_cast<float>(value & most) / static_cast<float>(most);
}

glm::vec3 unit111011(std::uint32_t value) {
  return {unit(value >> 21u, 11), unit(value >> 11u, 10), unit(value, 11)};
}

glm::vec4 rotationOf(std::uint32_t value) {
  std::array<float, 3> three{};
  for (unsigned i = 0; i < 3; ++i) {
    three[i] = (unit(value >> (20 - 10 * i), 10) - 0.5f) * std::sqrt(2.0f);
  }
  const auto wxyz = quaternionOf(three, value >> 30u);
  return {wxyz[1], wxyz[2], wxyz[3], wxyz[0]};
}

RawGaussian unpacked(const Packed& packed, const Chunk& chunk) {
  const glm::vec3 color(unit(packed.color >> 24u, 8), unit(packed.color >> 16u, 8),
                        unit(packed.color >> 8u, 8));
  return {.position = glm::mix(chunk.low, chunk.high, unit111011(packed.position)),
          .sigma = glm::exp(glm::mix(chunk.low_scale, chunk.high_scale, unit111011(packed.scale))),
          .rotation = rotationOf(packed.rotation),
          .opacity = unit(packed.color, 8),
          .color = glm::mix(chunk.low_color, chunk.high_color, color)};
}

std::vector<Chunk> readChunks(ply::Input& input, const Element& element) {
  static_assert(sizeof(Chunk) == kRanges.size() * sizeof(float));
  const std::size_t bytes = element.properties.size() * sizeof(float);
  std::vector<Chunk> chunks(element.count);
  for (Chunk& chunk : chunks) std::memcpy(&chunk, input.take(bytes), bytes);
  return chunks;
}

/// The elements of a file of this format.
struct Layout {
  const Element *chunk, *vertex, *harmonics;
  int degree = 0;
};

/// @throws InputError
Layout layoutOf(const ply::Header& header, const std::string& file) {
  const auto refuse = [&](const auto&... what) {
    return InputError(file, "compressed PLY of Gaussians: ", what...);
  };
  Layout layout{ply::elementNamed(header, "chunk"), ply::elementNamed(header, "vertex"),
                ply::elementNamed(header, "sh")};
  if (header.format != ply::Format::little) throw refuse("expected format binary_little_endian");
  const std::size_t ranges = layout.chunk == nullptr ? 0 : layout.chunk->properties.size();
  if ((ranges != kRanges.size() && ranges != kRangesWithoutColor) ||
      !isOfType(*layout.chunk, Scalar::float32) || !hasNames(*layout.chunk, kRanges)) {
    throw refuse("expected an element chunk of float min_x, min_y, ... (12 or 18 properties)");
  }
  if (layout.vertex == nullptr || layout.vertex->properties.size() != kPacked.size() ||
      !isOfType(*layout.vertex, Scalar::uint32) || !hasNames(*layout.vertex, kPacked)) {
    throw refuse("element vertex: expected uint packed_position, _rotation, _scale and _color");
  }
  const std::size_t needed = (layout.vertex->count + kChunk - 1) / kChunk;
  if (layout.chunk->count < needed) {
    throw refuse("has ", layout.chunk->count, " chunks: expected ", needed,
                 ", one for 256 vertices");
  }
  const bool ordered = layout.chunk < layout.vertex &&
                       (layout.harmonics == nullptr || layout.vertex < layout.harmonics);
  if (!ordered || header.elements.size() != (layout.harmonics != nullptr ? 3u : 2u)) {
    throw refuse("expected the elements chunk, vertex and, with harmonics, sh");
  }
  if (layout.harmonics == nullptr) return layout;
  layout.degree = degreeOf(static_cast<int>(layout.harmonics->properties.size()));
  if (layout.degree > kMaxHarmonicsDegree || layout.degree == 0 ||
      !isOfType(*layout.harmonics, Scalar::uint8) ||
      layout.harmonics->count != layout.vertex->count) {
    throw refuse("element sh: expected 9, 24 or 45 uchar for each vertex");
  }
  return layout;
}

float harmonicOf(unsigned char byte) {
  const float share = byte == 0     ? 0.0f
                      : byte == 255 ? 1.0f
                                    : (static_cast<float>(byte) + 0.5f) / 256.0f;
  return (share - 0.5f) * kHarmonicsRange;
}

}  // namespace

bool isCompressedGaussianPly(const ply::Header& header) {
  const Element* const vertex = ply::elementNamed(header, "vertex");
  return vertex != nullptr && vertex->has(kPacked[0]);
}

GaussianFile readCompressedGaussianPly(const std::filesystem::path& path) {
  static_assert(std::endian::native == std::endian::little);
  ply::Input input(path);
  const ply::Header header = ply::readHeader(input);
  const Layout layout = layoutOf(header, input.name());
  const std::vector<Chunk> chunks = readChunks(input, *layout.chunk);

  // Harmonics come after all vertices, so the packed vertices wait for them.
  std::vector<Packed> packed(layout.vertex->count);
  for (Packed& each : packed) std::memcpy(&each, input.take(sizeof(each)), sizeof(each));
  GaussianFile file{.format = "compressed PLY"};
  file.cloud.preserves_light = preservesLight(header);
  GaussianCollector collector(file, packed.size(), layout.degree);
  const std::size_t values = file.cloud.harmonicsPerGaussian();
  std::vector<float> harmonics(values);
  for (std::size_t i = 0; i < packed.size(); ++i) {
    // By channel in the file, by coefficient in the cloud.
    const unsigned char* const bytes = input.take(values);
    for (std::size_t k = 0; k < values; ++k) {
      harmonics[k] = harmonicOf(bytes[k % 3 * (values / 3) + k / 3]);
    }
    collector.append(unpacked(packed[i], chunks[i / kChunk]), harmonics);
  }
  finishGaussians(file, input.name());
  return file;
}

}  // namespace foci
