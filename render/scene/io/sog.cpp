// PlayCanvas' SOG: meta.json and lossless WebP images, in which a pixel is a Gaussian, as a ZIP
// archive (`.sog`) or in a folder. Positions have 16 bits in two images; deviations, colours and
// harmonics are bytes. In version 2 (developer.playcanvas.com, The SOG Format), a byte is a place
// in a codebook of 256 values. In version 1 (playcanvas/sogs, sogs_compression.py), it is a step
// between the least and the largest value of its channel, and an opacity is a logit.
#include <webp/decode.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>
#include <optional>
#include <string>
#include <string_view>

#include "base/input_error.h"
#include "render/scene/harmonics.h"
#include "render/scene/io/gaussian_formats.h"
#include "render/scene/io/zip_archive.h"

namespace foci {
namespace {

using Json = nlohmann::json;

constexpr const char* kMeta = "meta.json";
constexpr std::size_t kCodes = 256, kPaletteColumns = 64;
constexpr std::size_t kMaxFound = 40;  // bytes of a value in a message
constexpr std::uint64_t kMaxMeta = 1u << 20u, kMaxImage = std::uint64_t{1} << 30u;

/// The alpha of a quaternion is this plus the place of the component that is left out (w x y z).
constexpr unsigned kFirstMode = 252;

/// Pixels for each of the archive's bytes, at most: a lossless WebP of one colour has hardly any
/// bytes. A palette may be an image as large as this, too.
constexpr std::uint64_t kMaxPixelsPerByte = 256, kMaxPalette = 65536 * 15;

/// RGBA, row by row.
struct SogImage {
  int width = 0, height = 0;
  std::vector<unsigned char> rgba;

  std::size_t pixels() const { return rgba.size() / 4; }
  unsigned at(std::size_t pixel, std::size_t channel) const { return rgba[4 * pixel + channel]; }
};

/// meta.json and the images beside it.
class SogMembers {
 public:
  explicit SogMembers(const std::filesystem::path& path)
      : folder_(path.parent_path()), file_(path) {
    if (isArchive(firstBytes(path, 4))) zip_.emplace(file_);
  }

  static bool isArchive(const std::vector<unsigned char>& first) {
    return first == std::vector<unsigned char>{'P', 'K', 3, 4};
  }

  const std::string& name() const { return file_.name(); }

  std::vector<unsigned char> meta() const {
    if (zip_) return zip_->read(kMeta, kMaxMeta);
    return {file_.all().begin(), file_.all().end()};
  }

  std::vector<unsigned char> image(const std::string& name) const {
    if (zip_) return zip_->read(name, kMaxImage);
    if (std::filesystem::path(name).filename() != name) {
      throw InputError(file_.name(), "names the image " + name + ": expected one in its folder");
    }
    const FileBytes packed(folder_ / name);
    return {packed.all().begin(), packed.all().end()};
  }

 private:
  std::filesystem::path folder_;
  FileBytes file_;
  std::optional<ZipArchive> zip_;
};

/// Values of the bytes, for each channel.
template <std::size_t kChannels>
using Codes = std::array<std::array<float, kCodes>, kChannels>;

class SogReader {
 public:
  explicit SogReader(const SogMembers& members) : members_(members) {
    const std::vector<unsigned char> text = members.meta();
    meta_ = Json::parse(text.begin(), text.end());
    const std::int64_t version = has("version") ? integer("version") : 1;
    if (version != 1 && version != 2) {
      throw InputError(
          name(), "is SOG of version " + std::to_string(version) + ": expected version 1 or 2");
    }
    has_codebooks_ = version == 2;
    const std::int64_t count = integer(has_codebooks_ ? "count" : "means/shape/0");
    const std::vector<unsigned char> packed = packedImage("means", 0);
    if (count < 1 || static_cast<std::uint64_t>(count) > kMaxPixelsPerByte * packed.size()) {
      throw InputError(name(), "has " + std::to_string(count) + " Gaussians in images of " +
                                   std::to_string(packed.size()) + " bytes: damaged");
    }
    count_ = static_cast<std::size_t>(count);
  }

  GaussianFile read() {
    GaussianFile file{.format = "SOG"};
    if (has("antialias")) file.cloud.preserves_light = truth("antialias");
    readImages();
    const auto low = numbers<3>("means/mins");
    const auto high = numbers<3>("means/maxs");
    const auto sigmas = codes<3>("scales");
    const auto colors = colorCodes();
    GaussianCollector collector(file, count_, degree_);
    std::vector<float> harmonics(3 * static_cast<std::size_t>(harmonicsOf(degree_)));
    for (std::size_t i = 0; i < count_; ++i) {
      RawGaussian raw{.rotation = rotationOf(i), .opacity = colors[3][color_.at(i, 3)]};
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const int at = static_cast<int>(axis);
        const unsigned step = high_.at(i, axis) << 8u | low_.at(i, axis);
        const float n = low[axis] + (high[axis] - low[axis]) * static_cast<float>(step) / 65535.0f;
        raw.position[at] = std::copysign(std::expm1(std::abs(n)), n);
        raw.sigma[at] = std::exp(sigmas[axis][sigma_.at(i, axis)]);
        raw.color[at] = 0.5f + kHarmonic0 * colors[axis][color_.at(i, axis)];
      }
      readHarmonics(i, harmonics);
      collector.append(raw, harmonics);
    }
    collector.finish(name());
    return file;
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

