#pragma once

#include <string>
#include <vector>

namespace hapbench {

/// Overrides of task 2: its hand beyond the 2 N of the input limit all the time, for one rotation of the drill to and
/// fro.
inline const std::vector<std::string> kFirmHand = {
    R"(hand.force_N={"type":"sine","mean":3.5,"amplitude":1.4,"period_s":1.7})", "time.duration_s=6"};

}  // namespace hapbench
