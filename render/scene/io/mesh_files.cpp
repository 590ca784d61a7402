#include "render/scene/io/mesh_files.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fstream>
#include <iterator>
#include <system_error>

#include "base/file.h"
#include "base/input_error.h"
#include "base/media.h"
#include "base/quiet_stderr.h"
#include "base/text.h"
#include "render/scene/io/gltf_document.h"
#include "render/scene/io/obj.h"
#include "render/scene/io/ply_items.h"

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

constexpr int kMaxEntries = 10'000;  // of a folder that is searched

bool isFile(const fs::path& path) {
  std::error_code ignored;
  return fs::exists(path, ignored) && !fs::is_directory(path, ignored);
}

/// The entry of a folder whose name differs in case alone.
std::optional<fs::path> entryOf(const fs::path& folder, const fs::path& name) {
  std::error_code error;
  if (fs::exists(folder / name, error)) return folder / name;
  const std::string wanted = lowered(name.string());
  int entries = 0;
  for (fs::directory_iterator at(folder.empty() ? "." : folder, error), end; !error && at != end;
       at.increment(error)) {
    if (++entries > kMaxEntries) break;
    const fs::path entry = at->path().filename();
    if (lowered(entry.string()) == wanted) return folder / entry;
  }
  return std::nullopt;
}

/// The file below a folder whose names differ in case alone.
std::optional<fs::path> fileBelow(const fs::path& folder, const fs::path& name) {
  std::optional<fs::path> at = folder;
  for (const fs::path& part : name) {
    if (at) at = entryOf(*at, part);
  }
  return at && isFile(*at) ? at : std::nullopt;
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
  if (!image && media()) image = media()->decodeImage(bytes);
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
  std::ranges::replace(name, '\\', '/');
  remarks_.push_back("texture " + shown(fs::path(name).filename().string()) +
                     (source.name.find("<UDIM>") != std::string::npos
                          ? " stands for many tiles, and foci shows one texture for a material: "
                            "join them; "
                      : source.exists()
                          ? " cannot be read: make it a PNG or JPEG of at most 8192 x 8192; "
                          : " is missing: put it beside the mesh; ") +
                     instead);
  return std::nullopt;
}

std::optional<fs::path> namedFile(const fs::path& beside, std::string_view name) {
  std::string stated(plainName(name));
  std::ranges::replace(stated, '\\', '/');
  const fs::path path = stated, folder = beside.parent_path(), bare = path.filename();
  if (bare.empty()) return std::nullopt;
  if (isFile(folder / path)) return folder / path;
  if (path.is_relative()) {
    if (auto below = fileBelow(folder, path)) return below;
  }
  if (auto own = fileBelow(folder, bare)) return own;
  return fileBelow(folder, fs::path("textures") / bare);
}

std::string_view plainName(std::string_view name) {
  name = trimmed(name);
  if (name.size() >= 2 && name.front() == '"' && name.back() == '"') {
    name = trimmed(name.substr(1, name.size() - 2));
  }
  return name;
}

std::string percentDecoded(std::string_view uri) {
  std::string text;
  for (std::size_t i = 0; i < uri.size(); ++i) {
    unsigned code = 0;
    const char* const first = uri.data() + i + 1;
    const bool encoded = uri[i] == '%' && i + 2 < uri.size() &&
                         std::from_chars(first, first + 2, code, 16).ptr == first + 2;
    text += encoded ? static_cast<char>(code) : uri[i];
    if (encoded) i += 2;
  }
  return text;
}

std::optional<fs::path> fileOfUri(const fs::path& beside, const std::string& uri) {
  const auto file = namedFile(beside, uri);
  return file ? file : namedFile(beside, percentDecoded(uri));
}

std::vector<fs::path> meshCompanions(const fs::path& mesh) {
  std::vector<fs::path> files;
  const auto add = [&](const std::optional<fs::path>& file) {
    if (file && std::ranges::find(files, *file) == files.end()) files.push_back(*file);
  };
  std::error_code ignored;
  if (!fs::is_regular_file(mesh, ignored)) return files;
  const std::string extension = lowerExtension(mesh);
  try {
    if (extension == ".gltf" || extension == ".glb") {
      const GltfDocument gltf(mesh);
      for (const char* list : {"buffers", "images"}) {
        for (const auto& entry : arrayIn(gltf.json(), list)) {
          const auto uri = textIn(entry, "uri");
          if (uri && !uri->starts_with("data:")) add(fileOfUri(mesh, *uri));
        }
      }
    } else if (extension == ".obj") {
      for (const fs::path& library : librariesOf(mesh, libraryNames(mesh))) {
        add(library);
        for (const fs::path& texture : readMtl(library, mesh).textures) add(texture);
      }
    } else if (extension == ".ply") {
      ply::Input input(mesh);
      for (const std::string& name : ply::textureNames(ply::readHeader(input))) {
        add(namedFile(mesh, name));
      }
    }
  } catch (const InputError&) {  // opening the scene reports it
    files.clear();
  }
  return files;
}

}  // namespace foci
