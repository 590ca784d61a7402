// The names come from exports and documentation of the makers in vendor_tables.cpp, and of
// iMotions, GazeBaseVR, JuDo1000 and BIDS.
#include "gaze/sources/table_layout.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "base/quantile.h"
#include "base/text.h"
#include "gaze/sources/column_names.h"

namespace foci {
namespace {

constexpr std::string_view kTimes =
    "time timestamp t sampletime recordingtimestamp gazetimestamp devicetimestamp recordingtime "
    "tettime n";
// A plain "x" is last: beside "gaze_x" it is the place of something else.
constexpr std::string_view kXs =
    "gazex xgaze gazepointx xcoordinate porx bporx pointofregardbinocularx gazeposx averagegazex x "
    "xp";
constexpr std::string_view kYs =
    "gazey ygaze gazepointy ycoordinate pory bpory pointofregardbinoculary gazeposy averagegazey y "
    "yp";
// Of one eye: patterns of `keysOf`. One letter for the eye is last: "rx" may be a rotation.
constexpr std::string_view kEyesAxes =
    "EYEA AEYE EYEgazeA gazeEYEA gazeAEYE gazepointEYEA gazepointAEYE EYEgazepointA EporA "
    "etgazeEYEA pointofregardEYEA EYEAcoordinate EpogA EYEgazepointondisplayareaA EYEeyeA "
    "AgazeposEYEeye gAEYE ApE EA AE";
constexpr std::string_view kEyesValidity =
    "EYEgazepointvalidity validityEYE EYEvalidity EYEgazepointvalid Epogv validityEYEeye";
constexpr std::string_view kEyesPupil =
    "EYEpupildiameter pupildiameterEYE pupilEYE Emappeddiameter Epupildiameter EYEpupilsize "
    "EYEpupil Epmm diameterpupilEYEeye";

class Recogniser {
 public:
  Recogniser(Rows& rows, const TraceColumns& columns)
      : rows_(rows), given_(columns), before_(rows.before()), names_(rows, rows.names()) {
    const char between = rows.delimiter();
    layout_.of_scene_camera = before_.of_scene_camera;
    layout_.names = names_.size();
    layout_.format = rows.areNumbers() || between == '\t' ? "TSV" : between == ' ' ? "text" : "CSV";
  }

  TableLayout recognise() {
    const bool is_told = !given_.x.empty() || given_.space.hasSight() || given_.space.from_head ||
                         given_.mapped_later;
    const bool of_vendor = !is_told && takeSpaceVendor(names_, given_, layout_);
    if (!layout_.time) findTime();
    if (of_vendor) {
      if (given_.space.hasHead()) {
        takeHead(rows_, names_, given_.space, *layout_.space);
        layout_.space->head_axes = axesOf(rows_, given_.space);
      }
    } else if (given_.space.hasSight() || given_.space.hasHead() || given_.space.from_head) {
      takeSpace();
    } else {
      findEyes();
      takeGivenEyes();
      findPoint();
    }
    findRest();
    if (!layout_.space) takeVendorFormat(names_, given_, before_, layout_);
    judgeValidity(rows_, layout_);
    if (layout_.camera_axes && layout_.x && !layout_.sights_beside) leaveOutEmptyDirections();
    refuseOtherTables();
    layout_.has_eyes = layout_.eyes != std::array<EyeColumns, 2>{};
    layout_.roles = rolesOf(layout_, given_);
    layout_.groups = groupRows(rows_, names_, layout_, given_);
    layout_.roles = rolesOf(layout_, given_);
    for (std::size_t i = 0; i < names_.size(); ++i) {
      if (!layout_.uses(i)) continue;
      if (!given_.x.starts_with('#')) names_.refuseTwin(i);
      layout_.columns = i + 1;
    }
    layout_.readings = readingsOf(names_, layout_);
    findUnusedValidity();
    findUnusedGaze();
    return std::move(layout_);
  }

 private:
  std::optional<std::size_t> find(std::string_view keys) const { return names_.find(keys); }

  /// The column that the study names. A column that is named by its number may have no header.
  std::size_t named(const std::string& name) {
    const std::size_t column = names_.named(name);
    layout_.headless |= name.starts_with('#') && parseNumber(names_.text(column)).has_value();
    return column;
  }

