// Wavefront's OBJ: the polygonal part of the format, with colours of vertices behind their places
// (x y z r g b), as MeshLab and ZBrush write them.
#include "render/scene/io/obj.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cstdlib>
#include <map>
#include <system_error>
#include <utility>

#include "base/input_error.h"
#include "base/mapped_file.h"
#include "base/text.h"

namespace foci {
namespace {

bool isBlank(char c) { return c == ' ' || c == '\t'; }
bool isLineEnd(char c) { return c == '\n' || c == '\r'; }

class ObjParser {
 public:
  ObjParser(std::string name, std::string_view text)
      : name_(std::move(name)), text_(text), at_(text.data()), end_(at_ + text.size()) {}

  ObjFile parse() {
    while (at_ < end_) {
      line_ = at_;
      skipBlanks();
      if (!atEnd()) {
        takeLine();
      } else if (at_ < end_ && *at_ == '#') {
        takeComment();
      }
      while (at_ < end_ && !isLineEnd(*at_)) ++at_;
      while (at_ < end_ && isLineEnd(*at_)) ++at_;
    }
    judgeEnd();
    if (painted_.size() == file_.positions.size() && file_.colors.empty()) {
      file_.colors = std::move(painted_);
    } else if (!painted_.empty()) {
      file_.remarks.emplace_back("its colours of ZBrush (#MRGB) are not one a vertex: left out");
    }
    if (free_form_) file_.remarks.emplace_back("its free-form curves and surfaces are left out");
    return std::move(file_);
  }

 private:
  /// Also over the end of a line after a backslash.
  void skipBlanks() {
    for (;;) {
      while (at_ < end_ && isBlank(*at_)) ++at_;
      if (at_ == end_ || *at_ != '\\') return;
      const char* after = at_ + 1;
      if (after < end_ && *after == '\r') ++after;
      if (after < end_ && *after == '\n') ++after;
      if (after == at_ + 1) return;
      at_ = after;
    }
  }

  bool atEnd() const { return at_ == end_ || isLineEnd(*at_) || *at_ == '#'; }

  std::string_view takeWord() {
    const char* const first = at_;
    while (at_ < end_ && !isBlank(*at_) && !isLineEnd(*at_)) ++at_;
    return {first, static_cast<std::size_t>(at_ - first)};
  }

  std::string_view takeRest() {
    skipBlanks();
    const char* const first = at_;
    while (at_ < end_ && !isLineEnd(*at_)) ++at_;
    return trimmed({first, static_cast<std::size_t>(at_ - first)});
  }

  /// Names may have blanks, and quotes around them.
  std::string takeName() { return std::string(plainName(takeRest())); }

  template <typename... Parts>
  [[noreturn]] void refuse(const Parts&... what) const {
    const auto lines = std::count(text_.data(), line_, '\n');
    throw InputError(concat(name_, ":", 1 + lines), what...);
  }

  double takeNumber() {
    const char* const first = at_;
    const bool plus = *at_ == '+';
    double value = 0.0;
    const auto [end, error] = std::from_chars(at_ + plus, end_, value);
    at_ = end;
    if (error == std::errc() && (atEnd() || isBlank(*at_) || *at_ == '\\')) return value;
    at_ = first;
    std::string word(takeWord());
    std::ranges::replace(word, ',', '.');  // a decimal comma
    char* last = nullptr;
    value = std::strtod(word.c_str(), &last);  // or a number that is too large or too small
    if (last != word.c_str() + word.size()) refuse("expected a number, found ", shown(word));
    return value;
  }

  template <std::size_t N>
  std::size_t takeNumbers(std::array<double, N>& numbers) {
    std::size_t count = 0;
    for (skipBlanks(); !atEnd(); skipBlanks()) {
      const double number = takeNumber();
      if (count < N) numbers[count] = number;
      ++count;
    }
    return count;
  }

  void takeLine() {
    const std::string_view word = takeWord();
    if (word == "v") {
      takeVertex();
    } else if (word == "f") {
      takeFace();
    } else if (word == "vt") {
      std::array<double, 3> uv{};
      takeNumbers(uv);
      file_.uv.emplace_back(uv[0], uv[1]);
    } else if (word == "vn") {
      std::array<double, 3> normal{};
      takeNumbers(normal);
      file_.normals.emplace_back(normal[0], normal[1], normal[2]);
    } else {
      takeOther(lowered(word));
    }
  }

  void takeOther(const std::string& word) {
    if (word == "usemtl") {
      material_ = numberOf(takeName(), file_.materials, material_numbers_);
    } else if (word == "o" || word == "g") {
      object_ = numberOf(takeName(), file_.objects, object_numbers_);
    } else if (word == "mtllib") {
      file_.libraries.emplace_back(takeRest());
    } else if (word == "p") {
      ++file_.points;
    } else if (word == "l") {
      ++file_.lines;
    } else {
      free_form_ |= word == "curv" || word == "surf";
    }
  }

