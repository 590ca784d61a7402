// manifest.json: all that is needed to repeat a run to the same bytes.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "app/record/live_facts.h"
#include "app/record/tables.h"
#include "app/study/study.h"
#include "gaze/events/recording_quality.h"
#include "gaze/geometry/gaze_sample.h"

namespace foci {

nlohmann::ordered_json toJson(const RecordingQuality& quality);

/// One line.
std::string qualityText(const RecordingQuality& quality);

/// The figures of a run, for manifest.json, the report and standard output.
struct RunSummary {
  std::size_t frames = 0;
  double duration_s = 0.0;  ///< of the video
  double gaze_valid = 0.0;  ///< share of the run's samples that have a gaze point
  std::size_t fixations = 0;
  std::size_t saccades = 0;
  double render_ms_median = 0.0;  ///< of all frames; a reused frame takes 0 ms
  double render_ms_p95 = 0.0;
  std::size_t frames_rendered = 0;  ///< the others were reused
  double rendered_ms_median = 0.0;  ///< of the rendered frames; 0 without any
  double rendered_ms_p95 = 0.0;
  std::uint64_t splats = 0;  ///< in a frame, median
  double pupil_mm = 0.0;     ///< median
  std::filesystem::path out;
};

struct InputFile {
  std::filesystem::path path;
  std::string sha256;
};

/// The gaze of the run.
struct GazeFacts {
  std::string format;
  bool simulated = false;
  double rate_Hz = 0.0;
  std::size_t samples = 0;
  std::vector<std::string> assumed{};  ///< as `GazeTrace::assumed`
  std::optional<RecordingQuality> quality{};
  std::optional<GazeReception> reception{};  ///< of a live run
};

struct ManifestFacts {
  std::string command;
  unsigned threads = 0;
  std::string device;  ///< that rendered the frames (`Session::deviceOf`)
  GazeFacts gaze;
  std::vector<std::string> warnings{};  ///< `Warnings::all` of the run
  const Landings* landings = nullptr;   ///< of a live run; else null
  std::vector<InputFile> inputs{};
  std::string
      frames_sha256{};  ///< of the 8-bit sRGB bytes of all frames, in order, before encoding
};

std::string manifestJson(const Study& study, const RunSummary& summary, const ManifestFacts& facts);

GazeFacts factsOf(const GazeTrace& trace, const RunEvents& judged);

/// How soon after saccades the frames of a live run had full quality.
nlohmann::ordered_json landingsJson(const Landings& landings);

/// Adds how the gaze of a live run has arrived to what is said about it.
void addReception(const GazeReception& reception, nlohmann::ordered_json& json);

/// `--json`: the summary as one line.
std::string summaryJson(const RunSummary& summary);

/// The summary for people.
std::string summaryText(const RunSummary& summary);

}  // namespace foci
