#include "gaze/live/lsl_source.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <type_traits>
#include <utility>

#include "base/input_error.h"
#include "base/quiet_stderr.h"
#include "base/shared_library.h"
#include "base/text.h"
#include "gaze/sources/lsl_stream.h"
#include "gaze/sources/recording_formats.h"

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
  double (*time_correction)(LslHandle inlet, double timeout_s, std::int32_t* error);
  double (*local_clock)();
};

namespace {

constexpr double kFind_s = 2.0, kPull_s = 0.1;
constexpr double kUsual_Hz = 500.0;  // of a stream with an irregular rate: between common trackers
constexpr std::int32_t kBuffered_s = 10;
constexpr std::size_t kMostAtOnce = 64;

/// Turns off the library's own log, which would stand on standard error. A user who has a
/// configuration of the library (lsl_api.cfg) states the log there.
void silence(LslHandle library) {
  const char* const home = std::getenv("HOME");
  std::error_code ignored;
  const auto exists = [&](const std::string& file) {
    return std::filesystem::exists(file, ignored);
  };
  if (std::getenv("LSLAPICFG") || exists("lsl_api.cfg") || exists("/etc/lsl_api/lsl_api.cfg") ||
      (home && exists(std::string(home) + "/lsl_api/lsl_api.cfg"))) {
    return;
  }
  const auto configure = reinterpret_cast<void (*)(const char*)>(
      symbolIn(library, "lsl_set_config_content"));  // from liblsl 1.17.7 on
  if (configure) configure("[log]\nlevel = -3\n");
}

/// @throws InputError
LslLibrary loadLsl(const std::string& file) {
  LslHandle const library = openLibrary(file);
  if (!library) {
    throw InputError("--source lsl", "liblsl is not installed: expected " + file +
                                         " (packages: github.com/sccn/liblsl/releases)");
  }
  LslLibrary lsl{};
  const auto find = [&](auto& function, const char* name) {
    function =
        reinterpret_cast<std::remove_reference_t<decltype(function)>>(symbolIn(library, name));
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
  find(lsl.time_correction, "lsl_time_correction");
  find(lsl.local_clock, "lsl_local_clock");
  silence(library);
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

  bool measured = false;                  // the sender's clock is
  std::atomic<double> correction_s{0.0};  // from the sender's clock to the library's; 0 if unknown

  Inlet(const std::string& wanted, const std::string& library) : lsl(loadLsl(library)) {
    const QuietStderr quiet;  // the library logs before it has read its configuration
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
    correction_s = lsl.time_correction(handle, kFind_s, &error);
    measured = error == 0;
    if (!measured) correction_s = 0.0;
  }
  ~Inlet() { lsl.destroy_inlet(handle); }
  Inlet(const Inlet&) = delete;
  Inlet& operator=(const Inlet&) = delete;

  /// The samples that have come, at most `kMostAtOnce`; waits for the first.
  Pulled pull();

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

/// Samples as rows of numbers. The time in each row is the number of the row.
struct LslSource::Pulled {
  std::vector<double> sent_s{};  ///< on the library's clock, if the sender's is measured
  std::vector<double> values{};
};

LslSource::Pulled LslSource::Inlet::pull() {
  Pulled pulled;
  std::vector<double> values(stream.channels);
  double timeout_s = kPull_s;
  for (std::size_t i = 0; i < kMostAtOnce; ++i) {
    std::int32_t error = 0;
    const double time_s = lsl.pull_sample_d(
        handle, values.data(), static_cast<std::int32_t>(values.size()), timeout_s, &error);
    if (error != 0 && i == 0) std::this_thread::sleep_for(std::chrono::milliseconds(100));
    if (time_s == 0.0 || error != 0) break;
    pulled.sent_s.push_back(time_s);
    pulled.values.push_back(static_cast<double>(i));
    pulled.values.insert(pulled.values.end(), values.begin(), values.end());
    timeout_s = 0.0;
  }
  if (measured) {  // anew every few seconds
    std::int32_t error = 0;
    const double latest_s = lsl.time_correction(handle, 0.0, &error);
    if (error == 0) correction_s = latest_s;
    for (double& sent_s : pulled.sent_s) sent_s += correction_s;
  }
  return pulled;
}

LslSource::LslSource(const std::string& stream, TraceColumns columns, const Screen& screen,
                     const std::string& library)
    : columns_(std::move(columns)),
      screen_(screen),
      inlet_(std::make_unique<Inlet>(stream, library)),
      pushed_(inlet_->stream.rate_Hz > 0.0 ? inlet_->stream.rate_Hz : kUsual_Hz, inlet_->measured) {
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
    try {
      if (const Pulled pulled = inlet_->pull(); !pulled.sent_s.empty()) take(pulled);
    } catch (const std::exception& error) {  // of memory: the next samples may do
      const std::lock_guard lock(mutex_);
      ++unread_;
      why_ = error.what();
    }
  }
}

/// Reads all rows, or, if some of them are wrong, the others.
void LslSource::take(const Pulled& pulled) {
  const std::size_t count = pulled.sent_s.size();
  std::vector<GazeSample> samples;
  std::size_t unread = 0;
  if (!readSome(pulled, 0, count, samples)) {
    for (std::size_t i = 0; i < count; ++i) unread += !readSome(pulled, i, i + 1, samples);
    if (unread == 0) {  // only all of them together show what is wrong
      samples.clear();
      unread = count;
    }
  }
  pushed_.push(samples, inlet_->lsl.local_clock());
  const std::lock_guard lock(mutex_);
  unread_ += unread;
}

/// @return whether the rows are right; otherwise it reads none
bool LslSource::readSome(const Pulled& pulled, std::size_t begin, std::size_t end,
                         std::vector<GazeSample>& samples) {
  const std::size_t before = samples.size(), columns = inlet_->stream.columns.size();
  const auto at = [&](std::size_t row) {
    return pulled.values.begin() + static_cast<std::ptrdiff_t>(row * columns);
  };
  try {
    read({at(begin), at(end)}, [&](const GazeSample& sample) {
      samples.push_back(sample);
      samples.back().time_s = pulled.sent_s[static_cast<std::size_t>(std::lround(sample.time_s))];
    });
    return true;
  } catch (const InputError& error) {
    samples.resize(before);
    const std::lock_guard lock(mutex_);
    why_ = error.what();
    return false;
  }
}

void LslSource::poll(double now_s, std::vector<GazeSample>& samples) {
  // Both clocks are the monotonic clock of this machine, but this thread may have waited since
  // `now_s`: the difference is the largest seen.
  const double ahead_s = std::max<double>(ahead_s_, now_s - inlet_->lsl.local_clock());
  ahead_s_ = ahead_s;
  const std::size_t before = samples.size();
  pushed_.poll(now_s - ahead_s, samples);
  for (std::size_t i = before; i < samples.size(); ++i) {
    double& time_s = samples[i].time_s;
    time_s = std::min(time_s + ahead_s, now_s);
    if (given_s_) time_s = std::max(time_s, *given_s_ + kBurst_s);
    given_s_ = time_s;
  }
}

std::string LslSource::status() const {
  return "LSL stream " + shown(inlet_->stream.name) + (pushed_.isHeard() ? "" : ", no gaze yet");
}

SenderFacts LslSource::sender() const {
  SenderFacts facts = pushed_.sender();
  facts.clock->offset_s += ahead_s_ + inlet_->correction_s.load();
  const std::lock_guard lock(mutex_);
  if (unread_ > facts.dropped) facts.why = why_;
  facts.dropped += unread_;
  return facts;
}

}  // namespace foci
