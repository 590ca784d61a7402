#include "render/scene/io/mesh_textures.h"

#include <assimp/scene.h>

#include <algorithm>
#include <cctype>
#include <cstdint>
#include <fstream>
#include <iterator>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <span>
#include <system_error>
#include <utility>

#include "base/input_error.h"
#include "base/quiet_stderr.h"
#include "base/text.h"
#include "render/scene/io/gltf_json.h"
#include "render/scene/io/image_header.h"

namespace foci {
namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t kMaxTextureBytes = 1 << 30;
constexpr int kMaxEntries = 10'000;  // of a folder that is searched

std::string lower(std::string text) {
  for (char& c : text) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return text;
}

/// The entry of a folder that has this name in lower case.
std::optional<fs::path> entryOf(const fs::path& folder, const std::string& name) {
  std::error_code error;
  int entries = 0;
  for (fs::directory_iterator at(folder.empty() ? "." : folder, error), end; !error && at != end;
       at.increment(error)) {
    if (++entries > kMaxEntries) break;
    const fs::path file = at->path().filename();
    if (lower(file.string()) == name) return folder / file;
  }
  return std::nullopt;
}

cv::Mat decoded(std::span<const unsigned char> bytes) {
  const auto size = statedImageSize(bytes);
  if (size && (size->columns > kMaxTexturePixels || size->rows > kMaxTexturePixels ||
               size->columns * size->rows > kMaxTexturePixels)) {
    return {};
  }
  const cv::Mat header(1, static_cast<int>(bytes.size()), CV_8U,
                       const_cast<unsigned char*>(bytes.data()));
  return cv::imdecode(header, cv::IMREAD_UNCHANGED);
}

cv::Mat imageOf(const aiTexture& embedded) {
  if (embedded.mHeight == 0) {  // the bytes of an image file
    return decoded({reinterpret_cast<const unsigned char*>(embedded.pcData), embedded.mWidth});
  }
  return cv::Mat(static_cast<int>(embedded.mHeight), static_cast<int>(embedded.mWidth), CV_8UC4,
                 embedded.pcData);
}

cv::Mat imageOf(const fs::path& file) {
  requireRegularFile(file);
  std::error_code error;
  if (fs::file_size(file, error) > kMaxTextureBytes || error) return {};
  std::ifstream in(file, std::ios::binary);
  const std::vector<unsigned char> bytes{std::istreambuf_iterator<char>(in), {}};
  return bytes.empty() ? cv::Mat() : decoded(bytes);
}

/// See `MeshTextures::readMask`.
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

std::optional<fs::path> textureFile(const fs::path& mesh, std::string name) {
  std::replace(name.begin(), name.end(), '\\', '/');
  const fs::path folder = mesh.parent_path(), stated = folder / name;
  std::error_code ignored;
  if (fs::exists(stated, ignored) && !fs::is_directory(stated, ignored)) return stated;
  if (isGltf(mesh)) {  // names are URIs
    if (std::string plain = percentDecoded(name); plain != name) return textureFile(mesh, plain);
  }
  const std::string bare = lower(fs::path(name).filename().string());
  if (bare.empty()) return std::nullopt;
  if (auto beside = entryOf(folder, bare)) return beside;
  const auto textures = entryOf(folder, "textures");
  return textures ? entryOf(*textures, bare) : std::nullopt;
}

std::shared_ptr<const MeshTexture> MeshTextures::read(const std::string& name) {
  const auto [at, is_new] = textures_.try_emplace(name);
  if (!is_new) return at->second;
  const cv::Mat read = image(name, "the colour of its material is shown");
  if (!read.empty()) at->second = std::make_shared<const MeshTexture>(read);
  return at->second;
}

std::shared_ptr<const MeshTexture> MeshTextures::readMask(const std::string& name) {
  const auto [at, is_new] = masks_.try_emplace(name);
  if (!is_new) return at->second;
  const cv::Mat read = image(name, "its material is shown without holes");
  if (!read.empty()) at->second = std::make_shared<const MeshTexture>(maskOf(read));
  return at->second;
}

cv::Mat MeshTextures::image(std::string name, const char* instead) {
  const aiTexture* const embedded = scene_.GetEmbeddedTexture(name.c_str());
  const auto file = embedded != nullptr ? std::nullopt : textureFile(mesh_, name);
  cv::Mat image;
  try {
    const QuietStderr quiet;
    if (embedded != nullptr) {
      image = imageOf(*embedded);
    } else if (file) {
      image = imageOf(*file);
    }
  } catch (const cv::Exception&) {
    image.release();
  }
  const bool usable = !image.empty() && image.total() <= kMaxTexturePixels &&
                      (image.depth() == CV_8U || image.depth() == CV_16U) && image.channels() != 2;
  if (usable) return image;
  const bool absent = embedded == nullptr && !file;
  std::replace(name.begin(), name.end(), '\\', '/');
  remarks_.push_back("texture " + shown(fs::path(name).filename().string()) +
                     (absent ? " is missing: put it beside the mesh; "
                             : " cannot be read: make it a PNG or JPEG of at most 8192 x 8192; ") +
                     instead);
  return {};
}

}  // namespace foci
