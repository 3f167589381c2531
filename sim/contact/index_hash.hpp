#pragma once

#include "sim/contact/contact_buffer.hpp"
#include "sim/core/hash.hpp"

namespace hapbench {

/// Returns a hash of the set of contact indices: the sum of their hashes, which does not depend on the order. O(n).
inline std::uint64_t index_hash(const ContactBuffer& contacts) noexcept {
  std::uint64_t set = 0;
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    Hash64 hash;
    hash.word(contacts.index[i]);
    set += hash.value();
  }
  return set;
}

}  // namespace hapbench
