// The inheritance principle of BIDS: a JSON file applies to the recordings below its folder that
// have all entities of its name.
#include "gaze/sources/bids.h"

#include <algorithm>
#include <string_view>
#include <utility>

#include "base/file.h"
#include "base/input_error.h"
#include "base/text.h"
#include "gaze/sources/column_names.h"

namespace foci {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

Json readJson(const fs::path& file) {
  constexpr std::uintmax_t kMaxBytes = 1 << 20;  // a sidecar has a page or two
  Json json = Json::parse(bytesOfFile(file, kMaxBytes), nullptr, false);
  if (!json.is_object()) throw InputError(file.string(), "expected a JSON object");
  return json;
}

/// The folders from the data set's root to the recording's own. The root has
/// dataset_description.json, or is above the folder of the subject.
std::vector<fs::path> foldersOf(const fs::path& file) {
  constexpr int kMaxDepth = 8;
  std::error_code unreadable;
  const fs::path own = fs::absolute(file, unreadable).lexically_normal().parent_path();
  std::vector<fs::path> folders{own};
  fs::path folder = own;
  for (int depth = 0; depth < kMaxDepth; ++depth) {
    if (fs::exists(folder / "dataset_description.json", unreadable)) return folders;
    const bool of_subject = folder.filename().string().starts_with("sub-");
    folder = folder.parent_path();
    folders.insert(folders.begin(), folder);
    if (of_subject) return folders;
    if (!folder.has_relative_path()) break;
  }
  return {own};
}

/// The files of a folder that end in `ending` and whose parts, between underscores, the recording
/// has, too. Those of fewer parts come first.
std::vector<fs::path> filesIn(const fs::path& folder, std::string_view ending,
                              const std::vector<std::string_view>& parts) {
  std::vector<fs::path> files;
  std::error_code unreadable;
  for (const auto& entry : fs::directory_iterator(folder, unreadable)) {
    const std::string name = entry.path().filename().string();
    if (!name.ends_with(ending) || !entry.is_regular_file(unreadable)) continue;
    const std::string stem = name.substr(0, name.size() - ending.size());
    // "physio.json" applies to all; "task-look_physio.json" to a task.
    if (!stem.empty() && stem.back() != '_') continue;
    const bool applies = std::ranges::all_of(wordsOf(stem, "_"), [&](std::string_view part) {
      return std::ranges::find(parts, part) != parts.end();
    });
    if (applies) files.push_back(entry.path());
  }
  std::ranges::sort(files, {}, [](const fs::path& file) {
    return std::pair(std::ranges::count(file.filename().string(), '_'), file);
  });
  return files;
}

/// The two numbers of a list; {0, 0} if there is no such list within the limits.
glm::dvec2 pairIn(const Json& json, const char* key, double low, double high) {
  const auto found = json.find(key);
  if (found == json.end() || !found->is_array() || found->size() != 2) return glm::dvec2(0.0);
  glm::dvec2 result{0.0};
  for (int axis : {0, 1}) {
    const Json& value = (*found)[static_cast<std::size_t>(axis)];
    if (!value.is_number()) return glm::dvec2(0.0);
    result[axis] = value.get<double>();
    if (!(result[axis] >= low && result[axis] <= high)) return glm::dvec2(0.0);
  }
  return result;
}

std::optional<double> bidsNumber(const Json& json, const char* key) {
  const auto found = json.find(key);
  return found != json.end() && found->is_number() ? std::optional(found->get<double>())
                                                   : std::nullopt;
}

/// The name without its folder and without _physio.tsv or _physio.tsv.gz; nothing for another one.
std::optional<std::string> stemOf(const fs::path& file) {
  const std::string name = file.filename().string();
  for (const std::string_view ending : {"_physio.tsv.gz", "_physio.tsv"}) {
    if (name.ends_with(ending)) return name.substr(0, name.size() - ending.size());
  }
  return std::nullopt;
}

}  // namespace

std::optional<double> BidsMetadata::number(const char* key) const {
  return bidsNumber(physio, key);
}

std::string BidsMetadata::text(const char* key) const {
  const auto found = physio.find(key);
  return found != physio.end() && found->is_string() ? found->get<std::string>() : std::string();
}

Screen BidsMetadata::screen() const {
  Screen screen;
  if (!stimulus.is_object()) return screen;
  screen.size_px = glm::ivec2(pairIn(stimulus, "ScreenResolution", 16, 16384));
  screen.size_m = pairIn(stimulus, "ScreenSize", 0.01, 20.0);
  const double distance_m = bidsNumber(stimulus, "ScreenDistance").value_or(0.0);
  if (isScreenDistance(distance_m)) screen.distance_m = distance_m;
  return screen;
}

std::string BidsMetadata::unitOf(const std::string& column) const {
  const auto entry = physio.find(column);
  if (entry == physio.end() || !entry->is_object()) return {};
  const auto units = entry->find("Units");
  if (units == entry->end() || !units->is_string()) return {};
  std::string unit = lowered(units->get<std::string>().substr(0, 64));
  for (char& c : unit) {
    if (std::string_view("\t\n\r\"[]()").find(c) != std::string_view::npos) c = ' ';
  }
  unit = trimmed(unit);
  std::string known = shortUnit(unit.substr(0, unit.find(' ')));
  if (known.empty()) known = unitIn(unit);
  return known.empty() ? unit : known;
}

std::optional<BidsMetadata> bidsMetadata(const fs::path& file) {
  const auto stem = stemOf(file);
  if (!stem) return std::nullopt;
  BidsMetadata metadata{.physio = Json::object(), .physioevents = Json::object()};
  bool any = false;
  const auto parts = wordsOf(*stem, "_");
  for (const fs::path& folder : foldersOf(file)) {
    for (fs::path& path : filesIn(folder, "physio.json", parts)) {
      metadata.physio.update(readJson(path));
      metadata.files.push_back(std::move(path));
      any = true;
    }
    for (const fs::path& path : filesIn(folder, "physioevents.json", parts)) {
      metadata.physioevents.update(readJson(path));
    }
    for (fs::path& path : filesIn(folder, "events.tsv", parts)) metadata.events = std::move(path);
    for (fs::path& path : filesIn(folder, "events.json", parts)) {
      const Json json = readJson(path);
      const auto stimulus = json.find("StimulusPresentation");
      if (stimulus == json.end()) continue;
      metadata.stimulus = *stimulus;
      metadata.files.insert(metadata.files.begin(), std::move(path));
    }
  }
  if (!any) return std::nullopt;
  for (const char* ending : {"_physioevents.tsv.gz", "_physioevents.tsv"}) {
    std::error_code unreadable;
    const fs::path messages = file.parent_path() / (*stem + ending);
    if (!fs::is_regular_file(messages, unreadable)) continue;
    metadata.messages = messages;
    break;
  }
  const auto own = metadata.physio.find("StimulusPresentation");
  if (!metadata.stimulus.is_object() && own != metadata.physio.end()) metadata.stimulus = *own;
  return metadata;
}

}  // namespace foci
