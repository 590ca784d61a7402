// The names come from exports and documentation of Tobii Pro Lab, Tobii Studio, Tobii Pro SDK,
// Pupil Core, Neon, SMI BeGaze, GazeBase, GazeBaseVR, JuDo1000 and BIDS.
#include "gaze/sources/table_layout.h"

#include <algorithm>
#include <initializer_list>
#include <string>

#include "base/number.h"
#include "base/text.h"
#include "gaze/sources/column_names.h"

namespace foci {
namespace {

using Keys = ColumnNames::Keys;

constexpr std::string_view kTimes[] = {
    "time",          "timestamp",       "t", "sampletime", "recordingtimestamp",
    "gazetimestamp", "devicetimestamp", "n"};
constexpr std::string_view kXs[] = {"x",    "gazex",    "xgaze",       "gazepointx",
                                    "eyex", "normposx", "xcoordinate", "porx"};
constexpr std::string_view kYs[] = {"y",    "gazey",    "ygaze",       "gazepointy",
                                    "eyey", "normposy", "ycoordinate", "pory"};

double secondsPer(const std::string& unit) {
  return unit == "s" ? 1.0 : unit == "ms" ? 1e-3 : unit == "us" ? 1e-6 : unit == "ns" ? 1e-9 : 0.0;
}

char delimiterOf(std::string_view header) {
  const auto has = [&](char c) { return header.find(c) != std::string_view::npos; };
  return has('\t') ? '\t' : has(';') ? ';' : has(',') ? ',' : ' ';
}

class Recogniser {
 public:
  Recogniser(const LineReader& lines, std::string_view header, const TraceColumns& columns,
             const TablePreamble& before)
      : lines_(lines),
        given_(columns),
        before_(before),
        names_(lines, header, delimiterOf(header)) {
    layout_.delimiter = delimiterOf(header);
    layout_.format = layout_.delimiter == '\t' ? "TSV" : layout_.delimiter == ' ' ? "text" : "CSV";
  }

  TableLayout recognise() {
    findTime();
    findEyes();
    takeGivenEyes();
    findPoint();
    findRest();
    recogniseFormat();
    for (std::size_t i = 0; i < names_.size(); ++i) {
      if (isUsed(i)) layout_.columns = i + 1;
      for (const EyeColumns& eye : layout_.eyes) layout_.has_eyes |= isOf(eye, i);
    }
    return std::move(layout_);
  }

 private:
  std::optional<std::size_t> find(Keys keys) const { return names_.find(keys); }
  std::optional<std::size_t> find(std::initializer_list<std::string_view> keys) const {
    return names_.find(keys);
  }

  /// The column that the study names. A column that is named by its number may have no header.
  std::size_t named(const std::string& name) {
    const std::size_t column = names_.named(name);
    layout_.headless |= name.starts_with('#') && parseNumber(names_.text(column)).has_value();
    return column;
  }

  std::size_t require(const std::string& name, Keys usual) {
    return name.empty() ? names_.require(name, usual) : named(name);
  }

  /// Pupil diameters, if they are in millimetres: by the unit, or because Tobii always writes them
  /// so.
  std::optional<std::size_t> findPupil(std::initializer_list<std::string_view> keys) const {
    const auto found = find(keys);
    const bool tobii = find({"recordingtimestamp", "devicetimestamp"}).has_value();
    return found && (tobii || names_.unit(*found) == "mm") ? found : std::nullopt;
  }

