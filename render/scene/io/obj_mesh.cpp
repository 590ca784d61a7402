// Meshes in OBJ, with the materials of their MTL files.
#include <algorithm>
#include <cctype>
#include <fstream>
#include <iterator>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "base/input_error.h"
#include "base/text.h"
#include "render/scene/io/mesh_builder.h"
#include "render/scene/io/mesh_files.h"
#include "render/scene/io/mesh_formats.h"
#include "render/scene/io/obj.h"
#include "render/scene/io/scan_values.h"

namespace foci {
namespace {

/// The next word of a line; empty at its end. `rest` loses the word and the blanks before it.
std::string_view nextMtlWord(std::string_view& rest) {
  rest = trimmed(rest);
  const std::string_view word = rest.substr(0, rest.find_first_of(" \t"));
  rest.remove_prefix(word.size());
  return word;
}

std::optional<float> nextMtlNumber(std::string_view& rest) {
  std::string_view after = rest;
  const auto number = parseNumber(nextMtlWord(after));
  if (!number) return std::nullopt;
  rest = after;
  return static_cast<float>(*number);
}

/// Absent if it is not in numbers, but `spectral` or `xyz`.
std::optional<glm::vec3> mtlColor(std::string_view rest) {
  const auto first = nextMtlNumber(rest);
  if (!first) return std::nullopt;
  glm::vec3 color(*first);
  color.y = nextMtlNumber(rest).value_or(color.x);  // one number is grey
  color.z = nextMtlNumber(rest).value_or(color.x);
  return color;
}

class MtlReader {
 public:
  MtlReader(const std::filesystem::path& mtl, const std::filesystem::path& obj)
      : mtl_(mtl), obj_(obj) {}

  MtlFile read() {
    requireRegularFile(mtl_);
    std::ifstream in(mtl_, std::ios::binary);
    std::string text(std::istreambuf_iterator<char>(in), {});
    std::ranges::replace(text, '\r', '\n');
    std::string_view left = withoutByteOrderMark(text);
    while (!left.empty()) {
      const std::size_t end = std::min(left.find('\n'), left.size());
      takeLine(left.substr(0, end));
      left.remove_prefix(std::min(end + 1, left.size()));
    }
    return std::move(file_);
  }

 private:
  void takeLine(std::string_view rest) {
    const std::string word = lowered(nextMtlWord(rest));
    if (word == "#") linear_ |= trimmed(rest).starts_with("Blender ");
    if (word == "newmtl") {
      file_.materials.push_back({.name = std::string(plainName(rest))});
      return;
    }
    MtlMaterial unnamed;
    MtlMaterial& material = file_.materials.empty() ? unnamed : file_.materials.back();
    if (word == "kd") {
      constexpr float kMost = 1.001f;
      const auto color = mtlColor(rest);
      if (color) material.diffuse = lightOf(*color);
      if (color && std::max({color->x, color->y, color->z}) < kMost) return;
      file_.remarks = {mtl_.filename().string() + " has Kd " + shown(trimmed(rest)) +
                       ": write red, green and blue as 0 to 1"};
    } else if (word == "ke") {
      material.emitted = lightOf(mtlColor(rest).value_or(glm::vec3(0.0f)));
    } else if (word == "d") {
      if (trimmed(rest).starts_with("-halo")) nextMtlWord(rest);
      material.opacity = nextMtlNumber(rest);
    } else if (word == "tr") {
      material.transparency = nextMtlNumber(rest);
    } else if (word.starts_with("map_") || word == "bump" || word == "norm" || word == "disp") {
      MtlTexture texture = textureOf(rest);
      if (texture.source.file) file_.textures.push_back(*texture.source.file);
      if (word == "map_kd") {
        material.color = std::move(texture);
      } else if (word == "map_ke") {
        material.emission = std::move(texture);
      } else if (word == "map_d" || word == "map_opacity") {
        material.mask = std::move(texture);
      }
    }
  }

  /// Blender writes linear light, and most others sRGB, as did Blender3D before version 2.5: the
  /// format states neither.
  glm::vec3 lightOf(const glm::vec3& color) const {
    return linear_ ? glm::clamp(color, 0.0f, 1.0f) : linearColor(color);
  }

