// The PLY of Kerbl et al. 2023: see gaussian_formats.h.
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <string>
#include <string_view>

#include "base/input_error.h"
#include "render/scene/harmonics.h"
#include "render/scene/io/gaussian_formats.h"
#include "render/scene/io/ply_header.h"

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

bool hasProperty(const Element& element, std::string_view name) {
  return std::any_of(element.properties.begin(), element.properties.end(),
                     [&](const Property& each) { return each.name == name; });
}

/// Where the values of a Gaussian lie in its record.
class Columns {
 public:
  Columns(const Element& vertex, const std::string& file) : file_(file) {
    for (const Property& property : vertex.properties) {
      if (property.list) throw refusal("property " + property.name + " is a list");
      places_.push_back({property.name, record_bytes_, property.type});
      record_bytes_ += ply::sizeOf(property.type);
    }
    if (record_bytes_ > ply::Input::kBlock) throw refusal("has a record longer than 1 MiB");
    fill(position_, {"x", "y", "z"});
    fill(color_, {"f_dc_0", "f_dc_1", "f_dc_2"});
    fill(scale_, {"scale_0", "scale_1", "scale_2"});
    fill(rotation_, {"rot_0", "rot_1", "rot_2", "rot_3"});
    fill(opacity_, {"opacity"});
    findHarmonics();
  }

  std::size_t recordBytes() const { return record_bytes_; }
  int degree() const { return degree_; }

  RawGaussian gaussianOf(const unsigned char* record) const {
    const auto at = [&](std::size_t place) { return floatIn(record, place); };
    const auto vector = [&](const std::array<std::size_t, 3>& three) {
      return glm::vec3(at(three[0]), at(three[1]), at(three[2]));
    };
    return {.position = vector(position_),
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
    Scalar type;
  };

  InputError refusal(const std::string& what) const { return {file_, "element vertex: " + what}; }

  float floatIn(const unsigned char* record, std::size_t place) const {
    if (places_[place].type == Scalar::float64) {
      double value = 0.0;
      std::memcpy(&value, record + places_[place].at, sizeof(value));
      return static_cast<float>(std::clamp(value, -1e30, 1e30));
    }
    float value = 0.0f;
    std::memcpy(&value, record + places_[place].at, sizeof(value));
    return value;
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
  std::vector<Place> places_;
  std::size_t record_bytes_ = 0;
  std::array<std::size_t, 3> position_{}, color_{}, scale_{};
  std::array<std::size_t, 4> rotation_{};
  std::array<std::size_t, 1> opacity_{};
  std::vector<std::size_t> rest_;
  int degree_ = 0;
};

void skip(ply::Input& input, const Element& element) {
  std::uint64_t bytes = 0;
  for (const Property& property : element.properties) {
    if (property.list) {
      throw InputError(input.name(), "element " + element.name + " before vertex has a list");
    }
    bytes += ply::sizeOf(property.type);
  }
  input.skip(element.count * bytes);
}

}  // namespace

bool isGaussianPly(const std::filesystem::path& path) {
  const std::vector<unsigned char> magic = firstBytes(path, 4);
  if (magic.size() < 4 || std::memcmp(magic.data(), "ply", 3) != 0) return false;
  try {
    ply::Input input(path);
    const ply::Header header = ply::readHeader(input);
    const Element* vertex = vertexOf(header);
    return vertex != nullptr && hasProperty(*vertex, "f_dc_0") && hasProperty(*vertex, "scale_0") &&
           hasProperty(*vertex, "rot_0");
  } catch (const InputError&) {
    return false;  // the reader of points says what is wrong
  }
}

GaussianFile readGaussianPly(const std::filesystem::path& path) {
  static_assert(std::endian::native == std::endian::little);
  ply::Input input(path);
  const ply::Header header = ply::readHeader(input);
  if (header.format != ply::Format::little) {
    throw InputError(input.name(), "Gaussians: expected format binary_little_endian");
  }
  const Element* vertex = vertexOf(header);
  if (vertex == nullptr) throw InputError(input.name(), "expected an element vertex");
  for (const Element& element : header.elements) {
    if (&element == vertex) break;
    skip(input, element);
  }
  const Columns columns(*vertex, input.name());
  GaussianFile file{.format = "PLY"};
  GaussianCollector collector(file, vertex->count, columns.degree());
  std::vector<float> harmonics(file.cloud.harmonicsPerGaussian());
  for (std::uint64_t i = 0; i < vertex->count; ++i) {
    const unsigned char* record = input.take(columns.recordBytes());
    columns.harmonicsOfRecord(record, harmonics);
    collector.append(columns.gaussianOf(record), harmonics);
  }
  collector.finish(input.name());
  return file;
}

}  // namespace foci
