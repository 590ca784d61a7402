// PlayCanvas' SOG: meta.json and lossless WebP images, in which a pixel is a Gaussian. Positions
// have 16 bits in two images; deviations, colours and harmonics are bytes. In version 2
// (developer.playcanvas.com, The SOG Format), a byte is a place in a codebook of 256 values. In
// version 1 (playcanvas/sogs, sogs_compression.py), it is a step between the least and the largest
// value of its channel, and an opacity is a logit. Private to the readers of SOG.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <glm/glm.hpp>
#include <nlohmann/json.hpp>
#include <numbers>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "base/image_codec.h"
#include "base/input_error.h"
#include "render/scene/harmonics.h"
#include "render/scene/io/compression.h"
#include "render/scene/io/file_bytes.h"
#include "render/scene/io/gaussian_file.h"

namespace foci::sog {

using Json = nlohmann::json;

inline constexpr const char* kMeta = "meta.json";
inline constexpr const char* kStreamMeta = "lod-meta.json";
inline constexpr std::size_t kCodes = 256, kPaletteColumns = 64;
inline constexpr std::size_t kMaxFound = 40;  // bytes of a value in a message
inline constexpr std::uint64_t kMaxMeta = 1u << 20u, kMaxStreamMeta = 1u << 26u,
                               kMaxImage = std::uint64_t{1} << 30u;

/// The alpha of a quaternion is this plus the place of the component that is left out (w x y z).
inline constexpr unsigned kFirstMode = 252;

/// Pixels for each of the archive's bytes, at most: a lossless WebP of one colour has hardly any
/// bytes. A palette may be an image as large as this, too.
inline constexpr std::uint64_t kMaxPixelsPerByte = 256, kMaxPalette = 65536 * 15;

/// RGBA, row by row.
struct Image {
  int width = 0, height = 0;
  std::vector<unsigned char> rgba;

  std::size_t pixels() const { return rgba.size() / 4; }
  unsigned at(std::size_t pixel, std::size_t channel) const { return rgba[4 * pixel + channel]; }
};

/// The files of a SOG: in a ZIP archive, or below a folder.
class Source {
 public:
  explicit Source(const std::filesystem::path& path) : folder_(path.parent_path()), file_(path) {
    if (isArchive(firstBytes(path, 4))) zip_.emplace(file_);
  }

  static bool isArchive(const std::vector<unsigned char>& first) {
    return first == std::vector<unsigned char>{'P', 'K', 3, 4};
  }

  const std::string& name() const { return file_.name(); }

  /// Of the file that the source was opened by, `meta` is the name in an archive.
  std::vector<unsigned char> main(const char* meta, std::uint64_t max_bytes) const {
    if (zip_) return zip_->read(meta, max_bytes);
    return {file_.all().begin(), file_.all().end()};
  }

  /// @param member  "0_0/means_l.webp"; nothing outside of the folder
  std::vector<unsigned char> read(const std::string& member, std::uint64_t max_bytes) const {
    if (zip_) return zip_->read(member, max_bytes);
    const std::filesystem::path path(member);
    if (path.is_absolute() || std::ranges::find(path, "..") != path.end()) {
      throw InputError(file_.name(), "names the file ", member, ": expected one in its folder");
    }
    const FileBytes packed(folder_ / path);
    return {packed.all().begin(), packed.all().end()};
  }

 private:
  std::filesystem::path folder_;
  FileBytes file_;
  std::optional<ZipArchive> zip_;
};

/// A part of a chunk: Gaussians one after another.
struct Range {
  std::size_t offset = 0, count = 0;
};

/// Values of the bytes, for each channel.
template <std::size_t kChannels>
using Codes = std::array<std::array<float, kCodes>, kChannels>;

class Reader {
 public:
  /// @param folder  of the images in the source: "0_0/", or ""
  Reader(const Source& source, std::string folder, const std::vector<unsigned char>& meta)
      : source_(source), folder_(std::move(folder)), meta_(Json::parse(meta.begin(), meta.end())) {
    const std::int64_t version = has("version") ? integer("version") : 1;
    if (version != 1 && version != 2) {
      throw InputError(name(), "is SOG of version ", version, ": expected version 1 or 2");
    }
    has_codebooks_ = version == 2;
    const std::int64_t count = integer(has_codebooks_ ? "count" : "means/shape/0");
    const std::vector<unsigned char> packed = packedImage("means", 0);
    if (count < 1 || static_cast<std::uint64_t>(count) > kMaxPixelsPerByte * packed.size()) {
      throw InputError(name(), "has ", count, " Gaussians in images of ", packed.size(),
                       " bytes: damaged");
    }
    count_ = static_cast<std::size_t>(count);
  }

  std::size_t count() const { return count_; }

  int degree() const {
    if (!has("shN")) return 0;
    if (has_codebooks_) return std::min(degreeNamed(integer("shN/bands")), kMaxHarmonicsDegree);
    return degreeOfPalette(image("shN", 0, 0));
  }

