// The PLY of Kerbl et al. 2023, and its variants: see gaussian_formats.h.
#include <algorithm>
#include <array>
#include <cmath>
#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "base/input_error.h"
#include "base/text.h"
#include "render/scene/harmonics.h"
#include "render/scene/io/gaussian_formats.h"
#include "render/scene/io/ply_items.h"
#include "render/scene/io/scan_values.h"

namespace foci {
namespace {

using ply::Items;

constexpr int kMaxStoredDegree = 4;
constexpr std::size_t kEnough = 16;  // Gaussians, to judge their values by

/// Where the values of a Gaussian lie.
class Columns {
 public:
  Columns(const Items& items, const std::string& file) : items_(items), file_(file) {
    position_ = all({"x", "y", "z"});
    if (has("f_dc_0") || !has("red")) {
      color_ = all({"f_dc_0", "f_dc_1", "f_dc_2"});
    } else {
      color_ = all({"red", "green", "blue"});
      stores_light_ = true;
    }
    // 2D Gaussian Splatting (Huang et al. 2024): discs have no third scale.
    is_flat_ = has("scale_1") && !has("scale_2") && has("rot_3") && has("opacity");
    scale_ = is_flat_ ? all({"scale_0", "scale_1"}) : all({"scale_0", "scale_1", "scale_2"});
    rotation_ = all({"rot_0", "rot_1", "rot_2", "rot_3"});
    opacity_ = all({"opacity"})[0];
    filter_ = items.find("filter_3d");
    findHarmonics();
  }

  int degree() const { return std::min(stored_degree_, kMaxHarmonicsDegree); }
  int storedDegree() const { return stored_degree_; }
  bool isFlat() const { return is_flat_; }
  bool isFiltered() const { return filter_.has_value(); }
  bool isFine() const { return items_.property(position_[0]).type == ply::Scalar::float64; }
  glm::dvec3 position() const { return items_.vector(position_); }
  float rawOpacity() const { return items_.floatValue(opacity_); }
  float rawScale() const { return items_.floatValue(scale_[0]); }

  RawGaussian gaussian(const glm::dvec3& position) const {
    const auto at = [&](std::size_t column) { return items_.floatValue(column); };
    const auto narrowed = [](double x) {
      return static_cast<float>(std::isfinite(x) ? std::clamp(x, -1e30, 1e30) : x);
    };
    RawGaussian raw{
        .position = {narrowed(position.x), narrowed(position.y), narrowed(position.z)},
        .sigma = glm::exp(glm::vec3(at(scale_[0]), at(scale_[1]), 0.0f)),
        .rotation = {at(rotation_[1]), at(rotation_[2]), at(rotation_[3]), at(rotation_[0])},
        .opacity = sigmoid(at(opacity_)),
        .color = {at(color_[0]), at(color_[1]), at(color_[2])}};
    raw.sigma.z = is_flat_ ? 0.0f : std::exp(at(scale_[2]));
    if (!stores_light_) raw.color = 0.5f + kHarmonic0 * raw.color;
    if (filter_) {
      // Yu et al., Mip-Splatting, 2024, eq. 8: the 3D filter widens, and keeps the integral.
      const float width = at(*filter_);
      const glm::vec3 before2 = raw.sigma * raw.sigma, after2 = before2 + width * width;
      const glm::vec3 share = before2 / after2;
      raw.opacity *= std::sqrt(share.x * share.y * share.z);
      raw.sigma = glm::sqrt(after2);
    }
    return raw;
  }

  /// From all coefficients of a channel after another to all channels of a coefficient.
  void takeHarmonics(std::vector<float>& harmonics) const {
    for (std::size_t i = 0; i < harmonics.size(); ++i) {
      harmonics[i] = items_.floatValue(rest_[i % 3 * (rest_.size() / 3) + i / 3]);
    }
  }

  /// Colours as the file stores them become display values, 0 to 1: bytes, or values of 0 to 255
  /// or 65535 in another type.
  void finishColors(GaussianCloud& cloud) const {
    if (!stores_light_) return;
    float greatest = 0.0f;
    for (const glm::vec3& c : cloud.color) greatest = std::max({greatest, c.x, c.y, c.z});
    const bool bytes = items_.property(color_[0]).type == ply::Scalar::uint8;
    const bool unit = ply::isFloat(items_.property(color_[0]).type) && greatest <= 1.0f;
    const float white = bytes ? 255.0f : unit ? 1.0f : greatest <= 255.0f ? 255.0f : 65535.0f;
    for (glm::vec3& c : cloud.color) c /= white;
  }

 private:
  template <typename... Parts>
  InputError refusal(const Parts&... what) const {
    return {file_, "element vertex: ", what...};
  }
  bool has(std::string_view name) const { return items_.find(name).has_value(); }

  std::vector<std::size_t> all(std::initializer_list<const char*> names) const {
    std::vector<std::size_t> columns;
    for (const char* name : names) {
      const auto found = items_.find(name);
      if (!found) throw refusal("expected the property ", name, " of a Gaussian");
      columns.push_back(*found);
    }
    return columns;
  }

