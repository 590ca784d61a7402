// Names after the vendors' exports and their documentation: Tobii Pro Lab, Tobii Studio, Tobii Pro
// SDK, Pupil Core, Neon, SMI BeGaze, GazeBase, GazeBaseVR, JuDo1000, BIDS.
#include "gaze/sources/table_layout.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <span>

#include "base/nearest.h"

namespace foci {
namespace {

using Keys = std::span<const std::string_view>;

constexpr std::string_view kTimes[] = {
    "time",          "timestamp",       "t", "sampletime", "recordingtimestamp",
    "gazetimestamp", "devicetimestamp", "n"};
constexpr std::string_view kXs[] = {"x",    "gazex",    "xgaze",       "gazepointx",
                                    "eyex", "normposx", "xcoordinate", "porx"};
constexpr std::string_view kYs[] = {"y",    "gazey",    "ygaze",       "gazepointy",
                                    "eyey", "normposy", "ycoordinate", "pory"};

/// A column's name without its unit and without everything that is no letter or digit.
struct Name {
  std::string key, unit;
};

bool isUnit(std::string_view word) {
  for (const std::string_view unit :
       {"s", "ms", "us", "ns", "px", "deg", "dva", "norm", "mm", "m"}) {
    if (word == unit) return true;
  }
  return false;
}

Name nameOfColumn(std::string_view text) {
  std::string lower;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const bool micro =
        text.substr(i).starts_with("\xce\xbc") || text.substr(i).starts_with("\xc2\xb5");
    lower += micro ? 'u' : static_cast<char>(std::tolower(static_cast<unsigned char>(text[i])));
    i += micro;
  }
  Name name;
  const std::size_t bracket = lower.find_first_of("[(");
  if (bracket != std::string::npos && bracket > 0) {
    std::string inside = lower.substr(bracket + 1);
    inside.erase(
        std::find_if(inside.begin(), inside.end(), [](char c) { return c == ']' || c == ')'; }),
        inside.end());
    // "DACS px", "ADCSpx", "MCSnorm": the last part counts.
    for (const std::string_view unit : {"px", "norm", "deg", "mm", "ms", "us", "ns", "s"}) {
      if (name.unit.empty() && inside.ends_with(unit)) name.unit = unit;
    }
    lower.resize(bracket);
  } else if (const std::size_t at = lower.rfind('_');
             at != std::string::npos && at > 0 && isUnit(lower.substr(at + 1))) {
    name.unit = lower.substr(at + 1);
    lower.resize(at);
  }
  for (const char c : lower) {
    if (std::isalnum(static_cast<unsigned char>(c))) name.key += c;
  }
  return name;
}

double secondsPer(const std::string& unit) {
  return unit == "s" ? 1.0 : unit == "ms" ? 1e-3 : unit == "us" ? 1e-6 : unit == "ns" ? 1e-9 : 0.0;
}

class Recogniser {
 public:
  Recogniser(const LineReader& lines, std::string_view header, const TraceColumns& columns,
             const TablePreamble& before)
      : lines_(lines), given_(columns), before_(before) {
    const auto has = [&](char c) { return header.find(c) != std::string_view::npos; };
    layout_.delimiter = has('\t') ? '\t' : has(';') ? ';' : has(',') ? ',' : ' ';
    layout_.format = layout_.delimiter == '\t' ? "TSV" : layout_.delimiter == ' ' ? "text" : "CSV";
    splitRow(header, layout_.delimiter, fields_);
    constexpr std::size_t kMaxColumns = 4096;
    if (fields_.size() > kMaxColumns) throw lines.error("over 4096 columns");
    for (const std::string_view field : fields_) names_.push_back(nameOfColumn(field));
  }

  TableLayout recognise() {
    findTime();
    findEyes();
    takeGivenEyes();
    findPoint();
    findRest();
    recogniseFormat();
    for (std::size_t i = 0; i < fields_.size(); ++i) {
      if (isUsed(i)) layout_.columns = i + 1;
      for (const EyeColumns& eye : layout_.eyes) layout_.has_eyes |= isOf(eye, i);
    }
    return std::move(layout_);
  }

 private:
  std::optional<std::size_t> find(std::initializer_list<std::string_view> keys) const {
    return find(Keys(keys.begin(), keys.size()));
  }

