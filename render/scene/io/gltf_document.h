// A glTF 2.0 file (Khronos): its JSON, parsed once, and the numbers behind its accessors, each
// checked against its view and buffer before it is read. Private to the readers of scenes.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/mapped_file.h"
#include "base/memory_budget.h"
#include "base/text.h"

namespace foci {

inline constexpr std::size_t kNoEntry = SIZE_MAX;  ///< of a list

class GltfDocument {
 public:
  using Json = nlohmann::json;
  using Bytes = std::span<const unsigned char>;

  /// Text or binary, by the first bytes. A name in another code than UTF-8 has "?" for its bytes.
  /// @throws InputError if the file cannot be read, is cut off, is of another version, nests too
  /// deeply, is no JSON object, or requires an extension that foci does not read
  explicit GltfDocument(const std::filesystem::path& path);

  const std::filesystem::path& path() const { return path_; }
  const Json& json() const { return json_; }

  /// @throws InputError with the name of the file; names the compression if the file has one
  template <typename... Parts>
  [[noreturn]] void refuse(const Parts&... what) const {
    refuseFor(concat(what...));
  }

  /// An entry of a list of the file, which is an object; null if it is not there.
  const Json* entry(const char* list, std::size_t number) const;
  /// The same for the number that `object` has under a key.
  const Json* entry(const char* list, const Json& object, const char* key) const;

  /// The numbers of an accessor, record by record; normalised integers as 0 to 1 or -1 to 1.
  /// @param components  that each record must have
  /// @param as_unit     integers are normalised, whatever the accessor says
  /// @throws InputError if there is no such accessor, it has another type, or it reaches beyond its
  /// view or buffer
  std::vector<float> floats(std::size_t accessor, std::size_t components,
                            bool as_unit = false) const;
  /// The same for indices.
  std::vector<std::uint32_t> integers(std::size_t accessor) const;

  /// Records and components of an accessor. @throws InputError if there is none
  std::size_t countOf(std::size_t accessor) const;
  std::size_t componentsOf(std::size_t accessor) const;

  /// The bytes of a view, which are unpacked first if they are compressed. They stay as long as
  /// this. @throws InputError if it is not there or reaches beyond its buffer
  Bytes view(std::size_t number) const;

  /// The bytes of a URI that holds them ("data:..."); absent for another.
  static std::optional<std::vector<unsigned char>> dataOf(const std::string& uri);

 private:
  struct Records;

  [[noreturn]] void refuseFor(const std::string& what) const;

  void parse(Bytes file);
  [[noreturn]] void refuseVersion(const std::string& version) const;
  void checkExtensions();
  const Json& accessorAt(std::size_t number) const;
  Bytes buffer(std::size_t number) const;
  Bytes slice(const std::string& what, const Json& object) const;
  Records recordsOf(const std::string& what, const Json& object, std::size_t count,
                    std::size_t components, std::size_t type) const;
  template <class To>
  std::vector<To> values(std::size_t accessor, std::size_t components, bool as_unit) const;

  std::filesystem::path path_;
  MappedFile file_;
  Json json_;
  Bytes chunk_;              // of a binary file
  std::string compression_;  // that the file requires
  mutable MemoryBudget budget_;
  mutable std::map<std::size_t, Bytes> buffers_;  // read so far
  mutable std::map<std::size_t, std::vector<unsigned char>> unpacked_, decoded_;
  mutable std::vector<std::unique_ptr<MappedFile>> files_;
};

/// A whole number that is not negative; `otherwise` if the object has none.
/// @throws InputError for another value
std::size_t numberIn(const GltfDocument& gltf, const nlohmann::json& object, const char* key,
                     std::size_t otherwise);

/// A list inside an object; empty if there is none.
const nlohmann::json& arrayIn(const nlohmann::json& object, const char* key);

/// The numbers of a list; `otherwise` if there is none of this length.
template <std::size_t N>
std::array<double, N> listIn(const nlohmann::json& object, const char* key,
                             const std::array<double, N>& otherwise) {
  const nlohmann::json& list = arrayIn(object, key);
  std::array<double, N> numbers{};
  for (std::size_t i = 0; i < N; ++i) {
    if (list.size() != N || !list[i].is_number()) return otherwise;
    numbers[i] = list[i].get<double>();
  }
  return numbers;
}

/// An object inside an object; null if there is none.
const nlohmann::json* partOf(const nlohmann::json& object, const char* key);

/// A text or a number inside an object.
std::optional<std::string> textIn(const nlohmann::json& object, const char* key);
double fractionIn(const nlohmann::json& object, const char* key, double otherwise);

/// What an extension says of an object; null if it says nothing.
const nlohmann::json* extensionOf(const nlohmann::json& object, const char* name);

}  // namespace foci
