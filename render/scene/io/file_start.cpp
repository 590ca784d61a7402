// The beginning of a file, and what it says of a file that is no scene.

#include <algorithm>
#include <array>
#include <cstddef>
#include <utility>

#include "base/input_error.h"
#include "base/text.h"
#include "render/scene/io/file_bytes.h"
#include "render/scene/io/open_scene.h"

namespace foci {
namespace {

constexpr std::size_t kStart = 4096;  // bytes; the header of .ksplat is the longest

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
  const auto* const found = std::ranges::find_if(
      kConverters, [&](const Converter& each) { return start.hasExtensionIn(each.extensions); });
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
  const std::string word = lowered(start.firstWord());
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
  if (text.starts_with('{') && start.holdsAll({"\"geometricError\""})) {
    return "is a tileset of 3D Tiles, which foci does not read: give foci one of its tiles as glTF";
  }
  if (text.starts_with('{') && start.holdsAll({"\"frames\"", "\"camera_"})) {
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

FileStart::FileStart(const std::filesystem::path& file)
    : path(file), extension(unpackedExtension(file)), bytes(firstBytes(file, 4 * kStart)) {
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

bool FileStart::startsWith(std::initializer_list<std::string_view> any) const {
  const std::string_view begun =
      text().substr(std::min(text().find_first_not_of(" \t\r\n"), bytes.size()));
  return std::ranges::any_of(any, [&](std::string_view mark) { return begun.starts_with(mark); });
}

bool FileStart::holdsAll(std::initializer_list<std::string_view> all) const {
  return std::ranges::all_of(
      all, [&](std::string_view part) { return text().find(part) != std::string_view::npos; });
}

std::string_view FileStart::firstWord() const {
  std::string_view left = text();
  while (!left.empty()) {
    const std::string_view line = trimmed(left.substr(0, left.find('\n')));
    if (!line.empty() && line[0] != '#') return line.substr(0, line.find_first_of(" \t"));
    left.remove_prefix(std::min(left.find('\n'), left.size() - 1) + 1);
  }
  return {};
}

bool FileStart::hasExtensionIn(std::string_view extensions) const {
  if (extension.empty()) return false;
  const std::size_t at = extensions.find(extension), end = at + extension.size();
  return at != std::string_view::npos && (end == extensions.size() || extensions[end] == ' ');
}

bool FileStart::hasOtherFormat() const { return converterOf(*this) != nullptr; }

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

}  // namespace foci