  /// The study's column of pupils, which are taken for diameters in mm or, scaled, another length.
  std::size_t namedPupil(const std::string& name) {
    const std::size_t column = named(name);
    const std::string &key = names_.key(column), &unit = names_.unit(column);
    const bool other_unit = !unit.empty() && unit != "mm";
    const bool area = key.find("area") != key.npos || key.ends_with("mm2");
    const bool scalable =
        key.find("radius") != key.npos || other_unit || !names_.unknownUnit(column).empty();
    if (area || (scalable && given_.pupil_scale_mm == 1.0)) {
      layout_.doubtful_pupil = names_.text(column);
    }
    return column;
  }

  std::optional<std::size_t> findPosition(std::string_view keys) const {
    // Units that the user states hold for any column.
    return given_.units ? names_.find(keys) : names_.findPosition(keys);
  }

  /// Gazepoint's best point of both eyes, else the one filtered to fixations; else by the usual
  /// names; else Pupil Core's, a position only if the name also says "norm".
  std::optional<std::size_t> findAxis(std::string_view gazepoint_keys, std::string_view keys,
                                      std::string_view norm_keys) const {
    if (const auto gazepoint = find(gazepoint_keys)) return gazepoint;
    if (const auto found = findPosition(keys)) return found;
    const auto norm = find(norm_keys);
    return norm && names_.unit(*norm) == "norm" ? norm : std::nullopt;
  }
  std::optional<std::size_t> findX() const { return findAxis("bpogx fpogx", kXs, "posx gazeposx"); }
  std::optional<std::size_t> findY() const { return findAxis("bpogy fpogy", kYs, "posy gazeposy"); }

  /// Pupil diameters, if they are in millimetres: by the unit, or because Tobii always writes them
  /// so.
  std::optional<std::size_t> findPupil(std::string_view keys) const {
    const auto found = find(keys);
    const bool tobii = isTobiiStudio(names_, before_) ||
                       find("recordingtimestamp devicetimestamp tettime").has_value();
    const bool gazepoint = found && (names_.key(*found) == "lpmm" || names_.key(*found) == "rpmm");
    return found && (tobii || gazepoint || names_.unit(*found) == "mm") ? found : std::nullopt;
  }

  /// Pupils in another unit that the name states.
  std::optional<std::size_t> findOwnPupil(std::string_view keys) {
    const auto found = find(keys);
    if (!found || (names_.unit(*found) != "a.u." && names_.unit(*found) != "px")) {
      return std::nullopt;
    }
    layout_.pupil_unit = names_.unit(*found) == "px" ? "px" : "arbitrary";
    return found;
  }

  void findEyes() {
    layout_.sights_beside = find("opticalaxisleftx") && find("gazex");
    layout_.camera_axes = layout_.sights_beside || find("gazenormal0x gazenormal1x");
    for (std::size_t side : {0, 1}) {
      EyeColumns& eye = layout_.eyes[side];
      const auto findOf = [&](std::string_view pattern) { return find(keysOf(pattern, side)); };
      // SMI's "L Raw X" is the pupil in the image of a camera.
      const std::string_view axes = isEyeTribe(names_) ? "ErawA" : kEyesAxes;
      eye.x = findPosition(keysOf(axes, side, 'x'));
      eye.y = findPosition(keysOf(axes, side, 'y'));
      eye.validity = findOf(kEyesValidity);
      // In Pupil Core the right eye is number 0.
      eye.pupil_mm =
          findPupil(keysOf(kEyesPupil, side) + (side == 0 ? " diameter13d" : " diameter03d"));
      if (!eye.pupil_mm)
        eye.pupil_own = findOwnPupil(keysOf("EYEpupilsize EYEpupil pupilEYE", side));
      eye.point = findOf("EYEgazepointondisplayarea");
      eye.origin_point_mm = findOf("EYEgazeorigininusercoordinatesystem");
      eye.sight_point_mm = findOf("EYEgazepointinusercoordinatesystem");
      eye.origin_validity = findOf("EYEgazeoriginvalidity");
      // Tobii's user coordinate system: x right, y up, z towards the user.
      std::string_view origin = "EYEoriginA EYEgazeorigininusercoordinatesystemA";
      std::string_view direction = "EYEdirectionA";
      if (layout_.sights_beside) {
        origin = "eyeballcenterEYEA";
        direction = "opticalaxisEYEA";
      } else if (layout_.camera_axes) {
        origin = side == 0 ? "eyecenter13dA" : "eyecenter03dA";
        direction = side == 0 ? "gazenormal1A" : "gazenormal0A";
      }
      eye.origin_mm = names_.findTriple(origin, side);
      eye.direction = names_.findTriple(direction, side);
      // As docs/calibration.md names them. Others do not tell their axes and their frame.
      const bool in_mm = eye.origin_mm && names_.unit((*eye.origin_mm)[0]) == "mm";
      if (eye.direction && !layout_.camera_axes && !in_mm) eye.direction = eye.origin_mm = {};
      eye.sight_mm = names_.findTriple("EYEgazepointinusercoordinatesystemA", side);
    }
  }