  /// ZBrush writes the colours of the vertices as comments, eight digits each: #MRGB ffRRGGBB...
  void takeComment() {
    constexpr std::string_view kKey = "#MRGB";
    constexpr std::size_t kDigits = 8;
    std::string_view codes = takeRest();
    if (!codes.starts_with(kKey)) return;
    for (codes = trimmed(codes.substr(kKey.size())); codes.size() >= kDigits;
         codes.remove_prefix(kDigits)) {
      std::uint32_t code = 0;
      const char* const end = codes.data() + kDigits;
      if (std::from_chars(codes.data(), end, code, 16).ptr != end) return;
      painted_.push_back(glm::vec3(code >> 16u & 255u, code >> 8u & 255u, code & 255u) / 255.0f);
    }
  }

  static std::uint32_t numberOf(const std::string& name, std::vector<std::string>& names,
                                std::map<std::string, std::uint32_t>& numbers) {
    const auto [at, is_new] = numbers.emplace(name, static_cast<std::uint32_t>(names.size()));
    if (is_new) names.push_back(name);
    return at->second;
  }

  void takeVertex() {
    std::array<double, 7> v{};
    const std::size_t count = takeNumbers(v);
    if (count != 3 && count != 4 && count != 6 && count != 7) {
      refuse("a vertex has ", count,
             " numbers: expected x y z, x y z w, x y z r g b, x y z r g b a or x y z w r g b");
    }
    // Weights of coloured vertices are 1, and hardly ever less.
    if (count == 7 && v[3] >= 0.0 && v[3] < 1.0 && !std::exchange(has_alpha_, true)) {
      for (glm::vec3& color : file_.colors) {  // red was taken for a weight of 1
        if (color != glm::vec3(-1.0f)) color = {1.0f, color.r, color.g};
      }
    }
    const bool colored = count >= 6, weighted = count == 4 || (count == 7 && !has_alpha_);
    const bool scaled = weighted && v[3] != 0.0 && v[3] != 1.0;
    file_.positions.push_back(glm::dvec3(v[0], v[1], v[2]) / (scaled ? v[3] : 1.0));
    if (colored || !file_.colors.empty()) {
      const double* const rgb = &v[weighted ? 4 : 3];
      file_.colors.resize(file_.positions.size() - 1, glm::vec3(-1.0f));
      file_.colors.emplace_back(colored ? glm::dvec3(rgb[0], rgb[1], rgb[2]) : glm::dvec3(-1.0));
    }
  }

  /// An index of `count` things so far; negative ones count from the last. kNone if there is none.
  std::uint32_t takeIndex(std::size_t count) {
    std::int64_t index = 0;
    const auto [end, error] = std::from_chars(at_, end_, index);
    if (error != std::errc()) return ObjFile::kNone;
    at_ = end;
    const std::int64_t from_zero = index > 0 ? index - 1 : static_cast<std::int64_t>(count) + index;
    if (index == 0 || from_zero < 0 || from_zero >= ObjFile::kNone) {
      refuse("a face names vertex ", index, ": expected 1 to ", count);
    }
    return static_cast<std::uint32_t>(from_zero);
  }

  void takeFace() {
    const auto first = static_cast<std::uint32_t>(file_.corners.size());
    for (skipBlanks(); !atEnd(); skipBlanks()) {
      const char* const begin = at_;
      ObjFile::Corner corner;
      corner.vertex = takeIndex(file_.positions.size());
      if (at_ < end_ && *at_ == '/') {
        ++at_;
        corner.uv = takeIndex(file_.uv.size());
        if (at_ < end_ && *at_ == '/') {
          ++at_;
          corner.normal = takeIndex(file_.normals.size());
        }
      }
      if (corner.vertex == ObjFile::kNone || !(atEnd() || isBlank(*at_) || *at_ == '\\')) {
        at_ = begin;
        refuse("found ", shown(takeWord()), ": expected a corner of a face, such as 1/2/3");
      }
      file_.corners.push_back(corner);
    }
    const auto count = static_cast<std::uint32_t>(file_.corners.size()) - first;
    if (count >= 3) {
      file_.faces.push_back({first, count, material_, object_});
    } else {
      file_.corners.resize(first);
      ++file_.two_corners;
    }
  }

