// A SOG by itself, as a ZIP archive (`.sog`) or in a folder: see sog_reader.h.
#include <algorithm>
#include <array>
#include <filesystem>
#include <initializer_list>
#include <string>
#include <string_view>
#include <vector>

#include "base/input_error.h"
#include "render/scene/io/gaussian_formats.h"
#include "render/scene/io/sog_reader.h"

namespace foci {
namespace {

/// Whether an archive has a member of this name, or a JSON file all these words. Other scenes are
/// ZIP archives or JSON, too. A damaged archive has the name before one of its members.
bool holdsWords(const std::filesystem::path& path, std::string_view member, std::uint64_t max_json,
                std::initializer_list<std::string_view> words) {
  const std::vector<unsigned char> first = firstBytes(path, 4);
  const bool is_archive = sog::Source::isArchive(first);
  std::error_code error;
  if (!is_archive && (first.empty() || first[0] != '{')) return false;
  if (!is_archive && std::filesystem::file_size(path, error) > max_json) return false;
  const FileBytes bytes(path);
  const auto all = bytes.all();
  const auto holds = [&](std::string_view word) {
    return std::search(all.begin(), all.end(), word.begin(), word.end()) != all.end();
  };
  return is_archive ? holds(member) : std::ranges::all_of(words, holds);
}

}  // namespace

bool isStreamedSog(const std::filesystem::path& path) {
  return holdsWords(path, sog::kStreamMeta, sog::kMaxStreamMeta,
                    {"\"lodLevels\"", "\"filenames\""});
}

bool isSogFile(const std::filesystem::path& path) {
  return holdsWords(path, sog::kMeta, sog::kMaxMeta, {"\"means\"", "\"quats\"", "\"sh0\""});
}

GaussianFile readSogFile(const std::filesystem::path& path) {
  const sog::Source source(path);
  try {
    sog::Reader reader(source, "", source.main(sog::kMeta, sog::kMaxMeta));
    GaussianFile file{.format = "SOG"};
    file.cloud.degree = reader.degree();
    reader.appendTo(file, std::array{sog::Range{0, reader.count()}});
    finishGaussians(file, source.name());
    return file;
  } catch (const sog::Json::exception&) {
    throw InputError(source.name(),
                     std::string(sog::kMeta) + ": expected the JSON of a SOG of version 1 or 2");
  }
}

}  // namespace foci
