// A study: what is shown to whom, on which screen, under which gaze. It is read from TOML. The
// table of keys in study_keys.cpp is the only place that knows their names, types, ranges and
// meaning.
#pragma once

#include <cstdint>
#include <filesystem>
#include <glm/glm.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "app/session/session_settings.h"
#include "gaze/events/event_settings.h"
#include "gaze/focus/accommodation.h"
#include "gaze/geometry/gaze_sample.h"
#include "gaze/sources/trace_reader.h"

namespace foci {

/// What a map has at each pixel.
enum class FrameMap {
  light,    ///< linear RGB, without the gaze marker
  depth,    ///< distance of the surface along the line of sight, metres; 0: no surface
  defocus,  ///< reciprocal of that distance minus the focus, dioptres: above 0 the surface is
            ///< nearer than the focus; NaN: no surface
};

/// A part of the scene with a name: a box along the axes, or a sphere.
struct NamedShape {
  std::string name;
  glm::dvec3 center_m{0.0};
  std::optional<glm::dvec3> size_m{};  ///< edges of a box
  std::optional<double> radius_m;      ///< of a sphere; one of the two is there

  bool holds(const glm::dvec3& point_m) const;
};

/// Least and most metres per unit of a file.
inline constexpr double kMinScale_m = 1e-6, kMaxScale_m = 1e6;

/// A further file of the scene, and where it stands: first scaled, then turned, then moved.
struct ScenePart {
  std::filesystem::path file;
  glm::dvec3 position_m{0.0};
  glm::dvec4 rotation{0.0, 0.0, 0.0, 1.0};  ///< quaternion x, y, z, w, of any length but 0
  double scale_m = 1.0;                     ///< metres per unit of the file
};

/// Aberrations over the visual field: none, those of the typical eye, or a file's.
struct FieldChoice {
  bool typical = false;
  std::optional<std::filesystem::path> file{};
};

/// The table of an aberrometer, or coefficients for both eyes; by default neither.
struct WavefrontChoice {
  std::optional<std::filesystem::path> file = {};
  std::vector<double> zernike_um = {};
};

struct Study {
  std::filesystem::path file;

  struct Scene {
    std::optional<std::filesystem::path> file;
    std::string builtin = "gallery";  ///< shown if there is no file
    double scale_m = 1.0;             ///< metres per unit of the file
    bool cache = true;                ///< the user's (load_scene.h)
    std::vector<NamedShape> objects;  ///< what gaze meets within them is on them
    std::vector<ScenePart> parts;     ///< join the file or the built-in scene
  } scene;

  struct Eye {
    std::optional<glm::dvec3> position_m;  ///< absent: the built-in scene's own pose
    std::optional<glm::dvec3> look_at_m;
    glm::dvec3 up{0.0, 1.0, 0.0};
    std::vector<EyeKeyframe> path;  ///< by time; empty: the eye stands still
    /// The head of the recording, once it is read (`withRecordedHead`). No key sets it.
    std::optional<EyePath> recorded;
  } eye;

  struct ScreenChoice : Screen {
    ScreenChoice() : Screen(defaultScreen()) {}

    std::optional<std::filesystem::path> monitor;  ///< our TOML or PsychoPy JSON
    std::optional<double> gamma;     ///< light = code^gamma; absent: sRGB as displayed
    double luminance_cd_m2 = 120.0;  ///< of white
    std::optional<std::filesystem::path>
        spectra;             ///< of the primaries; absent: sRGB's dominant light
    bool is_default = true;  ///< the study says nothing about its screen
  } screen;

  struct Display {
    DisplayKind kind = DisplayKind::screen;
    /// Left, right, up, down: what the left eye sees; the right eye's field is its mirror image.
    /// Absent: the recording's, else `EyeField`.
    std::optional<glm::dvec4> field_deg;
    double pixels_per_degree = kHeadsetPixelsPerDegree;
    // Of a headset that foci live opened; absent: as its left eye is, and without cant.
    std::optional<glm::dvec4> right_field_deg;
    std::optional<glm::dvec3> left_eye_m, right_eye_m;  ///< in the head's frame
    std::optional<glm::dvec4> left_eye_rotation, right_eye_rotation;

    EyeField field() const;
  } display;

  struct Observer : StatedObserver {
    double retina_mm = 24.0;
    double sphere_D = 0.0, cylinder_D = 0.0, axis_deg = 0.0;  ///< the prescription of both eyes
    bool corrected = true;                                    ///< the prescription is worn
    int wavelengths = 9;  ///< that the screen's spectra are rendered as
    WavefrontChoice wavefront;
    FieldChoice field;
    std::optional<double> age_years;            ///< typical aberrations; absent: none
    std::optional<double> wavefront_pupil_mm;   ///< that its coefficients hold for
    glm::dvec2 stiles_crawford_center_mm{0.0};  ///< towards the nose, upwards
    glm::dvec2 pupil_offset_mm{0.0};            ///< from the achromatic axis; towards the nose, up
  } observer;

