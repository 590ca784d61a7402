#include "render/optics/eye_field.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <utility>

namespace foci {
namespace {

constexpr double kDiscFrom_deg = 10.0, kDiscTo_deg = 18.0, kDiscHalfHeight_deg = 5.0;
constexpr double kFovea_deg = 5.0;
constexpr double kPupilRadius_mm = 2.0;

template <typename Visit>
void forEachTerm(int degree, const glm::dvec2& field_deg, const Visit& visit) {
  const glm::dvec2 at = field_deg / kFieldUnit_deg;
  std::size_t i = 0;
  for (int n = 1; n <= degree; ++n) {
    for (int b = 0; b <= n; ++b) visit(i++, std::pow(at.x, n - b) * std::pow(at.y, b));
  }
}

template <std::size_t N>
double valueOf(const std::array<double, N>& terms, int degree, const glm::dvec2& field_deg) {
  double sum = 0.0;
  forEachTerm(degree, field_deg, [&](std::size_t i, double term) { sum += terms[i] * term; });
  return sum;
}

/// Solves A x = b by elimination. False where A is singular.
bool solve(std::vector<std::vector<double>> a, std::vector<double> b, std::span<double> x) {
  const std::size_t n = b.size();
  for (std::size_t i = 0; i < n; ++i) {
    std::size_t pivot = i;
    for (std::size_t k = i; k < n; ++k) {
      if (std::abs(a[k][i]) > std::abs(a[pivot][i])) pivot = k;
    }
    if (!(std::abs(a[pivot][i]) > 1e-7)) return false;
    std::swap(a[i], a[pivot]);
    std::swap(b[i], b[pivot]);
    for (std::size_t k = i + 1; k < n; ++k) {
      const double factor = a[k][i] / a[i][i];
      for (std::size_t j = i; j < n; ++j) a[k][j] -= factor * a[i][j];
      b[k] -= factor * b[i];
    }
  }
  for (std::size_t i = n; i-- > 0;) {
    double rest = b[i];
    for (std::size_t j = i + 1; j < n; ++j) rest -= a[i][j] * x[j];
    x[i] = rest / a[i][i];
  }
  return true;
}

double median(std::vector<double> values) {
  std::ranges::sort(values);
  return 0.5 * (values[(values.size() - 1) / 2] + values[values.size() / 2]);
}

struct Measured {
  glm::dvec2 field_deg;
  double value = 0.0;
};

/// The median over the eyes in each direction, of `value_of` relative to the fovea.
template <typename ValueOf>
std::vector<Measured> medianEye(std::span<const FieldSample> samples, const ValueOf& value_of) {
  std::map<int, std::vector<double>> at_fovea;
  for (const FieldSample& each : samples) {
    const glm::dvec2 off = glm::abs(each.field_deg);
    if (std::max(off.x, off.y) <= kFovea_deg) at_fovea[each.eye].push_back(value_of(each));
  }
  std::map<std::pair<double, double>, std::vector<double>> by_direction;
  for (const FieldSample& each : samples) {
    const glm::dvec2& at = each.field_deg;
    const bool on_disc =
        at.x >= kDiscFrom_deg && at.x <= kDiscTo_deg && std::abs(at.y) <= kDiscHalfHeight_deg;
    const auto fovea = at_fovea.find(each.eye);
    if (on_disc || fovea == at_fovea.end()) continue;
    by_direction[{at.x, at.y}].push_back(value_of(each) - median(fovea->second));
  }
  std::vector<Measured> all;
  all.reserve(by_direction.size());
  for (auto& [at, values] : by_direction) {
    all.push_back({{at.first, at.second}, median(values)});
  }
  return all;
}

bool fitTerms(const std::vector<Measured>& measured, int degree, std::span<double> terms) {
  const std::size_t n = terms.size();
  std::vector<std::vector<double>> a(n, std::vector<double>(n));
  std::vector<double> b(n), basis(n);
  for (const Measured& each : measured) {
    forEachTerm(degree, each.field_deg, [&](std::size_t i, double term) { basis[i] = term; });
    for (std::size_t i = 0; i < n; ++i) {
      b[i] += basis[i] * each.value;
      for (std::size_t j = 0; j < n; ++j) a[i][j] += basis[i] * basis[j];
    }
  }
  return solve(std::move(a), std::move(b), terms);
}

}  // namespace

bool fitField(std::span<const FieldSample> samples, FieldAberrations& field) {
  const double r2 = kPupilRadius_mm * kPupilRadius_mm;  // mm^2: um over it are dioptres
  const auto fit = [&](std::size_t j, double factor, int degree, auto& terms) {
    const auto value = [&](const FieldSample& each) { return factor * each.z_um[j - 3]; };
    return fitTerms(medianEye(samples, value), degree, terms);
  };
  return fit(4, 4.0 * std::sqrt(3.0) / r2, FieldAberrations::kPowerDegree, field.power_D) &&
         fit(5, 2.0 * std::sqrt(6.0) / r2, FieldAberrations::kJ0Degree, field.j0_D) &&
         fit(3, 2.0 * std::sqrt(6.0) / r2, FieldAberrations::kJ45Degree, field.j45_D) &&
         fit(7, 1.0, FieldAberrations::kComa7Degree, field.coma7_um) &&
         fit(8, 1.0, FieldAberrations::kComa8Degree, field.coma8_um);
}

LocalAberration FieldAberrations::at(const glm::dvec2& from_gaze_deg, bool left) const {
  // The temple is right of the right eye, and left of the left one. The image's y points down.
  glm::dvec2 field_deg(left ? -from_gaze_deg.x : from_gaze_deg.x, -from_gaze_deg.y);
  field_deg /=
      std::max({std::abs(field_deg.x) / kMaxX_deg, std::abs(field_deg.y) / kMaxY_deg, 1.0});
  // A left eye is the mirror image of a right one: what is odd in x changes its sign. Both of the
  // aberrometer's axes are opposite to the image's, and coma is odd.
  const double mirrored = left ? -1.0 : 1.0;
  return {
      .power_D = {valueOf(power_D, kPowerDegree, field_deg), valueOf(j0_D, kJ0Degree, field_deg),
                  mirrored * valueOf(j45_D, kJ45Degree, field_deg)},
      .coma_um = {-mirrored * valueOf(coma8_um, kComa8Degree, field_deg),
                  -valueOf(coma7_um, kComa7Degree, field_deg)}};
}

glm::dmat2 pupilShape(const glm::dvec2& from_gaze_deg, bool left) {
  constexpr double kAxis_deg = 5.3, kStretch = 1.121, kMost_deg = 75.0;
  const auto ratio = [&](double deg) {
    return std::cos(std::min(deg, kMost_deg) / kStretch * std::numbers::pi / 180.0);
  };
  // It is roundest from the side of the temple, which is right of the right eye.
  const glm::dvec2 from_axis = from_gaze_deg - glm::dvec2(left ? -kAxis_deg : kAxis_deg, 0.0);
  const double deg = glm::length(from_axis);
  if (deg == 0.0) return glm::dmat2(1.0);
  const double narrow = ratio(deg) / ratio(kAxis_deg);
  const glm::dvec2 along = from_axis / deg;
  return glm::dmat2(1.0) + (narrow - 1.0) * glm::outerProduct(along, along);
}

const FieldAberrations& typicalField() {
  static constexpr FieldAberrations kTypical{
      .power_D = {-0.6412, 0.4693, 1.2312, -0.2228, 3.0814, 0.2354, 0.2851, 0.1914, -0.6900,
                  -0.5134, -0.0955, -3.2973, 0.5602, -3.5067},
      .j0_D = {-0.3863, -0.1764, 1.7082, 0.0558, -2.0054},
      .j45_D = {-0.3091, 0.5281, 0.0356, -3.4551, -0.0646, -0.0025, -0.0138, 0.7184, -0.1461},
      .coma7_um = {-0.0175, -0.3011, -0.0434, 0.0246, 0.0806},
      .coma8_um = {0.2836, 0.0041},
  };
  return kTypical;
}

}  // namespace foci
