// The PLY of Kerbl et al. 2023: see gaussian_formats.h.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "base/input_error.h"
#include "render/scene/harmonics.h"
#include "render/scene/io/gaussian_formats.h"
#include "render/scene/io/ply_header.h"
#include "render/scene/io/scan_values.h"

namespace foci {
namespace {

using ply::Element;
using ply::Property;
using ply::Scalar;

const Element* vertexOf(const ply::Header& header) {
  const auto found = std::find_if(header.elements.begin(), header.elements.end(),
                                  [](const Element& each) { return each.name == "vertex"; });
  return found == header.elements.end() ? nullptr : &*found;
}

/// Points have none of these. Two of them are enough: the reader names a missing one.
constexpr std::array<std::string_view, 3> kTelling = {"f_dc_0", "scale_0", "rot_0"};

bool hasProperty(const Element& element, std::string_view name) {
  return std::any_of(element.properties.begin(), element.properties.end(),
                     [&](const Property& each) { return each.name == name; });
}

/// Where the values of a Gaussian lie in its record.
class Columns {
 public:
  /// The records of an ASCII file are parsed to doubles.
  Columns(const Element& vertex, ply::Format format, const std::string& file)
      : file_(file), swap_(format != ply::Format::ascii && ply::mustSwap(format)) {
    const bool parsed = format == ply::Format::ascii;
    for (const Property& property : vertex.properties) {
      if (property.list) throw refusal("property " + property.name + " is a list");
      const Scalar held = parsed ? Scalar::float64 : property.type;
      places_.push_back({property.name, record_bytes_, property.type, held});
      record_bytes_ += ply::sizeOf(held);
    }
    if (record_bytes_ > ply::Input::kBlock) throw refusal("has a record longer than 1 MiB");
    fill(position_, {"x", "y", "z"});
    fill(color_, {"f_dc_0", "f_dc_1", "f_dc_2"});
    fill(scale_, {"scale_0", "scale_1", "scale_2"});
    fill(rotation_, {"rot_0", "rot_1", "rot_2", "rot_3"});
    fill(opacity_, {"opacity"});
    findHarmonics();
  }

  std::size_t count() const { return places_.size(); }
  std::size_t recordBytes() const { return record_bytes_; }
  int degree() const { return degree_; }
  bool isFine() const { return places_[position_[0]].type == Scalar::float64; }  // positions

  glm::dvec3 positionOf(const unsigned char* record) const {
    return {valueIn(record, position_[0]), valueIn(record, position_[1]),
            valueIn(record, position_[2])};
  }

  RawGaussian gaussianOf(const unsigned char* record, const glm::dvec3& position) const {
    const auto at = [&](std::size_t place) { return floatIn(record, place); };
    const auto vector = [&](const std::array<std::size_t, 3>& three) {
      return glm::vec3(at(three[0]), at(three[1]), at(three[2]));
    };
    return {.position = {narrowed(position.x), narrowed(position.y), narrowed(position.z)},
            .sigma = glm::exp(vector(scale_)),
            .rotation = {at(rotation_[1]), at(rotation_[2]), at(rotation_[3]), at(rotation_[0])},
            .opacity = sigmoid(at(opacity_[0])),
            .color = 0.5f + kHarmonic0 * vector(color_)};
  }

  /// From all coefficients of a channel after another to all channels of a coefficient.
  void harmonicsOfRecord(const unsigned char* record, std::vector<float>& harmonics) const {
    const std::size_t count = rest_.size() / 3;
    for (std::size_t k = 0; k < count; ++k) {
      for (std::size_t channel = 0; channel < 3; ++channel) {
        harmonics[3 * k + channel] = floatIn(record, rest_[channel * count + k]);
      }
    }
  }

 private:
  struct Place {
    std::string name;
    std::size_t at;
    Scalar type, held;  // as the header states it, and in the record
  };

  InputError refusal(const std::string& what) const { return {file_, "element vertex: " + what}; }

  double valueIn(const unsigned char* record, std::size_t place) const {
    return ply::scalarAt(record + places_[place].at, places_[place].held, swap_);
  }

  float floatIn(const unsigned char* record, std::size_t place) const {
    if (places_[place].held != Scalar::float32 || swap_) return narrowed(valueIn(record, place));
    float value = 0.0f;  // nearly all files: twice as fast
    std::memcpy(&value, record + places_[place].at, sizeof(value));
    return value;
  }

  /// Infinity and NaN stay so. A float holds what is left of other values.
  static float narrowed(double value) {
    return static_cast<float>(std::isfinite(value) ? std::clamp(value, -1e30, 1e30) : value);
  }

