// The command line (CLI11): options to a study, errors to one line and an exit code.
#include <tbb/global_control.h>

#include <CLI/CLI.hpp>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "app/calibrate/calibrate.h"
#include "app/cli/chart_command.h"
#include "app/cli/doctor_command.h"
#include "app/cli/events_command.h"
#include "app/cli/keys_command.h"
#include "app/cli/live_command.h"
#include "app/cli/methods_command.h"
#include "app/cli/reproduce_command.h"
#include "app/cli/trace_command.h"
#include "app/prepare/prepare_command.h"
#include "app/record/manifest.h"
#include "app/record/tables.h"
#include "app/replay/render_image.h"
#include "app/replay/replay.h"
#include "app/study/inputs.h"
#include "app/study/study.h"
#include "base/input_error.h"
#include "base/text.h"

namespace foci {
namespace {

constexpr int kDone = 0, kFailed = 1, kBadInput = 2;
constexpr unsigned kMaxThreads = 1024;
constexpr double kLiveFrame_ms = 10.0;  // the rest of 1/60 s is the window's

/// A finite number that fills the whole text.
std::optional<double> numberOf(std::string_view text) {
  double value = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || !std::isfinite(value)) return {};
  return value;
}

/// "1280x720", "2:8.5", "960,540".
std::vector<double> pairOf(const std::string& option, const std::string& text, char between,
                           const char* expected) {
  const std::size_t at = text.find(between);
  const auto first = numberOf(std::string_view(text).substr(0, at));
  const auto second =
      at == std::string::npos ? std::nullopt : numberOf(std::string_view(text).substr(at + 1));
  if (!first || !second) throw InputError(option + " " + text, std::string("expected ") + expected);
  return {*first, *second};
}

/// What replay and render have in common. Empty texts: not given.
struct Options {
  std::string study, scene, trace, screen, gaze_map, camera, out, size, seconds, method, pupil,
      focus, gaze, depth, threads, view;
  bool json = false, marker = false, split = false;
};

unsigned threadsOf(const Options& options) {
  if (options.threads.empty()) {
    return static_cast<unsigned>(
        tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism));
  }
  const auto threads = numberOf(options.threads);
  if (!threads || *threads < 1 || *threads > kMaxThreads || *threads != std::floor(*threads)) {
    throw InputError("--threads " + options.threads,
                     "expected an integer, 1 to " + std::to_string(kMaxThreads));
  }
  return static_cast<unsigned>(*threads);
}

/// The study, overridden by the options, checked.
Study studyOf(const Options& options) {
  Study study = readStudy(options.study);
  if (!options.scene.empty()) overrideKey(study, "scene.file", options.scene, "--scene");
  if (!options.trace.empty()) overrideKey(study, "gaze.source", options.trace, "--trace");
  if (!options.screen.empty()) overrideKey(study, "screen.monitor", options.screen, "--screen");
  if (!options.gaze_map.empty()) overrideKey(study, "gaze.map", options.gaze_map, "--gaze-map");
  if (!options.camera.empty()) overrideKey(study, "gaze.camera", options.camera, "--camera");
  if (!options.method.empty()) {
    overrideKey(study, "render.method", options.method, "--method " + options.method);
  }
  if (!options.size.empty()) {
    overrideKey(study, "output.size_px",
                pairOf("--size", options.size, 'x', "WIDTHxHEIGHT, e.g. 1280x720"),
                "--size " + options.size);
  }
  if (!options.seconds.empty()) {
    overrideKey(study, "output.seconds",
                pairOf("--seconds", options.seconds, ':', "FROM:TO in seconds, e.g. 2:8.5"),
                "--seconds " + options.seconds);
  }
  if (!options.pupil.empty()) {
    const auto pupil_mm = numberOf(options.pupil);
    const bool named = options.pupil == "recording" || options.pupil == "luminance";
    if (!pupil_mm && !named) {
      throw InputError("--pupil " + options.pupil,
                       "expected millimetres, e.g. 4, or recording or luminance");
    }
    overrideKey(study, "observer.pupil", named ? options.pupil : "fixed", "--pupil");
    if (pupil_mm) overrideKey(study, "observer.pupil_mm", *pupil_mm, "--pupil " + options.pupil);
  }
  if (!options.view.empty()) overrideKey(study, "output.view", options.view, "--view");
  if (options.marker) study.output.marker = true;
  if (options.split) study.output.split = true;
  checkStudy(study);
  return study;
}

int runReplay(const Options& options, const std::string& command) {
  const unsigned threads = threadsOf(options);
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
  const RunSummary summary = replay(studyOf(options), options.out, command, threads);
  if (options.json) {
    std::puts(summaryJson(summary).c_str());
  } else {
    std::printf(
        "%zu frames, %.2f s; %.0f %% of the gaze samples valid; %zu fixations, %zu saccades\n"
        "%zu frames rendered, %.1f ms each (median; 95 %%: %.1f ms), %llu splats; the others show "
        "nothing new, %.1f ms over all (95 %%: %.1f ms)\nreport: %s\n",
        summary.frames, summary.duration_s, 100.0 * summary.gaze_valid, summary.fixations,
        summary.saccades, summary.frames_rendered, summary.rendered_ms_median, summary.rendered_ms_p95,
        static_cast<unsigned long long>(summary.splats), summary.render_ms_median,
        summary.render_ms_p95, (summary.out / "report.html").c_str());
  }
  return kDone;
}

