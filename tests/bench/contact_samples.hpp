#pragma once

#include <string>
#include <vector>

#include "sim/contact/contact_buffer.hpp"

namespace hapbench::bench {

/// Numbers of contacts over which growth is measured.
inline constexpr std::size_t kGrowthContacts[] = {10, 100, 1000, 10'000, 100'000};

/// n contacts with depths and gradients as the force laws see them before the reduction: those of T2's poses one after
/// the other, a tenth of a second apart, until there are enough (about 2000 are). Padded.
ContactBuffer task_contacts(std::size_t n);
/// The same for any n: beyond kRepeated, those repeated until there are enough. So what a law makes of many contacts
/// follows from what it makes of a thousand.
inline constexpr std::size_t kRepeated = 1000;
ContactBuffer repeated_contacts(std::size_t n);

/// The contacts of every 64th pose of a task, as the force laws see them before the reduction. Padded.
std::vector<ContactBuffer> contacts_along(const std::string& task);

}  // namespace hapbench::bench
