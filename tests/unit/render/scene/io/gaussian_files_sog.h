// .sog: images in a ZIP archive.
#pragma once

#include <webp/encode.h>
#include <webp/types.h>
#include <zlib.h>

#include <cmath>
#include <cstring>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "render/scene/harmonics.h"
#include "tests/unit/render/scene/io/gaussian_files.h"

namespace foci {

/// A lossless WebP image of one row for each of `rows`.
inline std::string webp(const std::vector<std::string>& rows) {
  std::string pixels;
  for (const std::string& row : rows) pixels += row;
  const int width = static_cast<int>(rows.front().size() / 4), stride = 4 * width;
  std::uint8_t* packed = nullptr;
  const std::size_t size =
      WebPEncodeLosslessRGBA(reinterpret_cast<const std::uint8_t*>(pixels.data()), width,
                             static_cast<int>(rows.size()), stride, &packed);
  std::string file(reinterpret_cast<const char*>(packed), size);
  WebPFree(packed);
  return file;
}

inline std::string rgba(int r, int g, int b, int a = 255) {
  std::string pixel;
  for (const int value : {r, g, b, a}) putByte(pixel, value);
  return pixel;
}

inline std::string deflated(const std::string& bytes) {
  std::string packed(compressBound(bytes.size()), '\0');
  z_stream stream{};
  deflateInit2(&stream, 9, Z_DEFLATED, -MAX_WBITS, 8, Z_DEFAULT_STRATEGY);
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));
  stream.avail_in = static_cast<uInt>(bytes.size());
  stream.next_out = reinterpret_cast<Bytef*>(packed.data());
  stream.avail_out = static_cast<uInt>(packed.size());
  deflate(&stream, Z_FINISH);
  packed.resize(stream.total_out);
  deflateEnd(&stream);
  return packed;
}

inline std::string zip(const std::vector<std::pair<std::string, std::string>>& members) {
  std::string file, directory;
  std::uint16_t method = 8;
  for (const auto& [name, bytes] : members) {
    const std::string packed = method == 8 ? deflated(bytes) : bytes;
    std::string facts;
    put(facts, std::uint16_t{20}, std::uint16_t{0}, method, std::uint32_t{0},
        static_cast<std::uint32_t>(crc32(0, reinterpret_cast<const Bytef*>(bytes.data()),
                                         static_cast<uInt>(bytes.size()))),
        static_cast<std::uint32_t>(packed.size()), static_cast<std::uint32_t>(bytes.size()),
        static_cast<std::uint16_t>(name.size()), std::uint16_t{0});
    directory += "PK\x01\x02";
    put(directory, std::uint16_t{20});
    directory += facts;
    put(directory, std::uint16_t{0}, std::uint16_t{0}, std::uint16_t{0}, std::uint32_t{0},
        static_cast<std::uint32_t>(file.size()));
    directory += name;
    file.append("PK\x03\x04").append(facts).append(name).append(packed);
    method = 0;
  }
  const auto at = static_cast<std::uint32_t>(file.size());
  const auto count = static_cast<std::uint16_t>(members.size());
  file += directory + "PK\x05\x06";
  put(file, std::uint32_t{0}, count, count, static_cast<std::uint32_t>(directory.size()), at,
      std::uint16_t{0});
  return file;
}

inline std::string listOf(const std::vector<float>& numbers) {
  std::string list;
  for (const float number : numbers) list += (list.empty() ? "[" : ",") + std::to_string(number);
  return list + "]";
}

inline std::string codebook(std::vector<float> numbers) {
  numbers.resize(256);
  return "\"codebook\":" + listOf(numbers);
}

using SogMembers = std::vector<std::pair<std::string, std::string>>;

/// Positions, in every version.
inline std::string sogMeans() {
  const float high = std::log(1.0f + kPosition.z + 1.0f);
  return "\"mins\":" + listOf({0.0f, -std::log(1.0f - kPosition.y), std::log(1.0f + kPosition.z)}) +
         ",\"maxs\":" + listOf({std::log(1.0f + kPosition.x), 0.0f, high}) +
         ",\"files\":[\"l.webp\",\"u.webp\"]";
}