int runLiveCommand(const Options& options, const LiveOptions& given, const std::string& command) {
  LiveOptions live = given;
  live.command = command;
  // The window, the tracker and the system want one, too; of two, for a part of the time.
  const unsigned threads = threadsOf(options);
  live.threads = options.threads.empty() && threads > 2 ? threads - 1 : threads;
  if (!options.out.empty()) live.record = options.out;
  Study study = studyOf(options);
  // Unless told otherwise, what follows an eye holds 60 frames a second.
  if (!study.quality.frame_ms) study.quality.frame_ms = kLiveFrame_ms;
  if (study.eye.path.empty() && !study.eye.position_m) {
    // Where the eye is as the study has it, to be moved from there.
    const EyePose pose = builtinPose(study);
    study.eye.position_m = pose.position_m;
    study.eye.look_at_m = pose.target_m;
    study.eye.up = pose.up;
  }
  const LiveSummary summary = runLive(study, live);
  std::puts((options.json ? liveSummaryJson(summary) : liveSummaryText(summary)).c_str());
  return kDone;
}

int runRender(const Options& options) {
  const unsigned threads = threadsOf(options);
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
  const Study study = studyOf(options);
  ImageRequest request{.out = options.out, .depth = {}, .focus_D = {}, .gaze_px = {}};
  if (!options.depth.empty()) request.depth = options.depth;
  if (!options.focus.empty()) {
    const auto focus_m = options.focus == "inf" ? std::optional(HUGE_VAL) : numberOf(options.focus);
    if (!focus_m || !(*focus_m >= 0.01)) {
      throw InputError("--focus " + options.focus, "expected metres, 0.01 or more, or inf");
    }
    request.focus_D = 1.0 / *focus_m;
  }
  if (!options.gaze.empty()) {
    const auto point = pairOf("--gaze", options.gaze, ',', "X,Y in px of the study's screen");
    const Screen screen = study.screenInForce();
    request.gaze_px = glm::dvec2(point[0], point[1]);
    if (point[0] < 0 || point[1] < 0 || point[0] > screen.size_px.x ||
        point[1] > screen.size_px.y) {
      throw InputError("--gaze " + options.gaze, "expected a point on the study's screen, 0,0 to " +
                                                     std::to_string(screen.size_px.x) + "," +
                                                     std::to_string(screen.size_px.y));
    }
  }
  const ImageSummary summary = renderImage(study, request);
  const auto& surface_m = summary.surface_distance_m;
  if (options.json) {
    nlohmann::ordered_json json = {{"out", options.out},
                                   {"focus_D", summary.focus_D},
                                   {"surface_distance_m", nullptr},
                                   {"pupil_mm", summary.pupil_mm},
                                   {"method", study.render.method},
                                   {"splats", summary.stats.splats},
                                   {"fragments", summary.stats.fragments},
                                   {"render_ms", summary.stats.ms}};
    if (surface_m) json["surface_distance_m"] = *surface_m;
    std::puts(json.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace).c_str());
  } else {
    const std::string surface = request.focus_D ? ""
                                : surface_m
                                    ? ", on the surface " + decimal(*surface_m, 3) + " m away"
                                    : ", at rest: no surface under the gaze";
    std::printf("%s: focus %.3f D%s; pupil %.2f mm; %.1f ms\n", options.out.c_str(),
                summary.focus_D, surface.c_str(), summary.pupil_mm, summary.stats.ms);
  }
  return kDone;
}

void addCommonOptions(CLI::App& command, Options& options) {
  const auto add = [&](const char* name, std::string& value, const char* type, const char* help) {
    return command.add_option(name, value, help)->type_name(type);
  };
  add("STUDY", options.study, "FILE", "study file (TOML)")->required();
  add("--scene", options.scene, "FILE",
      "points (PLY), mesh or prepared scene instead of the study's");
  add("--screen", options.screen, "FILE", "calibrated screen: foci's TOML or a PsychoPy monitor");
  add("--gaze-map", options.gaze_map, "FILE",
      "map of foci calibrate gaze, for the recording or webcam");
  add("--camera", options.camera, "FILE", "camera of foci calibrate camera");
  add("--size", options.size, "WxH", "of the images, px, e.g. 1280x720");
  add("--pupil", options.pupil, "MM",
      "diameter of the pupil, millimetres; or recording or luminance, where it comes from");
  add("--method", options.method, "NAME", "one of `foci methods`");
  add("--view", options.view, "NAME", "mono, side-by-side, top-bottom or anaglyph");
  add("--threads", options.threads, "N", "at most; the result is the same for any");
  command.add_flag("--json", options.json, "print the summary as JSON");
}

