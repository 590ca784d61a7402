#include "app/replay/recordings.h"

#include <algorithm>
#include <cstdint>
#include <set>
#include <sstream>
#include <string_view>
#include <utility>

#include "app/graphics/html.h"
#include "app/platform/output_files.h"
#include "app/platform/warnings.h"
#include "app/replay/fixation_tables.h"
#include "base/file.h"
#include "base/input_error.h"
#include "base/text.h"
#include "base/transformed.h"
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
    return transformed(files, [&](const auto& file) { return nameOf(file, parts, extension); });
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
  std::vector<std::string> names = numbered(
      transformed(recordings, [](const BatchRecording& each) { return safeName(each.name); }));
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
      result.bad_input = dynamic_cast<const InputError*>(&error) != nullptr;
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

namespace {

void writeCard(std::ostream& out, const BatchResult& result) {
  const RunSummary& run = result.run.summary;
  out << "<figure><a href=\"" << hrefOf(result.recording.name)
      << "/report.html\"><img alt=\"frame at " << decimal(result.run.image.time_s, 2)
      << " s\" src=\"" << imageUri(result.run.image.jpeg) << "\"></a><figcaption><a href=\""
      << hrefOf(result.recording.name) << "/report.html\">" << escaped(result.recording.name)
      << "</a><br>" << decimal(run.duration_s, 1) << " s &middot; "
      << counted(run.fixations, "fixation") << " &middot; " << counted(run.saccades, "saccade")
      << " &middot; " << decimal(100.0 * run.gaze_valid, 1)
      << "&thinsp;% valid</figcaption></figure>\n";
}

void writeProblems(std::ostream& out, const std::vector<BatchResult>& results) {
  out << "<h2>Recordings without a run</h2>\n<table><tr><th>recording</th><th>problem</th></tr>\n";
  for (const BatchResult& result : results) {
    if (result.problem.empty()) continue;
    out << "<tr>" << cell(escaped(result.recording.trace)) << cell(escaped(result.problem))
        << "</tr>\n";
  }
  out << "</table>\n";
}

}  // namespace

std::string recordingsTable(const std::vector<BatchResult>& results) {
  std::string table =
      "recording\tfolder\tframes\tduration_s\tgaze_valid\tfixations\tsaccades\tpupil_mm\t"
      "frames_rendered\trendered_ms\tproblem\n";
  for (const BatchResult& result : results) {
    const RunSummary& run = result.run.summary;
    const std::string figures =
        result.problem.empty()
            ? tabbed(run.frames, decimal(run.duration_s, 3), decimal(run.gaze_valid, 4),
                     run.fixations, run.saccades, decimal(run.pupil_mm, 3), run.frames_rendered,
                     decimal(run.rendered_ms_median, 3), "n/a")
            : tabbed("n/a\tn/a\tn/a\tn/a\tn/a\tn/a\tn/a\tn/a", visible(result.problem));
    table += rowOf(visible(result.recording.trace), visible(result.recording.name), figures);
  }
  return table;
}

std::string recordingsPage(const Study& study, const std::vector<BatchResult>& results) {
  const auto failed = static_cast<std::size_t>(
      std::ranges::count_if(results, [](const BatchResult& r) { return !r.problem.empty(); }));
  double duration_s = 0.0;
  std::size_t fixations = 0, saccades = 0;
  for (const BatchResult& result : results) {
    duration_s += result.run.summary.duration_s;
    fixations += result.run.summary.fixations;
    saccades += result.run.summary.saccades;
  }
  std::ostringstream out;
  const std::string title = std::to_string(results.size()) + " recordings";
  out << pageStart(title + " - foci replay", "") << "<h1>" << title
      << "</h1>\n<p class=\"quiet\">foci " FOCI_VERSION " &middot; study "
      << escaped(study.file.string()) << " &middot; the same figures in recordings.tsv</p>\n"
      << "<div class=\"numbers\">\n"
      << numberCell(results.size() - failed, "run")
      << numberCell(std::to_string(failed), "without a run")
      << numberCell(decimal(duration_s, 1) + " s", "of all runs")
      << numberCell(fixations, "fixation") << numberCell(saccades, "saccade") << "</div>\n";
  if (failed > 0) writeProblems(out, results);
  out << "<h2>Runs</h2>\n<p class=\"quiet\">A frame from the middle of each run, at which a "
         "fixation had lasted longest. It links to the report.</p>\n<div class=\"sheet\">\n";
  for (const BatchResult& result : results) {
    if (result.problem.empty()) writeCard(out, result);
  }
  out << "</div>\n" << kPageEnd;
  return out.str();
}

}  // namespace foci
