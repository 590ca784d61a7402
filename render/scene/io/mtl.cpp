// Wavefront's MTL, with the options -s, -o and -clamp of textures.
#include "render/scene/io/mtl.h"

#include <algorithm>
#include <cctype>
#include <fstream>
#include <iterator>
#include <utility>

#include "base/input_error.h"
#include "base/number.h"
#include "base/text.h"
#include "base/words.h"
#include "render/scene/io/named_file.h"

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

glm::vec3 mtlColor(std::string_view rest) {
  glm::vec3 color(nextMtlNumber(rest).value_or(0.0f));
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
    std::replace(text.begin(), text.end(), '\r', '\n');
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
    if (word == "newmtl") {
      file_.materials.push_back({.name = std::string(plainName(rest))});
      return;
    }
    MtlMaterial unnamed;
    MtlMaterial& material = file_.materials.empty() ? unnamed : file_.materials.back();
    if (word == "kd") {
      material.diffuse = mtlColor(rest);
    } else if (word == "ke") {
      material.emitted = mtlColor(rest);
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
};

}  // namespace

MtlFile readMtl(const std::filesystem::path& mtl, const std::filesystem::path& obj) {
  return MtlReader(mtl, obj).read();
}

}  // namespace foci
