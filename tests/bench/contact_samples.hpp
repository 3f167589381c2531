#pragma once

#include "sim/contact/contact_buffer.hpp"

namespace hapbench::bench {

/// n contacts with depths and gradients as the force laws see them before the reduction: those of T2's poses one after
/// the other, a tenth of a second apart, until there are enough. Padded.
ContactBuffer task_contacts(std::size_t n);

}  // namespace hapbench::bench
