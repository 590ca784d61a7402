// Whether a recording's head and lines of sight fit the scene that it is replayed in.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "app/session/frame_record.h"

namespace foci {

class SurfaceAgreement {
 public:
  void add(const FrameRecord& record);

  /// One sentence for each doubt, with the keys to set: most fixations meet no surface, or the
  /// lines of sight usually meet elsewhere than on the surface.
  std::vector<std::string> doubts() const;

 private:
  std::size_t fixated_ = 0, without_surface_ = 0, compared_ = 0, disagree_ = 0, diverge_ = 0;
};

}  // namespace foci