  static bool hasPoint(const EyeColumns& eye) { return eye.point || (eye.x && eye.y); }

  /// Whether two points are of one gaze, by the first rows: most of them are nearer to each other
  /// than a quarter of the range that the first one covers. Codes of data loss do not count.
  bool areOneGaze(const std::array<std::size_t, 2>& first,
                  const std::array<std::size_t, 2>& other) {
    constexpr std::size_t kFewest = 20;
    constexpr double kNear = 0.25;
    std::array<std::vector<double>, 2> values, apart;
    rows_.survey(kSurveyedRows, [&] {
      for (const std::size_t axis : {0, 1}) {
        if (std::max(first[axis], other[axis]) >= rows_.size()) continue;
        const auto a = parseNumber(rows_.text(first[axis])),
                   b = parseNumber(rows_.text(other[axis]));
        if (!a || !b || *a <= 0.0 || *b <= 0.0) continue;
        values[axis].push_back(*a);
        apart[axis].push_back(std::abs(*a - *b));
      }
    });
    for (const std::size_t axis : {0, 1}) {
      if (values[axis].size() < kFewest) continue;
      const double range = quantile(values[axis], 0.98) - quantile(values[axis], 0.02);
      if (range > 0.0 && quantile(apart[axis], 0.5) > kNear * range) return false;
    }
    return true;
  }

  /// A plain point is that of a mouse or a target where the gaze of both eyes, in its unit, is at
  /// one other point.
  bool isOfOther(std::size_t x, std::size_t y) {
    const auto& [left, right] = layout_.eyes;
    return names_.key(x) == "x" && left.x && left.y && right.x && right.y &&
           names_.key(*left.x).find("gaze") != std::string::npos &&
           names_.unit(*left.x) == names_.unit(x) &&
           areOneGaze({*left.x, *left.y}, {*right.x, *right.y}) &&
           !areOneGaze({*left.x, *left.y}, {x, y});
  }

  void findPoint() {
    const bool eyes = hasPoint(layout_.eyes[0]) || hasPoint(layout_.eyes[1]);
    const bool told = !given_.eyes[0].x.empty() || !given_.eyes[1].x.empty();
    const auto x = findX(), y = findY();
    const bool is_other = eyes && x && y && !told && given_.x.empty() && isOfOther(*x, *y);
    if (given_.x.empty() && given_.y.empty() && eyes && (told || !(x && y) || is_other)) {
      if (is_other) layout_.unused_gaze = names_.text(*x);
      takeUnits(layout_.eyes[0].x ? layout_.eyes[0].x : layout_.eyes[1].x);
      return;
    }
    // Without columns of a point, lines of sight give it.
    if (given_.x.empty() && given_.y.empty() && layout_.hasDirections() && !x) return;
    layout_.x = given_.x.empty() ? x : named(given_.x);
    if (!layout_.x) throw names_.missing(ColumnNames::Meaning::x, kXs);
    layout_.y = given_.y.empty() ? y : named(given_.y);
    if (!layout_.y) throw names_.missing(ColumnNames::Meaning::y, kYs);
    takeUnits(layout_.x);
    for (EyeColumns& eye : layout_.eyes) {
      // One scale holds for all positions: an eye in other units is left out. So are eyes beside a
      // point that only the study names, and what has an eye's letter but is elsewhere ("rx").
      if (!eye.x || told) continue;
      const bool has_letter = names_.key(*eye.x).size() == 2 && eye.y;
      if (layout_.x != x || names_.unit(*eye.x) != names_.unit(*layout_.x) ||
          (has_letter && !areOneGaze({*layout_.x, *layout_.y}, {*eye.x, *eye.y}))) {
        eye.x = eye.y = {};
      }
    }
    if (names_.unit(*layout_.x) != names_.unit(*layout_.y) && !given_.units) {
      throw rows_.error("columns " + shown(names_.text(*layout_.x)) + " and " +
                        shown(names_.text(*layout_.y)) +
                        " have different units: expected the same");
    }
  }

