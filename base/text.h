// Numbers as text, the same in every locale.
#pragma once

#include <string>

namespace foci {

/// `value` with `digits` after the point, never "-0".
std::string decimal(double value, int digits);

/// The same; "inf" for what is not finite.
std::string decimalOrInf(double value, int digits);

/// 12345.6 as 12,346.
std::string thousands(double value);

/// Milliseconds, as many digits as are worth reading.
std::string milliseconds(double ms);

}  // namespace foci