  /// Appends Gaussians of these places, with harmonics of the file's degree, which may be higher.
  void appendTo(GaussianFile& file, std::span<const Range> ranges) {
    cloudFacts(file);
    readImages();
    const auto low = numbers<3>("means/mins");
    const auto high = numbers<3>("means/maxs");
    const auto sigmas = codes<3>("scales");
    const auto colors = colorCodes();
    std::size_t count = 0;
    for (const Range& range : ranges) count += range.count;
    GaussianCollector collector(file, count, file.cloud.degree);
    std::vector<float> harmonics(file.cloud.harmonicsPerGaussian());
    for (const Range& range : ranges) {
      if (range.offset > count_ || range.count > count_ - range.offset) {
        throw InputError(name(), folder_, kMeta, ": has ", count_, " Gaussians, fewer than ",
                         kStreamMeta, " names");
      }
      for (std::size_t i = range.offset; i < range.offset + range.count; ++i) {
        RawGaussian raw{.rotation = rotationOf(i), .opacity = colors[3][color_.at(i, 3)]};
        for (std::size_t axis = 0; axis < 3; ++axis) {
          const int at = static_cast<int>(axis);
          const unsigned step = high_.at(i, axis) << 8u | low_.at(i, axis);
          const float n =
              low[axis] + (high[axis] - low[axis]) * static_cast<float>(step) / 65535.0f;
          raw.position[at] = std::copysign(static_cast<float>(std::expm1(std::abs(double{n}))), n);
          raw.sigma[at] = std::exp(sigmas[axis][sigma_.at(i, axis)]);
          raw.color[at] = 0.5f + kHarmonic0 * colors[axis][color_.at(i, axis)];
        }
        readHarmonics(i, harmonics);
        collector.append(raw, harmonics);
      }
    }
  }

 private:
  /// Keys of meta.json are paths, as `means/files/0`.
  bool has(const std::string& path) const { return meta_.contains(Json::json_pointer("/" + path)); }

  Json valueAt(const std::string& path) const {
    return has(path) ? meta_.at(Json::json_pointer("/" + path)) : Json();
  }

  InputError unexpected(const std::string& path, const std::string& expected) const {
    std::string found = "nothing";
    if (has(path)) {
      const Json value = valueAt(path);
      found = value.dump(-1, ' ', /*ensure_ascii=*/true);
      if (found.size() > kMaxFound) found = found.substr(0, kMaxFound) + "...";
      if (value.is_array()) found = "a list of " + std::to_string(value.size()) + ": " + found;
    }
    return {name(),
            std::string(kMeta) + ": " + path + ": expected " + expected + ", found " + found};
  }

  /// What the file says of all its Gaussians.
  void cloudFacts(GaussianFile& file) const {
    if (has("antialias")) file.cloud.preserves_light = truth("antialias");
    if (valueAt("model") == "antialiased") file.cloud.preserves_light = true;
    if (stored_degree_ > kMaxHarmonicsDegree) file.remarks.emplace_back(kDegree4);
  }

  std::int64_t integer(const std::string& path) const {
    const Json value = valueAt(path);
    if (!value.is_number_integer()) throw unexpected(path, "a whole number");
    return value.get<std::int64_t>();
  }

  float number(const std::string& path) const {
    const Json value = valueAt(path);
    if (!value.is_number()) throw unexpected(path, "a number");
    return value.get<float>();
  }

  bool truth(const std::string& path) const {
    const Json value = valueAt(path);
    if (!value.is_boolean()) throw unexpected(path, "true or false");
    return value.get<bool>();
  }

  /// The name of an image, which lies beside its meta.json.
  std::string nameOf(const std::string& property, std::size_t which) const {
    const std::string path = property + "/files/" + std::to_string(which);
    const Json value = valueAt(path);
    if (!value.is_string()) throw unexpected(path, "the name of an image");
    std::string file = value.get<std::string>();
    if (std::filesystem::path(file).filename() != file) {
      throw InputError(name(), "names the image ", file, ": expected one in its folder");
    }
    return file;
  }

  template <std::size_t kCount>
  std::array<float, kCount> numbers(const std::string& path) const {
    const Json list = valueAt(path);
    const bool sound = list.is_array() && list.size() == kCount &&
                       std::ranges::all_of(list, [](const Json& x) { return x.is_number(); });
    if (!sound) throw unexpected(path, "a list of " + std::to_string(kCount) + " numbers");
    std::array<float, kCount> all{};
    for (std::size_t i = 0; i < kCount; ++i) all[i] = list[i].get<float>();
    return all;
  }

  /// A property's codebook, which all channels share; in version 1, steps for each channel.
  template <std::size_t kChannels>
  Codes<kChannels> codes(const std::string& property) const {
    Codes<kChannels> all{};
    if (has_codebooks_) {
      all.fill(numbers<kCodes>(property + "/codebook"));
      return all;
    }
    const auto low = numbers<kChannels>(property + "/mins");
    const auto high = numbers<kChannels>(property + "/maxs");
    for (std::size_t k = 0; k < kChannels; ++k) all[k] = stepsBetween(low[k], high[k]);
    return all;
  }