/// One line for whatever CLI11 has against the arguments.
std::string oneLine(std::string text) {
  for (char& c : text) {
    if (static_cast<unsigned char>(c) < 0x20) c = ' ';
  }
  return text;
}

int run(int argc, char** argv) {
  CLI::App app(
      "foci shows a scene as a human eye would focus it, following where the observer looks.\n"
      "Example: foci replay configs/demo.toml --out out/demo",
      "foci");
  app.set_version_flag("--version", "foci " FOCI_VERSION);
  app.require_subcommand(1);
  Options options;

  auto* replay = app.add_subcommand(
      "replay",
      "Replay a recorded gaze: video, tables and a report of what the eye saw.\n"
      "Example: foci replay configs/lion.toml --scene lion.ply --trace gaze.tsv --out out/lion");
  addCommonOptions(*replay, options);
  replay
      ->add_option("--trace", options.trace,
                   "recording, or webcam:VIDEO, instead of the study's gaze")
      ->type_name("FILE");
  replay->add_option("--out", options.out, "folder of the results; default: out")->type_name("DIR");
  replay->add_option("--seconds", options.seconds, "from, to: after the recording's first sample")
      ->type_name("A:B");
  replay->add_flag("--marker", options.marker, "mark where the observer looks");
  replay->add_flag("--split", options.split, "left half sharp, right half as the eye sees");

  auto* render =
      app.add_subcommand("render",
                         "Draw one image at a given focus or gaze.\n"
                         "Example: foci render configs/demo.toml --focus 0.5 --out near.png");
  addCommonOptions(*render, options);
  render->add_option("--out", options.out, "image: .png (sRGB), .pfm or .exr (linear)")
      ->type_name("FILE")
      ->required();
  auto* focus = render->add_option("--focus", options.focus, "distance in focus, metres, or inf")
                    ->type_name("METRES");
  render->add_option("--gaze", options.gaze, "px of the study's screen: focus on what is there")
      ->type_name("X,Y")
      ->excludes(focus);
  render->add_option("--depth", options.depth, "also the distance seen, metres, as PFM")
      ->type_name("FILE");

  LiveOptions live_options;
  auto* live = app.add_subcommand("live",
                                  "Look at the scene and it follows your eye. ? lists the keys.\n"
                                  "Example: foci live configs/demo.toml --window");
  addCommonOptions(*live, options);
  live->add_option("--source", live_options.source,
                   "of gaze: mouse, trace:FILE, pupil:HOST:PORT or webcam[:N|FILE]")
      ->type_name("NAME");
  live->add_flag("--window", live_options.window, "a window instead of the full screen");
  live->add_option("--monitor", live_options.monitor, "0 is the primary one: `foci doctor`")
      ->type_name("N");
  live->add_option("--record", options.out, "record from the start, to this folder")
      ->type_name("DIR");
  live->add_option("--socket", live_options.socket,
                   "listen for an experiment's commands: a port of this machine's own address")
      ->type_name("[ADDRESS:]PORT");
  live->add_flag("--marker", options.marker, "mark where the observer looks");
  live->add_flag("--split", options.split, "left half sharp, right half as the eye sees");

  addCalibrateCommand(app);
  addChartCommand(app);
  addDoctorCommand(app);
  addEventsCommand(app);
  addKeysCommand(app);
  addMethodsCommand(app);
  addPrepareCommand(app);
  addReproduceCommand(app);
  addTraceCommand(app);

  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return app.exit(error);  // --help, --version
    throw InputError(oneLine(error.what()) + " (foci --help)");
  }
  for (const char* command : {"calibrate", "chart", "doctor", "events", "keys", "methods",
                              "prepare", "reproduce", "trace"}) {
    if (app.got_subcommand(command)) return kDone;
  }
  for (const CLI::Option* option : app.get_subcommands().front()->get_options()) {
    if (option->count() > 0 && option->get_type_size() > 0 && option->as<std::string>().empty()) {
      throw InputError(option->get_name(), "expected a value that is not empty");
    }
  }
  if (*render) return runRender(options);
  std::string command = "foci";
  for (int i = 1; i < argc; ++i) command += std::string(" ") + argv[i];
  if (*live) return runLiveCommand(options, live_options, command);
  if (options.out.empty()) options.out = "out";
  return runReplay(options, command);
}

}  // namespace
}  // namespace foci

int main(int argc, char** argv) {
  // Errors are ours to report, in one line; OpenCV and its encoders keep quiet unless asked.
  setenv("OPENCV_LOG_LEVEL", "SILENT", 0);
  setenv("OPENCV_FFMPEG_LOGLEVEL", "-8", 0);
  try {
    return foci::run(argc, argv);
  } catch (const foci::InputError& error) {
    std::fprintf(stderr, "foci: %s\n", error.what());
    return foci::kBadInput;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "foci: %s\n", error.what());
    return foci::kFailed;
  }
}
