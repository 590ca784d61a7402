// The table of scene formats: extensions, first bytes and readers, and the right word for what is
// no scene.

#include <algorithm>
#include <array>
#include <cstddef>
#include <initializer_list>
#include <span>
#include <utility>

#include "base/file.h"
#include "base/input_error.h"
#include "base/text.h"
#include "render/scene/io/file_bytes.h"
#include "render/scene/io/mesh_formats.h"
#include "render/scene/io/open_scene.h"
#include "render/scene/io/ply.h"
#include "render/scene/io/point_formats.h"
#include "render/scene/io/scan_values.h"

namespace foci {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kStart = 4096;  // bytes; the header of .ksplat is the longest

/// Blanks before the text do not count.
bool startsWith(const FileStart& start, std::initializer_list<std::string_view> any) {
  const std::string_view text =
      start.text().substr(std::min(start.text().find_first_not_of(" \t\r\n"), start.bytes.size()));
  return std::ranges::any_of(any, [&](std::string_view mark) { return text.starts_with(mark); });
}

bool holdsAll(const FileStart& start, std::initializer_list<std::string_view> all) {
  return std::ranges::all_of(all, [&](std::string_view part) {
    return start.text().find(part) != std::string_view::npos;
  });
}

/// The first word of the first line that is neither empty nor a comment.
std::string_view firstWord(std::string_view text) {
  while (!text.empty()) {
    const std::string_view line = trimmed(text.substr(0, text.find('\n')));
    if (!line.empty() && line[0] != '#') return line.substr(0, line.find_first_of(" \t"));
    text.remove_prefix(std::min(text.find('\n'), text.size() - 1) + 1);
  }
  return {};
}

bool isObj(const FileStart& start) {
  constexpr std::array<std::string_view, 9> kWords = {"v", "vn", "vt", "mtllib", "usemtl",
                                                      "o", "g",  "s",  "vp"};
  return std::ranges::find(kWords, firstWord(start.text())) != kWords.end();
}

bool isStl(const FileStart& start) {
  if (start.text().starts_with("solid") && holdsAll(start, {"facet"})) return true;
  constexpr std::size_t kHead = 84, kTriangle = 50;
  std::error_code ignored;
  const std::uintmax_t size = fs::file_size(start.path, ignored);
  return start.bytes.size() >= kHead + kTriangle && !ignored &&
         size == kHead + kTriangle * std::uintmax_t{u32At(start.bytes, kHead - 4)};
}

bool isGltfText(const FileStart& start) {
  return firstWord(start.text()).starts_with('{') && !holdsAll(start, {"\"geometricError\""}) &&
         (holdsAll(start, {"\"asset\""}) || holdsAll(start, {"\"accessors\""}) ||
          holdsAll(start, {"\"bufferViews\""}));
}

bool isText(const FileStart& start) {
  return std::ranges::find(start.bytes, 0) == start.bytes.end();
}

template <auto kRead>
SceneContent with(const fs::path& path, std::uint64_t /*checked_B*/) {
  return kRead(path);
}

/// Of a reader of points or a mesh.
template <auto kRead>
SceneContent either(const fs::path& path, std::uint64_t /*checked_B*/) {
  return std::visit([](auto&& read) { return SceneContent(std::forward<decltype(read)>(read)); },
                    kRead(path));
}

SceneContent readPrepared(const fs::path& path, std::uint64_t checked_B) {
  if (isSceneFile(path)) return readSceneFile(path, checked_B);
  throw InputError(
      path.string(),
      "is no prepared scene: expected FOCI in its first bytes; foci prepare makes one");
}

SceneContent readPlyScene(const fs::path& path, std::uint64_t /*checked_B*/) {
  ply::Input input(path);
  const ply::Header header = ply::readHeader(input);
  if (isGaussianPly(header)) return readGaussianPly(path);
  if (isCompressedGaussianPly(header)) return readCompressedGaussianPly(path);
  if (isPlyMesh(header)) return readPlyMesh(path);
  return readPly(path);
}

/// Adds a remark if the mesh is far larger than the Gaussians beside it.
void remarkLargeMesh(GaussianFile& file) {
  constexpr float kOtherUnit = 30.0f;  // chosen by hand
  const auto extentOf = [](std::span<const glm::vec3> places) {
    const auto [low, high] = boxOf(places);
    return glm::length(high - low);
  };
  const float times = extentOf(file.mesh->corners_m) / extentOf(file.cloud.position_m);
  if (!(times > kOtherUnit)) return;
  file.remarks.push_back(
      "the mesh is " + thousands(double{times}) +
      " times as large as the Gaussians beside it: is one of them in another unit?");
}

/// Gaussians, with the mesh and the points beside them; else points, or a mesh.
SceneContent readGltfScene(const fs::path& path, std::uint64_t /*checked_B*/) {
  const GltfDocument gltf(path);
  GltfPoints found = readGltfPoints(gltf);
  if (!found.gaussians && (found.has_triangles || !found.points)) return readGltfMesh(gltf);
  if (!found.gaussians) return std::move(*found.points);
  GaussianFile& file = *found.gaussians;
  if (found.points) file.points = std::make_shared<PointCloud>(std::move(*found.points));
  if (found.has_triangles) {
    file.mesh = std::make_shared<TriangleMesh>(readGltfMesh(gltf, true).mesh);
    file.remarks.insert(file.remarks.end(), file.mesh->remarks.begin(), file.mesh->remarks.end());
    remarkLargeMesh(file);
  }
  return std::move(file);
}

SceneContent readSpzScene(const fs::path& path, std::uint64_t /*checked_B*/) {
  return readSpz(FileBytes(path));
}

using Kind = SceneKind;

/// Formats with a mark come first; in each half, the order decides.
constexpr std::array kSceneFormats = {
    SceneFormat{Kind::prepared, ".foci", true, false,
                [](const FileStart& s) { return isSceneFile(s.path); }, readPrepared},
    SceneFormat{Kind::las, ".las .laz", true, true,
                [](const FileStart& s) { return startsWith(s, {"LASF"}); }, with<readLas>},
    SceneFormat{Kind::ply_points, ".ply", true, true,
                [](const FileStart& s) {
                  return startsWith(s, {"ply\n", "ply\r", "ply "});
                },
                readPlyScene},
    SceneFormat{Kind::gaussians, ".ssog", true, false,
                [](const FileStart& s) { return isStreamedSog(s.path); },
                [](const fs::path& path, std::uint64_t) -> SceneContent {
                  return StreamedGaussians(path);
                }},
    SceneFormat{Kind::gaussians, ".sog", true, false,
                [](const FileStart& s) { return isSogFile(s.path); }, with<readSogFile>},
    SceneFormat{Kind::gltf, ".glb .gltf", true, false,
                [](const FileStart& s) { return startsWith(s, {"glTF"}) || isGltfText(s); },
                readGltfScene},
    SceneFormat{Kind::fbx, ".fbx", true, false,
                [](const FileStart& s) {
                  return startsWith(s, {"Kaydara FBX Binary", "; FBX"});
                },
                with<readFbxMesh>},
    SceneFormat{Kind::gaussians, ".spz", true, true,
                [](const FileStart& s) { return isSpz(s.bytes); }, readSpzScene},
    SceneFormat{Kind::gaussians, ".ksplat", true, false,
                [](const FileStart& s) { return isKsplatFile(s.path); }, with<readKsplatFile>},
    SceneFormat{Kind::pcd, ".pcd", true, true, [](const FileStart& s) { return isPcd(s.text()); },
                with<readPcd>},
    SceneFormat{Kind::obj, ".obj", false, false, isObj, either<readObj>},
    SceneFormat{Kind::stl, ".stl", false, false, isStl, with<readStlMesh>},
    SceneFormat{Kind::off_points, ".off", false, true,
                [](const FileStart& s) { return firstWord(s.text()).ends_with("OFF"); },
                either<readOff>},
    SceneFormat{Kind::gaussians, ".splat", false, false,
                [](const FileStart& s) { return isSplatFile(s.path); }, with<readSplatFile>},
    SceneFormat{Kind::colmap, "", false, false,
                [](const FileStart& s) { return isColmapFile(s.path); }, with<readColmap>},
    SceneFormat{Kind::text_points, ".xyz .pts .asc .pwn .xyzrgb", false, true,
                [](const FileStart& s) { return isText(s) && startsWithPoints(s.path); },
                with<readTextPoints>},
};

bool isListed(std::string_view extensions, std::string_view extension) {
  if (extension.empty()) return false;
  const std::size_t at = extensions.find(extension);
  const std::size_t end = at + extension.size();
  return at != std::string_view::npos && (end == extensions.size() || extensions[end] == ' ');
}

constexpr std::string_view kPdal = "CloudCompare, or pdal translate IN OUT.ply, makes a PLY of it";
constexpr std::string_view kBlender = "Blender can export it as glTF";
constexpr std::string_view kCad = "FreeCAD can export it as STL or OBJ";
constexpr std::string_view kParaview = "ParaView can export it as PLY";
constexpr std::string_view kSplats = "SuperSplat or splat-transform makes a PLY of it";

/// Formats that foci does not read, and what converts them.
struct Converter {
  std::string_view extensions, how;
};
constexpr std::array kConverters = {
    Converter{".e57 .ptx", kPdal},
    Converter{".dae .3ds .blend .usd .usda .usdc .usdz .x3d .wrl .lwo .dxf .abc .drc", kBlender},
    Converter{".3mf .step .stp .iges .igs .3dm .amf", kCad},
    Converter{".vtk .vtp .vtu", kParaview},
    Converter{".lcc", kSplats},
};

const Converter* converterOf(const FileStart& start) {
  const auto* const found = std::ranges::find_if(kConverters, [&](const Converter& each) {
    return isListed(each.extensions, start.extension);
  });
  return found == kConverters.end() ? nullptr : found;
}

/// What the first bytes say of a file that is no scene.
struct Mark {
  std::size_t at;
  std::string_view bytes;  ///< in lower case
  std::string_view what;
  std::string_view how{};  ///< what else to do; empty: `what` says it
};
using namespace std::string_view_literals;
constexpr std::string_view kPicture =
    "is a picture: foci renders scenes of points, meshes or Gaussians";
constexpr std::string_view kColmapList =
    "is a list of COLMAP: give foci its points (points3D.bin or points3D.txt)";
constexpr std::string_view kTileWords =
    "is a tile of 3D Tiles, which foci does not read: give foci the glTF that it was made of";
constexpr std::array kMarks = {
    Mark{0, "b3dm", kTileWords},
    Mark{0, "i3dm", kTileWords},
    Mark{0, "cmpt", kTileWords},
    Mark{0, "pnts", kTileWords},
    Mark{0, "7z\xbc\xaf", "is a 7z archive: unpack it, and give the scene in it"},
    Mark{0, "rar!", "is a RAR archive: unpack it, and give the scene in it"},
    Mark{0, "bzh", "is packed by bzip2: unpack it with bunzip2"},
    Mark{0, "\xfd\x37zxz", "is packed by xz: unpack it with unxz"},
    Mark{0, "\x28\xb5\x2f\xfd", "is packed by Zstandard: unpack it with unzstd"},
    Mark{257, "ustar", "is a tar archive: unpack it, and give the scene in it"},
    Mark{0, "\x89png", kPicture},
    Mark{0, "\xff\xd8\xff", kPicture},
    Mark{0, "gif8", kPicture},
    Mark{0, "ii*\0"sv, kPicture},
    Mark{0, "mm\0*"sv, kPicture},
    Mark{8, "webp", kPicture},
    Mark{4, "ftyp", "is a video, or a picture: foci renders scenes of points, meshes or Gaussians"},
    Mark{0, "%pdf", "is a PDF"},
    Mark{0, "\x89hdf", "is an HDF5 file", "save points as PLY or XYZ"},
    Mark{0, "\x93numpy", "is a NumPy array: numpy.savetxt writes points as text"},
    Mark{0, "astm-e57", "is an E57 scan", kPdal},
    Mark{0, "pxr-usdc", "is a USD scene", kBlender},
    Mark{0, "#usda", "is a USD scene", kBlender},
    Mark{0, "blender", "is a Blender scene", kBlender},
    Mark{0, "# vtk datafile", "is a VTK file", kParaview},
    Mark{0, "#vrml", "is a VRML scene", kBlender},
    Mark{0, "<?xml", "is an XML file", "if it is a scene, Blender may export it as glTF"},
    Mark{0, "# image list with two lines", kColmapList},
    Mark{0, "# camera list with one line", kColmapList},
    Mark{0, "visionre",
         "is a VRS recording: give foci the points beside it (semidense_points.csv.gz)"},
    Mark{0, "\x7f\x65lf", "is a program"},
};

std::string zipWords(const FileStart& start) {
  constexpr std::size_t kNameLengthAt = 26, kFirstNameAt = 30;
  std::string first;
  if (start.bytes.size() > kFirstNameAt) {
    first = start.text().substr(kFirstNameAt, u16At(start.bytes, kNameLengthAt));
  }
  if (first.find("data.pkl") != std::string::npos) {
    return "is a checkpoint of PyTorch: export its Gaussians as PLY";
  }
  return "is a ZIP archive" + (first.empty() ? "" : " that begins with " + shown(first)) +
         ": unpack it, and give the scene in it";
}

/// Whether a text in ASCII has two bytes a character, behind the byte order mark.
bool isUtf16(std::string_view text) {
  constexpr std::size_t kLeast = 6, kLookedAt = 16;
  const bool big = text.starts_with("\xfe\xff");
  if (text.size() < kLeast || (!big && !text.starts_with("\xff\xfe"))) return false;
  for (std::size_t i = 2; i + 1 < std::min(text.size(), kLookedAt); i += 2) {
    if ((text[i] == '\0') != big || (text[i + 1] == '\0') == big) return false;
  }
  return true;
}

/// Whether a text begins like an ESRI ASCII grid: "ncols 100".
bool isGrid(const FileStart& start) {
  const std::string word = lowered(firstWord(start.text()));
  return word == "ncols" || word == "nrows";
}

std::optional<std::string> wordsOfContent(const FileStart& start, const SceneFormat* format) {
  const std::string text = lowered(start.text());
  if (text.starts_with("version https://git-lfs")) {
    return "is a pointer of Git LFS, not the file itself: git lfs pull fetches it";
  }
  if (format != nullptr && format->marked && format->begins(start)) return std::nullopt;
  if (text.starts_with("pk\3\4")) return zipWords(start);
  if (isUtf16(text)) return "is text in UTF-16: save it in UTF-8";
  if (text.starts_with('{') && holdsAll(start, {"\"geometricError\""})) {
    return "is a tileset of 3D Tiles, which foci does not read: give foci one of its tiles as glTF";
  }
  if (text.starts_with('{') && holdsAll(start, {"\"frames\"", "\"camera_"})) {
    return "is a list of cameras, as nerfstudio's: give foci the scene itself, e.g. its PLY";
  }
  if (isGrid(start)) {
    return "is an ESRI ASCII grid, a map of heights: gdal_translate -of XYZ IN OUT.xyz makes "
           "points of it";
  }
  const std::string_view begun =
      std::string_view(text).substr(std::min(text.find_first_not_of(" \t\r\n"), text.size()));
  if (begun.starts_with("<!doctype html") || begun.starts_with("<html")) {
    return "is a web page, not the file itself: download it again";
  }
  for (const Mark& mark : kMarks) {
    if (text.size() < mark.at || !text.substr(mark.at).starts_with(mark.bytes)) continue;
    return (start.gzip ? "packed by gzip, " : "") + std::string(mark.what) +
           (mark.how.empty() ? "" : ", which foci does not read: " + std::string(mark.how));
  }
  return std::nullopt;
}

}  // namespace