  /// The name of an image.
  std::string fileOf(const std::string& property, std::size_t which) const {
    const std::string path = property + "/files/" + std::to_string(which);
    const Json value = valueAt(path);
    if (!value.is_string()) throw unexpected(path, "the name of an image");
    return value.get<std::string>();
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
    degree_ = has_codebooks_ ? degreeNamed(integer("shN/bands")) : degreeOfPalette();
    codes_ = has_codebooks_ ? numbers<kCodes>("shN/codebook")
                            : stepsBetween(number("shN/mins"), number("shN/maxs"));
  }

  int degreeNamed(std::int64_t degree) const {
    if (degree < 1 || degree > kMaxHarmonicsDegree) {
      throw InputError(name(),
                       "has harmonics of degree " + std::to_string(degree) + ": expected 1 to 3");
    }
    return static_cast<int>(degree);
  }

  int degreeOfPalette() const {
    for (int degree = 1; degree <= kMaxHarmonicsDegree; ++degree) {
      if (palette_.width == static_cast<int>(kPaletteColumns) * harmonicsOf(degree)) return degree;
    }
    throw InputError(name(), "has a palette of harmonics " + std::to_string(palette_.width) +
                                 " pixels wide: expected 192, 512 or 960, for degree 1 to 3");
  }

  std::vector<unsigned char> packedImage(const char* property, std::size_t which) const {
    return members_.image(fileOf(property, which));
  }

  /// @param least  pixels that the image must have
  SogImage image(const char* property, std::size_t which, std::size_t least) const {
    const std::string file = fileOf(property, which);
    const std::vector<unsigned char> packed = members_.image(file);
    SogImage image;
    if (WebPGetInfo(packed.data(), packed.size(), &image.width, &image.height) == 0) {
      throw InputError(name(), file + ": expected a WebP image");
    }
    const std::uint64_t pixels =
        static_cast<std::uint64_t>(image.width) * static_cast<std::uint64_t>(image.height);
    if (pixels < least || pixels > kMaxPalette + 2 * std::uint64_t{count_} + (1u << 16u)) {
      throw InputError(name(), file + " has " + std::to_string(pixels) + " pixels for " +
                                   std::to_string(count_) + " Gaussians: damaged");
    }
    image.rgba.resize(4 * pixels);
    if (WebPDecodeRGBAInto(packed.data(), packed.size(), image.rgba.data(), image.rgba.size(),
                           4 * image.width) == nullptr) {
      throw InputError(name(), file + ": a damaged WebP image");
    }
    return image;
  }

  /// Three components in bytes; the largest, which is positive, follows from the length of 1.
  glm::vec4 rotationOf(std::size_t i) const {
    const unsigned left_out = rotation_.at(i, 3) - kFirstMode;
    if (left_out > 3) {
      throw InputError(name(), "has a rotation of mode " + std::to_string(rotation_.at(i, 3)) +
                                   ": expected 252 to 255");
    }
    std::array<float, 4> wxyz{};
    float rest = 1.0f;
    for (std::size_t k = 0, channel = 0; k < 4; ++k) {
      if (k == left_out) continue;
      const float byte = static_cast<float>(rotation_.at(i, channel++)) / 255.0f;
      wxyz[k] = (byte - 0.5f) * std::numbers::sqrt2_v<float>;
      rest -= wxyz[k] * wxyz[k];
    }
    wxyz[left_out] = std::sqrt(std::max(rest, 0.0f));
    return {wxyz[1], wxyz[2], wxyz[3], wxyz[0]};
  }

  void readHarmonics(std::size_t i, std::vector<float>& harmonics) const {
    if (degree_ == 0) return;
    const auto each = static_cast<std::size_t>(harmonicsOf(degree_));
    const std::size_t label = label_.at(i, 1) << 8u | label_.at(i, 0);
    const std::size_t row = label / kPaletteColumns, column = label % kPaletteColumns * each;
    const auto width = static_cast<std::size_t>(palette_.width);
    if (column + each > width || row >= static_cast<std::size_t>(palette_.height)) {
      throw InputError(name(), "has harmonics " + std::to_string(label) +
                                   ", which are not in its palette: damaged");
    }
    for (std::size_t k = 0; k < each; ++k) {
      for (std::size_t channel = 0; channel < 3; ++channel) {
        harmonics[3 * k + channel] = codes_[palette_.at(row * width + column + k, channel)];
      }
    }
  }

  const std::string& name() const { return members_.name(); }

  const SogMembers& members_;
  Json meta_;
  bool has_codebooks_ = true;  // version 2
  std::size_t count_ = 0;
  int degree_ = 0;
  SogImage low_, high_, sigma_, rotation_, color_, palette_, label_;
  std::array<float, kCodes> codes_{};
};

}  // namespace

bool isSogFile(const std::filesystem::path& path) {
  const std::vector<unsigned char> first = firstBytes(path, 4);
  // Other scenes are ZIP archives or JSON, too. A damaged archive has the name before one of its
  // members.
  std::vector<std::string_view> words;
  if (SogMembers::isArchive(first)) {
    words = {kMeta};
  } else if (!first.empty() && first[0] == '{') {
    words = {"\"means\"", "\"quats\"", "\"sh0\""};
  } else {
    return false;
  }
  const FileBytes bytes(path);
  const auto all = bytes.all();
  return std::ranges::all_of(words, [&](std::string_view word) {
    return std::search(all.begin(), all.end(), word.begin(), word.end()) != all.end();
  });
}

GaussianFile readSogFile(const std::filesystem::path& path) {
  const SogMembers members(path);
  try {
    return SogReader(members).read();
  } catch (const Json::exception&) {
    throw InputError(members.name(),
                     std::string(kMeta) + ": expected the JSON of a SOG of version 1 or 2");
  }
}

}  // namespace foci
