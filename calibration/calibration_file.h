// The files of a calibration: small TOML documents of numbers and texts. Every key is checked.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <set>
#include <span>
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
  /// @throws InputError where the file cannot be read, is no TOML, or has a value that is neither a
  ///   number, a text nor an array of numbers
  explicit CalibrationFile(const std::filesystem::path& path);

  bool has(const std::string& key) const { return values_.contains(key); }
  /// @param instead  what else is allowed, for the message
  double number(const std::string& key, double low, double high, const std::string& instead = "");
  /// The number; absent for the word in its place.
  std::optional<double> numberOrWord(const std::string& key, const char* word, double low,
                                     double high);
  std::vector<double> numbers(const std::string& key, std::size_t count, double low, double high);
  /// As many numbers as `to` has.
  void read(const std::string& key, std::span<double> to, double low, double high);
  glm::dvec2 pair(const std::string& key, double low, double high);
  glm::ivec2 size_px(const std::string& key);
  /// Nine numbers, column by column, with orthonormal columns and determinant 1.
  glm::dmat3 rotation(const std::string& key);
  std::string text(const std::string& key);

  /// Refuses keys that no getter has asked for: a spelling mistake would otherwise go unseen.
  void refuseUnknownKeys() const;

  /// Throws InputError: the value of `key` is not `allowed`.
  [[noreturn]] void refuse(const std::string& key, const std::string& allowed) const;

 private:
  using Value = std::variant<double, std::string, std::vector<double>>;
  const Value& at(const std::string& key);

  std::string file_;
  std::map<std::string, Value> values_;
  std::set<std::string> asked_;
};

/// Values as TOML arrays, each number as `exactText` of base/text.h.
std::string exactText(const glm::dvec2& pair);          ///< "[x, y]"
std::string exactText(const glm::ivec2& pair);          ///< "[x, y]"
std::string exactText(const glm::dmat3& matrix);        ///< "[...]", column by column
std::string exactText(std::span<const double> values);  ///< "[a, b, ...]"

}  // namespace foci
