// Studies (TOML).
#include "app/study/study.h"
#include "tests/fuzz/harness.h"

FOCI_FUZZ(study) {
  const auto file = foci::fuzz::asFile("study.toml", bytes, size);
  foci::fuzz::readWithinLimits(size, [&] {
    const foci::Study study = foci::readStudy(file);
    foci::checkStudy(study);
    foci::resolvedKeys(study);
  });
  return 0;
}
