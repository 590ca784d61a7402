#include "render/optics/lens_field.h"

#include <cmath>
#include <numbers>

namespace foci {
namespace {

/// Nodes are this far apart, as a tangent: aberrations between them are linear to 0.01 D.
constexpr float kStep = 0.03f;

/// Takes the unit vector `from` to `to` along a great circle, and other vectors with it.
glm::dvec3 carried(const glm::dvec3& v, const glm::dvec3& from, const glm::dvec3& to) {
  const glm::dvec3 sum = from + to;
  return v - glm::dot(v, sum) / (1.0 + glm::dot(from, to)) * sum + 2.0 * glm::dot(v, from) * to;
}

/// Image axes: x right, y down, z forward.
glm::dvec3 directionOf(const glm::dvec2& tangent) {
  return glm::normalize(glm::dvec3(tangent, 1.0));
}

struct LocalFrame {
  glm::dvec2 from_gaze_deg{0.0};
  glm::dmat2 tangent_per_rad{1.0};  ///< of the gaze's right and down, carried to the direction
};

LocalFrame frameAt(const glm::dvec2& tangent, const glm::dvec2& gaze_tangent) {
  const glm::dvec3 ahead(0.0, 0.0, 1.0);
  const glm::dvec3 gaze = directionOf(gaze_tangent), to = directionOf(tangent);
  const glm::dvec3 right = carried({1.0, 0.0, 0.0}, ahead, gaze);
  const glm::dvec3 down = carried({0.0, 1.0, 0.0}, ahead, gaze);
  LocalFrame frame;
  const glm::dvec2 aside(glm::dot(to, right), glm::dot(to, down));
  const double sine = glm::length(aside);
  if (sine > 0.0) {
    const double deg = std::atan2(sine, glm::dot(to, gaze)) * 180.0 / std::numbers::pi;
    frame.from_gaze_deg = deg / sine * aside;
  }
  const auto onImage = [&](const glm::dvec3& v) { return (glm::dvec2(v) - tangent * v.z) / to.z; };
  frame.tangent_per_rad =
      glm::dmat2(onImage(carried(right, gaze, to)), onImage(carried(down, gaze, to)));
  return frame;
}

LocalLens lensAt(const FieldAberrations& eye, bool left, const glm::dvec2& tangent,
                 const glm::dvec2& gaze_tangent, const glm::dvec2& radius_px_per_D,
                 double pupil_radius_m) {
  constexpr double kMeasured_m = 2e-3, kUm = 1e-6;
  const LocalFrame frame = frameAt(tangent, gaze_tangent);
  const LocalAberration added = eye.at(frame.from_gaze_deg, left);
  const glm::dmat2 s = pupilShape(frame.from_gaze_deg, left);
  const glm::dmat2& g = frame.tangent_per_rad;
  const glm::dmat2 p(radius_px_per_D * g[0], radius_px_per_D * g[1]);
  // The slope of sqrt(8) c (3 rho^2 - 2) x / r, over the pupil's radius, without its constant.
  const glm::dvec2 c =
      3.0 * std::sqrt(8.0) * kUm * pupil_radius_m * added.coma_um / std::pow(kMeasured_m, 3.0);
  // Over the unit disc, u'Au and u'Bu have the covariance tr(AB) / 12 - tr(A) tr(B) / 48.
  const glm::dmat2 ax = s * glm::dmat2(3.0 * c.x, c.y, c.y, c.x) * s;
  const glm::dmat2 ay = s * glm::dmat2(c.y, c.x, c.x, 3.0 * c.y) * s;
  const auto covariance = [](const glm::dmat2& a, const glm::dmat2& b) {
    const glm::dmat2 ab = a * b;
    return (ab[0][0] + ab[1][1]) / 12.0 - (a[0][0] + a[1][1]) * (b[0][0] + b[1][1]) / 48.0;
  };
  const double xy = covariance(ax, ay);
  const glm::dmat2 coma =
      p * glm::dmat2(covariance(ax, ax), xy, xy, covariance(ay, ay)) * glm::transpose(p);
  const glm::dvec3& power = added.power_D;
  const std::array<double, LocalLens::kValues> values{
      p[0][0],           p[1][0], p[0][1],           p[1][1], s[0][0], s[0][1],    s[1][1],
      power.x + power.y, power.z, power.x - power.y, c.x,     c.y,     coma[0][0], coma[0][1],
      coma[1][1],        0.0};
  LocalLens lens;
  std::ranges::transform(values, lens.values.begin(),
                         [](double each) { return static_cast<float>(each); });
  return lens;
}

/// Smallest and largest singular value.
std::pair<float, float> stretchOf(const glm::mat2& m) {
  const float plus = glm::length(glm::vec2(m[0][0] + m[1][1], m[0][1] - m[1][0]));
  const float minus = glm::length(glm::vec2(m[0][0] - m[1][1], m[0][1] + m[1][0]));
  return {0.5f * std::abs(plus - minus), 0.5f * (plus + minus)};
}

}  // namespace

glm::mat2 LocalLens::blur_px(const Defocus& defocus, float point_D) const {
  const float off_D = defocus.focus_D - point_D;
  const glm::vec2 j = defocus.astigmatism_D;
  const glm::mat2 focus_D(off_D + values[kFxx] + j.x, values[kFxy] + j.y, values[kFxy] + j.y,
                          off_D + values[kFyy] - j.x);
  return imagePerAngle() * focus_D * pupil();
}

std::vector<glm::vec2> comaShifts_px(const LocalLens& lens, const std::vector<glm::vec2>& centres) {
  std::vector<glm::vec2> shifts_px;
  const auto n = static_cast<float>(centres.size());
  glm::vec2 mean(0.0f);
  for (const glm::vec2& centre : centres) {
    shifts_px.push_back(lens.imagePerAngle() * comaAt(lens.coma_D(), lens.pupil() * centre));
    mean += shifts_px.back() / n;
  }
  float squares = 0.0f;
  for (glm::vec2& shift : shifts_px) {
    shift -= mean;
    squares += glm::dot(shift, shift) / n;
  }
  const float variance = lens[LocalLens::kCxx] + lens[LocalLens::kCyy];
  const float scale = squares > 0.0f ? std::sqrt(variance * (1.0f - 1.0f / n) / squares) : 0.0f;
  for (glm::vec2& shift : shifts_px) shift *= scale;
  return shifts_px;
}

LensField::LensField(const FieldAberrations& eye, bool left, const View& view,
                     const glm::vec2& gaze_px, const Defocus& defocus) {
  const glm::vec2 size_px(view.size_px);
  step_px_ = kStep * std::sqrt(view.focal_px.x * view.focal_px.y);
  first_px_ = -view.principal_px - step_px_;
  size_ = glm::ivec2(glm::ceil(size_px / step_px_)) + 3;
  const glm::dvec2 gaze_tangent =
      glm::dvec2(gaze_px - view.principal_px) / glm::dvec2(view.focal_px);
  const double pupil_radius_m = defocus.radius_px_per_D.x / view.focal_px.x;
  for (int y = 0; y < size_.y; ++y) {
    for (int x = 0; x < size_.x; ++x) {
      const glm::dvec2 offset_px = first_px_ + step_px_ * glm::vec2(x, y);
      nodes_.push_back(lensAt(eye, left, offset_px / glm::dvec2(view.focal_px), gaze_tangent,
                              defocus.radius_px_per_D, pupil_radius_m));
    }
  }
  const auto compare = [&](const LocalLens& a, const LocalLens& b) {
    const glm::mat2 in_focus =
        a.blur_px(defocus, defocus.focus_D) - b.blur_px(defocus, defocus.focus_D);
    change_per_px_ = std::max(change_per_px_, stretchOf(in_focus).second / step_px_);
    const glm::mat2 per_D = a.imagePerAngle() * a.pupil() - b.imagePerAngle() * b.pupil();
    change_per_px_D_ = std::max(change_per_px_D_, stretchOf(per_D).second / step_px_);
  };
  for (int y = 0; y < size_.y; ++y) {
    for (int x = 0; x < size_.x; ++x) {
      if (x > 0) compare(nodes_[indexOf(x, y)], nodes_[indexOf(x - 1, y)]);
      if (y > 0) compare(nodes_[indexOf(x, y)], nodes_[indexOf(x, y - 1)]);
    }
  }
}

LocalLens LensField::at(const glm::vec2& offset_px) const {
  const glm::vec2 last(size_ - 1);
  const glm::vec2 place = glm::clamp((offset_px - first_px_) / step_px_, glm::vec2(0.0f), last);
  const glm::ivec2 below = glm::min(glm::ivec2(place), size_ - 2);
  const glm::vec2 t = place - glm::vec2(below);
  const LocalLens* node = &nodes_[indexOf(below.x, below.y)];
  LocalLens lens;
  for (std::size_t i = 0; i < LocalLens::kValues; ++i) {
    const float top = node[0].values[i] + t.x * (node[1].values[i] - node[0].values[i]);
    const LocalLens* row = node + size_.x;
    const float bottom = row[0].values[i] + t.x * (row[1].values[i] - row[0].values[i]);
    lens.values[i] = top + t.y * (bottom - top);
  }
  return lens;
}

std::pair<float, float> LensField::blurBounds_px(const glm::vec2& offset_px, float around_px,
                                                 const Defocus& defocus, float point_D,
                                                 float range_D) const {
  const LocalLens lens = at(offset_px);
  const auto [least, most] = stretchOf(lens.blur_px(defocus, point_D));
  const float off_D = std::abs(defocus.focus_D - point_D) + range_D;
  const float change = (change_per_px_ + off_D * change_per_px_D_) * around_px +
                       range_D * stretchOf(lens.imagePerAngle() * lens.pupil()).second;
  // Coma adds at most a disc of its variance.
  const float coma =
      2.0f * std::sqrt(std::max(lens[LocalLens::kCxx] + lens[LocalLens::kCyy], 0.0f));
  return {std::max(least - change, 0.0f), most + change + coma};
}

float LensField::maxBlur_px(const Defocus& defocus, float point_D) const {
  float most_px = 0.0f;
  for (int y = 1; y < size_.y - 1; ++y) {
    for (int x = 1; x < size_.x - 1; ++x) {
      const glm::vec2 at_px = first_px_ + step_px_ * glm::vec2(x, y);
      most_px = std::max(most_px, blurBounds_px(at_px, 0.0f, defocus, point_D, 0.0f).second);
    }
  }
  return most_px;
}

glm::vec2 LensField::meridianAt(const glm::vec2& offset_px, const Defocus& defocus) const {
  const glm::mat2 b = at(offset_px).blur_px(defocus, defocus.focus_D);
  // In double: the same bytes from every C library.
  const double angle_rad = 0.5 * std::atan2(double{b[0][1] + b[1][0]}, double{b[0][0] - b[1][1]});
  return {std::cos(angle_rad), std::sin(angle_rad)};
}

OffFocus offFocus(const Defocus& defocus, const glm::vec2& offset_px, float around_px,
                  float point_D, float range_D) {
  const LensField* field = shownField(defocus);
  if (!field) {
    return {std::max(minDefocus_D(defocus, point_D) - range_D, 0.0f),
            maxDefocus_D(defocus, point_D) + range_D};
  }
  const auto [min_px, max_px] =
      field->blurBounds_px(offset_px, around_px, defocus, point_D, range_D);
  const float per_px = 1.0f / std::sqrt(defocus.radius_px_per_D.x * defocus.radius_px_per_D.y);
  return {min_px * per_px, max_px * per_px};
}

}  // namespace foci
