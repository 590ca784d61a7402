// What each column of a table holds, how it is used, and what makes that sure, for people.
#include "gaze/sources/table_layout.h"

#include <algorithm>
#include <string>
#include <utility>

#include "base/text.h"
#include "gaze/sources/column_names.h"

namespace foci {
namespace {

class Roles {
 public:
  Roles(const TableLayout& layout, const TraceColumns& given) : layout_(layout), given_(given) {
    addTable();
    for (std::size_t side : {0, 1}) addEye(layout.eyes[side], side == 0 ? "left eye" : "right eye");
    if (layout.space) addSpace(*layout.space);
  }

  std::vector<ColumnRole> take() { return std::move(roles_); }

 private:
  using Kind = ColumnRole::Kind;

  void add(const std::optional<std::size_t>& column, const std::string& meaning,
           Kind kind = Kind::other) {
    if (column) roles_.push_back({*column, meaning, kind});
  }

  template <std::size_t N>
  void add(const ColumnsAt<N>& columns, const std::string& meaning, const char* parts,
           Kind kind = Kind::other) {
    for (std::size_t i = 0; columns && i < N; ++i) {
      add((*columns)[i], meaning + ", " + std::string(1, parts[i]), kind);
    }
  }

  std::string unit() const {
    switch (given_.units.value_or(layout_.units.value_or(GazeUnits::px))) {
      case GazeUnits::deg:
        return "deg";
      case GazeUnits::normalised:
        return layout_.y_up ? "fractions of the screen from its lower left corner"
               : given_.offset == glm::dvec2(0.0)
                   ? "fractions of the screen from its upper left corner"
                   : "fractions of the screen";
      case GazeUnits::relative:
        return "uncalibrated";
      case GazeUnits::px:
        break;
    }
    return "px";
  }

  void addTable() {
    add(layout_.time, layout_.time_scale_s > 0.0
                          ? "time, a unit is " + exactText(layout_.time_scale_s) + " s"
                          : "time; its unit follows from the rate");
    add(layout_.fine_time, "time of the tracker, microseconds");
    add(layout_.x, "horizontal position of gaze, " + unit(), Kind::gaze);
    add(layout_.y, "vertical position of gaze, " + unit(), Kind::gaze);
    add(layout_.pupil_mm, "diameter of the pupil, mm", Kind::rating);
    add(layout_.pupil_own, "size of the pupil in the tracker's own unit");
    add(layout_.groups.eye, "which eye the row is of");
    for (const ValueColumn& only : layout_.groups.only) add(only.at, "chooses the rows");
    for (const std::size_t people : layout_.groups.people) add(people, "whose row it is");
    if (layout_.groups.device) add(layout_.groups.device->at, "which device the row is of");
    add(layout_.blink, "blink", Kind::rating);
    add(layout_.confidence, "confidence, 0 to 1", Kind::rating);
    add(layout_.validity, "whether gaze is valid", Kind::rating);
    add(layout_.uncertainty_deg, "uncertainty of gaze, deg");
    add(layout_.width_px, "width of the screen, px");
    add(layout_.height_px, "height of the screen, px");
    add(layout_.resolution, "size of the screen, px");
    add(layout_.rows.column, "which rows are samples");
  }

  void addEye(const EyeColumns& eye, const std::string& name) {
    add(eye.x, "horizontal position of the " + name + ", " + unit(), Kind::gaze);
    add(eye.y, "vertical position of the " + name + ", " + unit(), Kind::gaze);
    add(eye.point, "position of the " + name + ", " + unit(), Kind::gaze);
    add(eye.validity, "whether the " + name + " is valid", Kind::rating);
    add(eye.pupil_mm, "diameter of the pupil of the " + name + ", mm", Kind::rating);
    add(eye.pupil_own, "size of the pupil of the " + name + " in the tracker's own unit");
    add(eye.origin_point_mm, "origin of the " + name + ", mm");
    add(eye.sight_point_mm, "point in space that the " + name + " looks at, mm");
    add(eye.origin_validity, "whether the origin of the " + name + " is valid");
    add(eye.origin_mm, "origin of the " + name + ", mm", "xyz");
    add(eye.direction, "direction of the " + name, "xyz", Kind::gaze);
    add(eye.sight_mm, "point in space that the " + name + " looks at, mm", "xyz");
  }

  void addSpace(const SpaceLayout& space) {
    const std::string frame = space.in_world ? " in the world" : " in the head's frame";
    const std::string length = ", a unit is " + exactText(space.origin_scale_m) + " m";
    const std::string turn = space.tangents                 ? ", rad (by its tangent)"
                             : space.angle_scale_rad == 1.0 ? ", rad"
                                                            : ", deg";
    const auto sight = [&](const SightAt& at, const std::string& name) {
      add(at.direction, "direction of " + name + frame, "xyz", Kind::gaze);
      add(at.point, "point in space that " + name + " looks at" + frame + length, "xyz",
          Kind::gaze);
      add(at.origin, "origin of " + name + frame + length, "xyz");
      add(at.angles, "angle of " + name + frame + turn, "hv", Kind::gaze);
      add(at.quaternion, "rotation of " + name + frame, "xyzw", Kind::gaze);
      add(at.validity, "whether " + name + " is valid", Kind::rating);
    };
    sight(space.both, "both eyes");
    sight(space.eyes[0], "the left eye");
    sight(space.eyes[1], "the right eye");
    add(space.depth_m, "depth of the point that both eyes look at, m");
    add(space.head_position,
        "position of the head, a unit is " + exactText(space.head_scale_m) + " m", "xyz");
    add(space.head_quaternion, "orientation of the head", "xyzw",
        space.from_head ? Kind::gaze : Kind::other);
    add(space.head_angles, "turn of the head" + turn, "hvr");
    add(space.head_euler, "turn of the head about an axis of the recording" + turn, "xyz");
  }

  const TableLayout& layout_;
  const TraceColumns& given_;
  std::vector<ColumnRole> roles_{};
};

}  // namespace

std::vector<ColumnRole> rolesOf(const TableLayout& layout, const TraceColumns& given) {
  return Roles(layout, given).take();
}

std::vector<ColumnReading> readingsOf(const ColumnNames& names, const TableLayout& layout) {
  std::vector<ColumnReading> readings;
  for (std::size_t i = 0; i < names.size(); ++i) {
    ColumnReading reading{.columns = layout.headless ? "#" + std::to_string(i + 1)
                                                     : std::string(names.text(i))};
    const auto role = std::ranges::find(layout.roles, i, &ColumnRole::column);
    if (role != layout.roles.end()) {
      reading.meaning = role->meaning;
      reading.why = names.isNamed(i) ? "the study states it"
                    : !layout.lacks.empty()
                        ? "likely: a column of " + layout.format + ", which lacks " + layout.lacks
                    : !layout.isPlain()             ? "certain: a column of " + layout.format
                    : !names.unknownUnit(i).empty() ? "a guess: its unit is unknown"
                    : names.unit(i).empty()         ? "a guess: its name has no unit"
                                                    : "likely: its name states the unit";
    } else {
      reading.meaning = "unused";
    }
    readings.push_back(std::move(reading));
  }
  return readings;
}

}  // namespace foci
