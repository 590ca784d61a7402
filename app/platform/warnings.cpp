#include "app/platform/warnings.h"

#include <algorithm>
#include <atomic>
#include <cstdio>
#include <cstdlib>
#include <opencv2/core/utils/logger.hpp>

#include "base/text.h"

namespace foci {

namespace {

void print(const std::string& text) { std::fprintf(stderr, "foci: %s\n", visible(text).c_str()); }

std::atomic<void (*)(const std::string&)> listening = print;

}  // namespace

void say(const std::string& text) { listening.load()(text); }

void sayTo(void (*listener)(const std::string& text)) { listening = listener; }

void quietLibraries() {
  // OpenCV reads its own variable before `main`.
  if (!std::getenv("OPENCV_LOG_LEVEL")) {
    cv::utils::logging::setLogLevel(cv::utils::logging::LOG_LEVEL_SILENT);
  }
  setenv("OPENCV_FFMPEG_LOGLEVEL", "-8", 0);
}

bool Warnings::keep(const std::string& text) {
  if (std::ranges::find(all_, text) != all_.end()) return false;
  all_.push_back(text);
  return true;
}

void Warnings::add(const std::string& text) {
  if (!text.empty() && keep(text)) say(text);
}

void Warnings::include(const std::vector<std::string>& printed) {
  for (const std::string& text : printed) keep(text);
}

}  // namespace foci
