#include "app/replay/recordings.h"

#include <algorithm>
#include <set>
#include <utility>

#include "app/platform/interrupt.h"
#include "app/platform/output_files.h"
#include "app/platform/warnings.h"
#include "app/replay/recordings_page.h"
#include "base/input_error.h"
#include "gaze/webcam/webcam_frames.h"

namespace foci {
namespace {

constexpr const char *kPage = "index.html", *kTable = "recordings.tsv";

std::filesystem::path fileOf(const std::string& trace) {
  const auto place = webcamPlaceOf(trace);
  return place ? place->file : std::filesystem::path(trace);
}

/// The last `parts` parts of a file's path, with or without its extension.
std::string nameOf(const std::filesystem::path& file, std::size_t parts, bool extension) {
  std::string name = extension ? file.filename().string() : file.stem().string();
  std::filesystem::path folder = file.parent_path();
  for (; parts > 1 && folder.has_relative_path(); --parts, folder = folder.parent_path()) {
    name.insert(0, folder.filename().string() + "-");
  }
  return name;
}

bool differ(const std::vector<std::string>& names) {
  return std::set<std::string>(names.begin(), names.end()).size() == names.size();
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
  for (const bool extension : {false, true}) {
    for (std::size_t parts = 1; parts <= depth; ++parts) {
      std::vector<std::string> names;
      names.reserve(files.size());
      for (const auto& file : files) names.push_back(nameOf(file, parts, extension));
      if (differ(names)) return names;
    }
  }
  throw InputError("--trace", "the names of the recordings do not tell them apart");
}

std::vector<std::filesystem::path> batchFiles(const std::vector<BatchRecording>& recordings,
                                              const std::filesystem::path& out) {
  std::vector<std::filesystem::path> files = {out / kPage, out / kTable};
  for (const BatchRecording& each : recordings) {
    for (auto& file : RunWriter::files(each.study, out / each.name)) files.push_back(file);
  }
  return files;
}

std::vector<BatchResult> replayAll(const std::vector<BatchRecording>& recordings,
                                   const std::filesystem::path& out, const std::string& command,
                                   unsigned threads, ReplayedScene& scene) {
  std::vector<BatchResult> results;
  for (const BatchRecording& each : recordings) {
    BatchResult result{.recording = each};
    say(each.trace + ": " + std::to_string(results.size() + 1) + " of " +
        std::to_string(recordings.size()));
    try {
      result.run = replay(each.study, out / each.name, command, threads, scene);
    } catch (const std::exception& error) {
      if (isInterrupted()) throw;
      result.problem = error.what();
      say(result.problem);
    }
    results.push_back(std::move(result));
  }
  OutputFiles files;
  files.write(out / kTable, recordingsTable(results));
  files.write(out / kPage, recordingsPage(recordings.front().study, results));
  files.commit();
  return results;
}

}  // namespace foci
