#include "calibration/calibration_file.h"

#include <algorithm>

#include "base/input_error.h"
#include "calibration/toml_file.h"

namespace foci {
namespace {

constexpr double kRotation = 1e-6;  // a rotation written with 7 digits is still one

std::optional<double> numberOf(const toml::value& value) {
  if (value.is_floating()) return value.as_floating();
  if (value.is_integer()) return static_cast<double>(value.as_integer());
  return std::nullopt;
}

}  // namespace

CalibrationFile::CalibrationFile(const std::filesystem::path& path) : file_(path.string()) {
  const TomlDocument document = readToml(path);
  const auto add = [&](const std::string& key, const toml::value& value) {
    if (const auto number = numberOf(value)) {
      values_[key] = *number;
    } else if (value.is_string()) {
      values_[key] = toml::get<std::string>(value);
    } else if (value.is_array()) {
      std::vector<double> numbers;
      for (const toml::value& element : value.as_array()) {
        const auto one = numberOf(element);
        if (!one) throw InputError(file_, key + ": expected numbers");
        numbers.push_back(*one);
      }
      values_[key] = std::move(numbers);
    } else {
      throw InputError(file_, key + ": expected a number, a text or numbers");
    }
  };
  for (const auto& [key, value] : document.table()) {
    if (!value.is_table()) {
      add(key, value);
      continue;
    }
    const std::string table = key + ".";
    for (const auto& [inner, inner_value] : value.as_table()) add(table + inner, inner_value);
  }
}

const CalibrationFile::Value& CalibrationFile::at(const std::string& key) {
  asked_.insert(key);
  const auto found = values_.find(key);
  if (found == values_.end()) throw InputError(file_, "no " + key);
  return found->second;
}

double CalibrationFile::number(const std::string& key, double low, double high,
                               const std::string& instead) {
  const auto* value = std::get_if<double>(&at(key));
  const std::string range = instead + "a number from " + exactText(low) + " to " + exactText(high);
  if (!value || !(*value >= low && *value <= high)) refuse(key, range);
  return *value;
}

std::optional<double> CalibrationFile::numberOrWord(const std::string& key, const char* word,
                                                    double low, double high) {
  const auto* const text = std::get_if<std::string>(&at(key));
  if (text && *text == word) return std::nullopt;
  return number(key, low, high, "\"" + std::string(word) + "\" or ");
}

std::vector<double> CalibrationFile::numbers(const std::string& key, std::size_t count, double low,
                                             double high) {
  const auto* values = std::get_if<std::vector<double>>(&at(key));
  const std::string range =
      std::to_string(count) + " numbers from " + exactText(low) + " to " + exactText(high);
  if (!values || values->size() != count) refuse(key, range);
  for (double value : *values) {
    if (!(value >= low && value <= high)) refuse(key, range);
  }
  return *values;
}

void CalibrationFile::read(const std::string& key, std::span<double> to, double low, double high) {
  std::ranges::copy(numbers(key, to.size(), low, high), to.begin());
}

glm::dvec2 CalibrationFile::pair(const std::string& key, double low, double high) {
  glm::dvec2 two;
  read(key, std::span(&two.x, 2), low, high);
  return two;
}

glm::ivec2 CalibrationFile::size_px(const std::string& key) {
  return glm::ivec2(pair(key, 16, 16384));
}

glm::dmat3 CalibrationFile::rotation(const std::string& key) {
  glm::dmat3 r;
  read(key, std::span(&r[0].x, 9), -1.0 - kRotation, 1.0 + kRotation);
  if (std::abs(glm::determinant(r) - 1.0) > kRotation ||
      std::abs(glm::dot(r[0], r[1])) > kRotation || std::abs(glm::length(r[2]) - 1.0) > kRotation) {
    refuse(key, "a rotation");
  }
  return r;
}

std::string CalibrationFile::text(const std::string& key) {
  const auto* value = std::get_if<std::string>(&at(key));
  if (!value) refuse(key, "a text in quotes");
  return *value;
}

void CalibrationFile::refuseUnknownKeys() const {
  for (const auto& [key, value] : values_) {
    if (!asked_.contains(key)) throw InputError(file_, "unknown key " + key.substr(0, 60));
  }
}

void CalibrationFile::refuse(const std::string& key, const std::string& allowed) const {
  std::string shown;
  if (const auto found = values_.find(key); found != values_.end()) {
    if (const auto* number = std::get_if<double>(&found->second)) shown = exactText(*number);
    if (const auto* text = std::get_if<std::string>(&found->second)) {
      shown = quotedText(text->substr(0, 40));
    }
    if (const auto* list = std::get_if<std::vector<double>>(&found->second)) {
      shown = std::to_string(list->size()) + " numbers";
    }
  }
  throw InputError(file_, key + " = " + shown + ": expected " + allowed);
}

std::string exactText(std::span<const double> values) {
  return "[" + listed(values, ", ", [](double value) { return exactText(value); }) + "]";
}

std::string exactText(const glm::dvec2& pair) { return exactText(std::span(&pair.x, 2)); }

std::string exactText(const glm::ivec2& pair) {
  return "[" + std::to_string(pair.x) + ", " + std::to_string(pair.y) + "]";
}

std::string exactText(const glm::dmat3& matrix) { return exactText(std::span(&matrix[0].x, 9)); }

}  // namespace foci
