#pragma once

#include <string>

namespace condyle::test {

inline const std::string pose_header = "time_s,tx_mm,ty_mm,tz_mm,qw,qx,qy,qz\n";

}  // namespace condyle::test
