#include "render/methods/quality_level.h"

#include <charconv>

namespace foci {

std::optional<QualityLevel> qualityLevelNumbered(int n) {
  if (n < 1 || n > static_cast<int>(kQualityLevels)) return std::nullopt;
  return QualityLevel{static_cast<std::uint8_t>(n - 1)};
}

std::string textOf(QualityLevel level) {
  return std::string(kAutoMethod) + ':' + std::to_string(static_cast<int>(level) + 1);
}

std::optional<QualityLevel> qualityLevelFrom(std::string_view method) {
  if (!method.starts_with(kAutoMethod)) return std::nullopt;
  method.remove_prefix(kAutoMethod.size());
  if (!method.starts_with(':')) return std::nullopt;
  method.remove_prefix(1);
  int n = 0;
  const char* end = method.data() + method.size();
  const auto [rest, error] = std::from_chars(method.data(), end, n);
  if (error != std::errc() || rest != end) return std::nullopt;
  return qualityLevelNumbered(n);
}

}  // namespace foci
