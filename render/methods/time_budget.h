// What each way to render takes, learnt from what it took: to hold a budget, one must know
// beforehand.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace foci {

class TimeBudget {
 public:
  /// @param likely  what the ways take, in any unit: a first guess of one from the others
  explicit TimeBudget(std::span<const float> likely);

  /// What a way is expected to take; infinite where nothing has been rendered yet.
  float expected_ms(std::size_t way) const;

  /// Whether it fits. One that took the place of the way rendered last must fit well, so that what
  /// is rendered does not flicker.
  bool fits(std::size_t way, float budget_ms) const;

  /// It was rendered. What is known of the others fades towards trying them again, sooner where the
  /// view has `moved`: other things are in sight.
  void took(std::size_t way, float ms, bool moved);

 private:
  struct Way {
    float likely = 1.0f;
    float ms = 0.0f;  // 0: never rendered
  };
  std::vector<Way> ways_;
  std::size_t last_ = 0;
};

}  // namespace foci
