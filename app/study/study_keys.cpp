// The table of keys, and how TOML (toml11) sets them.

#include <algorithm>
#include <cassert>
#include <cmath>

#include "app/study/key_table.h"
#include "app/study/toml_values.h"
#include "base/input_error.h"
#include "base/text.h"
#include "render/methods/method.h"

namespace foci {

namespace {

std::optional<std::string> expectedAxes(std::string_view axes) {
  if (AxisConvention::named(axes)) return std::nullopt;
  return std::string(kAxesExpected);
}

std::optional<std::string> expectedEulerOrder(std::string_view order) {
  if (isEulerOrder(order)) return std::nullopt;
  return "each of x, y and z once, such as \"yxz\"";
}

/// "gaze.pupil" of "gaze.columns.pupil".
std::string nameOfKey(const std::string& member) {
  return member.substr(0, member.find('.')) +
         member.substr(std::min(member.rfind('.'), member.size()));
}

// A key of a `Keyed` that is named as its member, and one that has a name of its own.
#define FOCI_KEY(member, ...) FOCI_KEY_AS(nameOfKey(#member), member, __VA_ARGS__)
#define FOCI_KEY_AS(name, member, ...)                     \
  key < Keyed, [](auto& of) -> auto& { return of.member; } \
  > (name, __VA_ARGS__)

// What a line of sight is read from. The name of a member cannot stand in parentheses.
// NOLINTBEGIN(bugprone-macro-parentheses)
#define FOCI_SIGHT_KEYS(prefix, sight)                                                         \
  FOCI_KEY_AS(prefix "direction", sight.direction,                                             \
              "columns x, y, z of the line of sight, as a unit vector"),                       \
      FOCI_KEY_AS(prefix "angles", sight.angles,                                               \
                  "columns of the line of sight as angles: to the right, upwards"),            \
      FOCI_KEY_AS(prefix "quaternion", sight.quaternion,                                       \
                  "columns x, y, z, w of the line of sight, as a rotation of straight ahead"), \
      FOCI_KEY_AS(prefix "point", sight.point,                                                 \
                  "columns x, y, z of the point that the line of sight meets"),                \
      FOCI_KEY_AS(prefix "origin", sight.origin,                                               \
                  "columns x, y, z of the point where the line of sight begins")
// NOLINTEND(bugprone-macro-parentheses)

constexpr double kFar_m = 1e6;  // a float there has steps of 6 cm

/// The keys of a table in a list.
template <class Table>
const std::vector<Key<Table>>& keysOf();

template <>
const std::vector<Key<EyeKeyframe>>& keysOf() {
  using Keyed = EyeKeyframe;
  static const std::vector<Key<Keyed>> keys = {
      FOCI_KEY(time_s, "time after the recording's first sample, s", {0, 1e6}),
      FOCI_KEY(position_m, "where the eye is, m", {-kFar_m, kFar_m}),
      FOCI_KEY(look_at_m, "point that the centre of the screen shows, m", {-kFar_m, kFar_m}),
      FOCI_KEY(up, "upwards; absent: eye.up", {-1, 1}),
  };
  return keys;
}

template <>
const std::vector<Key<NamedShape>>& keysOf() {
  using Keyed = NamedShape;
  static const std::vector<Key<Keyed>> keys = {
      FOCI_KEY(name, "name of the object in the tables"),
      FOCI_KEY(center_m, "centre, m", {-kFar_m, kFar_m}),
      FOCI_KEY(size_m, "edges of a box along the axes, m", {1e-6, kFar_m}),
      FOCI_KEY(radius_m, "radius of a sphere, m", {1e-6, kFar_m}),
  };
  return keys;
}

template <>
const std::vector<Key<TraceTrial>>& keysOf() {
  constexpr double kFar_s = 1e12;
  using Keyed = TraceTrial;
  static const std::vector<Key<Keyed>> keys = {
      FOCI_KEY(name, "name of the trial in the tables"),
      FOCI_KEY_AS("start_s", first_s, "on the recording's clock, s", {-kFar_s, kFar_s}),
      FOCI_KEY_AS("end_s", last_s, "on the recording's clock, s", {-kFar_s, kFar_s}),
      FOCI_KEY(type, "such as a condition"),
  };
  return keys;
}

template <>
const std::vector<Key<ScenePart>>& keysOf() {
  using Keyed = ScenePart;
  static const std::vector<Key<Keyed>> keys = {
      FOCI_KEY(file, "as scene.file"),
      FOCI_KEY(position_m, "where the file's origin lies, m", {-kFar_m, kFar_m}),
      FOCI_KEY(rotation, "quaternion x, y, z, w that turns it", {-1, 1}),
      FOCI_KEY(scale_m, "metres per unit of the file", {kMinScale_m, kMaxScale_m}),
  };
  return keys;
}

}  // namespace

template <class Table>
requires(!HasStudyWords<Table>) static std::string write(const std::vector<Table>& list) {
  return writeList(list, keysOf<Table>());
}

// `eye.path`, `scene.object`, `scene.part`, `trial` and `observer.wavefront` have types of their
// own; toml_values.h has the others.
static void read(const toml::value& from, const Allowed&, std::vector<EyeKeyframe>& to) {
  readList(from, keysOf<EyeKeyframe>(), "a list of at most 10000 { time_s, position_m, look_at_m }",
           "keyframe", {"time_s", "position_m", "look_at_m"}, to);
}

static void read(const toml::value& from, const Allowed&, std::vector<NamedShape>& to) {
  readList(from, keysOf<NamedShape>(),
           "a list of at most 10000 { name, center_m, size_m or radius_m }", "shape",
           {"name", "center_m"}, to);
  for (const NamedShape& shape : to) {
    if (shape.size_m.has_value() == shape.radius_m.has_value()) {
      throw Expected{"size_m for a box, or radius_m for a sphere, in each shape"};
    }
  }
}

static void read(const toml::value& from, const Allowed&, std::vector<TraceTrial>& to) {
  readList(from, keysOf<TraceTrial>(), "a list of at most 10000 { name, start_s, end_s, type }",
           "trial", {"name", "start_s", "end_s"}, to);
  for (const TraceTrial& trial : to) {
    if (!(trial.last_s > trial.first_s)) throw Expected{"end_s above start_s in each trial"};
  }
  std::ranges::stable_sort(to, {}, &TraceTrial::first_s);
}

static void read(const toml::value& from, const Allowed&, std::vector<ScenePart>& to) {
  readList(from, keysOf<ScenePart>(),
           "a list of at most 10000 { file, position_m, rotation, scale_m }", "part", {"file"}, to);
  for (const ScenePart& part : to) {
    if (!(glm::length(part.rotation) > 1e-6)) {
      throw Expected{"a rotation of each part that is not 0, 0, 0, 0"};
    }
  }
}

static void read(const toml::value& from, const Allowed& allowed, FieldChoice& to) {
  to = {};
  readPart("\"none\", \"typical\" or a file's name", from, allowed, to.file);
  to.typical = *to.file == "typical";
  if (to.typical || *to.file == "none") to.file.reset();
}

static std::string write(const FieldChoice& field) {
  if (field.file) return write(field.file);
  return write(std::string(field.typical ? "typical" : "none"));
}

static void read(const toml::value& from, const Allowed& allowed, WavefrontChoice& to) {
  const std::string what =
      "a file's name, or a list of at most 66 numbers, each " + rangeText(allowed);
  to = {};
  if (from.is_array() && !from.as_array().empty() && from.as_array().size() <= 66) {
    for (const toml::value& element : from.as_array()) {
      readPart(what, element, allowed, to.zernike_um.emplace_back());
    }
  } else {
    readPart(what, from, allowed, to.file);
    if (to.file->string().starts_with('[')) throw Expected{what};
  }
}

static std::string write(const WavefrontChoice& wavefront) {
  return wavefront.zernike_um.empty() ? write(wavefront.file) : listOf(wavefront.zernike_um);
}

namespace {

const std::vector<Key<Study>>& studyKeys() {
  using Keyed = Study;
  static const std::vector<Key<Keyed>> keys = {
      FOCI_KEY(scene.file, "points, a mesh, 3D Gaussians or a prepared scene (.foci)"),
      FOCI_KEY(scene.builtin, "built-in scene, if there is no file",
               {.words = {"gallery", "plane"}}),
      FOCI_KEY(scene.scale_m, "metres per unit of the file", {kMinScale_m, kMaxScale_m}),
      FOCI_KEY(
          scene.cache,
          "keep the surfels of meshes and scans in the user's cache folder; the frames are the "
          "same"),
      live(FOCI_KEY_AS("scene.background", lighting.background, "linear RGB behind everything",
                       {0, 1})),
      FOCI_KEY_AS("scene.object", scene.objects,
                  "boxes { name, center_m, size_m } and spheres { name, center_m, radius_m } that "
                  "name objects; the first match counts"),
      FOCI_KEY_AS("scene.part", scene.parts,
                  "further files { file, position_m, rotation, scale_m } of any kind"),
      live(FOCI_KEY(eye.position_m, "where the eye is, m", {-kFar_m, kFar_m})),
      live(FOCI_KEY(eye.look_at_m, "point that the centre of the screen shows, m",
                    {-kFar_m, kFar_m})),
      FOCI_KEY(eye.up, "upward direction", {-1, 1}),
      FOCI_KEY(eye.path,
               "keyframes { time_s, position_m, look_at_m, up } of a moving eye, instead of "
               "position_m and look_at_m"),
      FOCI_KEY(screen.monitor,
               "a calibrated screen (foci calibrate screen, PsychoPy), instead of sizes"),
      FOCI_KEY(screen.size_px, "width and height, px", {16, 16384}),
      FOCI_KEY(screen.size_m, "width and height of the visible area, m", {0.01, 20}),
      FOCI_KEY(screen.distance_m, "eye to screen, m", {kNearestScreen_m, kFarthestScreen_m}),
      FOCI_KEY(screen.gamma, "gamma of the display, light = code^gamma; absent: sRGB", {1, 4}),
      FOCI_KEY(screen.luminance_cd_m2, "luminance of white, cd/m^2", {1, 10000}),
      FOCI_KEY(screen.spectra,
               "table of the primaries' spectra for observer.chromatic: wavelength (nm), red, "
               "green, blue, or as its heading names them; absent: one wavelength each"),
      FOCI_KEY(display.kind,
               "a fixed screen, or a headset, whose screen replaces [screen] and moves with the "
               "head; default for head poses without a [screen]",
               {.words = studyWords<DisplayKind>()}),
      FOCI_KEY(display.field_deg,
               "what the left eye sees in a headset: left, right, up, down, deg; the right eye's "
               "field is the mirror image; absent: as recorded, else 50 each",
               {1, 80}),
      FOCI_KEY(display.pixels_per_degree, "resolution of a headset straight ahead, px/deg",
               {1, 100}),
      FOCI_KEY(display.right_field_deg, "field of the right eye, if not the mirror image", {1, 80}),
      live(FOCI_KEY(display.left_eye_m,
                    "left eye in the head's frame, m; absent: by observer.ipd_mm", {-0.5, 0.5})),
      live(FOCI_KEY(display.right_eye_m, "right eye", {-0.5, 0.5})),
      FOCI_KEY(display.left_eye_rotation,
               "cant of the left display: quaternion x, y, z, w from it to the head", {-1, 1}),
      FOCI_KEY(display.right_eye_rotation, "cant of the right one", {-1, 1}),
      FOCI_KEY(observer.pupil, "fixed, from the recording, or from the luminance of the images",
               {.words = studyWords<PupilModel>()}),
      live(FOCI_KEY(observer.pupil_mm,
                    "diameter of the fixed pupil, mm; also until the recording states one",
                    {0.5, 12})),
      FOCI_KEY(observer.retina_mm, "lens to retina, mm", {10, 40}),
      live(FOCI_KEY(observer.ipd_mm, "interpupillary distance, mm", {kMinIpd_mm, kMaxIpd_mm})),
      live(FOCI_KEY(observer.sphere_D,
                    "sphere of the prescription of both eyes, D; below 0 short-sighted",
                    {-20, 20})),
      live(FOCI_KEY(
          observer.cylinder_D,
          "cylinder of the prescription, D; the power across the axis is sphere + cylinder",
          {-10, 10})),
      live(FOCI_KEY(
          observer.axis_deg,
          "axis of the cylinder, deg, counter-clockwise for somebody who faces the observer",
          {0, 180})),
      live(FOCI_KEY(observer.corrected, "true: with glasses of this prescription; false: without")),
      live(FOCI_KEY(observer.chromatic,
                    "red, green and blue have their own focus; a frame takes three times as long")),
      FOCI_KEY(observer.wavelengths, "wavelengths that sample screen.spectra, one rendering each",
               {3, 31}),
      live(FOCI_KEY(
          observer.wavefront,
          "Zernike coefficients of both eyes, um, in the order of OSA and ANSI from index 0; "
          "or an aberrometer's file (CSV)",
          {-50, 50})),
      live(FOCI_KEY(observer.wavefront_pupil_mm,
                    "diameter of the pupil that the coefficients hold for, mm", {1, 12})),
      live(FOCI_KEY(observer.age_years,
                    "typical aberrations of this age, without observer.wavefront; focus.age_years "
                    "limits how near the eye focuses",
                    {18, 90})),
      live(FOCI_KEY(
          observer.field,
          "aberrations beside the line of sight: \"none\", \"typical\" (of ten eyes), or a "
          "table of coefficients by angle")),
      live(FOCI_KEY(
          observer.spherical_um_per_D,
          "change of the spherical aberration (coefficient 12, pupil of 5 mm) per dioptre of "
          "accommodation, um/D; young eyes: about -0.05",
          {-0.5, 0.5})),
      live(FOCI_KEY(observer.stiles_crawford, "light near the rim of the pupil counts less")),
      live(FOCI_KEY(observer.stiles_crawford_center_mm,
                    "where light counts most: towards the nose, upwards, mm", {-3, 3})),
      live(FOCI_KEY(observer.pupil_offset_mm,
                    "centre of the pupil from the achromatic axis: towards the nose, upwards, mm; "
                    "shifts the colours of observer.chromatic",
                    {-3, 3})),
      live(FOCI_KEY(observer.diffraction,
                    "diffraction at 555 nm, where pixels are fine enough to show it")),
      FOCI_KEY(gaze.source, "\"simulated\", a recording (TSV, CSV, ASC, XDF), or webcam:VIDEO"),
      FOCI_KEY(gaze.map, "map of foci calibrate gaze, for a recording or a webcam"),
      FOCI_KEY(gaze.camera, "camera of foci calibrate camera"),
      FOCI_KEY(gaze.columns.time, "column of the time; its name, or #1 for the first"),
      FOCI_KEY(gaze.columns.x, "column of the horizontal position"),
      FOCI_KEY(gaze.columns.y, "column of the vertical position"),
      FOCI_KEY(gaze.columns.rows,
               "columns and values of the rows to read, such as { participant = \"A\" }"),
      FOCI_KEY(gaze.columns.stream,
               "stream of an XDF file, by name or number (\"#2\"); its channels are the columns"),
      FOCI_KEY(gaze.trial_marker,
               "begins the event markers (messages) that begin a trial; absent: TRIALID"),
      FOCI_KEY(gaze.columns.pupil, "column of the pupil's diameter"),
      FOCI_KEY(gaze.columns.blink, "column that marks blinks"),
      FOCI_KEY(gaze.columns.confidence,
               "column of the confidence, 0 to 1; below 0.6 there is no gaze"),
      FOCI_KEY_AS("gaze.left_x", gaze.columns.eyes[0].x, "column of the horizontal position"),
      FOCI_KEY_AS("gaze.left_y", gaze.columns.eyes[0].y, "column of the vertical position"),
      FOCI_KEY_AS("gaze.left_pupil", gaze.columns.eyes[0].pupil, "column of the pupil's diameter"),
      FOCI_KEY_AS("gaze.right_x", gaze.columns.eyes[1].x, "column of the horizontal position"),
      FOCI_KEY_AS("gaze.right_y", gaze.columns.eyes[1].y, "column of the vertical position"),
      FOCI_KEY_AS("gaze.right_pupil", gaze.columns.eyes[1].pupil, "column of the pupil's diameter"),
      FOCI_SIGHT_KEYS("gaze.", gaze.columns.space.both),
      FOCI_SIGHT_KEYS("gaze.left_", gaze.columns.space.eyes[0]),
      FOCI_SIGHT_KEYS("gaze.right_", gaze.columns.space.eyes[1]),
      FOCI_KEY(gaze.columns.space.head_position,
               "columns x, y, z of the head's position; the head then moves the eye"),
      FOCI_KEY(gaze.columns.space.head_quaternion, "columns x, y, z, w of the head's orientation"),
      FOCI_KEY(gaze.columns.space.head_angles,
               "columns of the head's turn to the right, upwards, and roll to the right, instead "
               "of the quaternion"),
      FOCI_KEY(gaze.columns.space.head_euler,
               "columns of the head's turns about the recording's x, y and z axes (Unity's "
               "eulerAngles), instead of the quaternion"),
      FOCI_KEY(gaze.columns.space.head_euler_order,
               "order of those turns about the head's own axes", {.expected = expectedEulerOrder}),
      FOCI_KEY(gaze.columns.space.from_head,
               "the head's direction is the gaze, in a recording without an eye tracker"),
      FOCI_KEY(gaze.columns.space.frame,
               "frame of the gaze columns, if the recording has the head's pose",
               {.words = studyWords<std::optional<SightFrame>>()}),
      FOCI_KEY(gaze.columns.space.axes,
               "where x, y and z of the recording point: right-up-back (OpenXR), right-up-forward "
               "(Unity), right-down-forward (OpenCV) or others",
               {.expected = expectedAxes}),
      FOCI_KEY(gaze.columns.space.angle_units, "unit of angles",
               {.words = studyWords<AngleUnit>()}),
      FOCI_KEY(gaze.columns.space.head_scale_m, "metres per unit of the head's position",
               {1e-9, 1e6}),
      FOCI_KEY(gaze.columns.space.origin_scale_m, "metres per unit of origins and points",
               {1e-9, 1e6}),
      FOCI_KEY_AS("gaze.scene_rotation", gaze.alignment.rotation,
                  "quaternion x, y, z, w that turns the recording's world to the scene's axes",
                  {-1, 1}),
      FOCI_KEY_AS("gaze.scene_scale", gaze.alignment.scale,
                  "scene's metres per metre of the recording", {1e-6, 1e6}),
      FOCI_KEY_AS("gaze.scene_offset_m", gaze.alignment.offset_m,
                  "where the recording's origin lies in the scene, m", {-kFar_m, kFar_m}),
      FOCI_KEY(gaze.columns.missing, "number that means data loss, in positions and pupils",
               {-1e9, 1e9}),
      FOCI_KEY(gaze.columns.scale, "position in gaze.units = scale * column + offset", {-1e6, 1e6}),
      FOCI_KEY(gaze.columns.offset, "position in gaze.units = scale * column + offset",
               {-1e6, 1e6}),
      FOCI_KEY(gaze.columns.pupil_scale_mm, "millimetres per unit of the pupil columns",
               {1e-9, 1e6}),
      FOCI_KEY(gaze.columns.rate_Hz, "samples per second of a table without a time column",
               {5, 20000}),
      FOCI_KEY(gaze.columns.time_scale_s, "seconds per unit of time", {1e-12, 3600}),
      FOCI_KEY(gaze.columns.units, "units of the position; auto: as the file says",
               {.words = studyWords<std::optional<GazeUnits>>()}),
      FOCI_KEY(gaze.events.detector, "what labels the eye movements",
               {.words = studyWords<Detector>()}),
      FOCI_KEY(gaze.events.pursuit,
               "false: pursuit counts as fixation; absent: false for a headset without head poses, "
               "else true"),
      FOCI_KEY(gaze.events.saccade_deg_s,
               "speed above which the detectors rules and ivt find a saccade, deg/s", {1, 1000}),
      FOCI_KEY(gaze.events.window_s, "time over which the detector rules measures the speed, s",
               {0.002, 0.5}),
      FOCI_KEY(gaze.events.delay_s, "how far the online detector may look ahead, s", {0, 0.2}),
      FOCI_KEY(gaze.events.max_gap_s, "longest data loss that is filled, s", {0, 1}),
      FOCI_KEY(gaze.events.max_blink_s, "longest data loss that counts as a blink, s", {0, 10}),
      FOCI_KEY(focus.cone_deg, "half-angle of the cone in which foci looks for the surface, deg",
               {0.01, 20}),
      FOCI_KEY(focus.coverage, "share of the cone that a surface must fill", {0.01, 1}),
      FOCI_KEY_AS("focus.accommodation", focus.accommodation.on,
                  "false: focus jumps to its target"),
      FOCI_KEY(focus.accommodation.latency_s, "time before focus begins to move, s", {0, 5}),
      FOCI_KEY(focus.accommodation.time_constant_s, "time constant of the exponential approach, s",
               {0.001, 10}),
      FOCI_KEY(focus.accommodation.far_time_constant_s,
               "the same towards a farther target, s; absent: equal", {0.001, 10}),
      FOCI_KEY(focus.accommodation.age_years, "limits how near the eye focuses; absent: no limit",
               {1, 120}),
      FOCI_KEY(focus.accommodation.lag, "focus lags behind near targets"),
      FOCI_KEY(focus.vergence,
               "focus also depends on the distance at which both lines of sight meet"),
      FOCI_KEY(focus.accommodation.resting_D, "focus before there is a target, D", {0, 10}),
      live(FOCI_KEY(focus.fixed_D, "fixed focus, D; absent: focus follows the gaze", {0, 20})),
      live(FOCI_KEY(render.method, "method that renders depth of field: `foci methods`",
                    {.expected = expectedMethod})),
      live(FOCI_KEY_AS(
          "render.shading", lighting.shading,
          "share of the colour that falls off with the angle between surface and sight", {0, 1})),
      FOCI_KEY(render.device, "what renders; auto: a GPU with OpenGL 4.5, else the CPU",
               {.words = studyWords<RenderDevice>()}),
      live(FOCI_KEY(
          quality.tolerance,
          "error that method auto allows in 95 % of the pixels, just-noticeable differences",
          {0.1, 100})),
      live(FOCI_KEY(
          quality.frame_ms,
          "frame-time budget of method auto, ms, instead of the tolerance; images then depend "
          "on the machine's speed; absent: none",
          {1, 1000})),
      live(FOCI_KEY(quality.foveated,
                    "renders no finer than the eye resolves away from gaze, and reuses frames in "
                    "saccades and blinks (auto)")),
      FOCI_KEY(output.size_px, "width and height of the images, px; absent: those of the screen",
               {16, 8192}),
      FOCI_KEY(output.fps, "frames per second", {1, 1000}),
      FOCI_KEY(output.seconds, "start and end, after the recording's first sample, s", {0, 1e6}),
      live(FOCI_KEY(output.marker, "shows where the observer looks")),
      live(FOCI_KEY(output.split, "left half sharp, right half as the eye sees it")),
      FOCI_KEY(output.sync_patch,
               "side of a patch in the lower right corner of foci live, px, whose brightness "
               "follows the frame number, for a photodiode; 0: none",
               {0, 1000}),
      FOCI_KEY(output.images, "also saves every frame as a PNG"),
      FOCI_KEY(output.maps,
               "also saves EXR maps of every replayed frame: linear RGB, depth in metres, defocus "
               "in D (above 0: nearer than the focus); for a single view only",
               {.words = studyWords<FrameMap>()}),
      live(FOCI_KEY(
          output.view,
          "one eye in the middle; both eyes: left beside right, left above right, or left in "
          "red; or one eye alone",
          {.words = studyWords<StereoView>()})),
      FOCI_KEY(record.frames, "frames.tsv of a live run, instead of output.fps"),
      FOCI_KEY(record.changes, "changes.tsv of a live run"),
      FOCI_KEY(record.markers, "event_markers.tsv of a live run, which the report shows"),
      FOCI_KEY(record.head, "head.tsv of a headset"),
      FOCI_KEY(record.rate_Hz,
               "samples per second, as the source states it; absent: the median of the recording",
               {5, 20000}),
      FOCI_KEY(record.device, "what rendered the frames of a live run"),
      FOCI_KEY(remote.folder,
               "folder whose files the remote control of foci live may name (set "
               "observer.wavefront \"NAME\"); absent: none"),
      FOCI_KEY_AS(
          "trial", trials,
          "trials { name, start_s, end_s, type } on the recording's clock; absent: those of "
          "the recording"),
      FOCI_KEY(seed, "seed of the simulated observer", {0, 9007199254740992.0}),
  };
  return keys;
}

#undef FOCI_SIGHT_KEYS
#undef FOCI_KEY
#undef FOCI_KEY_AS

}  // namespace

std::string shownName(std::string_view name) {
  const std::string quoted = quotedText(name.substr(0, 60));
  // People read a quote without its escape.
  return replaced(quoted.substr(1, quoted.size() - 2), "\\\"", "\"");
}

bool changesLive(std::string_view key) {
  const auto found = std::ranges::find(studyKeys(), key, &Key<Study>::name);
  return found != studyKeys().end() && found->live;
}

KeyNames setKeys(Study& study, const TomlDocument& document, const std::string& file) {
  return apply(studyKeys(), document.table(), "", {file, &document}, study);
}

void setKey(Study& study, std::string_view key, const toml::value& value) {
  const auto found = std::ranges::find(studyKeys(), key, &Key<Study>::name);
  assert(found != studyKeys().end());
  found->read(value, found->allowed, study);
}

void setKey(Study& study, std::string_view key, const std::string& text, const std::string& where) {
  const auto& keys = studyKeys();
  const auto found = std::ranges::find(keys, key, &Key<Study>::name);
  if (found == keys.end()) throw unknownKey(where, std::string(key), {}, namesOf(keys));
  if (text == "null") {
    found->reset(study);
    return;
  }
  const auto refusal = [&](const std::string& expected) {
    return InputError(where, std::string(key) + " = " + shownName(text) + ": expected " + expected);
  };
  try {
    const TomlDocument document = parseToml("value = " + text, where);
    found->read(document.table().at("value"), found->allowed, study);
  } catch (const Expected& expected) {
    throw refusal(expected.text({}));
  } catch (const std::exception&) {
    throw refusal("a TOML value; a text needs quotes");
  }
}

std::vector<ResolvedKey> resolvedKeys(const Study& study) {
  const Study defaults;
  std::vector<ResolvedKey> resolved;
  for (const auto& key : studyKeys()) {
    std::string allowed = listed(key.allowed.words, ", ",
                                 [](const auto word) { return quotedText(std::string(word)); });
    if (std::isfinite(key.allowed.high)) allowed = rangeText(key.allowed);
    const std::string json = key.write(study);
    resolved.push_back({key.name, key.meaning, json, allowed, json == key.write(defaults)});
  }
  return resolved;
}

}  // namespace foci