/// Two Gaussians. @param scales, color  of the first
inline SogMembers sogImages(int degree, const std::string& scales, const std::string& color) {
  // The component that is left out is w, or z: the others are 0 and 0.7071.
  const std::string rotation =
      degree % 2 == 0 ? rgba(128, 128, 255, 252) : rgba(255, 128, 128, 255);
  const std::string means = rgba(255, 0, 0) + rgba(255, 0, 255);
  return {{"l.webp", webp({means})},
          {"u.webp", webp({means})},
          {"s.webp", webp({scales + rgba(0, 0, 0)})},
          {"q.webp", webp({rotation + rotation})},
          {"c.webp", webp({color + rgba(0, 0, 0)})}};
}

/// The second Gaussian has entry 65: the second one in the second row.
inline void addSogHarmonics(SogMembers& members, int degree) {
  std::vector<std::string> palette(2);
  for (int entry = 0; entry < 128; ++entry) {
    for (int k = 0; k < harmonicsOf(degree); ++k) {
      const auto code = [&](int channel) {
        return entry == 65 ? static_cast<int>(32.0f * coefficient(channel, k)) + 128 : 0;
      };
      palette[static_cast<std::size_t>(entry / 64)] += rgba(code(0), code(1), code(2));
    }
  }
  members.emplace_back("p.webp", webp(palette));
  members.emplace_back("i.webp", webp({rgba(0, 0, 0) + rgba(65, 0, 0)}));
}

inline std::string sogFile(int degree, int version = 2) {
  std::string meta =
      "{\"version\":" + std::to_string(version) + ",\"count\":2,\"means\":{" + sogMeans() +
      "},\"scales\":{" + codebook({std::log(kSigma.x), std::log(kSigma.y), std::log(kSigma.z)}) +
      ",\"files\":[\"s.webp\"]},\"quats\":{\"files\":[\"q.webp\"]},\"sh0\":{" +
      codebook({(kColor.r - 0.5f) / kHarmonic0, 0.0f, (kColor.b - 0.5f) / kHarmonic0}) +
      ",\"files\":[\"c.webp\"]}";
  SogMembers members = sogImages(degree, rgba(0, 1, 2), rgba(0, 1, 2, 204));
  if (degree > 0) {
    std::vector<float> steps(256);
    for (int i = 0; i < 256; ++i)
      steps[static_cast<std::size_t>(i)] = 0.03125f * static_cast<float>(i - 128);
    meta += ",\"shN\":{\"count\":128,\"bands\":" + std::to_string(degree) + "," + codebook(steps) +
            ",\"files\":[\"p.webp\",\"i.webp\"]}";
    addSogHarmonics(members, degree);
  }
  members.insert(members.begin(), {"meta.json", meta + "}"});
  return zip(members);
}

/// Version 1, as playcanvas/sogs writes it: without `version`. A byte is a step from the least to
/// the largest value of its channel.
inline SogMembers sogFolder(int degree) {
  const auto logit = [](float opacity) { return std::log(opacity / (1.0f - opacity)); };
  std::string meta =
      "{\"means\":{\"shape\":[2,3],\"dtype\":\"float32\"," + sogMeans() +
      "},\"scales\":{\"shape\":[2,3],\"mins\":" +
      listOf({std::log(kSigma.x), std::log(kSigma.y) - 1.0f, -9.0f}) +
      ",\"maxs\":" + listOf({0.0f, std::log(kSigma.y) + 1.55f, std::log(kSigma.z)}) +
      ",\"files\":[\"s.webp\"]},\"quats\":{\"shape\":[2,4],\"encoding\":\"quaternion_packed\","
      "\"files\":[\"q.webp\"]},\"sh0\":{\"shape\":[2,1,4],\"mins\":" +
      listOf({-1.0f, -1.0f, (kColor.b - 0.5f) / kHarmonic0, logit(kOpacity) - 1.0f}) +
      ",\"maxs\":" +
      listOf({(kColor.r - 0.5f) / kHarmonic0, 1.55f, 1.0f, logit(kOpacity) + 1.55f}) +
      ",\"files\":[\"c.webp\"]}";
  SogMembers members = sogImages(degree, rgba(0, 100, 255), rgba(255, 100, 0, 100));
  if (degree > 0) {
    meta += ",\"shN\":{\"shape\":[2," + std::to_string(3 * harmonicsOf(degree)) +
            "],\"mins\":-4.0,\"maxs\":3.96875,\"quantization\":8,"
            "\"files\":[\"p.webp\",\"i.webp\"]}";
    addSogHarmonics(members, degree);
  }
  members.insert(members.begin(), {"meta.json", meta + "}"});
  return members;
}

}  // namespace foci
