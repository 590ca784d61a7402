// A stand-in for liblsl with two streams: gaze at 100 Hz, and markers. The tests load it in place
// of the library, which Debian does not have, and set the variables at the end.
#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <thread>

namespace {

constexpr const char* kGaze =
    "<?xml version=\"1.0\"?><info><name>Tracker</name><type>Gaze</type>"
    "<channel_count>3</channel_count><nominal_srate>100</nominal_srate>"
    "<channel_format>float32</channel_format><desc><channels>"
    "<channel><label>gaze_x</label><unit>normalized</unit></channel>"
    "<channel><label>gaze_y</label><unit>normalized</unit></channel>"
    "<channel><label>pupil</label><unit>mm</unit></channel></channels></desc></info>";
constexpr const char* kMarkers =
    "<?xml version=\"1.0\"?><info><name>Markers</name><type>Markers</type>"
    "<channel_count>1</channel_count><nominal_srate>0</nominal_srate>"
    "<channel_format>string</channel_format></info>";
constexpr std::int32_t kTimeout = -1;
constexpr double kPeriod_s = 0.01;

std::atomic<bool> quiet = false;
double begun_s = 0.0;
int pulled = 0;

void log(const char* text) {
  if (!quiet) std::fprintf(stderr, "fake_lsl INFO| %s\n", text);
}

}  // namespace

extern "C" {

// What the tests set before they make an inlet.
int fake_lsl_samples = 50;             ///< that the stream has
double fake_lsl_correction_s = 0.0;    ///< nan: no answer about the sender's clock
double fake_lsl_sender_ahead_s = 0.0;  ///< of the sender's times before the library's
int fake_lsl_wild = -1;                ///< the sample with a value that is no gaze; -2: all

double lsl_local_clock() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

void lsl_set_config_content(const char* content) {
  quiet = std::strstr(content, "level = -3") != nullptr;
}

std::int32_t lsl_resolve_all(void** found, std::uint32_t most, double /*wait_s*/) {
  std::fprintf(stderr, "fake_lsl INFO| Loaded default config\n");
  if (most < 2) return 0;
  found[0] = const_cast<char*>(kGaze);
  found[1] = const_cast<char*>(kMarkers);
  return 2;
}

void* lsl_create_inlet(void* info, std::int32_t /*buffer_s*/, std::int32_t /*chunk*/,
                       std::int32_t /*recover*/) {
  pulled = 0;
  begun_s = lsl_local_clock();
  return info;
}

void lsl_destroy_inlet(void* /*inlet*/) {}

void* lsl_get_fullinfo(void* inlet, double /*timeout_s*/, std::int32_t* error) {
  *error = 0;
  return inlet;
}

char* lsl_get_xml(void* info) { return strdup(static_cast<const char*>(info)); }

void lsl_destroy_string(char* text) { std::free(text); }

void lsl_destroy_streaminfo(void* /*info*/) {}

double lsl_time_correction(void* /*inlet*/, double /*timeout_s*/, std::int32_t* error) {
  *error = fake_lsl_correction_s == fake_lsl_correction_s ? 0 : kTimeout;
  return *error == 0 ? fake_lsl_correction_s : 0.0;
}

/// Sample i looks at (0.25 + 0.01 i, 0.5), and again from the left every 50; every tenth has no
/// gaze. It comes when it is measured.
double lsl_pull_sample_d(void* /*inlet*/, double* values, std::int32_t count, double timeout_s,
                         std::int32_t* error) {
  *error = 0;
  const int i = pulled;
  const double measured_s = begun_s + kPeriod_s * i;
  const double wait_s = std::min(measured_s - lsl_local_clock(), timeout_s);
  const bool ended = i == fake_lsl_samples || count != 3;
  if (ended || wait_s > 0.0) {
    std::this_thread::sleep_for(std::chrono::duration<double>(ended ? timeout_s : wait_s));
  }
  if (ended || lsl_local_clock() < measured_s) return 0.0;
  if (i % 10 == 0) log("pulled a sample");
  ++pulled;
  const double absent = std::strtod("nan", nullptr);
  const bool wild = i == fake_lsl_wild || fake_lsl_wild == -2;
  values[0] = wild ? 1e30 : i % 10 == 9 ? absent : 0.25 + 0.01 * (i % 50);
  values[1] = i % 10 == 9 ? absent : 0.5;
  values[2] = 3.5;
  return measured_s + fake_lsl_sender_ahead_s;
}
}