FileStart::FileStart(const fs::path& file)
    : path(file), extension(lowerExtension(file)), bytes(firstBytes(file, 4 * kStart)) {
  if (extension == ".gz") extension = lowerExtension(file.stem());
  gzip = isGzip(bytes);
  if (gzip) {
    const std::vector<unsigned char> packed = std::move(bytes);
    bytes.clear();
    try {
      constexpr std::size_t kMarkOnly = 64;  // of a file that is cut off
      Gunzip stream(file.string(), packed);
      bytes = stream.next(kMarkOnly);
      const std::vector<unsigned char> more = stream.next(kStart);
      bytes.insert(bytes.end(), more.begin(), more.end());
    } catch (const InputError&) {  // its reader says what is wrong
    }
  }
  bytes.resize(std::min(bytes.size(), kStart));
  const std::size_t mark = text().size() - withoutByteOrderMark(text()).size();
  bytes.erase(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(mark));
}

const SceneFormat* formatOf(const FileStart& start) {
  const auto find = [](const auto& condition) {
    const auto* const found = std::ranges::find_if(kSceneFormats, condition);
    return found == kSceneFormats.end() ? nullptr : found;
  };
  const SceneFormat* format =
      find([&](const SceneFormat& each) { return each.marked && each.begins(start); });
  if (format == nullptr) {
    format =
        find([&](const SceneFormat& each) { return isListed(each.extensions, start.extension); });
  }
  if (format != nullptr || converterOf(start) != nullptr) return format;
  return find([&](const SceneFormat& each) { return !each.marked && each.begins(start); });
}

