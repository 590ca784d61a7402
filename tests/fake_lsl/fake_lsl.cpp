// A stand-in for liblsl with two streams: half a second of gaze at 100 Hz, and markers. The tests
// load it in place of the library, which Debian does not have.
#include <chrono>
#include <cstdint>
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

int pulled = 0;

}  // namespace

extern "C" {

std::int32_t lsl_resolve_all(void** found, std::uint32_t most, double /*wait_s*/) {
  if (most < 2) return 0;
  found[0] = const_cast<char*>(kGaze);
  found[1] = const_cast<char*>(kMarkers);
  return 2;
}

void* lsl_create_inlet(void* info, std::int32_t /*buffer_s*/, std::int32_t /*chunk*/,
                       std::int32_t /*recover*/) {
  pulled = 0;
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

/// Sample i looks at (0.25 + 0.01 i, 0.5); every tenth has no gaze.
double lsl_pull_sample_d(void* /*inlet*/, double* values, std::int32_t count, double timeout_s,
                         std::int32_t* error) {
  *error = 0;
  if (pulled == 50 || count != 3) {
    std::this_thread::sleep_for(std::chrono::duration<double>(timeout_s));
    return 0.0;
  }
  const int i = pulled++;
  const double absent = std::strtod("nan", nullptr);
  values[0] = i % 10 == 9 ? absent : 0.25 + 0.01 * i;
  values[1] = i % 10 == 9 ? absent : 0.5;
  values[2] = 3.5;
  return 1000.0 + 0.01 * i;
}
}