  void findEyes() {
    auto& [left, right] = layout_.eyes;
    left.point = find({"leftgazepointondisplayarea"});
    right.point = find({"rightgazepointondisplayarea"});
    left.x = find({"lx", "leftx", "xleft", "leftgazex", "gazeleftx", "gazexleft", "gazepointleftx",
                   "leftgazepointx", "lporx", "leftxcoordinate", "xl"});
    left.y = find({"ly", "lefty", "yleft", "leftgazey", "gazelefty", "gazeyleft", "gazepointlefty",
                   "leftgazepointy", "lpory", "leftycoordinate", "yl"});
    right.x = find({"rx", "rightx", "xright", "rightgazex", "gazerightx", "gazexright",
                    "gazepointrightx", "rightgazepointx", "rporx", "rightxcoordinate", "xr"});
    right.y = find({"ry", "righty", "yright", "rightgazey", "gazerighty", "gazeyright",
                    "gazepointrighty", "rightgazepointy", "rpory", "rightycoordinate", "yr"});
    left.validity = find({"leftgazepointvalidity", "validityleft", "leftvalidity"});
    right.validity = find({"rightgazepointvalidity", "validityright", "rightvalidity"});
    left.pupil_mm = findPupil({"leftpupildiameter", "pupildiameterleft", "pupilleft",
                               "lmappeddiameter", "leftpupilsize", "leftpupil"});
    right.pupil_mm = findPupil({"rightpupildiameter", "pupildiameterright", "pupilright",
                                "rmappeddiameter", "rightpupilsize", "rightpupil"});
    // Tobii's user coordinate system: x right, y up, z towards the user.
    for (std::size_t side : {0, 1}) {
      EyeColumns& eye = layout_.eyes[side];
      const std::string name = side == 0 ? "left" : "right";
      eye.origin_point_mm = find({name + "gazeorigininusercoordinatesystem"});
      eye.sight_point_mm = find({name + "gazepointinusercoordinatesystem"});
      eye.origin_validity = find({name + "gazeoriginvalidity"});
    }
    const std::string axes = "xyz";
    for (std::size_t axis : {0, 1, 2}) {
      const std::string letter = axes.substr(axis, 1);
      left.origin_mm[axis] = find({"leftorigin" + letter});
      right.origin_mm[axis] = find({"rightorigin" + letter});
      left.direction[axis] = find({"leftdirection" + letter});
      right.direction[axis] = find({"rightdirection" + letter});
    }
    if (left.direction[0] || right.direction[0]) return;
    // In Pupil Core the right eye is number 0.
    layout_.camera_axes = true;
    for (std::size_t axis : {0, 1, 2}) {
      left.origin_mm[axis] = find({"eyecenter13d" + axes.substr(axis, 1)});
      right.origin_mm[axis] = find({"eyecenter03d" + axes.substr(axis, 1)});
      left.direction[axis] = find({"gazenormal1" + axes.substr(axis, 1)});
      right.direction[axis] = find({"gazenormal0" + axes.substr(axis, 1)});
    }
  }

  static bool hasPoint(const EyeColumns& eye) { return eye.point || (eye.x && eye.y); }

  void findPoint() {
    const bool eyes = hasPoint(layout_.eyes[0]) || hasPoint(layout_.eyes[1]);
    const bool told = !given_.eyes[0].x.empty() || !given_.eyes[1].x.empty();
    if (given_.x.empty() && given_.y.empty() && eyes &&
        (told || !(find(Keys(kXs)) && find(Keys(kYs))))) {
      takeUnits(layout_.eyes[0].x ? layout_.eyes[0].x : layout_.eyes[1].x);
      return;
    }
    // Without columns of a point, lines of sight give it.
    if (given_.x.empty() && given_.y.empty() && layout_.hasDirections() && !find(Keys(kXs))) return;
    layout_.x = require(given_.x, kXs);
    layout_.y = require(given_.y, kYs);
    takeUnits(layout_.x);
    if (names_.unit(*layout_.x) != names_.unit(*layout_.y) && !given_.units) {
      throw lines_.error("columns " + shown(names_.text(*layout_.x)) + " and " +
                         shown(names_.text(*layout_.y)) +
                         " have different units: expected the same");
    }
  }

  void takeUnits(const std::optional<std::size_t>& column) {
    if (column) layout_.units = unitsNamed(names_.unit(*column));
  }

  void findTime() {
    const std::optional<double> rate_Hz = given_.rate_Hz ? given_.rate_Hz : before_.rate_Hz;
    const bool counted = given_.time.empty() && rate_Hz && (given_.rate_Hz || !find(Keys(kTimes)));
    if (counted) {
      layout_.rate_Hz = *rate_Hz;
      layout_.time_scale_s = 1.0;
    } else {
      layout_.time = require(given_.time, kTimes);
      layout_.time_scale_s = given_.time_scale_s.value_or(secondsPer(names_.unit(*layout_.time)));
    }
  }

  void takeGivenEyes() {
    for (std::size_t side : {0, 1}) {
      const TraceColumns::Eye& given = given_.eyes[side];
      EyeColumns& eye = layout_.eyes[side];
      const char* name = side == 0 ? "left" : "right";
      if (given.x.empty() != given.y.empty()) {
        throw lines_.error(std::string(name) + "_x and " + name + "_y: expected both or neither");
      }
      if (!given.x.empty()) {
        eye = EyeColumns{.x = named(given.x), .y = named(given.y)};
      } else if (given_.namesEye(1 - side) && given.pupil.empty()) {
        eye = {};  // the study names the other eye alone
      }
      if (!given.pupil.empty()) eye.pupil_mm = named(given.pupil);
    }
  }