  void takeUnits(const std::optional<std::size_t>& column) {
    if (!column) return;
    const std::string& unit = names_.unit(*column);
    if (names_.needsScale(*column) && !given_.units && !given_.mapped_later) {
      throw rows_.error("column " + shown(names_.text(*column)) + " is in " + shown(unit) +
                        ": expected px, deg or fractions of the screen; gaze.scale converts it "
                        "to gaze.units");
    }
    layout_.units = unitsNamed(unit);
    if (given_.units || before_.units || given_.mapped_later) return;
    if (const double degrees = degreesPer(unit); degrees > 0.0) {
      layout_.units = GazeUnits::deg;
      // The study's own scale, other than of signs, replaces that of the unit.
      if (glm::abs(given_.scale) == glm::dvec2(1.0)) layout_.scale = degrees;
    }
    if (!names_.unknownUnit(*column).empty()) layout_.unknown_unit = names_.text(*column);
  }

  /// Lines of sight and heads, as the study names them; of the rest, the pupils.
  void takeSpace() {
    if (!given_.x.empty() || !given_.y.empty() || !given_.eyes[0].x.empty() ||
        !given_.eyes[1].x.empty()) {
      throw rows_.error(
          "gaze.x and gaze.y are positions on a screen: expected them, or gaze in space");
    }
    layout_.format += ", gaze in space";
    layout_.space = spaceLayoutOf(rows_, names_, given_.space);
    layout_.space->scale = given_.scale;
    layout_.space->offset = given_.offset;
    for (std::size_t side : {0, 1}) {
      if (!given_.eyes[side].pupil.empty()) {
        layout_.eyes[side].pupil_mm = namedPupil(given_.eyes[side].pupil);
      }
    }
  }

  void findTime() {
    const std::optional<double> rate_Hz = given_.rate_Hz ? given_.rate_Hz : before_.rate_Hz;
    const bool counted = given_.time.empty() && rate_Hz && (given_.rate_Hz || !find(kTimes));
    if (counted) {
      layout_.rate_Hz = *rate_Hz;
      layout_.time_scale_s = 1.0;
    } else {
      layout_.time = given_.time.empty() ? find(kTimes) : named(given_.time);
      if (!layout_.time) throw names_.missing(ColumnNames::Meaning::time, kTimes);
      layout_.time_scale_s = given_.time_scale_s.value_or(names_.secondsPerUnit(*layout_.time));
      const auto fine = find("eyetrackertimestamp");
      const bool whole_ms = given_.time.empty() && names_.unit(*layout_.time) == "ms";
      if (whole_ms && fine && names_.unit(*fine) == "us") layout_.fine_time = fine;
    }
  }

  void takeGivenEyes() {
    for (std::size_t side : {0, 1}) {
      const TraceColumns::Eye& given = given_.eyes[side];
      EyeColumns& eye = layout_.eyes[side];
      const char* name = side == 0 ? "left" : "right";
      if (given.x.empty() != given.y.empty()) {
        throw rows_.error(std::string(name) + "_x and " + name + "_y: expected both or neither");
      }
      if (!given.x.empty()) {
        eye = EyeColumns{.x = named(given.x), .y = named(given.y)};
      } else if (given_.namesEye(1 - side) && given.pupil.empty()) {
        eye = {};  // the study names the other eye alone
      }
      if (!given.pupil.empty()) eye.pupil_mm = namedPupil(given.pupil);
    }
  }