  static std::array<float, kCodes> stepsBetween(float low, float high) {
    std::array<float, kCodes> steps{};
    for (std::size_t i = 0; i < kCodes; ++i) {
      steps[i] = low + (high - low) * static_cast<float>(i) / 255.0f;
    }
    return steps;
  }

  /// Coefficients of degree 0, and opacities.
  Codes<4> colorCodes() const {
    Codes<4> all = codes<4>("sh0");
    if (has_codebooks_) {
      all[3] = stepsBetween(0.0f, 1.0f);
    } else {
      for (float& opacity : all[3]) opacity = sigmoid(opacity);
    }
    return all;
  }

  void readImages() {
    low_ = image("means", 0, count_);
    high_ = image("means", 1, count_);
    sigma_ = image("scales", 0, count_);
    rotation_ = image("quats", 0, count_);
    color_ = image("sh0", 0, count_);
    if (!has("shN")) return;
    palette_ = image("shN", 0, 0);
    label_ = image("shN", 1, count_);
    stored_degree_ = has_codebooks_ ? degreeNamed(integer("shN/bands")) : degreeOfPalette(palette_);
    codes_ = has_codebooks_ ? numbers<kCodes>("shN/codebook")
                            : stepsBetween(number("shN/mins"), number("shN/maxs"));
  }

  int degreeNamed(std::int64_t degree) const {
    if (degree < 1 || degree > kMaxHarmonicsDegree + 1) {
      throw InputError(name(), "has harmonics of degree ", degree, ": expected 1 to 4");
    }
    return static_cast<int>(degree);
  }

  int degreeOfPalette(const Image& palette) const {
    for (int degree = 1; degree <= kMaxHarmonicsDegree; ++degree) {
      if (palette.width == static_cast<int>(kPaletteColumns) * harmonicsOf(degree)) return degree;
    }
    throw InputError(name(), "has a palette of harmonics ", palette.width,
                     " pixels wide: expected 192, 512 or 960, for degree 1 to 3");
  }

  std::vector<unsigned char> packedImage(const char* property, std::size_t which) const {
    return source_.read(folder_ + nameOf(property, which), kMaxImage);
  }

  /// @param least  pixels that the image must have
  Image image(const char* property, std::size_t which, std::size_t least) const {
    const std::string file = nameOf(property, which);
    const std::vector<unsigned char> packed = source_.read(folder_ + file, kMaxImage);
    if (!readsCompressed()) {
      throw InputError(name(), "holds WebP images: foci was built without WebP");
    }
    const auto size = statedImageSize(packed);
    if (!size) throw InputError(name(), file, ": expected a WebP image");
    const std::uint64_t pixels = size->columns * size->rows;
    if (pixels < least || pixels > kMaxPalette + 2 * std::uint64_t{count_} + (1u << 16u)) {
      throw InputError(name(), file, " has ", pixels, " pixels for ", count_,
                       " Gaussians: damaged");
    }
    auto image = decodeImage(packed, pixels);
    if (!image) throw InputError(name(), file, ": a damaged WebP image");
    return {image->columns, image->rows, std::move(image->rgba)};
  }

  /// Three components in bytes; the largest, which is positive, follows from the length of 1.
  glm::vec4 rotationOf(std::size_t i) const {
    const unsigned left_out = rotation_.at(i, 3) - kFirstMode;
    if (left_out > 3) {
      throw InputError(name(), "has a rotation of mode ", rotation_.at(i, 3),
                       ": expected 252 to 255");
    }
    std::array<float, 3> three{};
    for (std::size_t k = 0; k < 3; ++k) {
      const float byte = static_cast<float>(rotation_.at(i, k)) / 255.0f;
      three[k] = (byte - 0.5f) * std::numbers::sqrt2_v<float>;
    }
    const auto wxyz = quaternionOf(three, left_out);
    return {wxyz[1], wxyz[2], wxyz[3], wxyz[0]};
  }

  void readHarmonics(std::size_t i, std::vector<float>& harmonics) const {
    std::ranges::fill(harmonics, 0.0f);
    if (stored_degree_ == 0) return;
    const auto each = static_cast<std::size_t>(harmonicsOf(stored_degree_));
    const std::size_t label = label_.at(i, 1) << 8u | label_.at(i, 0);
    const std::size_t row = label / kPaletteColumns, column = label % kPaletteColumns * each;
    const auto width = static_cast<std::size_t>(palette_.width);
    if (column + each > width || row >= static_cast<std::size_t>(palette_.height)) {
      throw InputError(name(), "has harmonics ", label, ", which are not in its palette: damaged");
    }
    for (std::size_t k = 0; k < std::min(each, harmonics.size() / 3); ++k) {
      for (std::size_t channel = 0; channel < 3; ++channel) {
        harmonics[3 * k + channel] = codes_[palette_.at(row * width + column + k, channel)];
      }
    }
  }

  const std::string& name() const { return source_.name(); }

  const Source& source_;
  std::string folder_;
  Json meta_;
  bool has_codebooks_ = true;  // version 2
  std::size_t count_ = 0;
  int stored_degree_ = 0;
  Image low_, high_, sigma_, rotation_, color_, palette_, label_;
  std::array<float, kCodes> codes_{};
};

}  // namespace foci::sog
