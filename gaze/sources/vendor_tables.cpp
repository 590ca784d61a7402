// From exports and documentation of Tobii Pro Lab, Tobii Studio, Tobii Pro SDK, PyGaze, Gazepoint,
// Pupil Core, Neon, SMI BeGaze, iMotions, E-Prime, PyTribe and GazeBase.

#include <algorithm>
#include <array>
#include <iterator>
#include <optional>
#include <string>
#include <string_view>

#include "gaze/sources/column_names.h"
#include "gaze/sources/table_layout.h"

namespace foci {
namespace {

using Names = const ColumnNames&;

/// What a vendor's format says beyond the names of its columns.
struct Vendor {
  const char* name;
  /// All of these columns; blanks separate choices.
  std::array<std::string_view, 6> needs{};
  /// Beside them, so that the format is certain.
  std::array<std::string_view, 3> complete{};
  std::optional<GazeUnits> units{};
  double time_scale_s = 0.0;  ///< unless the time's name has a unit; 0: unknown
  std::optional<ValidityCode> code{};
  std::string_view validity{};  ///< column for both eyes
  bool y_up = false, of_scene_camera = false, zero_is_absent = false;
  bool only_unnamed = false;                          ///< not if the study names the position
  bool (*is)(Names, const TablePreamble&) = nullptr;  ///< instead of `needs`
  void (*more)(Names, TableLayout&) = nullptr;
};

/// Gazepoint Analysis: seconds, fractions of the screen, 1 for valid; a blink's number or 0.
void takeGazepoint(Names names, TableLayout& layout) {
  if (layout.x) {
    layout.validity = names.find(names.key(*layout.x) == "bpogx" ? "bpogv" : "fpogv");
  }
  const bool seconds = layout.time && names.key(*layout.time) == "time";
  if (seconds && layout.time_scale_s == 0.0) layout.time_scale_s = 1.0;
}

/// Rows of the mouse and of events lie between those of the eye tracker.
void takeProLab(Names names, TableLayout& layout) {
  layout.of_scene_camera |= isOfProGlasses(names);
  layout.width_px = names.find("recordingresolutionwidth");
  layout.height_px = names.find("recordingresolutionheight");
  layout.rows = names.find("sensor")
                    ? SampleRows{.column = names.find("sensor"), .only = "Eye Tracker"}
                    : SampleRows{.column = names.find("eyetrackertimestamp")};
}

/// Version 1 and 2: times in ms, (0, 0) and (-width, -height) in data loss. Version 3: times in
/// ms, empty fields in data loss. Rows of the mouse, keys and events have no number of a sample.
void takeStudio(Names names, TableLayout& layout) {
  layout.size_off_is_absent = true;
  layout.resolution = names.find("recordingresolution");
  layout.rows.column = names.find(
      "gazepointindex number eyetrackertimestamp validityleft validityright gazepointxleft "
      "gazepointxright");
}

/// Messages and the separators of trials lie between the samples. Those of glasses have the time in
/// the video of the scene.
void takeSmi(Names names, TableLayout& layout) {
  layout.of_scene_camera |= names.find("videotime") && names.find("pointofregardbinocularx");
  if (const auto type = names.find("type")) {
    layout.rows = {.column = type, .only = "SMP"};
  } else {
    layout.rows = {.column = names.find("categoryright categoryleft categorybinocular"),
                   .except = "Separator"};
  }
}

bool isSurface(Names names, const TablePreamble&) {
  const auto x = names.find("x");
  return names.find("onsurf onsrf") && x && names.unit(*x) == "norm";
}

bool isSmi(Names names, const TablePreamble& before) {
  return before.smi ||
         (names.find("recordingtime") &&
          names.find("pointofregardleftx pointofregardrightx pointofregardbinocularx")) ||
         (names.find("type") && names.find("trial") && names.find("lporx rporx"));
}

bool isNeon(Names names, const TablePreamble&) {
  const auto time = names.find("timestamp");
  return time && names.unit(*time) == "ns" && names.find("gazex") && names.find("gazey");
}

void minusOneIsLoss(Names, TableLayout& layout) {
  if (!layout.missing) layout.missing = -1.0;
}

/// An eye that is not recorded is at (0, 0), one that is not seen at -32768.
void takeEyeLinkRelay(Names names, TableLayout& layout) {
  if (!layout.missing) layout.missing = -32768.0;
  layout.eyes[0].pupil_own = names.find("leftpupilarea");
  layout.eyes[1].pupil_own = names.find("rightpupilarea");
  layout.pupil_unit = "arbitrary";
}

constexpr std::optional<GazeUnits> kPx = GazeUnits::px, kDeg = GazeUnits::deg,
                                   kFractions = GazeUnits::normalised;

const Vendor kVendors[] = {
    {.name = "Gazepoint",
     .needs = {"bpogx fpogx lpogx rpogx", "bpogy fpogy lpogy rpogy"},
     .complete = {"time timetick", "bpogv fpogv lpogv rpogv"},
     .units = kFractions,
     .code = ValidityCode::one,
     .only_unnamed = true,
     .more = takeGazepoint},
    {.name = "Tobii Pro SDK",
     .needs = {"leftgazepointondisplayarea rightgazepointondisplayarea "
               "leftgazepointondisplayareax rightgazepointondisplayareax"},
     .complete = {"leftgazepointvalidity", "rightgazepointvalidity",
                  "devicetimestamp systemtimestamp"},
     .units = kFractions,
     .time_scale_s = 1e-6,
     .code = ValidityCode::one},
    {.name = "PyGaze, Tobii",
     .needs = {"gazepointxleft", "validityleft", "pupilvalidityleft", "gazepointxright",
               "validityright", "pupilvalidityright"},
     .units = kPx,
     .time_scale_s = 1e-3,
     .code = ValidityCode::one},
    {.name = "Tobii Studio",
     .complete = {"validityleft", "validityright"},
     .units = kPx,
     .time_scale_s = 1e-3,
     .zero_is_absent = true,
     .is = isTobiiStudio,
     .more = takeStudio},
    {.name = "Tobii Pro Lab",
     .needs = {"recordingtimestamp", "gazepointx gazepointleftx", "gazepointy gazepointlefty"},
     .complete = {"sensor eyetrackertimestamp", "validityleft", "validityright"},
     .units = kPx,
     .more = takeProLab},
    {.name = "Pupil Core export",
     .needs = {"gazetimestamp", "posx x", "posy y", "basedata"},
     .complete = {"confidence", "worldindex"},
     .units = kFractions,
     .time_scale_s = 1.0,
     .y_up = true,
     .of_scene_camera = true},
    {.name = "Pupil Core surface",
     .complete = {"confidence", "worldindex worldtimestamp"},
     .units = kFractions,
     .time_scale_s = 1.0,
     .y_up = true,
     .is = isSurface},
    {.name = "Neon export",
     .complete = {"worn"},
     .code = ValidityCode::not_zero,
     .validity = "worn",
     .of_scene_camera = true,
     .is = isNeon},
    {.name = "Pupil Capture's relay",
     .needs = {"posx", "posy", "gazenormal0x", "eyecenter03dx"},
     .units = kFractions,
     .y_up = true,
     .of_scene_camera = true},
    {.name = "EyeLink's relay",
     .needs = {"lefteyex", "lefteyey", "righteyex", "righteyey", "pixelsperdegreex"},
     .units = kPx,
     .zero_is_absent = true,
     .more = takeEyeLinkRelay},
    {.name = "SMI BeGaze",
     .complete = {"trial", "type categoryright categoryleft categorybinocular"},
     .units = kPx,
     .time_scale_s = 1e-6,
     .zero_is_absent = true,
     .is = isSmi,
     .more = takeSmi},
    {.name = "iMotions",
     .needs = {"etgazeleftx etgazerightx", "etgazelefty etgazerighty"},
     .units = kPx,
     .time_scale_s = 1e-3,
     .more = minusOneIsLoss},
    {.name = "E-Prime, Tobii",
     .needs = {"tettime", "xgazeposlefteye xgazeposrighteye", "ygazeposlefteye ygazeposrighteye"},
     .complete = {"validitylefteye", "validityrighteye"},
     .units = kFractions,
     .time_scale_s = 1e-3,
     .more = minusOneIsLoss},
    {.name = "The Eye Tribe",
     .complete = {"fix", "state"},
     .units = kPx,
     .time_scale_s = 1e-3,
     .zero_is_absent = true,
     .is = [](Names names, const TablePreamble&) { return isEyeTribe(names); }},
    {.name = "GazeBase",
     .needs = {"n", "x", "y", "val", "dp"},
     .complete = {"xt", "yt", "lab"},
     .units = kDeg,
     .time_scale_s = 1e-3,
     .code = ValidityCode::zero,
     .validity = "val"}};

/// Rows by an eye's validity and by whether it has a position. One that is kept tells nothing.
struct ValidityCounts {
  std::array<std::size_t, 2> good{}, lost{};  // of the values 0 and 1
  std::size_t others = 0;                     // of another value
  std::array<std::optional<double>, 2> last_x{}, last_y{};