  std::optional<std::size_t> find(Keys keys) const {
    for (const std::string_view key : keys) {
      for (std::size_t i = 0; i < names_.size(); ++i) {
        if (names_[i].key == key) return i;
      }
    }
    return std::nullopt;
  }

  /// Diameters, if the name says that they are in millimetres or the vendor always has them so.
  std::optional<std::size_t> findPupil(std::initializer_list<std::string_view> keys) const {
    const auto found = find(keys);
    const bool tobii = find({"recordingtimestamp", "devicetimestamp"}).has_value();
    return found && (tobii || names_[*found].unit == "mm") ? found : std::nullopt;
  }

  std::string nearestTo(std::string_view wanted) const {
    std::vector<std::string> known;
    for (const std::string_view field : fields_) known.emplace_back(field.substr(0, 64));
    return shown(nearest(wanted, known));
  }

  /// A column by its name, or by its number, "#1" the first.
  std::size_t named(const std::string& name) {
    const auto found = std::find(fields_.begin(), fields_.end(), name);
    if (found != fields_.end()) return static_cast<std::size_t>(found - fields_.begin());
    if (name.starts_with('#')) {
      const auto number = parseNumber(std::string_view(name).substr(1));
      if (number && *number >= 1.0 && *number <= static_cast<double>(fields_.size()) &&
          *number == std::floor(*number)) {
        const auto column = static_cast<std::size_t>(*number) - 1;
        layout_.headless |= parseNumber(fields_[column]).has_value();
        return column;
      }
      throw lines_.error("no column " + shown(name) + ": expected #1 to #" +
                         std::to_string(fields_.size()));
    }
    throw lines_.error("no column " + shown(name) + ": the nearest is " + nearestTo(name));
  }

  std::size_t require(const std::string& name, Keys usual) {
    if (!name.empty()) return named(name);
    if (const auto found = find(usual)) return *found;
    throw lines_.error("no column " + shown(usual[0]) + ": the nearest is " + nearestTo(usual[0]));
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
    // Tobii's user coordinates: x right, y up, z towards the user.
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
    // Pupil counts the right eye as 0.
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
    // Lines of sight give the point, too.
    if (given_.x.empty() && given_.y.empty() && layout_.hasDirections() && !find(Keys(kXs))) return;
    layout_.x = require(given_.x, kXs);
    layout_.y = require(given_.y, kYs);
    takeUnits(layout_.x);
    if (names_[*layout_.x].unit != names_[*layout_.y].unit && !given_.units) {
      throw lines_.error("columns " + shown(fields_[*layout_.x]) + " and " +
                         shown(fields_[*layout_.y]) + " have different units: expected the same");
    }
  }

  void takeUnits(const std::optional<std::size_t>& column) {
    if (column) layout_.units = unitsNamed(names_[*column].unit);
  }

  void findTime() {
    const std::optional<double> rate_Hz = given_.rate_Hz ? given_.rate_Hz : before_.rate_Hz;
    const bool counted = given_.time.empty() && rate_Hz && (given_.rate_Hz || !find(Keys(kTimes)));
    if (counted) {
      layout_.rate_Hz = *rate_Hz;
      layout_.time_scale_s = 1.0;
    } else {
      layout_.time = require(given_.time, kTimes);
      layout_.time_scale_s = given_.time_scale_s.value_or(secondsPer(names_[*layout_.time].unit));
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
        eye = {};  // the study speaks of the other eye alone
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
        given_.blink.empty() && layout_.blink && names_[*layout_.blink].key == "blinkid";
    layout_.confidence =
        !given_.confidence.empty() ? std::optional(named(given_.confidence)) : find({"confidence"});
    const auto uncertainty = find({"uncertainty"});
    if (uncertainty && names_[*uncertainty].unit == "deg") layout_.uncertainty_deg = uncertainty;
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
  std::vector<std::string_view> fields_{};
  std::vector<Name> names_{};
  TableLayout layout_{};
};

}  // namespace

TableLayout recogniseTable(const LineReader& lines, std::string_view header,
                           const TraceColumns& columns, const TablePreamble& before) {
  return Recogniser(lines, header, columns, before).recognise();
}

}  // namespace foci