  std::size_t find(const std::string& name) const {
    const auto found = std::find_if(places_.begin(), places_.end(),
                                    [&](const Place& each) { return each.name == name; });
    if (found == places_.end()) throw refusal("expected the property " + name + " of a Gaussian");
    if (!ply::isFloat(found->type))
      throw refusal("property " + name + ": expected float or double");
    return static_cast<std::size_t>(found - places_.begin());
  }

  template <std::size_t N>
  void fill(std::array<std::size_t, N>& places, const std::array<const char*, N>& names) {
    for (std::size_t i = 0; i < N; ++i) places[i] = find(names[i]);
  }

  void findHarmonics() {
    const auto count =
        static_cast<int>(std::count_if(places_.begin(), places_.end(), [](const Place& each) {
          return each.name.starts_with("f_rest_");
        }));
    while (degree_ <= kMaxHarmonicsDegree && 3 * harmonicsOf(degree_) != count) ++degree_;
    if (degree_ > kMaxHarmonicsDegree) {
      throw refusal("has " + std::to_string(count) +
                    " properties f_rest: expected 0, 9, 24 or 45, for degree 0 to 3");
    }
    for (int i = 0; i < count; ++i) rest_.push_back(find("f_rest_" + std::to_string(i)));
  }

  std::string file_;
  bool swap_;  // the bytes of values
  std::vector<Place> places_;
  std::size_t record_bytes_ = 0;
  std::array<std::size_t, 3> position_{}, color_{}, scale_{};
  std::array<std::size_t, 4> rotation_{};
  std::array<std::size_t, 1> opacity_{};
  std::vector<std::size_t> rest_;
  int degree_ = 0;
};

/// The records of the vertices, one after another.
class Records {
 public:
  Records(ply::Input& input, ply::Header& header, const Columns& columns)
      : input_(input), header_(header), columns_(columns), row_(columns.count()) {}

  /// Valid until the next call. @throws InputError with file and line (ASCII) or byte
  const unsigned char* next() {
    if (header_.format != ply::Format::ascii) return input_.take(columns_.recordBytes());
    ++header_.lines;
    const std::string_view line = input_.line();
    std::size_t at = 0;
    for (double& value : row_) value = ply::numberAt(line, at, input_.name(), header_.lines);
    if (line.find_first_not_of(" \t", at) != std::string_view::npos) {
      throw InputError(input_.name() + ":" + std::to_string(header_.lines),
                       "too many values for a vertex");
    }
    return reinterpret_cast<const unsigned char*>(row_.data());
  }

 private:
  ply::Input& input_;
  ply::Header& header_;
  const Columns& columns_;
  std::vector<double> row_;  // of an ASCII file
};

}  // namespace

bool isGaussianPly(const std::filesystem::path& path) {
  const std::vector<unsigned char> magic = firstBytes(path, 4);
  if (magic.size() < 4 || std::memcmp(magic.data(), "ply", 3) != 0) return false;
  try {
    ply::Input input(path);
    const ply::Header header = ply::readHeader(input);
    const Element* vertex = vertexOf(header);
    if (vertex == nullptr) return false;
    const auto told = std::ranges::count_if(
        kTelling, [&](std::string_view name) { return hasProperty(*vertex, name); });
    return told >= 2;
  } catch (const InputError&) {
    return false;  // the reader of points says what is wrong
  }
}

GaussianFile readGaussianPly(const std::filesystem::path& path) {
  ply::Input input(path);
  ply::Header header = ply::readHeader(input);
  const Element* vertex = vertexOf(header);
  if (vertex == nullptr) throw InputError(input.name(), "expected an element vertex");
  for (const Element& element : header.elements) {
    if (&element == vertex) break;
    ply::skipElement(input, element, header);
  }
  const Columns columns(*vertex, header.format, input.name());
  Records records(input, header, columns);
  GaussianFile file{.format = "PLY"};
  GaussianCollector collector(file, vertex->count, columns.degree());
  std::vector<float> harmonics(file.cloud.harmonicsPerGaussian());
  std::optional<glm::dvec3> origin;  // of the file; the first position in doubles decides
  for (std::uint64_t i = 0; i < vertex->count; ++i) {
    const unsigned char* record = records.next();
    const glm::dvec3 p = columns.positionOf(record);
    if (!origin && columns.isFine() && isNearEnough(p)) origin = originNear(p);
    columns.harmonicsOfRecord(record, harmonics);
    collector.append(columns.gaussianOf(record, p - origin.value_or(glm::dvec3(0.0))), harmonics);
  }
  if (origin) {
    if (auto remark = originRemark(*origin)) file.remarks.push_back(std::move(*remark));
  }
  collector.finish(input.name(), columns.isFine());
  return file;
}

}  // namespace foci