  void add(const Rows& rows, const EyeColumns& eye, std::size_t side) {
    if (!eye.validity || !eye.x || !eye.y) return;
    if (std::max({*eye.validity, *eye.x, *eye.y}) >= rows.size()) return;
    const auto value = rows.number(*eye.validity);
    if (!value) return;
    const auto x = parseNumber(rows.text(*eye.x)), y = parseNumber(rows.text(*eye.y));
    if (*value != 0.0 && *value != 1.0) {
      ++others;
    } else if (!x || !y || (*x == *y && *x <= 0.0)) {
      ++lost[*value == 1.0];
    } else if (x != last_x[side] || y != last_y[side]) {
      ++good[*value == 1.0];
    }
    last_x[side] = x;
    last_y[side] = y;
  }
};

bool isOf(const Vendor& vendor, Names names, const TablePreamble& before) {
  if (vendor.is) return vendor.is(names, before);
  return std::ranges::all_of(vendor.needs, [&](std::string_view keys) {
    return keys.empty() || names.find(keys).has_value();
  });
}

}  // namespace

bool isOfProGlasses(const ColumnNames& names) {
  bool in_head = false;
  for (std::size_t i = 0; i < names.size(); ++i) {
    in_head |= names.text(i).find("[HUCS") != std::string_view::npos;
  }
  return in_head ||
         (names.find("recordingmediawidth recordingmedianame gazepoint3dx gazepoint3dleftx "
                     "pupilpositionleftx gyrox accelerometerx") &&
          !names.find("recordingresolutionwidth presentedmedianame presentedstimulusname"));
}

bool isEyeTribe(const ColumnNames& names) {
  return names.find("avgx") && names.find("lavgx") && names.find("lrawx") && names.find("rrawx");
}

bool isTobiiStudio(const ColumnNames& names, const TablePreamble& before) {
  const auto time = names.find("recordingtimestamp");
  const bool version3 = time && names.text(*time).find(' ') == std::string_view::npos &&
                        names.find("gazepointx gazepointleftx");
  return before.tobii_studio || version3 ||
         (names.find("gazepointxleft") && names.find("gazepointyleft") &&
          names.find("camxleft distanceleft number"));
}

void judgeValidity(Rows& rows, TableLayout& layout) {
  constexpr std::size_t kEnough = 20, kMostly = 9;
  if (!layout.eyes[0].validity && !layout.eyes[1].validity) return;
  const auto countIn = [&](std::size_t most) {
    ValidityCounts seen;
    rows.survey(most, [&] {
      for (const std::size_t side : {0, 1}) seen.add(rows, layout.eyes[side], side);
    });
    return seen;
  };
  ValidityCounts seen = countIn(kSurveyedRows);
  const ValidityCode stated = layout.validity_code;
  if (seen.good[0] + seen.good[1] < kEnough) return;
  if (stated == ValidityCode::below_two && seen.others == 0) {
    if (seen.good[1] >= kMostly * seen.good[0]) {
      layout.validity_code = ValidityCode::one;
    } else if (seen.lost[1] > seen.good[1]) {
      layout.validity_code = ValidityCode::zero;
    }
  } else if (stated == ValidityCode::one && seen.good[0] >= kMostly * seen.good[1]) {
    // Against the vendor's code, all rows must tell, up to some megabytes.
    seen = countIn(SIZE_MAX);
    if (seen.good[0] < kMostly * seen.good[1] || seen.good[1] >= kEnough) return;
    layout.validity_code = seen.others > 0 ? ValidityCode::below_two : ValidityCode::zero;
  }
  if (layout.validity_code == stated) {
    if (layout.isPlain() && seen.others == 0 && std::min(seen.good[0], seen.good[1]) >= kEnough) {
      layout.validity_note =
          "validity of an eye is 0 or 1, and positions do not show which is good: both count; give "
          "gaze.confidence (1 is good) or gaze.blink (0 is good)";
    }
    return;
  }
  layout.validity_note = std::string("validity of an eye: ") +
                         (layout.validity_code == ValidityCode::one ? "1 is valid and 0 is lost"
                                                                    : "0 is valid and 1 is lost") +
                         ", as the positions show" +
                         (layout.isPlain() ? "" : "; usual for " + layout.format + ": ") +
                         (layout.isPlain()              ? ""
                          : stated == ValidityCode::one ? "1 is valid"
                                                        : "0 is valid, 4 is lost");
  if (!layout.isPlain()) layout.lacks = "its usual code of validity";
}

void takeVendorFormat(const ColumnNames& names, const TraceColumns& columns,
                      const TablePreamble& before, TableLayout& layout) {
  const auto* const found = std::ranges::find_if(kVendors, [&](const Vendor& vendor) {
    return (columns.x.empty() || !vendor.only_unnamed) && isOf(vendor, names, before);
  });
  if (found == std::end(kVendors)) {
    // Pupil Labs' norm_pos counts from the bottom.
    layout.y_up |=
        layout.x && names.unit(*layout.x) == "norm" && names.key(*layout.x).ends_with("posx");
    return;
  }
  layout.format = found->name;
  for (const std::string_view keys : found->complete) {
    const bool has = keys.empty() || names.find(keys);
    if (!has && layout.lacks.empty()) layout.lacks = keys.substr(0, keys.find(' '));
  }
  if (found->units && !(layout.units && found->units == kPx)) layout.units = found->units;
  if (layout.time_scale_s == 0.0 || (found->time_scale_s == 1.0 && !columns.time_scale_s)) {
    if (found->time_scale_s > 0.0) layout.time_scale_s = found->time_scale_s;
  }
  layout.validity_code = found->code.value_or(layout.validity_code);
  if (!found->validity.empty()) layout.validity = names.find(found->validity);
  layout.y_up |= found->y_up;
  layout.of_scene_camera |= found->of_scene_camera;
  layout.zero_is_absent |= found->zero_is_absent;
  if (found->more) found->more(names, layout);
}

}  // namespace foci
