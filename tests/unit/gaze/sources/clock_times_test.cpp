#include "gaze/sources/row_times.h"

#include <gtest/gtest.h>

#include <initializer_list>
#include <string>
#include <vector>

#include "base/input_error.h"
#include "gaze/sources/trace_reader.h"
#include "tests/unit/gaze/scratch.h"

namespace foci {
namespace FOCI_FILE {

constexpr double kMicrosecond_s = 1e-6;

/// 0 for a text that is refused.
double secondsOf(std::string_view text) { return ClockTimes().seconds(text).value_or(0.0); }

TEST(ClockTimes, DatesCountFrom1970) {
  EXPECT_EQ(secondsOf("1970-01-02T00:00:01Z"), 86401.0);
  EXPECT_EQ(secondsOf("2000-03-01T00:00:00Z"), 951868800.0);  // date -d
  EXPECT_NEAR(secondsOf("2026-11-26T10:00:00.123456Z"), 1795687200.123456, kMicrosecond_s);
  for (const char* same :
       {"2026-11-26T12:00:00+02:00", "2026-11-26 12:00:00+0200", "2026-11-26t08:30:00,000-01:30",
        "2026-11-26 10:00:00", "2026-11-27T00:00:00.000000000+14"}) {
    EXPECT_EQ(secondsOf(same), 1795687200.0) << same;
  }
}

TEST(ClockTimes, AColonMayStandBeforeMilliseconds) {
  EXPECT_NEAR(secondsOf("01:00:00:125"), 3600.125, kMicrosecond_s);
  EXPECT_FALSE(ClockTimes().seconds("01:00:00:12")) << "frames of a film";
}

TEST(ClockTimes, DotsPutTheDayFirst) {
  for (const char* same : {"26.11.2026 10:00:00", "26.11.2026 10:00:00,000",
                           "26.11.2026T12:00:00+02:00", "2026/11/26 10:00:00"}) {
    EXPECT_EQ(secondsOf(same), 1795687200.0) << same;
  }
  EXPECT_NEAR(secondsOf("1.3.2000 0:00:00.25"), 951868800.25, kMicrosecond_s);
  ClockTimes clock;
  EXPECT_TRUE(clock.seconds("26.11.2026 10:00:00"));
  EXPECT_FALSE(clock.seconds("2026-11-26 10:00:01")) << "another form than the first";
}

TEST(ClockTimes, TimesOfDayPassMidnight) {
  ClockTimes clock;
  EXPECT_NEAR(*clock.seconds("23:59:59.999999"), 86399.999999, kMicrosecond_s);
  EXPECT_FALSE(clock.passesMidnight());
  EXPECT_NEAR(*clock.seconds("0:00:00.000001"), 86400.000001, kMicrosecond_s);
  EXPECT_TRUE(clock.passesMidnight());
  EXPECT_EQ(clock.seconds("23:00:00"), 86400.0 + 82800.0);
  EXPECT_EQ(clock.seconds("22:00:00"), 86400.0 + 79200.0) << "a smaller step back is an error";
  EXPECT_EQ(clock.seconds("01:00:00"), 2 * 86400.0 + 3600.0);
}

TEST(ClockTimes, OtherTextsAreNone) {
  for (const char* text : {"",
                           "1",
                           "10:00",
                           "10:00:00.",
                           "10:00:60",
                           "24:00:00",
                           "10:60:00",
                           "10:00:00Z",
                           "10:00:00 ",
                           "-1:00:00",
                           "2026-11-26",
                           "2026-02-29T10:00:00",
                           "2026-13-01T10:00:00",
                           "26-11-2026 10:00:00",
                           "03/04/2026 10:00:00",
                           "11.26.2026 10:00:00",
                           "26.11.26 10:00:00",
                           "2026-11-26T10:00:00+2",
                           "2026-11-26T10:00:00+15:00",
                           "2026-11-26T10:00:00.1234567890Z",
                           "2026-11-26T10:00:00ZZ",
                           "2026-11-26T"}) {
    EXPECT_FALSE(ClockTimes().seconds(text)) << text;
  }
  ClockTimes clock;
  EXPECT_TRUE(clock.seconds("10:00:00"));
  EXPECT_FALSE(clock.seconds("2026-11-26T10:00:01")) << "another form than the first";
}

/// The times of a table with these fields.
std::vector<double> timesOf(std::initializer_list<const char*> fields, TraceHeader& header,
                            const TraceColumns& columns = {}) {
  std::string text = "time_ms,x_px,y_px\n";
  for (const char* field : fields) text += std::string(field) + ",1,1\n";
  std::vector<double> times_s;
  header = streamTrace(ScratchFile(text).path(), columns, {},
                       [&](const GazeSample& sample) { times_s.push_back(sample.time_s); });
  return times_s;
}

TEST(ClockTimes, ATableStatesThem) {
  TraceHeader header;
  const auto times_s = timesOf({"23:59:59.990", "00:00:00.000", "00:00:00.010"}, header);
  ASSERT_EQ(times_s.size(), 3u);
  EXPECT_NEAR(times_s[0], 86399.990, kMicrosecond_s);
  EXPECT_NEAR(times_s[2], 86400.010, kMicrosecond_s);
  EXPECT_EQ(header.columns[0].meaning, "time of day");
  EXPECT_NE(header.assumed.at(0).find("midnight"), std::string::npos);

  const auto dated_s = timesOf({"2026-11-26T10:00:00.000Z", "2026-11-26T10:00:00.010Z"}, header);
  EXPECT_EQ(dated_s.at(0), 1795687200.0);
  EXPECT_EQ(header.columns[0].meaning, "time, a date and a time of day");
  EXPECT_TRUE(header.assumed.empty());

  EXPECT_THROW(timesOf({"0", "10:00:00.010"}, header), InputError);
  EXPECT_THROW(timesOf({"10:00:00.010", "7"}, header), InputError);
  EXPECT_THROW(timesOf({"10:00:00.000", "10:00:00.010"}, header, {.time_scale_s = 1e-3}),
               InputError);
}

TEST(ClockTimes, ADateThatMayBeginWithTheMonthIsRefused) {
  TraceHeader header;
  EXPECT_EQ(timesOf({"31.03.2024 12:00:00.000", "31.03.2024 12:00:00.010"}, header).size(), 2u);
  try {
    timesOf({"03/04/2024 12:00:00.000", "03/04/2024 12:00:00.010"}, header);
    FAIL() << "accepted";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("write the year first"), std::string::npos);
  }
}

}  // namespace FOCI_FILE
}  // namespace foci
