// Options that several sub-commands take.
#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "app/evaluation/scene_in_view.h"
#include "app/platform/output_guard.h"
#include "app/study/study_request.h"

namespace foci {

/// A distance as dioptres: metres, 0.01 or more, or "inf". @throws InputError
double vergenceOf_D(const std::string& option, const std::string& text);

/// Adds an option that takes a value.
/// @param type  as the help shows the value, "FILE"
template <class Value>
CLI::Option* addOption(CLI::App& command, const char* name, Value& value, const char* type,
                       const char* help) {
  return command.add_option(name, value, help)->type_name(type);
}

/// Has `run` called once the command's options are known.
/// @throws InputError instead, while parsing, if the user gave an option an empty value
void onceParsed(CLI::App& command, const std::function<void()>& run);

/// Adds --overwrite.
void addOverwriteFlag(CLI::App& command, bool& overwrite);

/// The value of --threads; if `threads` is empty, the number that TBB uses now. @throws InputError
unsigned threadsOf(const std::string& threads);

// Of `foci live`, `replay` and `render`: a study, and what overrides it.

void addStudyOptions(CLI::App& command, StudyRequest& options);

/// --marker and --split, for commands that follow a gaze.
void addMarkerOptions(CLI::App& command, StudyRequest& options);

/// Writes the file of --write-study, if the option was given.
void saveStudy(const StudyRequest& options, const StudyAsked& asked, const OutputGuard& guard);

// Of `foci chart` and `foci reproduce`: a scan, its view, the number of threads.

struct ScanOptions {
  std::string scan{};
  std::vector<double> eye{-4.4, -1.1, 1.3}, look_at{-2.9, 3.9, -1.2}, up{0.0, 0.0, 1.0};
  std::string threads{};
};

/// Adds --scan, --eye, --look-at, --up and --threads.
void addScanOptions(CLI::App& command, ScanOptions& options);

/// The files of the scan; none without a scan.
std::vector<std::filesystem::path> scanFiles(const ScanOptions& options);

/// The scan, if the user gave one. @throws InputError for a pose without a direction of view
std::optional<ScanView> scanViewOf(const ScanOptions& options);

}  // namespace foci