  /// Options, then a name, which may have blanks.
  MtlTexture textureOf(std::string_view rest) const {
    MtlTexture texture;
    for (rest = trimmed(rest); rest.starts_with('-'); rest = trimmed(rest)) {
      std::string_view after = rest;
      const std::string_view option = nextMtlWord(after);
      if (option.size() < 2 || !std::isalpha(static_cast<unsigned char>(option[1]))) break;
      rest = after;
      glm::vec2* const pair = option == "-s"   ? &texture.scale
                              : option == "-o" ? &texture.offset
                                               : nullptr;
      int numbers = 0;
      for (; numbers < 3; ++numbers) {
        const auto number = nextMtlNumber(rest);
        if (!number) break;
        if (pair != nullptr && numbers < 2) (*pair)[numbers] = *number;
      }
      if (numbers == 0) {  // on, off or another word
        const std::string_view word = nextMtlWord(rest);
        if (option == "-clamp") texture.clamped = word == "on";
      }
    }
    texture.source.name = plainName(rest);
    texture.source.file = namedFile(mtl_, rest);
    if (!texture.source.file) texture.source.file = namedFile(obj_, rest);
    return texture;
  }

  std::filesystem::path mtl_, obj_;
  MtlFile file_;
  bool linear_ = false;
};

/// Brings colours to linear light; negative ones stay. Clears them if they are none, as normals
/// behind `v`. @return what the user should know
std::optional<std::string> linearise(std::vector<glm::vec3>& colors) {
  constexpr float kSlack = 1e-3f, kByte = 255.0f;
  float white = 1.0f, least = 0.0f;
  bool whole = true;
  for (const glm::vec3& color : colors) {
    white = std::max({white, color.x, color.y, color.z});
    if (color != glm::vec3(-1.0f)) least = std::min({least, color.x, color.y, color.z});
    whole = whole && color == glm::round(color);
  }
  const bool bytes = white > 1.0f + kSlack;
  if (least < -kSlack || (bytes && !(whole && white <= kByte))) {
    colors.clear();
    return "the numbers behind its vertices are no colours (" +
           decimal(double{least < -kSlack ? least : white}, 3) +
           " is among them): left out; write colours as 0 to 1, or as whole numbers of 0 to 255";
  }
  for (glm::vec3& color : colors) {
    if (color != glm::vec3(-1.0f)) color = linearColor(color / (bytes ? kByte : 1.0f));
  }
  return bytes ? std::optional("its colours are 0 to 255, and not 0 to 1") : std::nullopt;
}

/// The vertices of an OBJ without faces.
PointCloud pointsOf(ObjFile&& obj, const std::filesystem::path& path) {
  PointCloud points;
  points.format = "OBJ points";
  points.remarks = std::move(obj.remarks);
  if (const auto said = linearise(obj.colors)) points.remarks.push_back(*said);
  const bool has_normals = obj.normals.size() == obj.positions.size();
  ScanPositions positions(points);
  for (std::size_t i = 0; i < obj.positions.size(); ++i) {
    if (!positions.append(obj.positions[i])) continue;
    const bool colored = i < obj.colors.size() && obj.colors[i].x >= 0.0f;
    points.color.push_back(colored ? obj.colors[i] : glm::vec3(kUncolouredLight));
    if (has_normals) points.normal.push_back(unitNormal(obj.normals[i]));
  }
  positions.finish(path.string());
  remarkDark(points);
  if (obj.lines > 0) {
    points.remarks.push_back(counted(obj.lines, "line") +
                             " left out: the vertices are shown as points");
  }
  return points;
}

class ObjMesh {
 public:
  ObjMesh(const std::filesystem::path& path, ObjFile obj)
      : path_(path), obj_(std::move(obj)), builder_(path) {}

  MeshFile read() {
    builder_.remarks() = std::move(obj_.remarks);
    readLibraries();
    build();
    builder_.remarkCount(obj_.two_corners, "face",
                         "with two corners or fewer, and so no area: left out");
    builder_.remarkCount(unplaced_, "corner", "with texture coordinates that are not there");
    builder_.remarkLeftOut(obj_.points, obj_.lines);
    return builder_.finish({.kind = SceneKind::obj},
                           [&](std::uint32_t number) { return materialOf(number); });
  }

 private:
  void readLibraries() {
    std::vector<std::string> missing;
    auto files = librariesOf(path_, obj_.libraries, &missing);
    auto own = path_;  // exporters rename one of the two files
    own.replace_extension(".mtl");
    std::error_code ignored;
    const bool instead =
        files.empty() && !missing.empty() && std::filesystem::is_regular_file(own, ignored);
    if (instead) files.push_back(own);
    for (const std::string& name : missing) {
      builder_.remark("the file " + shown(name) + " cannot be read: its materials are " +
                      (instead ? "those of " + shown(own.filename().string()) : "shown in grey"));
    }
    for (const auto& file : files) {
      MtlFile mtl = readMtl(file, path_);
      for (const std::string& text : mtl.remarks) builder_.remark(text);
      for (MtlMaterial& material : mtl.materials) {
        std::string name = material.name;
        materials_.insert_or_assign(std::move(name), std::move(material));
      }
    }
    has_library_ = !files.empty();
  }