  /// Whether a column counts blinks: it rises above 0 again and again, and never returns.
  bool isCounter(std::size_t column) const {
    double last = 0.0;
    bool falls = false, counts = false;
    rows_.survey(kSurveyedRows, [&] {
      if (column >= rows_.size()) return;
      const double value = parseNumber(rows_.text(column)).value_or(0.0);
      falls |= value < last;
      counts |= last > 0.0 && value > last;
      last = value;
    });
    return counts && !falls;
  }

  void findRest() {
    layout_.pupil_mm = !given_.pupil.empty() ? std::optional(namedPupil(given_.pupil))
                                             : findPupil("pupil pupildiameter pupilsize");
    if (!layout_.pupil_mm) layout_.pupil_own = findOwnPupil("pupil pupilsize");
    layout_.blink = !given_.blink.empty() ? std::optional(named(given_.blink))
                                          : find("blink isblink blinkid bkid");
    layout_.named_blink =
        given_.blink.empty() && layout_.blink && names_.key(*layout_.blink) == "blinkid";
    const bool plain_blink =
        given_.blink.empty() && layout_.blink && names_.key(*layout_.blink) == "blink";
    if (plain_blink && isCounter(*layout_.blink)) layout_.blink.reset();
    layout_.confidence =
        !given_.confidence.empty() ? std::optional(named(given_.confidence)) : find("confidence");
    const auto uncertainty = find("uncertainty");
    if (uncertainty && names_.unit(*uncertainty) == "deg") layout_.uncertainty_deg = uncertainty;
    layout_.missing = given_.missing;
  }

  /// Tables whose columns have the names of gaze, but hold something else.
  void refuseOtherTables() const {
    if (!given_.x.empty() || given_.mapped_later || layout_.space) return;
    if (find("ellipsecenterx") && findX() && !find("gazetimestamp")) {
      throw rows_.error(
          "pupils in the images of the eye cameras (pupil_positions.csv), not gaze: export "
          "gaze_positions.csv from Pupil Player");
    }
    refuseFixations();
    for (const auto& x : {layout_.x, layout_.eyes[0].x, layout_.eyes[1].x}) {
      if (x) refuseThirdAxis(*x);
    }
  }

  /// Of fixations, most rows have durations, which differ and fill most of the time. Those of
  /// samples are equal, or count from the start of a fixation and fill more, or stand in few rows.
  void refuseFixations() const {
    constexpr std::size_t kFewest = 8;
    constexpr double kMostOf = 0.5, kAllOf = 0.99, kAlike = 0.1;
    const auto duration = find("duration fixationduration fixduration fpogd");
    if (!duration || !layout_.time) return;
    std::size_t rows = 0;
    std::vector<double> times, durations;
    rows_.survey(kSurveyedRows, [&] {
      ++rows;
      if (std::max(*duration, *layout_.time) >= rows_.size()) return;
      const auto time = parseNumber(rows_.text(*layout_.time));
      const auto lasts = parseNumber(rows_.text(*duration));
      if (!time || !lasts) return;
      times.push_back(*time);
      durations.push_back(*lasts);
    });
    if (times.size() < kFewest || 2 * times.size() < rows) return;
    double filled = std::accumulate(durations.begin(), durations.end(), 0.0);
    const double time_s = names_.secondsPerUnit(*layout_.time);
    const double duration_s = names_.secondsPerUnit(*duration);
    if (time_s > 0.0 && duration_s > 0.0) filled *= duration_s / time_s;
    const double span = times.back() - times.front(), usual = quantile(durations, 0.5);
    const auto alike = static_cast<std::size_t>(std::ranges::count_if(
        durations, [&](double each) { return std::abs(each - usual) <= kAlike * usual; }));
    if (2 * alike > times.size() || filled < kMostOf * span || filled > kAllOf * span) return;
    throw rows_.error("the rows are fixations or events, by the column " +
                      shown(names_.text(*duration)) + ": export the samples of gaze");
  }

  /// Whether a column has a number other than 0. PsychoPy's z of gaze has none.
  bool isUsed(std::size_t column) const {
    bool any = false;
    rows_.survey(kSurveyedRows, [&] {
      any |= column < rows_.size() && !rows_.isAbsent(column) &&
             parseNumber(rows_.text(column)) != 0.0;
    });
    return any;
  }

