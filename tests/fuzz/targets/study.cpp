// Studies (TOML).
#include <optional>
#include <string>
#include <string_view>

#include "app/study/study.h"
#include "tests/fuzz/harness.h"

namespace foci {

// Replaces the list of methods, so that the renderers need not be built.
std::optional<std::string> expectedMethod(std::string_view spec) {
  return spec == "sweep" ? std::nullopt : std::optional<std::string>("a known method");
}

}  // namespace foci

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  const auto file = foci::fuzz::asFile("study.toml", bytes, size);
  foci::fuzz::readWithinLimits(size, [&] {
    const foci::Study study = foci::readStudy(file);
    foci::checkStudy(study);
    foci::resolvedKeys(study);
  });
  return 0;
}