  /// Judges a last line without an end: a face there may be cut off.
  void judgeEnd() {
    if (text_.empty() || isLineEnd(text_.back())) return;
    const std::size_t begin = text_.find_last_of("\r\n") + 1;  // of none: npos + 1 is 0
    const std::string_view last = trimmed(text_.substr(begin));
    if (last != "f" && !last.starts_with("f ") && !last.starts_with("f\t")) return;
    const auto words = [](std::string_view line) {
      return wordsOf(line.substr(0, line.find('#')));
    };
    const auto slashes = [](std::string_view corner) { return std::ranges::count(corner, '/'); };
    const auto digits = [](std::string_view corner) {
      return corner.size() - (corner.rfind('/') + 1);
    };
    const std::vector<std::string_view> face = words(last);
    const bool within = face.size() < 4 || slashes(face.back()) < slashes(face[1]) ||
                        (face.back().ends_with('/') && !face[1].ends_with('/'));
    if (within) {
      refuse("ends within a face, ", shown(last), ": the file is cut off; export or copy it again");
    }
    // The last number has fewer digits than all others, or the face fewer corners than the one
    // before.
    const std::string_view before = begin > 0 ? text_.substr(0, begin - 1) : std::string_view();
    const auto above = words(before.substr(before.find_last_of("\r\n") + 1));
    const bool short_face = !above.empty() && above[0] == "f" && face.size() < above.size();
    const bool short_number =
        std::all_of(face.begin() + 1, face.end() - 1,
                    [&](std::string_view corner) { return digits(corner) > digits(face.back()); });
    if (!short_face && !short_number) return;
    file_.remarks.emplace_back(
        "the last line has no end, and its face is shorter than others, so it may be cut off: is "
        "the file complete?");
  }

  std::string name_;
  std::string_view text_;
  const char *at_, *end_, *line_ = nullptr;
  ObjFile file_;
  std::uint32_t material_ = 0, object_ = 0;
  std::map<std::string, std::uint32_t> material_numbers_, object_numbers_;
  std::vector<glm::vec3> painted_;              // by ZBrush
  bool free_form_ = false, has_alpha_ = false;  // behind the colours
};

std::string_view textOf(const MappedFile& file) {
  return {reinterpret_cast<const char*>(file.bytes().data()), file.bytes().size()};
}

/// The names of several files behind one `mtllib`: each ends in .mtl, or has no blank.
std::vector<std::string> separateNames(std::string_view names) {
  std::vector<std::string> separate;
  std::string name;
  for (names = trimmed(names); !names.empty(); names = trimmed(names)) {
    std::size_t end = names.find_first_of(" \t");
    if (name.empty() && names.front() == '"') end = names.find('"', 1) + 1;  // of none: 0
    if (end == 0) end = names.size();
    name += (name.empty() ? "" : " ") + std::string(names.substr(0, end));
    names.remove_prefix(std::min(end, names.size()));
    const std::string small = lowered(plainName(name));
    if (!small.ends_with(".mtl")) continue;
    separate.emplace_back(plainName(name));
    name.clear();
  }
  if (!name.empty()) separate.push_back(name);
  return separate;
}

}  // namespace

ObjFile parseObj(const std::filesystem::path& path) {
  const MappedFile file(path);
  return ObjParser(path.string(), withoutByteOrderMark(textOf(file))).parse();
}

std::vector<std::filesystem::path> librariesOf(const std::filesystem::path& obj,
                                               const std::vector<std::string>& names,
                                               std::vector<std::string>* missing) {
  std::vector<std::filesystem::path> files;
  const auto add = [&](const std::optional<std::filesystem::path>& file) {
    if (file && std::ranges::find(files, *file) == files.end()) {
      files.push_back(*file);
    }
    return file.has_value();
  };
  for (const std::string& line : names) {
    if (add(namedFile(obj, line))) continue;
    for (const std::string& name : separateNames(line)) {
      if (add(namedFile(obj, name)) || missing == nullptr) continue;
      if (std::find(missing->begin(), missing->end(), name) == missing->end()) {
        missing->push_back(name);
      }
    }
  }
  return files;
}

std::vector<std::string> libraryNames(const std::filesystem::path& obj) {
  constexpr std::string_view kKey = "mtllib";
  const MappedFile file(obj);
  const std::string_view text = textOf(file);
  std::vector<std::string> names;
  for (std::size_t at = text.find(kKey); at != std::string_view::npos;
       at = text.find(kKey, at + kKey.size())) {
    const std::size_t begin = at == 0 ? 0 : text.find_last_of("\r\n", at - 1) + 1;
    const std::string_view before = text.substr(begin, at - begin);
    if (!trimmed(withoutByteOrderMark(before)).empty()) continue;
    const std::size_t name = at + kKey.size();
    names.emplace_back(trimmed(text.substr(name, text.find_first_of("\r\n", name) - name)));
  }
  return names;
}

}  // namespace foci
