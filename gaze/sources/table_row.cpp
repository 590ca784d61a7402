#include "gaze/sources/table_row.h"

#include <algorithm>
#include <cmath>

#include "base/text.h"
#include "gaze/geometry/line_of_sight.h"

namespace foci {
namespace {

// Larger values are errors in the file, not gaze.
constexpr double kMaxEccentricity_deg = 89.0;  // a flat screen ends before 90
constexpr double kMaxPupil_mm = 15.0;
constexpr double kMaxConfidence = 1.01;     // 1, rounded
constexpr double kMinGazeConfidence = 0.6;  // as in Pupil Core's own software

std::optional<double> meanPupil(const std::array<EyeSample, 2>& eyes) {
  if (eyes[0].pupil_mm && eyes[1].pupil_mm) return 0.5 * (*eyes[0].pupil_mm + *eyes[1].pupil_mm);
  return eyes[0].pupil_mm ? eyes[0].pupil_mm : eyes[1].pupil_mm;
}

}  // namespace

std::optional<double> TableRow::coordinate(std::size_t column, int axis) const {
  const auto number = this->number(column);
  if (!number && isAbsent(column)) return std::nullopt;
  if (!number) fail(column, "expected a number");
  return coordinate(column, rows_.areNumbers() ? "" : field(column), axis, *number);
}

std::optional<double> TableRow::coordinate(std::size_t column, std::string_view text, int axis,
                                           double number) const {
  const double limit = units_ == GazeUnits::px || units_ == GazeUnits::relative ? kFarthestGaze_px
                       : units_ == GazeUnits::deg
                           ? kMaxEccentricity_deg
                           : kFarthestGaze_px / glm::max(screen_.size_px.x, screen_.size_px.y);
  commas_.note(rows_, column, text, static_cast<std::size_t>(axis), number);
  if (isMissing(number)) return std::nullopt;
  const double value = given_.scale[axis] * layout_.scale * number + given_.offset[axis];
  if (std::abs(value) > limit)
    fail(column, "too far from any screen; is it gaze.missing, or gaze.units wrong?");
  return value;
}

std::optional<glm::dvec2> TableRow::pointOf(double x, double y) const {
  if (layout_.zero_is_absent && x == 0.0 && y == 0.0) return std::nullopt;
  if (layout_.size_off_is_absent && screen_.size_px.x > 0 && x == -screen_.size_px.x &&
      y == -screen_.size_px.y) {
    return std::nullopt;
  }
  if (units_ == GazeUnits::deg) return pointAtEccentricity_px(screen_, {x, y});
  if (units_ == GazeUnits::px || units_ == GazeUnits::relative) return glm::dvec2(x, y);
  return glm::dvec2(x, layout_.y_up ? 1.0 - y : y) * glm::dvec2(screen_.size_px);
}

std::optional<double> TableRow::readPupil(std::size_t column) const {
  const auto pupil = number(column);
  if (!pupil && isAbsent(column)) return std::nullopt;
  if (pupil && isMissing(*pupil)) return std::nullopt;
  if (!pupil || *pupil * given_.pupil_scale_mm > kMaxPupil_mm) {
    fail(column, "expected a diameter up to 15 mm (gaze.pupil_scale_mm)");
  }
  if (!(*pupil > 0.0)) return std::nullopt;
  return *pupil * given_.pupil_scale_mm;
}

/// In the tracker's own unit: any number above 0.
std::optional<double> TableRow::readOwnPupil(std::size_t column) const {
  const auto pupil = number(column);
  if (!pupil && isAbsent(column)) return std::nullopt;
  if (!pupil) fail(column, "expected a number");
  return *pupil > 0.0 && !isMissing(*pupil) ? pupil : std::nullopt;
}

std::optional<glm::dvec2> TableRow::readPoint(std::size_t x, std::size_t y) const {
  const auto at_x = coordinate(x, 0);
  const auto at_y = at_x ? coordinate(y, 1) : std::nullopt;
  return at_y ? pointOf(*at_x, *at_y) : std::nullopt;
}

bool TableRow::isTrusted(GazeSample& sample) const {
  if (layout_.confidence && !isAbsent(*layout_.confidence)) {
    const std::string_view text = field(*layout_.confidence);
    const auto confidence = equalsIgnoringCase(text, "true")    ? std::optional(1.0)
                            : equalsIgnoringCase(text, "false") ? std::optional(0.0)
                                                                : number(*layout_.confidence);
    if (!confidence || *confidence > kMaxConfidence) {
      fail(*layout_.confidence,
           "expected a confidence of 0 to 1 (gaze.confidence); divide per cent by 100");
    }
    sample.confidence = std::clamp(*confidence, 0.0, 1.0);
    if (*sample.confidence < kMinGazeConfidence) return false;
  }
  return !layout_.validity || isValid(*layout_.validity);
}

void TableRow::read(GazeSample& sample) const {
  sample.point_px.reset();
  sample.confidence.reset();
  sample.uncertainty_deg.reset();
  sample.blink = false;
  if (layout_.has_eyes || layout_.space) sample.eyes = {};
  const bool trusted = isTrusted(sample);
  if (layout_.space) {
    readSpace(*this, *layout_.space, sample);
    if (!trusted) loseGaze(sample);
    if (sample.direction) sample.point_px = pointOnScreen_px(screen_, *sample.direction);
    for (std::size_t side : {0, 1}) {
      const auto& pupil = layout_.eyes[side].pupil_mm;
      if (trusted && pupil) sample.eyes[side].pupil_mm = readPupil(*pupil);
    }
  } else if (trusted) {
    if (layout_.has_eyes) {
      for (std::size_t side : {0, 1}) readEye(layout_.eyes[side], sample.eyes[side]);
    }
    if (layout_.hasDirections()) {
      sample.point_px = meanSight(sample.eyes);
    } else if (layout_.x) {
      sample.point_px = readPoint(*layout_.x, *layout_.y);
    }
  }
  sample.pupil_mm = layout_.pupil_mm ? readPupil(*layout_.pupil_mm) : meanPupil(sample.eyes);
  if (layout_.pupil_own) sample.pupil_own = readOwnPupil(*layout_.pupil_own);
  if (layout_.uncertainty_deg && !isAbsent(*layout_.uncertainty_deg)) {
    const auto uncertainty_deg = number(*layout_.uncertainty_deg);
    if (!uncertainty_deg || *uncertainty_deg < 0.0 || *uncertainty_deg > 45.0) {
      fail(*layout_.uncertainty_deg, "expected 0 to 45 degrees");
    }
    sample.uncertainty_deg = uncertainty_deg;
  }
  if (layout_.blink) {
    sample.blink = layout_.named_blink ? !isAbsent(*layout_.blink) : readFlag(*layout_.blink);
  }
}

/// x, y, z from three columns, in the frame of `EyeSample`.
std::optional<glm::dvec3> TableRow::triple(const ColumnsAt<3>& columns) const {
  if (!columns) return std::nullopt;
  glm::dvec3 result;
  for (const int axis : {0, 1, 2}) {
    const std::size_t column = (*columns)[static_cast<std::size_t>(axis)];
    if (isAbsent(column)) return std::nullopt;
    const auto value = number(column);
    if (!value) fail(column, "expected a number");
    result[axis] = axis == 0 || !layout_.camera_axes ? *value : -*value;
  }
  return result;
}

/// The parts of one field, "(x, y)" or "(x, y, z)"; none if one of them is absent.
/// @param expected  the form, for the error
template <std::size_t N>
std::optional<std::array<std::string_view, N>> TableRow::partsIn(std::size_t column,
                                                                 const char* expected) const {
  std::string_view text = field(column);
  if (isAbsent(column)) return std::nullopt;
  if (!text.starts_with('(') || !text.ends_with(')')) fail(column, expected);
  text = text.substr(1, text.size() - 2);
  std::array<std::string_view, N> parts{};
  bool absent = false;
  for (std::size_t i = 0; i < N; ++i) {
    const std::size_t comma = i + 1 < N ? text.find(',') : text.size();
    if (comma == text.npos) fail(column, expected);
    parts[i] = trimmed(text.substr(0, comma));
    absent |= foci::isAbsent(parts[i]);
    text.remove_prefix(std::min(comma + 1, text.size()));
  }
  return absent ? std::nullopt : std::optional(parts);
}

std::optional<glm::dvec3> TableRow::tripleIn(std::size_t column) const {
  constexpr const char* kExpected = "expected (x, y, z)";
  const auto parts = partsIn<3>(column, kExpected);
  if (!parts) return std::nullopt;
  glm::dvec3 result;
  for (int axis : {0, 1, 2}) {
    const auto value = parseNumber((*parts)[static_cast<std::size_t>(axis)]);
    if (!value) fail(column, kExpected);
    result[axis] = *value;
  }
  return result;
}

void TableRow::readEye(const EyeColumns& columns, EyeSample& eye) const {
  if (columns.validity && !isValid(*columns.validity)) return;
  if (columns.point) {
    eye.point_px = readTuple(*columns.point);
  } else if (columns.x && columns.y) {
    eye.point_px = readPoint(*columns.x, *columns.y);
  }
  if (columns.pupil_mm) eye.pupil_mm = readPupil(*columns.pupil_mm);
  if (columns.pupil_own) eye.pupil_own = readOwnPupil(*columns.pupil_own);
  if (const auto direction = triple(columns.direction)) {
    const double length = glm::length(*direction);
    // Pupil Core's directions have unit length, or length 0 in data loss.
    const double low = layout_.camera_axes ? 0.5 : 1e-6, high = layout_.camera_axes ? 2.0 : 1e6;
    if (length > low && length < high) eye.direction = *direction / length;
  }
  if (columns.origin_validity && !isValid(*columns.origin_validity)) return;
  const auto origin_mm =
      columns.origin_point_mm ? tripleIn(*columns.origin_point_mm) : triple(columns.origin_mm);
  const auto sight_mm =
      columns.sight_point_mm ? tripleIn(*columns.sight_point_mm) : triple(columns.sight_mm);
  if (!origin_mm) return;
  eye.origin_m = 1e-3 * *origin_mm;
  if (sight_mm && glm::distance(*origin_mm, *sight_mm) > 1.0)
    eye.direction = glm::normalize(*sight_mm - *origin_mm);
}

std::optional<glm::dvec2> TableRow::meanSight(const std::array<EyeSample, 2>& eyes) const {
  const auto direction = meanDirection(eyes);
  const auto point = direction ? pointOnScreen_px(screen_, *direction) : std::nullopt;
  return point && glm::length(*point) <= kFarthestGaze_px ? point : std::nullopt;
}

bool TableRow::isValid(std::size_t column) const {
  const auto value = number(column);
  if (!value) {
    const std::string word = lowered(field(column));
    if (isWordOf("valid true t yes", word)) return true;
    if (isAbsent(column) || word == "not valid" || isWordOf("invalid notvalid false f no", word)) {
      return false;
    }
    fail(column,
         "expected a number, or Valid or Invalid, or True or False; eyes that the study names "
         "(gaze.left_x, ...) are read without it");
  }
  switch (layout_.validity_code) {
    case ValidityCode::one:
      return *value == 1.0;
    case ValidityCode::zero:
      return *value == 0.0;
    case ValidityCode::not_zero:
      return *value != 0.0;
    case ValidityCode::gaze_bits:
      return *value >= 0.0 && *value < 65536.0 && (static_cast<int>(*value) & 3) == 3;
    case ValidityCode::below_two:
      return *value >= 0.0 && *value < 2.0;
  }
  return false;
}

std::optional<glm::dvec2> TableRow::readTuple(std::size_t column) const {
  const auto parts = partsIn<2>(column, "expected (x, y)");
  if (!parts) return std::nullopt;
  glm::dvec2 point(0.0);
  for (const int axis : {0, 1}) {
    const std::string_view part = (*parts)[static_cast<std::size_t>(axis)];
    const auto number = parseNumber(part);
    if (!number) fail(column, "expected a number");
    const auto value = coordinate(column, part, axis, *number);
    if (!value) return std::nullopt;
    point[axis] = *value;
  }
  return pointOf(point.x, point.y);
}

bool TableRow::readFlag(std::size_t column) const {
  const std::string_view text = field(column);
  if (isAbsent(column) || equalsIgnoringCase(text, "false")) return false;
  if (equalsIgnoringCase(text, "true")) return true;
  const auto value = number(column);
  if (!value) fail(column, "expected 0 or 1");
  return *value != 0.0;
}

void TableRow::failShort(std::size_t column) const { throw tooShort(column); }

InputError TableRow::tooShort(std::size_t column) const {
  return rows_.error(std::to_string(rows_.size()) + " fields: expected " +
                     std::to_string(column + 1) + " at least" + rows_.hint());
}

void TableRow::fail(std::size_t column, const char* expected) const {
  throw rows_.error("column " + std::to_string(column + 1) + " = " + shown(field(column)) + ": " +
                    expected + rows_.hint());
}

}  // namespace foci
