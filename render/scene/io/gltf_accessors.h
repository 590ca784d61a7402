// The numbers behind the accessors of a glTF. Private to the readers of meshes.
#pragma once

#include <cstddef>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace foci {

/// A whole number of a JSON object; `otherwise` if it has none.
std::size_t numberIn(const nlohmann::json& object, const char* key, std::size_t otherwise);

/// An entry of a list of the file; null if it is not there.
const nlohmann::json* listEntry(const nlohmann::json& json, const char* list, std::size_t number);

/// Reads accessors, and puts floats in their place or adds new ones.
class GltfAccessors {
 public:
  /// @param json  of the file; both must outlive this
  GltfAccessors(const std::filesystem::path& path, nlohmann::json& json)
      : path_(path), json_(json) {}

  /// Whether its numbers are integers.
  bool isInteger(std::size_t number) const;

  /// All numbers, record by record; sparse ones in their place. Absent if a buffer is not there, or
  /// the numbers are no floats, bytes or shorts.
  /// @throws InputError if it reaches beyond its buffer, or a sparse one beyond its count
  std::optional<std::vector<float>> valuesOf(std::size_t number);

  /// The bytes of a view. Absent if it, or its buffer, is not there.
  /// @throws InputError if it reaches beyond its buffer
  std::optional<std::vector<unsigned char>> bytesOfView(std::size_t number);

  /// Puts floats in place of an accessor's numbers.
  void replace(std::size_t number, std::span<const float> values);

  /// Adds an accessor of vectors of three.
  /// @return its number
  std::size_t add(std::span<const float> values);

  /// Puts the floats into a buffer of the file.
  /// @return whether there are any
  bool finish();

 private:
  using Bytes = std::span<const unsigned char>;

  [[noreturn]] void refuse(std::size_t number, const std::string& why) const;
  std::size_t addView(std::span<const float> values);
  std::optional<Bytes> viewOf(std::size_t accessor, std::size_t number, std::size_t offset,
                              std::size_t count, std::size_t record);
  std::optional<Bytes> bufferOf(std::size_t number);
  std::vector<unsigned char> binaryChunk() const;

  const std::filesystem::path& path_;
  nlohmann::json& json_;
  std::vector<float> floats_;  // of the accessors that are put in or added
  std::map<std::size_t, std::vector<unsigned char>> buffers_;
};

}  // namespace foci