std::optional<std::string> refusalOf(const FileStart& start, const SceneFormat* format) {
  if (auto words = wordsOfContent(start, format)) return words;
  if (format != nullptr) {
    if (start.gzip && !format->gzip) return "is packed by gzip: unpack it with gunzip";
    return std::nullopt;
  }
  if (const Converter* converter = converterOf(start)) {
    return "foci does not read " + start.extension.substr(1) +
           " files: " + std::string(converter->how);
  }
  if (start.gzip) return "is packed by gzip, and is no scene that foci reads";
  return std::nullopt;
}

fs::path sceneFileIn(const fs::path& path) {
  std::error_code ignored;
  if (!fs::is_directory(path, ignored)) return path;
  for (const char* name : {"lod-meta.json", "meta.json", "points3D.bin", "points3D.txt",
                           "sparse/0/points3D.bin", "sparse/0/points3D.txt"}) {
    if (fs::is_regular_file(path / name, ignored)) return path / name;
  }
  return path;
}

bool isScene(const fs::path& path) {
  std::error_code ignored;
  if (fs::is_directory(path, ignored)) return true;  // refused, with the reason
  const FileStart start(path);
  const SceneFormat* const format = formatOf(start);
  return format != nullptr || refusalOf(start, format).has_value();
}

SceneFile readScene(const fs::path& given, std::uint64_t checked_B) {
  std::error_code ignored;
  const fs::path path = sceneFileIn(given);
  if (!fs::exists(path, ignored)) throw InputError(path.string(), "no such file");
  if (fs::is_directory(path, ignored)) {
    throw InputError(path.string(), "is a folder, not a file: give the scene in it");
  }
  requireRegularFile(path);
  const FileStart start(path);
  const SceneFormat* const format = formatOf(start);
  if (const auto refusal = refusalOf(start, format)) throw InputError(path.string(), *refusal);
  if (format == nullptr) {
    throw InputError(path.string(),
                     start.bytes.empty()
                         ? "is empty"
                         : "is no scene that foci reads (docs/scenes.md lists the formats and "
                           "their extensions); points as text begin with numbers, or with a line "
                           "of names that has x, y and z");
  }
  SceneFile file{path, format->read(path, checked_B), format->kind};
  if (auto* const points = std::get_if<PointCloud>(&file.content)) remarkDegrees(*points);
  return file;
}

}  // namespace foci
