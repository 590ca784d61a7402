// Options of `foci live`, and the summary that it ends with.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "app/record/live_facts.h"
#include "app/study/study.h"
#include "render/scene/io/open_scene.h"

namespace foci {

/// What is shown next.
struct LiveNext {
  Study study{};
  std::optional<SceneFile> scene{};  ///< the study's scene file, if it has been read
  std::string source{};              ///< of the gaze
  std::string title{};
};

struct LiveOptions {
  std::string source = "mouse";
  bool window = false;   ///< false: full screen
  bool headset = false;  ///< shows both eyes there, and takes its gaze; the window shows one eye
  int monitor = 0;
  std::optional<std::filesystem::path> record;  ///< from the start, to this folder
  std::string socket;    ///< of remote control, as `RemoteSocket` takes it; empty: none
  unsigned threads = 1;  ///< that render
  std::string command;   ///< as typed
  std::string title;     ///< of the window
  /// Opens a file that was dropped on the window. Called from a thread; throws InputError.
  /// @param now  the study that is shown
  std::function<LiveNext(const std::filesystem::path& file, const Study& now)> open{};
};

struct LiveSummary {
  std::uint64_t frames = 0;    ///< shown
  std::uint64_t repeated = 0;  ///< refreshes of the screen that showed an old frame again
  std::uint64_t dropped = 0;   ///< rendered, never shown
  double first_frame_s = 0.0;  ///< from the start of the program to the first buffer swap
  Durations sample_to_swap, render;
  Durations sample_to_render, render_to_swap;  ///< the other parts of sample_to_swap
  Durations sample_to_display;  ///< of a headset: age of the gaze at the predicted display
  Landings landings;
  GazeReception reception;
  std::vector<std::filesystem::path> records;
  std::vector<std::string> failed_records;  ///< a line each: the folder, and why
  std::optional<LiveNext> next{};           ///< absent: the observer has left
};

/// Shows the study until the observer leaves, or drops a file on the window.
/// @param scene  the study's scene file, if it has been read
/// @throws InputError, std::runtime_error
LiveSummary runLive(const Study& study, const LiveOptions& options, std::optional<SceneFile> scene);

}  // namespace foci
