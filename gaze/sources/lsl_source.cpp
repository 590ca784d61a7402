#include "gaze/sources/lsl_source.h"

#include <dlfcn.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdint>
#include <type_traits>
#include <utility>
#include <vector>

#include "base/input_error.h"
#include "base/text.h"
#include "gaze/sources/read_rows.h"
#include "gaze/sources/xdf.h"

namespace foci {

using LslHandle = void*;  // of liblsl

/// The functions of liblsl that foci calls (lsl_c.h).
struct LslLibrary {
  std::int32_t (*resolve_all)(LslHandle* found, std::uint32_t most, double wait_s);
  LslHandle (*create_inlet)(LslHandle info, std::int32_t buffer_s, std::int32_t chunk,
                            std::int32_t recover);
  void (*destroy_inlet)(LslHandle inlet);
  LslHandle (*get_fullinfo)(LslHandle inlet, double timeout_s, std::int32_t* error);
  char* (*get_xml)(LslHandle info);
  void (*destroy_string)(char* text);
  void (*destroy_streaminfo)(LslHandle info);
  double (*pull_sample_d)(LslHandle inlet, double* values, std::int32_t count, double timeout_s,
                          std::int32_t* error);
};

namespace {

constexpr double kFind_s = 2.0, kPull_s = 0.1;
constexpr double kUsual_Hz = 500.0;  // of a stream with an irregular rate: between common trackers
constexpr std::int32_t kBuffered_s = 10;
constexpr std::size_t kMostAtOnce = 64;

/// @throws InputError
LslLibrary loadLsl(const std::string& file) {
  LslHandle const library = dlopen(file.c_str(), RTLD_NOW | RTLD_LOCAL);
  if (!library) {
    throw InputError("--source lsl", "liblsl is not installed: expected " + file +
                                         " (packages: github.com/sccn/liblsl/releases)");
  }
  LslLibrary lsl{};
  const auto find = [&](auto& function, const char* name) {
    function = reinterpret_cast<std::remove_reference_t<decltype(function)>>(dlsym(library, name));
    if (function) return;
    throw InputError("--source lsl", file + " has no " + name + ": expected liblsl 1.13 or later");
  };
  find(lsl.resolve_all, "lsl_resolve_all");
  find(lsl.create_inlet, "lsl_create_inlet");
  find(lsl.destroy_inlet, "lsl_destroy_inlet");
  find(lsl.get_fullinfo, "lsl_get_fullinfo");
  find(lsl.get_xml, "lsl_get_xml");
  find(lsl.destroy_string, "lsl_destroy_string");
  find(lsl.destroy_streaminfo, "lsl_destroy_streaminfo");
  find(lsl.pull_sample_d, "lsl_pull_sample_d");
  return lsl;
}

LslStream streamOf(const LslLibrary& lsl, LslHandle info) {
  char* const xml = lsl.get_xml(info);
  const std::string text = xml ? xml : "";
  lsl.destroy_string(xml);
  return lslStreamOf(text, "--source lsl");
}

}  // namespace

struct LslSource::Inlet {
  LslLibrary lsl;
  LslHandle handle = nullptr;
  LslStream stream{};

  Inlet(const std::string& wanted, const std::string& library) : lsl(loadLsl(library)) {
    LslHandle const info = find(wanted);
    handle = lsl.create_inlet(info, kBuffered_s, 0, 1);
    lsl.destroy_streaminfo(info);
    std::int32_t error = 0;
    LslHandle const full = handle ? lsl.get_fullinfo(handle, kFind_s, &error) : nullptr;
    if (!full) {
      if (handle) lsl.destroy_inlet(handle);
      throw InputError("--source lsl", "the stream does not answer; expected its description");
    }
    stream = streamOf(lsl, full);
    lsl.destroy_streaminfo(full);
  }
  ~Inlet() { lsl.destroy_inlet(handle); }
  Inlet(const Inlet&) = delete;
  Inlet& operator=(const Inlet&) = delete;

  /// The rows of the samples that have come, at most `kMostAtOnce`; waits for the first.
  std::vector<double> pull() const {
    std::vector<double> values(stream.channels), rows;
    double timeout_s = kPull_s;
    for (std::size_t i = 0; i < kMostAtOnce; ++i) {
      std::int32_t error = 0;
      const double time_s = lsl.pull_sample_d(
          handle, values.data(), static_cast<std::int32_t>(values.size()), timeout_s, &error);
      if (error != 0 && i == 0) std::this_thread::sleep_for(std::chrono::milliseconds(100));
      if (time_s == 0.0 || error != 0) break;
      rows.push_back(time_s);
      rows.insert(rows.end(), values.begin(), values.end());
      timeout_s = 0.0;
    }
    return rows;
  }

 private:
  LslHandle find(const std::string& wanted) const {
    std::array<LslHandle, 64> infos{};
    const std::int32_t count = lsl.resolve_all(infos.data(), infos.size(), kFind_s);
    LslHandle found = nullptr;
    std::string names;
    int matches = 0;
    for (std::size_t i = 0; i < static_cast<std::size_t>(std::max(count, 0)); ++i) {
      const LslStream each = streamOf(lsl, infos[i]);
      names += (names.empty() ? "" : ", ") + shown(each.name);
      const bool is = wanted.empty() ? each.isGaze() : each.name == wanted && each.hasNumbers();
      if (is && ++matches == 1) {
        found = infos[i];
      } else {
        lsl.destroy_streaminfo(infos[i]);
      }
    }
    if (matches == 1) return found;
    if (found) lsl.destroy_streaminfo(found);
    throw InputError(
        "--source lsl",
        std::string(matches == 0 ? "no stream of gaze" : "more than one stream of gaze") +
            " in 2 s; expected lsl:NAME, of the streams " +
            (names.empty() ? "of this network: there are none" : names));
  }
};

LslSource::LslSource(const std::string& stream, TraceColumns columns, const Screen& screen,
                     const std::string& library)
    : columns_(std::move(columns)),
      screen_(screen),
      inlet_(std::make_unique<Inlet>(stream, library)),
      pushed_(inlet_->stream.rate_Hz > 0.0 ? inlet_->stream.rate_Hz : kUsual_Hz) {
  // Columns that are no gaze are refused now.
  read({}, [](const GazeSample&) {});
  thread_ = std::jthread([this](const std::stop_token& stop) { run(stop); });
}

LslSource::~LslSource() = default;

void LslSource::read(std::vector<double> values, const TakeSample& take) const {
  NumberRows rows("--source lsl", inlet_->stream.columns, std::move(values));
  readRows(rows, columns_, screen_, take);
}

void LslSource::run(const std::stop_token& stop) {
  while (!stop.stop_requested()) {
    std::vector<double> values = inlet_->pull();
    std::vector<GazeSample> samples;
    try {
      read(std::move(values), [&](const GazeSample& sample) { samples.push_back(sample); });
      pushed_.push(samples);
    } catch (const InputError&) {
      // Times that do not increase: a sender that began anew. Its next samples may do.
    }
  }
}

std::string LslSource::status() const {
  return "LSL stream " + shown(inlet_->stream.name) + (pushed_.isHeard() ? "" : ", no gaze yet");
}

}  // namespace foci
