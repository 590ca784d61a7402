// The items of a PLY element, and the colours that they store: what the readers of points, meshes
// and Gaussians share. Private to the readers of scenes.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <initializer_list>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "render/scene/io/ply_header.h"

namespace foci::ply {

/// The element of this name; null if there is none.
const Element* elementNamed(const Header& header, std::string_view name);

/// Names the lines that a file holds beside its points or faces.
std::optional<std::string> edgesRemark(const Header& header);

/// The textures that comments "TextureFile" name.
std::vector<std::string> textureNames(const Header& header);

/// Reads an element item by item, in any format and with properties of any type. In an ASCII file,
/// an item may take several lines; it begins and ends with a line.
class Items {
 public:
  /// @param input  behind the header and all elements before this one
  Items(Input& input, Header& header, const Element& element);

  /// Reads the next item. @return false behind the last one
  /// @throws InputError with the line (ASCII) or the byte, if the file ends early or has no number
  bool next();

  /// The number of a property. Absent if the element has none of this name.
  /// @throws InputError if it is there twice, or a list where `list` is false
  std::optional<std::size_t> find(std::string_view name, bool list = false) const;
  /// The numbers of several properties, none of which is a list. Empty unless all are there.
  std::vector<std::size_t> findAll(std::initializer_list<std::string_view> names) const;

  const Element& element() const { return element_; }
  const Property& property(std::size_t number) const { return element_.properties[number]; }

  /// Of the item read last. A value of an integer type is that integer.
  double value(std::size_t property) const;
  /// The same as a float: infinite and NaN stay so, other values are clamped to +-1e30.
  float floatValue(std::size_t property) const;
  glm::dvec3 vector(std::span<const std::size_t> properties) const;
  std::span<const double> list(std::size_t property) const;

  /// The item read last, for messages: "file:12" or "file: vertex 3".
  std::string where() const;

 private:
  struct Place {
    std::size_t at = 0;      // of a scalar: in the record, or in `row_`; of a list: in `lists_`
    std::size_t length = 0;  // of a list
  };

  void readLine();
  double nextNumber();
  void readText();
  void readLists();
  std::string itemName() const;

  Input& input_;
  Header& header_;
  const Element& element_;
  bool swap_, records_;  // records: scalars of a binary file, which lie behind each other
  std::uint64_t read_ = 0;
  std::size_t record_bytes_ = 0;
  std::vector<Place> places_;
  const unsigned char* record_ = nullptr;
  std::vector<double> row_, lists_;
  std::string_view line_;
  std::size_t at_ = 0;                        // in the line
  std::optional<std::uint64_t> broken_line_;  // where an item goes on in a further line
};

/// The vertices, behind all elements before them. @throws InputError if there are none
Items verticesIn(Input& input, Header& header);

/// Brings colours to linear light, 0 to 1, in place.
/// @param stored  as the file stores them: integers, or floats of 0 to 1 or 0 to 255
/// @param type    of the property
/// @param what    an item, for messages: "vertex"
/// @param remarks gets one if integers of a large range, or floats, are taken as 0 to 255
/// @throws InputError if a colour is beyond the range of its type
void linearise(std::span<glm::vec3> stored, Scalar type, const std::string& file,
               const std::string& what, std::vector<std::string>& remarks);

/// The properties of a colour: r g b, red green blue, or diffuse_red ...; empty if there is none.
std::vector<std::size_t> colorOf(const Items& items);

/// The property of an opacity: opacity, alpha, or a beside r g b.
std::optional<std::size_t> opacityOf(const Items& items);

/// Brings opacities of vertices to 0 to 1, in place: stored as colours are.
/// @throws InputError
void normaliseOpacity(std::span<float> stored, Scalar type, const std::string& file);

}  // namespace foci::ply