  void findHarmonics() {
    const auto isRest = [](const auto& each) { return each.name.starts_with("f_rest_"); };
    const auto count = static_cast<int>(std::ranges::count_if(items_.element().properties, isRest));
    stored_degree_ = degreeOf(count);
    if (stored_degree_ > kMaxStoredDegree) {
      throw refusal("has ", count,
                    " properties f_rest: expected 0, 9, 24, 45 or 72, for degree 0 to 4");
    }
    for (int i = 0; i < count; ++i) {
      rest_.push_back(all({("f_rest_" + std::to_string(i)).c_str()})[0]);
    }
  }

  const Items& items_;
  const std::string& file_;
  std::vector<std::size_t> position_, color_, scale_, rotation_, rest_;
  std::size_t opacity_ = 0;
  std::optional<std::size_t> filter_;
  bool stores_light_ = false, is_flat_ = false;
  int stored_degree_ = 0;
};

/// Exporters that forget the logit and the logarithm write values that trained Gaussians never
/// have all together.
class Plausibility {
 public:
  void add(float opacity, float scale) {
    ++count_;
    opacity_is_share_ = opacity_is_share_ && opacity >= 0.0f && opacity <= 1.0f;
    scale_is_length_ = scale_is_length_ && scale > 0.0f;
  }

  /// @return whether it has named the scales
  bool remark(std::vector<std::string>& remarks) const {
    if (count_ < kEnough) return false;
    if (scale_is_length_) {
      remarks.push_back(std::string("all scales are positive") +
                        (opacity_is_share_ ? ", and all opacities 0 to 1," : "") +
                        " as if they were stored without the logarithm" +
                        (opacity_is_share_ ? " and the logit" : "") +
                        ": the Gaussians are then far too large");
    } else if (opacity_is_share_) {
      remarks.emplace_back(
          "all opacities are 0 to 1, as if they were stored without the logit: the Gaussians then "
          "look fainter than they are, or denser");
    }
    return scale_is_length_;
  }

 private:
  std::size_t count_ = 0;
  bool opacity_is_share_ = true, scale_is_length_ = true;
};

/// Spacetime Gaussians (Li et al. 2024), and those of four dimensions.
void remarkTime(const Items& items, std::vector<std::string>& remarks) {
  for (const char* name : {"trbf_center", "motion_0", "scale_t", "t_scale"}) {
    if (!items.find(name)) continue;
    remarks.push_back(std::string("its Gaussians change in time (property ") + name +
                      "): all are shown at once, where the file states them");
    return;
  }
}

}  // namespace

bool isGaussianPly(const ply::Header& header) {
  const ply::Element* const vertex = ply::elementNamed(header, "vertex");
  if (vertex == nullptr) return false;
  // Points have none of these. Two of them are enough: the reader names a missing one.
  constexpr std::array<std::string_view, 3> kTelling = {"f_dc_0", "scale_0", "rot_0"};
  return std::ranges::count_if(kTelling, [&](auto name) { return vertex->has(name); }) >= 2;
}

bool preservesLight(const ply::Header& header) {
  bool preserves = false;
  for (const std::string& comment : header.comments) {
    std::string text;  // in lower case, without blanks
    for (const std::string_view word : wordsOf(comment)) text += lowered(word);
    if (text.starts_with("splatrendermode:")) preserves = text == "splatrendermode:mip";
    if (text == "antialiased1" || text == "antialiased0") preserves = text.ends_with('1');
  }
  return preserves;
}

GaussianFile readGaussianPly(const std::filesystem::path& path) {
  ply::Input input(path);
  ply::Header header = ply::readHeader(input);
  Items items = ply::verticesIn(input, header);
  if (items.find("f_anchor_feat_0")) {
    throw InputError(input.name(),
                     "has anchors of Scaffold-GS, of which a network makes the Gaussians: export "
                     "these as PLY");
  }
  const Columns columns(items, input.name());
  GaussianFile file{.format = columns.isFlat() ? "PLY of 2D Gaussians" : "PLY"};
  file.cloud.preserves_light = columns.isFiltered() || preservesLight(header);
  remarkTime(items, file.remarks);
  if (columns.storedDegree() > columns.degree()) file.remarks.emplace_back(kDegree4);
  GaussianCollector collector(file, items.element().count, columns.degree());
  std::vector<float> harmonics(file.cloud.harmonicsPerGaussian());
  std::optional<glm::dvec3> origin;  // of the file; the first position in doubles decides
  Plausibility plausibility;
  while (items.next()) {
    const glm::dvec3 p = columns.position();
    if (!origin && columns.isFine() && isNearEnough(p)) origin = originNear(p);
    columns.takeHarmonics(harmonics);
    plausibility.add(columns.rawOpacity(), columns.rawScale());
    collector.append(columns.gaussian(p - origin.value_or(glm::dvec3(0.0))), harmonics);
  }
  columns.finishColors(file.cloud);
  if (origin) remarkOrigin(*origin, file.remarks);
  const bool named = plausibility.remark(file.remarks);
  finishGaussians(file, input.name(), {.fine = columns.isFine(), .knows_scales = named});
  return file;
}

}  // namespace foci
