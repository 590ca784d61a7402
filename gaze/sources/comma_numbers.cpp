#include "gaze/sources/comma_numbers.h"

#include <algorithm>

#include "base/number.h"
#include "base/text.h"

namespace foci {
namespace {

/// "1,271": a separator of thousands, or a decimal comma.
bool mayBeThousands(std::string_view text) {
  if (text.starts_with('-')) text.remove_prefix(1);
  const std::size_t comma = text.find(',');
  return comma >= 1 && comma <= 3 && text.size() == comma + 4 && text[0] != '0';
}

}  // namespace

std::optional<double> CommaNumbers::parse(std::string_view text) {
  if (!decimal_allowed_ || text.find(',') == std::string_view::npos) return parseNumber(text);
  std::string pointed(text.substr(0, 64));
  std::replace(pointed.begin(), pointed.end(), ',', '.');
  const auto number = parseNumber(pointed);
  if (number && example_.empty()) example_ = text;
  if (number) decimal_ |= !mayBeThousands(text);
  return number;
}

void CommaNumbers::note(const Place& place, std::size_t column, std::string_view text,
                        std::size_t axis, double number) {
  constexpr double kPlain = 100.0;  // above codes for data loss; 0 and -1 stand beside "410,492"
  if (plain_[axis] && (example_.empty() || thousands_[axis])) return;
  if (text.find(',') == std::string_view::npos) {
    plain_[axis] |= number >= kPlain;
  } else if (!thousands_[axis] && mayBeThousands(text)) {
    thousands_[axis] = place.error(
        "column " + std::to_string(column + 1) + " = " + shown(text) +
        ": a decimal comma, or a separator of thousands? Other numbers of the column have no "
        "comma: write them without separators of thousands");
  }
}

const std::string& CommaNumbers::example() const {
  for (const std::size_t axis : {0, 1}) {
    if (thousands_[axis] && plain_[axis] && !decimal_) throw *thousands_[axis];
  }
  return example_;
}

}  // namespace foci
