#include "render/scene/io/mesh_textures.h"

#include <algorithm>
#include <cstdint>
#include <fstream>
#include <iterator>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <span>
#include <system_error>
#include <utility>

#include "base/image_header.h"
#include "base/input_error.h"
#include "base/quiet_stderr.h"
#include "base/text.h"
#include "render/scene/io/named_file.h"

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

/// See `MeshTextures::read`.
cv::Mat maskOf(const cv::Mat& image) {
  cv::Mat alpha;
  if (image.channels() == 4) {
    cv::extractChannel(image, alpha, 3);
    double least = 0.0, greatest = 0.0;
    cv::minMaxLoc(alpha, &least, &greatest);
    if (least == greatest) cv::cvtColor(image, alpha, cv::COLOR_BGRA2GRAY);
  } else if (image.channels() == 3) {
    cv::cvtColor(image, alpha, cv::COLOR_BGR2GRAY);
  } else {
    alpha = image;
  }
  const cv::Mat white(image.size(), alpha.type(),
                      cv::Scalar(image.depth() == CV_16U ? 65535.0 : 255.0));
  cv::Mat mask;
  cv::merge(std::vector<cv::Mat>{white, white, white, alpha}, mask);
  return mask;
}

}  // namespace

std::shared_ptr<const MeshTexture> MeshTextures::read(const ImageSource& source, bool as_mask) {
  const auto [at, is_new] =
      textures_.try_emplace(std::pair(source.file ? source.file->string() : source.name, as_mask));
  if (!is_new) return at->second;
  const cv::Mat read = image(source, as_mask ? "its material is shown without holes"
                                             : "the colour of its material is shown");
  if (!read.empty())
    at->second = std::make_shared<const MeshTexture>(as_mask ? maskOf(read) : read);
  return at->second;
}

cv::Mat MeshTextures::decoded(std::span<const unsigned char> bytes) {
  budget_.addInput(bytes.size());
  const auto size = statedImageSize(bytes);
  if (size) {
    if (size->columns == 0 || size->rows > kMaxImagePixels / size->columns) return {};
    budget_.take(size->columns * size->rows, kPixelBytes, "its textures");
  }
  const cv::Mat header(1, static_cast<int>(bytes.size()), CV_8U,
                       const_cast<unsigned char*>(bytes.data()));
  cv::Mat image = cv::imdecode(header, cv::IMREAD_UNCHANGED);
  if (!size && image.total() <= kMaxImagePixels) {
    budget_.take(image.total(), kPixelBytes, "its textures");
  }
  return image;
}

cv::Mat MeshTextures::image(const ImageSource& source, const char* instead) {
  cv::Mat image;
  try {
    const QuietStderr quiet;
    const auto read = source.file ? imageBytes(*source.file) : std::vector<unsigned char>();
    const auto bytes = source.file ? std::span<const unsigned char>(read) : source.bytes;
    if (!bytes.empty()) image = decoded(bytes);
  } catch (const cv::Exception&) {
    image.release();
  }
  const bool usable = !image.empty() && image.total() <= kMaxImagePixels &&
                      (image.depth() == CV_8U || image.depth() == CV_16U) && image.channels() != 2;
  if (usable) return image;
  std::string name(plainName(source.name));
  std::replace(name.begin(), name.end(), '\\', '/');
  remarks_.push_back("texture " + shown(fs::path(name).filename().string()) +
                     (source.exists()
                          ? " cannot be read: make it a PNG or JPEG of at most 8192 x 8192; "
                          : " is missing: put it beside the mesh; ") +
                     instead);
  return {};
}

}  // namespace foci