  const MtlMaterial* defined(std::uint32_t number) const {
    const auto found = materials_.find(obj_.materials[number]);
    return found == materials_.end() ? nullptr : &found->second;
  }

  MeshCorner cornerOf(const ObjFile::Corner& from, const MtlTexture& texture) {
    if (from.vertex >= places_.size()) {
      throw InputError(path_.string(), "a face names vertex ", from.vertex + 1, ": expected 1 to ",
                       places_.size());
    }
    MeshCorner corner{.position = places_[from.vertex]};
    if (from.normal < obj_.normals.size()) corner.normal = obj_.normals[from.normal];
    if (from.uv < obj_.uv.size()) {
      corner.uv = obj_.uv[from.uv] * texture.scale + texture.offset;
    } else {
      unplaced_ += from.uv != ObjFile::kNone;
    }
    if (from.vertex < obj_.colors.size()) corner.color = obj_.colors[from.vertex];
    return corner;
  }

  void build() {
    if (const auto said = linearise(obj_.colors)) builder_.remark(*said);
    places_ = builder_.placesOf(obj_.positions);
    std::vector<std::uint16_t> objects;
    for (const std::string& name : obj_.objects) objects.push_back(builder_.addObject(name));
    static const MtlTexture kPlain;
    std::vector<const MtlTexture*> textures;  // by material
    for (std::uint32_t m = 0; m < obj_.materials.size(); ++m) {
      const MtlMaterial* const material = defined(m);
      textures.push_back(material && material->color ? &*material->color : &kPlain);
    }
    std::vector<MeshCorner> corners;
    for (const ObjFile::Face& face : obj_.faces) {
      corners.clear();
      for (std::uint32_t i = face.first; i < face.first + face.count; ++i) {
        corners.push_back(cornerOf(obj_.corners[i], *textures[face.material]));
      }
      builder_.useObject(objects[face.object]);
      builder_.addPolygon(corners, face.material);
    }
  }

  ReadMaterial materialOf(std::uint32_t number) {
    const MtlMaterial* const from = defined(number);
    ReadMaterial read{.material = {.factor = kPlainSurface}};
    const std::string& name = obj_.materials[number];
    if (!name.empty()) {
      read.facts.emplace();
      read.facts->name = name;
    }
    if (from == nullptr) {
      if (has_library_ && !name.empty()) {
        builder_.remark("material " + shown(name) + " is in none of its MTL files: shown in grey");
      }
      return read;
    }
    MeshMaterial& material = read.material;
    if (from->diffuse) material.factor = *from->diffuse;
    const bool is_black = from->diffuse && material.factor == glm::vec3(0.0f);
    const bool glows = builder_.takeLight(is_black, from->emitted, material);
    const float transparency = from->transparency.value_or(0.0f);
    const float opacity = from->opacity.value_or(1.0f - transparency);
    material.opacity = opacity >= 0.0f ? std::min(opacity, 1.0f) : 1.0f;
    read.facts->opacity = material.opacity;
    // The alpha of the texture itself counts already.
    const auto areSame = [](const ImageSource& a, const ImageSource& b) {
      std::error_code ignored;
      return a.file && b.file ? std::filesystem::equivalent(*a.file, *b.file, ignored)
                              : a.name == b.name;
    };
    const bool own =
        from->mask && !(from->color && areSame(from->color->source, from->mask->source));
    if (own) material.mask = builder_.textures().read(from->mask->source, /*as_mask=*/true);
    if (const auto& texture = glows ? from->emission : from->color) {
      read.facts->textures = {factsOf(texture->source)};
      material.texture = builder_.textures().read(texture->source);
      if (material.texture) material.factor = glm::vec3(1.0f);
      const TextureWrap wrap = texture->clamped ? TextureWrap::clamp : TextureWrap::repeat;
      material.wrap = {wrap, wrap};
    }
    return read;
  }

  std::filesystem::path path_;
  ObjFile obj_;
  MeshBuilder builder_;
  std::map<std::string, MtlMaterial> materials_;
  bool has_library_ = false;
  std::vector<glm::vec3> places_;  // of vertices
  std::uint64_t unplaced_ = 0;     // corners
};

}  // namespace

MtlFile readMtl(const std::filesystem::path& mtl, const std::filesystem::path& obj) {
  return MtlReader(mtl, obj).read();
}

std::variant<PointCloud, MeshFile> readObj(const std::filesystem::path& path) {
  ObjFile obj = parseObj(path);
  if (obj.faces.empty() && obj.two_corners == 0 && !obj.positions.empty()) {
    return pointsOf(std::move(obj), path);
  }
  return ObjMesh(path, std::move(obj)).read();
}

}  // namespace foci
