#include "calibration/calibration_file.h"

#include "base/input_error.h"
#include "calibration/toml_file.h"

namespace foci {
namespace {

std::optional<double> numberOf(const toml::value& value) {
  if (value.is_floating()) return value.as_floating();
  if (value.is_integer()) return static_cast<double>(value.as_integer());
  return std::nullopt;
}

}  // namespace

CalibrationFile::CalibrationFile(const std::filesystem::path& path) : file_(path.string()) {
  const toml::value document = readToml(path);
  const auto add = [&](const std::string& key, const toml::value& value) {
    if (const auto number = numberOf(value)) {
      values_[key] = *number;
    } else if (value.is_string()) {
      values_[key] = value.as_string().str;
    } else if (value.is_array()) {
      std::vector<double> numbers;
      for (const toml::value& element : value.as_array()) {
        const auto one = numberOf(element);
        if (!one) throw InputError(file_, key + ": expected numbers");
        numbers.push_back(*one);
      }
      values_[key] = std::move(numbers);
    } else {
      throw InputError(file_, key + ": expected a number, a word or numbers");
    }
  };
  for (const auto& [key, value] : document.as_table()) {
    if (!value.is_table()) {
      add(key, value);
      continue;
    }
    const std::string table = key + ".";
    for (const auto& [inner, inner_value] : value.as_table()) add(table + inner, inner_value);
  }
}

const CalibrationFile::Value& CalibrationFile::at(const std::string& key) {
  asked_[key] = true;
  const auto found = values_.find(key);
  if (found == values_.end()) throw InputError(file_, "no " + key);
  return found->second;
}

double CalibrationFile::number(const std::string& key, double low, double high) {
  const auto* value = std::get_if<double>(&at(key));
  const std::string range = "a number from " + exactText(low) + " to " + exactText(high);
  if (!value || !(*value >= low && *value <= high)) refuse(key, range);
  return *value;
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

glm::dvec2 CalibrationFile::pair(const std::string& key, double low, double high) {
  const std::vector<double> two = numbers(key, 2, low, high);
  return {two[0], two[1]};
}

glm::ivec2 CalibrationFile::size_px(const std::string& key) {
  return glm::ivec2(pair(key, 16, 16384));
}

std::string CalibrationFile::word(const std::string& key) {
  const auto* value = std::get_if<std::string>(&at(key));
  if (!value) refuse(key, "a word in quotes");
  return *value;
}

void CalibrationFile::refuseRest() const {
  for (const auto& [key, value] : values_) {
    if (!asked_.contains(key)) throw InputError(file_, "unknown key " + key.substr(0, 60));
  }
}

void CalibrationFile::refuse(const std::string& key, const std::string& allowed) const {
  std::string shown;
  if (const auto found = values_.find(key); found != values_.end()) {
    if (const auto* number = std::get_if<double>(&found->second)) shown = exactText(*number);
    if (const auto* word = std::get_if<std::string>(&found->second)) {
      shown = quotedText(word->substr(0, 40));
    }
    if (const auto* list = std::get_if<std::vector<double>>(&found->second)) {
      shown = std::to_string(list->size()) + " numbers";
    }
  }
  throw InputError(file_, key + " = " + shown + ": expected " + allowed);
}

std::string exactText(const glm::dvec2& pair) {
  return "[" + exactText(pair.x) + ", " + exactText(pair.y) + "]";
}

void writeWhole(const std::filesystem::path& path, const std::string& text) {
  std::filesystem::path aside = path;
  aside.replace_filename("." + path.filename().string() + ".part");
  bool written = false;
  {
    std::ofstream out(aside, std::ios::binary | std::ios::trunc);
    out << text;
    out.close();
    written = static_cast<bool>(out);
  }
  std::error_code error;
  if (written) std::filesystem::rename(aside, path, error);
  if (!written || error) {
    std::error_code ignored;
    std::filesystem::remove(aside, ignored);
    throw std::runtime_error(path.string() + ": cannot be written");
  }
}

}  // namespace foci