  /// Beside x and y, a column of z makes the three a point or a direction in space.
  void refuseThirdAxis(std::size_t x) const {
    const std::string& key = names_.key(x);
    const std::string& unit = names_.unit(x);
    if (unit == "px" || unit == "deg" || unit == "norm") return;
    for (std::size_t at = key.find('x'); at != key.npos; at = key.find('x', at + 1)) {
      std::string y = key, z = key;
      y[at] = 'y';
      z[at] = 'z';
      const auto column = names_.find(z);
      if (!column || !names_.find(y) || names_.unit(*column) != unit || !isUsed(*column)) continue;
      throw rows_.error("columns " + shown(names_.text(x)) + " and " + shown(names_.text(*column)) +
                        " are a point or a direction in space, not positions on a screen: name x, "
                        "y and z with gaze.point or gaze.direction, or the positions with gaze.x "
                        "and gaze.y");
    }
  }

  /// Pupil Core's exports have columns of directions in space also where gaze was mapped in two
  /// dimensions. The columns are then empty, and the positions are the gaze.
  void leaveOutEmptyDirections() {
    constexpr std::size_t kEnoughRows = 64;
    bool any = false;
    rows_.survey(kEnoughRows, [&] {
      for (const EyeColumns& eye : layout_.eyes) {
        for (std::size_t i = 0; eye.direction && i < 3; ++i) {
          const std::size_t column = (*eye.direction)[i];
          any |= column < rows_.size() && !rows_.isAbsent(column);
        }
      }
    });
    for (EyeColumns& eye : layout_.eyes) {
      if (!any) eye.direction = eye.origin_mm = std::nullopt;
    }
  }

  /// Of a plain table: vendors' columns are known. Some write 1 for good gaze, others 0. A
  /// confidence may be that of one eye ("LeftEyeConfidence").
  void findUnusedValidity() {
    if (!layout_.isPlain() || layout_.validity || layout_.confidence || !given_.blink.empty()) {
      return;
    }
    for (std::size_t i = 0; i < names_.size(); ++i) {
      const bool unused = layout_.readings[i].meaning == "unused";
      const auto has = [&](const char* part) {
        return names_.key(i).find(part) != std::string::npos;
      };
      const auto hints = {"valid",    "confidence", "quality", "tracking",  "tracked",  "status",
                          "eyeopen",  "openness",   "lost",    "missing",   "detected", "artefact",
                          "artifact", "outlier",    "reliab",  "gazestate", "found",    "blink"};
      const bool named = isWordOf("bad good ok flag error loss conf", names_.key(i));
      if (!unused || !(named || std::ranges::any_of(hints, has))) continue;
      layout_.unused_validity = names_.text(i);
      return;
    }
  }

  /// A plain "x" may be the place of something else.
  void findUnusedGaze() {
    if (!given_.x.empty() || !layout_.x || !layout_.isPlain() || names_.key(*layout_.x) != "x")
      return;
    const auto x = names_.findPosition("eyex gx eyegazex eyeposx eyepositionx");
    const auto y = names_.findPosition("eyey gy eyegazey eyeposy eyepositiony");
    if (x && y && layout_.readings[*x].meaning == "unused") layout_.unused_gaze = names_.text(*x);
  }

  Rows& rows_;
  const TraceColumns& given_;
  const TablePreamble& before_;
  ColumnNames names_;
  TableLayout layout_{};
};

}  // namespace

bool TableLayout::uses(std::size_t column) const {
  return std::ranges::find(roles, column, &ColumnRole::column) != roles.end();
}

bool TableLayout::isFilled(const Rows& row, bool with_rating) const {
  return std::ranges::any_of(roles, [&](const ColumnRole& role) {
    const bool counts = role.kind == ColumnRole::Kind::gaze ||
                        (with_rating && role.kind == ColumnRole::Kind::rating);
    return counts && role.column < row.size() && !row.isAbsent(role.column);
  });
}

TableLayout recogniseTable(Rows& rows, const TraceColumns& columns) {
  rows.nameRowNumbers();
  return Recogniser(rows, columns).recognise();
}

}  // namespace foci
