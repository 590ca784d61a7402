#include "render/scene/io/mesh_textures.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <fstream>
#include <iterator>
#include <span>
#include <system_error>
#include <utility>

#include "base/image_header.h"
#include "base/input_error.h"
#include "base/quiet_stderr.h"
#include "base/text.h"
#include "render/scene/io/named_file.h"

#ifdef FOCI_BMP_TIFF
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#endif

namespace foci {
namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t kMaxTextureBytes = 1 << 30;
constexpr std::uint64_t kPixelBytes = 8;  // of a texture in memory

std::vector<unsigned char> imageBytes(const fs::path& file) {
  requireRegularFile(file);
  std::error_code error;
  if (fs::file_size(file, error) > kMaxTextureBytes || error) return {};
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

#ifdef FOCI_BMP_TIFF
/// A BMP, TIFF or another format that OpenCV knows; nothing if it cannot be read.
std::optional<DecodedImage> decodeByOpenCv(std::span<const unsigned char> bytes) {
  try {
    const cv::Mat header(1, static_cast<int>(bytes.size()), CV_8U,
                         const_cast<unsigned char*>(bytes.data()));
    cv::Mat read = cv::imdecode(header, cv::IMREAD_UNCHANGED);
    if (read.empty() || (read.depth() != CV_8U && read.depth() != CV_16U)) return std::nullopt;
    read.convertTo(read, CV_8U, read.depth() == CV_16U ? 1.0 / 257.0 : 1.0);
    const int channels = read.channels();
    if (channels == 2) return std::nullopt;
    cv::cvtColor(read, read,
                 channels == 1   ? cv::COLOR_GRAY2RGBA
                 : channels == 3 ? cv::COLOR_BGR2RGBA
                                 : cv::COLOR_BGRA2RGBA);
    return DecodedImage{
        .columns = read.cols, .rows = read.rows, .rgba = {read.datastart, read.dataend}};
  } catch (const cv::Exception&) {
    return std::nullopt;
  }
}
#else
std::optional<DecodedImage> decodeByOpenCv(std::span<const unsigned char>) { return std::nullopt; }
#endif

/// See `MeshTextures::read`. The grey is the luma of ITU-R BT.601.
DecodedImage maskOf(DecodedImage image) {
  std::vector<std::uint8_t>& rgba = image.rgba;
  bool varies = false;
  for (std::size_t i = 3; i < rgba.size(); i += 4) varies |= rgba[i] != rgba[3];
  for (std::size_t i = 0; i < rgba.size(); i += 4) {
    const double grey = 0.299 * rgba[i] + 0.587 * rgba[i + 1] + 0.114 * rgba[i + 2];
    if (!varies) rgba[i + 3] = static_cast<std::uint8_t>(std::lround(grey));
    rgba[i] = rgba[i + 1] = rgba[i + 2] = 255;
  }
  return image;
}

}  // namespace

std::shared_ptr<const MeshTexture> MeshTextures::read(const ImageSource& source, bool as_mask) {
  const auto [at, is_new] =
      textures_.try_emplace(std::pair(source.file ? source.file->string() : source.name, as_mask));
  if (!is_new) return at->second;
  auto read = image(source, as_mask ? "its material is shown without holes"
                                    : "the colour of its material is shown");
  if (read) {
    at->second = std::make_shared<const MeshTexture>(as_mask ? maskOf(std::move(*read)) : *read);
  }
  return at->second;
}

std::optional<DecodedImage> MeshTextures::decoded(std::span<const unsigned char> bytes) {
  budget_.addInput(bytes.size());
  const auto size = statedImageSize(bytes);
  if (size) {
    if (size->columns == 0 || size->rows > kMaxImagePixels / size->columns) return std::nullopt;
    budget_.take(size->columns * size->rows, kPixelBytes, "its textures");
  }
  auto image = decodeImage(bytes);
  if (!image) image = decodeByOpenCv(bytes);
  if (image && image->total() > kMaxImagePixels) return std::nullopt;
  if (image && !size) budget_.take(image->total(), kPixelBytes, "its textures");
  return image;
}

std::optional<DecodedImage> MeshTextures::image(const ImageSource& source, const char* instead) {
  std::optional<DecodedImage> image;
  {
    const QuietStderr quiet;
    const auto read = source.file ? imageBytes(*source.file) : std::vector<unsigned char>();
    const auto bytes = source.file ? std::span<const unsigned char>(read) : source.bytes;
    if (!bytes.empty()) image = decoded(bytes);
  }
  if (image) return image;
  std::string name(plainName(source.name));
  std::replace(name.begin(), name.end(), '\\', '/');
  remarks_.push_back("texture " + shown(fs::path(name).filename().string()) +
                     (source.exists()
                          ? " cannot be read: make it a PNG or JPEG of at most 8192 x 8192; "
                          : " is missing: put it beside the mesh; ") +
                     instead);
  return std::nullopt;
}

}  // namespace foci
