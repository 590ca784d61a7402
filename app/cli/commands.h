// The sub-commands of `foci`.
//
// Each function adds one sub-command to the command line. The sub-command runs while CLI11 parses
// the arguments. Bad input leaves as InputError, which `main` reports.
#pragma once

#include <CLI/CLI.hpp>
#include <array>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "app/evaluation/scene_in_view.h"
#include "app/platform/output_guard.h"
#include "app/study/study_request.h"
#include "gaze/events/event_settings.h"
#include "gaze/geometry/gaze_sample.h"
#include "gaze/sources/trace_reader.h"

namespace foci {

void addCalibrateCommand(CLI::App& app);  ///< the screen, a tracker, a webcam or a camera
void addChartCommand(CLI::App& app);      ///< time and error of every method
void addDoctorCommand(CLI::App& app);     ///< what this machine offers
void addEventsCommand(CLI::App& app);     ///< eye movements of a recording
void addEyeCommand(CLI::App& app);        ///< the observer's eye itself
void addFiguresCommand(CLI::App& app);    ///< figures of a run for a paper
void addInfoCommand(CLI::App& app);       ///< facts about a scene
void addKeysCommand(CLI::App& app);       ///< the keys of a study file
void addManualCommand(CLI::App& app);     ///< man pages and shell completions
void addMethodsCommand(CLI::App& app);    ///< the depth-of-field methods
void addPrepareCommand(CLI::App& app);    ///< points or a mesh to a scene file
void addRenderCommand(CLI::App& app);     ///< one image
void addReproduceCommand(CLI::App& app);  ///< the tables and figures of the 2003 paper
void addTraceCommand(CLI::App& app);      ///< facts about a recording, and its conversion to BIDS
void addValidateCommand(CLI::App& app);   ///< foci against published measurements
void addWebcamCommand(CLI::App& app);     ///< what the webcam tracker sees

/// @param command_line  as the user typed it; the manifest of the run states it
void addLiveCommand(CLI::App& app, const std::string& command_line);
void addReplayCommand(CLI::App& app, const std::string& command_line);
void addCompareCommand(CLI::App& app);                                ///< runs side by side
void addJoinCommand(CLI::App& app, const std::string& command_line);  ///< parts of a replay

// Options that several sub-commands take.

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

// The options that describe a recording: its columns, units and screen.

/// Texts as the user typed them; an empty text means that the option was not given.
struct ScreenOptions {
  std::string size_px{}, size_m{}, distance_m{};
};

/// Adds --screen-px WxH, --screen-m WxH and --distance-m D.
void addScreenOptions(CLI::App& command, ScreenOptions& options);

/// Quantities that were not given are 0. @throws InputError
Screen screenOf(const ScreenOptions& options);

/// @throws InputError if a quantity that turns pixels into angles is missing
void requireWholeScreen(const Screen& screen, const std::string& file);

struct TraceOptions {
  std::string units{}, study{}, rows{};
  TraceColumns columns{};  ///< `time`, `x` and `y` alone
  ScreenOptions screen{};
  double time_scale_s = 0.0;
};

/// A recording as a study and the options describe it. An option overrides the study's key.
struct TraceDescription {
  TraceColumns columns{};
  Screen screen{};         ///< for what the recording does not state
  EventSettings events{};  ///< those of the study
};

/// Adds --time, --x, --y, --units, --rows, --time-scale-s, --study and the screen's options.
void addTraceOptions(CLI::App& command, TraceOptions& options);

/// @throws InputError
TraceDescription descriptionOf(const TraceOptions& options);

/// Runs `read`. A refusal that names a key of a study also says where to give it, if the user gave
/// no study.
void withTraceHints(const TraceOptions& options, const std::function<void()>& read);

/// Of `foci trace info REC --scene SCENE`: how a headset recording lies in a scene.
struct AlignmentOptions {
  std::string scene{}, up{}, out{"alignment.svg"};
  bool overwrite = false;
};

void addAlignmentOptions(CLI::App& command, AlignmentOptions& options);

/// Draws the recording in the scene, and prints how well it fits, and what would fit better.
/// @param trace  its study, if there is one, has the scene unless the option names it
/// @throws InputError
void showAlignment(const std::string& recording, const TraceOptions& trace,
                   const AlignmentOptions& options, bool json);

// Completions of the command line for bash, zsh and fish, from the options that CLI11 knows and the
// table of keys.

std::vector<const CLI::App*> commandsByName(const CLI::App& app);

/// The first sentence of a command's description, for lists that have one line for each command.
std::string firstSentence(const std::string& description);

/// What may stand at the last word, as `foci __complete WORD...` prints it for the shells: a line
/// "word<tab>help" for each command, option, value or key, or the one line ":files".
/// @param words  after "foci"; the last is what has been typed of the word, maybe nothing
std::string completionsOf(const CLI::App& app, const std::vector<std::string>& words);

/// Name and text of each shell's script, which asks `foci __complete`: foci (bash), _foci (zsh),
/// foci.fish.
std::array<std::pair<std::string, std::string>, 3> completionScripts();

}  // namespace foci
