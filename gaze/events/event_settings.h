// What an experimenter may set of the event detection.
#pragma once

namespace foci {

/// The thresholds are floors: where the recording's own noise is higher, they rise with it.
struct EventSettings {
  double saccade_deg_s = 30.0;   ///< no slower peak makes a saccade; slower ones are pursuit
  double window_s = 0.011;       ///< span of the samples whose slope is the velocity, at least
  double delay_s = 0.020;        ///< how far the online detector may look ahead
  double max_gap_s = 0.02;       ///< a loss up to this, without the motion of a lid, is bridged
  double max_blink_s = 0.5;      ///< a longer loss is lost gaze, a shorter one a blink
  double position_s = 0.1;       ///< a fixation lies at the mean of this last part of it
  double merge_gap_s = 0.075;    ///< fixations are one if less than this and (Tobii)
  double merge_deg = 0.5;        ///< less than this lies between them (Tobii)
  double min_fixation_s = 0.06;  ///< a shorter fixation is no event of its own (Tobii)
};

}  // namespace foci