  void findRest() {
    layout_.pupil_mm = !given_.pupil.empty() ? std::optional(named(given_.pupil))
                                             : findPupil({"pupil", "pupildiameter", "pupilsize"});
    layout_.blink = !given_.blink.empty() ? std::optional(named(given_.blink))
                                          : find({"blink", "isblink", "blinkid"});
    layout_.named_blink =
        given_.blink.empty() && layout_.blink && names_.key(*layout_.blink) == "blinkid";
    layout_.confidence =
        !given_.confidence.empty() ? std::optional(named(given_.confidence)) : find({"confidence"});
    const auto uncertainty = find({"uncertainty"});
    if (uncertainty && names_.unit(*uncertainty) == "deg") layout_.uncertainty_deg = uncertainty;
    layout_.numbers = {.missing = given_.missing,
                       .scale = given_.scale,
                       .offset = given_.offset,
                       .pupil_scale_mm = given_.pupil_scale_mm};
  }

  void recogniseFormat() {
    const auto set = [&](const char* format) { layout_.format = format; };
    if (layout_.eyes[0].point || layout_.eyes[1].point) {
      set("Tobii Pro SDK");
      layout_.units = GazeUnits::normalised;
      layout_.validity_code = ValidityCode::one;
      if (layout_.time_scale_s == 0.0) layout_.time_scale_s = 1e-6;
    } else if (find({"recordingtimestamp"}) && find({"gazepointx", "gazepointleftx"})) {
      set("Tobii Pro Lab");
      layout_.width_px = find({"recordingresolutionwidth"});
      layout_.height_px = find({"recordingresolutionheight"});
      if (!layout_.units) layout_.units = GazeUnits::px;
      if ((layout_.kind = find({"sensor"}))) layout_.sample_kind = "Eye Tracker";
    } else if (find({"gazetimestamp"}) && find({"normposx"}) && find({"basedata"})) {
      set("Pupil Core export");
      layout_.units = GazeUnits::normalised;
      layout_.y_up = true;
      layout_.time_scale_s = 1.0;
    } else if (find({"sectionid"}) && find({"gazex"}) && find({"recordingid"})) {
      set("Neon export");
    } else if (before_.smi) {
      set("SMI BeGaze");
      layout_.units = GazeUnits::px;
      layout_.zero_is_absent = true;
      if (layout_.time_scale_s == 0.0) layout_.time_scale_s = 1e-6;
      if ((layout_.kind = find({"type"}))) layout_.sample_kind = "SMP";
    } else if (find({"n"}) && find({"clx"}) && find({"lx"})) {
      set("GazeBaseVR");
      layout_.units = GazeUnits::deg;
      layout_.time_scale_s = 1e-3;
    } else if (find({"n"}) && find({"val"}) && find({"dp"})) {
      set("GazeBase");
      layout_.units = GazeUnits::deg;
      layout_.time_scale_s = 1e-3;
      layout_.validity = find({"val"});
      layout_.validity_code = ValidityCode::zero;
    }
  }

  static bool isOf(const EyeColumns& eye, std::size_t column) {
    const auto is = [&](const std::optional<std::size_t>& at) { return at == column; };
    return is(eye.x) || is(eye.y) || is(eye.point) || is(eye.validity) || is(eye.pupil_mm) ||
           is(eye.origin_point_mm) || is(eye.sight_point_mm) || is(eye.origin_validity) ||
           std::any_of(eye.origin_mm.begin(), eye.origin_mm.end(), is) ||
           std::any_of(eye.direction.begin(), eye.direction.end(), is);
  }

  bool isUsed(std::size_t column) const {
    const auto is = [&](const std::optional<std::size_t>& at) { return at == column; };
    bool used = is(layout_.time);
    for (const auto& at : {layout_.x, layout_.y, layout_.pupil_mm, layout_.blink,
                           layout_.confidence, layout_.validity, layout_.width_px,
                           layout_.height_px, layout_.kind, layout_.uncertainty_deg}) {
      used |= is(at);
    }
    for (const EyeColumns& eye : layout_.eyes) used |= isOf(eye, column);
    return used;
  }

  const LineReader& lines_;
  const TraceColumns& given_;
  const TablePreamble& before_;
  ColumnNames names_;
  TableLayout layout_{};
};

}  // namespace

TableLayout recogniseTable(const LineReader& lines, std::string_view header,
                           const TraceColumns& columns, const TablePreamble& before) {
  return Recogniser(lines, header, columns, before).recognise();
}

}  // namespace foci
