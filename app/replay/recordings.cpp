#include "app/replay/recordings.h"

#include <algorithm>
#include <cstdint>
#include <set>
#include <string_view>
#include <utility>

#include "app/platform/output_files.h"
#include "app/platform/warnings.h"
#include "app/replay/fixation_tables.h"
#include "app/replay/recordings_page.h"
#include "base/file_bytes.h"
#include "base/input_error.h"
#include "base/text.h"
#include "base/words.h"
#include "gaze/webcam/webcam_frames.h"

namespace foci {
namespace {

constexpr std::uintmax_t kMaxTableBytes = 1U << 30U;
constexpr const char *kPage = "index.html", *kTable = "recordings.tsv";

std::filesystem::path fileOf(const std::string& trace) {
  const auto place = webcamPlaceOf(trace);
  return place ? place->file : std::filesystem::path(trace);
}

/// A name that is a folder of its own everywhere: UTF-8, not hidden, not `..`, not too long,
/// without control characters and those that some systems refuse, and none of the batch's own
/// files.
std::string safeName(std::string_view name) {
  constexpr std::size_t kMaxBytes = 120;
  std::string safe = visible(name);  // the escapes' backslashes become "_"
  std::size_t size = std::min(safe.size(), kMaxBytes);
  const auto insideCharacter = [&] {
    return (static_cast<unsigned char>(safe[size]) & 0xC0U) == 0x80;
  };
  while (size < safe.size() && size > 0 && insideCharacter()) --size;
  safe.resize(size);
  std::ranges::replace_if(
      safe,
      [](char c) { return std::string_view("/\\:*?\"<>|").find(c) != std::string_view::npos; },
      '_');
  if (safe.empty()) return "recording";
  if (safe.front() == '.') safe.front() = '_';
  if (safe.back() == '.' || safe.back() == ' ') safe.back() = '_';
  for (const char* own : {kPage, kTable, kFixationTable, kSaccadeTable}) {
    if (safe == own) safe += "_";
  }
  return safe;
}

/// The last `parts` parts of a file's path, with or without its extension.
std::string nameOf(const std::filesystem::path& file, std::size_t parts, bool extension) {
  std::string name = extension ? file.filename().string() : file.stem().string();
  std::filesystem::path folder = file.parent_path();
  for (; parts > 1 && folder.has_relative_path(); --parts, folder = folder.parent_path()) {
    name.insert(0, folder.filename().string() + "-");
  }
  return safeName(name);
}

/// Whatever the case of their letters, which some file systems ignore.
bool differ(const std::vector<std::string>& names) {
  std::set<std::string> all;
  for (const std::string& name : names) all.insert(lowered(name));
  return all.size() == names.size();
}

/// The names, with numbers after those that another name equals.
std::vector<std::string> numbered(std::vector<std::string> names) {
  std::set<std::string> all;
  for (const std::string& name : names) all.insert(lowered(name));
  std::set<std::string> taken;
  for (std::string& name : names) {
    const std::string stem = name;
    for (int number = 2; taken.contains(lowered(name)); ++number) {
      std::string next = stem + "-" + std::to_string(number);
      if (!all.contains(lowered(next))) name = std::move(next);
    }
    taken.insert(lowered(name));
  }
  return names;
}

/// @throws InputError if two recordings are the same file
void requireDifferent(const std::vector<std::filesystem::path>& files) {
  std::set<std::filesystem::path> seen;
  for (const auto& file : files) {
    if (!seen.insert(file).second) throw InputError("--trace " + file.string(), "is given twice");
  }
}

}  // namespace

std::vector<std::string> folderNames(const std::vector<std::string>& traces) {
  std::vector<std::filesystem::path> files;
  std::size_t depth = 1;
  for (const std::string& trace : traces) {
    files.push_back(std::filesystem::weakly_canonical(fileOf(trace)));
    const auto length = std::distance(files.back().begin(), files.back().end());
    depth = std::max(depth, static_cast<std::size_t>(length));
  }
  requireDifferent(files);
  const auto named = [&](std::size_t parts, bool extension) {
    std::vector<std::string> names;
    names.reserve(files.size());
    for (const auto& file : files) names.push_back(nameOf(file, parts, extension));
    return names;
  };
  for (const bool extension : {false, true}) {
    for (std::size_t parts = 1; parts <= depth; ++parts) {
      std::vector<std::string> names = named(parts, extension);
      if (differ(names)) return names;
    }
  }
  return numbered(named(1, false));
}

void nameSafely(std::vector<BatchRecording>& recordings) {
  std::vector<std::string> names;
  names.reserve(recordings.size());
  for (const BatchRecording& each : recordings) names.push_back(safeName(each.name));
  names = numbered(std::move(names));
  for (std::size_t i = 0; i < names.size(); ++i) recordings[i].name = std::move(names[i]);
}

std::vector<std::filesystem::path> batchFiles(const std::vector<BatchRecording>& recordings,
                                              const std::filesystem::path& out) {
  std::vector<std::filesystem::path> files;
  for (const char* name : {kPage, kTable, kFixationTable, kSaccadeTable})
    files.push_back(out / name);
  for (const BatchRecording& each : recordings) {
    for (auto& file : RunWriter::files(each.study, out / each.name)) files.push_back(file);
  }
  return files;
}

std::vector<BatchResult> replayAll(const std::vector<BatchRecording>& recordings,
                                   const std::filesystem::path& out, const std::string& command,
                                   unsigned threads, ReplayedScene& scene,
                                   const OutputGuard& guard) {
  OutputFiles files(guard);
  files.claimFolder(out);
  std::vector<BatchResult> results;
  for (const BatchRecording& each : recordings) {
    BatchResult result{.recording = each};
    say(each.trace + ": " + std::to_string(results.size() + 1) + " of " +
        std::to_string(recordings.size()));
    try {
      result.run = replay(each.study, out / each.name, command, threads, scene, guard);
    } catch (const std::exception& error) {
      result.problem = error.what();
      say(result.problem);
    }
    results.push_back(std::move(result));
  }
  files.write(out / kTable, recordingsTable(results));
  for (const char* name : {kFixationTable, kSaccadeTable}) {
    std::vector<std::pair<std::string, std::string>> tables;
    for (const BatchResult& each : results) {
      if (!each.problem.empty()) continue;
      tables.emplace_back(each.recording.name,
                          bytesOfFile(out / each.recording.name / name, kMaxTableBytes));
    }
    files.write(out / name, joinedTable(tables));
  }
  files.write(out / kPage, recordingsPage(recordings.front().study, results));
  files.commit();
  return results;
}

}  // namespace foci
