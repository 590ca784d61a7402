// The files of a calibration: small TOML documents of numbers and words, read without mercy.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include <glm/glm.hpp>

#include "base/text.h"

namespace foci {

/// A document as "table.key" to value. Every getter throws InputError by file and key where the
/// value is missing, of the wrong type or out of range.
class CalibrationFile {
 public:
  /// @throws InputError where the file cannot be read, is larger than 1 MiB or is not such a
  /// document
  explicit CalibrationFile(const std::filesystem::path& path);

  bool has(const std::string& key) const { return values_.contains(key); }
  double number(const std::string& key, double low, double high);
  std::vector<double> numbers(const std::string& key, std::size_t count, double low, double high);
  glm::dvec2 pair(const std::string& key, double low, double high);
  glm::ivec2 size_px(const std::string& key);
  std::string word(const std::string& key);

  /// Refuses keys that nobody asked for: a spelling mistake would otherwise go unseen.
  void refuseRest() const;

  [[noreturn]] void refuse(const std::string& key, const std::string& allowed) const;

 private:
  using Value = std::variant<double, std::string, std::vector<double>>;
  const Value& at(const std::string& key);

  std::string file_;
  std::map<std::string, Value> values_;
  std::map<std::string, bool> asked_;
};

/// "[x, y]", each as `exactText` of a number.
std::string exactText(const glm::dvec2& pair);

/// Writes aside and renames, so that no half-written file ever bears the name.
/// @throws std::runtime_error
void writeWhole(const std::filesystem::path& path, const std::string& text);

}  // namespace foci
