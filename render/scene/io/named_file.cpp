#include "render/scene/io/named_file.h"

#include <algorithm>
#include <charconv>
#include <system_error>

#include "base/text.h"
#include "base/words.h"

namespace foci {
namespace {

namespace fs = std::filesystem;

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

std::optional<fs::path> namedFile(const fs::path& beside, std::string_view name) {
  std::string stated(plainName(name));
  std::replace(stated.begin(), stated.end(), '\\', '/');
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

}  // namespace foci
