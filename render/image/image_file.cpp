#include "render/image/image_file.h"

#include <zlib.h>

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string>

#include "base/file.h"
#include "base/image_codec.h"
#include "base/input_error.h"
#include "render/image/srgb.h"

namespace foci {
namespace {

/// Little-endian, as PFM and OpenEXR are here.
template <class T>
void append(std::string& bytes, const T& value) {
  bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
}

/// Planes of floats, in rows from the top.
struct Planes {
  glm::ivec2 size_px{0, 0};
  int channels = 1;  ///< 1, or 3: R, G, B
  const float* first = nullptr;
  std::ptrdiff_t stride = 1;  ///< from pixel to pixel

  float at(int x, int y, int channel) const {
    return first[(static_cast<std::ptrdiff_t>(y) * size_px.x + x) * stride + channel];
  }
};

/// Portable float map: rows from the bottom.
std::string pfmOf(const Planes& image) {
  std::string bytes = std::string(image.channels == 1 ? "Pf" : "PF") + "\n" +
                      std::to_string(image.size_px.x) + " " + std::to_string(image.size_px.y) +
                      "\n-1\n";
  for (int y = image.size_px.y - 1; y >= 0; --y) {
    for (int x = 0; x < image.size_px.x; ++x) {
      for (int k = 0; k < image.channels; ++k) append(bytes, image.at(x, y, k));
    }
  }
  return bytes;
}

/// A row's bytes as OpenEXR packs them: those of even places, then those of odd ones, differences
/// of neighbours, and zlib.
std::string packed(const std::string& row) {
  const std::size_t half = (row.size() + 1) / 2;
  std::string turned(row.size(), '\0');
  for (std::size_t i = 0; i < row.size(); ++i) turned[i / 2 + (i % 2) * half] = row[i];
  for (std::size_t i = row.size() - 1; i > 0; --i) {
    turned[i] = static_cast<char>(turned[i] - turned[i - 1] + 128);
  }
  uLongf size = compressBound(static_cast<uLong>(row.size()));
  std::string to(size, '\0');
  compress(reinterpret_cast<Bytef*>(to.data()), &size, reinterpret_cast<Bytef*>(turned.data()),
           static_cast<uLong>(turned.size()));
  to.resize(size);
  return to.size() < row.size() ? to : row;
}

/// OpenEXR (openexr.com, "OpenEXR file layout"): one part of scan lines, each a block of its own.
std::string exrOf(const Planes& image) {
  std::string bytes;
  append(bytes, std::uint32_t{20000630});
  append(bytes, std::uint32_t{2});  // version
  const auto attribute = [&](const char* name, const char* type, const std::string& value) {
    bytes.append(name).push_back('\0');
    bytes.append(type).push_back('\0');
    append(bytes, static_cast<std::int32_t>(value.size()));
    bytes += value;
  };
  const std::string names = image.channels == 1 ? "Y" : "BGR";  // in the order of the alphabet
  std::string channels, window, one, centre(8, '\0');
  for (const char name : names) {
    channels += name + std::string(1, '\0');
    for (const int value : {2, 0, 1, 1}) append(channels, value);  // floats of each pixel
  }
  channels += '\0';
  for (const int value : {0, 0, image.size_px.x - 1, image.size_px.y - 1}) append(window, value);
  append(one, 1.0f);
  attribute("channels", "chlist", channels);
  attribute("compression", "compression", std::string(1, '\2'));  // zlib, one row in a block
  attribute("dataWindow", "box2i", window);
  attribute("displayWindow", "box2i", window);
  attribute("lineOrder", "lineOrder", std::string(1, '\0'));
  attribute("pixelAspectRatio", "float", one);
  attribute("screenWindowCenter", "v2f", centre);
  attribute("screenWindowWidth", "float", one);
  bytes += '\0';
  const std::size_t places = bytes.size();
  bytes.resize(places + sizeof(std::uint64_t) * static_cast<std::size_t>(image.size_px.y));
  for (int y = 0; y < image.size_px.y; ++y) {
    const std::uint64_t place = bytes.size();
    std::memcpy(bytes.data() + places + sizeof place * static_cast<std::size_t>(y), &place,
                sizeof place);
    std::string row;
    for (int k = image.channels - 1; k >= 0; --k) {
      for (int x = 0; x < image.size_px.x; ++x) append(row, image.at(x, y, k));
    }
    row = packed(row);
    append(bytes, y);
    append(bytes, static_cast<std::int32_t>(row.size()));
    bytes += row;
  }
  return bytes;
}

void writeFloats(const std::filesystem::path& file, const Planes& image) {
  replaceFile(file, file.extension() == ".exr" ? exrOf(image) : pfmOf(image));
}

}  // namespace

void checkImageExtension(const std::filesystem::path& file) {
  const std::string extension = file.extension().string();
  if (extension != ".png" && extension != ".pfm" && extension != ".exr") {
    throw InputError(file.string(), "expected a name that ends in .png, .pfm or .exr");
  }
}

void writeImage(const std::filesystem::path& file, const Frame& frame,
                std::optional<double> gamma) {
  checkImageExtension(file);
  if (file.extension() == ".png") {
    const std::vector<std::uint8_t> rgb = codesOf(frame, gamma);
    const auto png = encodePng(frame.size_px.x, frame.size_px.y, 3, rgb.data());
    replaceFile(file, std::string(png.begin(), png.end()));
  } else {
    writeFloats(
        file,
        {.size_px = frame.size_px, .channels = 3, .first = &frame.rgba.data()->x, .stride = 4});
  }
}

void writeMap(const std::filesystem::path& file, const glm::ivec2& size_px,
              const std::vector<float>& values) {
  writeFloats(file, {.size_px = size_px, .first = values.data()});
}

}  // namespace foci