  struct Gaze {
    std::string source = "simulated";  ///< or a file, as the study or the option names it
    TraceColumns columns;
    SceneAlignment alignment;
    std::optional<std::filesystem::path> map;     ///< of foci calibrate gaze; applied to recordings
    std::optional<std::filesystem::path> camera;  ///< of foci calibrate camera
    std::string trial_marker;  ///< begins the markers that begin trials; empty: kTrialMessage
    /// Data loss up to 75 ms is filled, as in Tobii's I-VT filter, so that focus follows through.
    EventSettings events{.max_gap_s = 0.075};
  } gaze;

  std::vector<TraceTrial> trials;  ///< empty: those of the recording

  FocusSettings focus;

  struct Render {
    std::string method = "auto";
    RenderDevice device = RenderDevice::automatic;
  } render;

  Lighting lighting;

  QualitySettings quality;

  struct Output {
    std::optional<glm::ivec2> size_px;  ///< of the images; absent: the screen's
    double fps = 30.0;
    std::optional<glm::dvec2> seconds;  ///< from, to, after the recording's first sample
    bool marker = false;
    int sync_patch = 0;  ///< side of the patch for a photodiode in foci live, px; 0: none
    bool split = false;
    bool images = false;         ///< every frame as a PNG, too
    std::vector<FrameMap> maps;  ///< of every frame, as EXR
    StereoView view = StereoView::mono;
  } output;

  /// What the record of a live run adds for its replay (app/live/record.h).
  struct Record {
    std::optional<std::filesystem::path> frames;   ///< times and methods, instead of output.fps
    std::optional<std::filesystem::path> changes;  ///< of keys during the run
    std::optional<std::filesystem::path> markers;  ///< event markers of the run, for its report
    std::optional<std::filesystem::path> head;     ///< poses of a headset
    std::optional<double> rate_Hz;  ///< of the samples; absent: the median of the recording
    std::string device;             ///< that rendered the run (`Session::devices`); empty: unknown
  } record;

  struct Remote {
    std::optional<std::filesystem::path> folder;  ///< whose files remote control may name
  } remote;

  std::int64_t seed = 1;

  bool gazeIsSimulated() const { return gaze.source == "simulated"; }
  /// The screen in force: that of the study, of its monitor file, the default one, or what both
  /// eyes see of a headset's display.
  Screen screenInForce() const;
  HeadsetEyes headsetEyes() const;
  /// Of all views of a frame together.
  glm::ivec2 imageSize_px() const;
  /// How to read the recording.
  TraceColumns columnsInForce() const;
};

/// @throws InputError naming file, line, key and value where the table of keys forbids something
Study readStudy(const std::filesystem::path& file);

using OptionValue = std::variant<double, std::string, std::vector<double>>;

/// Sets a key to a TOML value, e.g. `"mono"` or `[0, 1.6, 2]`; "null" sets its default.
/// @param where  for messages
/// @throws InputError
void setKey(Study& study, std::string_view key, const std::string& toml, const std::string& where);

/// Whether a key may change while a session runs (`changeLive`).
bool changesLive(std::string_view key);

/// Sets a key as a command-line option does, under the same checks as in the file.
/// @param option  for messages, e.g. "--pupil 40"
void overrideKey(Study& study, std::string_view key, const OptionValue& value,
                 const std::string& option);

/// Sets a key as `--set KEY=VALUE` does. The value is TOML, or a plain text. A key replaces the
/// keys that a study may not have beside it, as scene.builtin does scene.file. A file's name is
/// relative to the current folder.
/// @throws InputError
void setKeyByOption(Study& study, const std::string& assignment);

/// Checks what several keys decide together: that the scene has an eye pose, that the path is
/// ordered, and so on. Called after the last override.
/// @throws InputError
void checkStudy(const Study& study);

struct ResolvedKey {
  std::string_view name;     ///< "observer.pupil_mm"
  std::string_view meaning;  ///< with its unit
  std::string json;          ///< the value in force; "null" where absent
  std::string allowed;       ///< range or words; empty where anything of the type is
  bool is_default;           ///< the value in force
};

/// "observer" of "observer.pupil_mm"; empty for a key above the first section.
std::string_view sectionOf(std::string_view key);
/// "pupil_mm" of it.
std::string_view leafOf(std::string_view key);

/// Every key with the value in force, in the table's order.
std::vector<ResolvedKey> resolvedKeys(const Study& study);

}  // namespace foci
