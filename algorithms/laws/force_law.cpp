#include "algorithms/laws/force_law.hpp"

#include <algorithm>

namespace hapbench {

void set_weights(ContactBuffer& contacts, double c) noexcept {
  std::fill_n(contacts.weight.begin(), contacts.size(), c);
  std::fill(contacts.weight.begin() + static_cast<std::ptrdiff_t>(contacts.size()),
            contacts.weight.begin() + static_cast<std::ptrdiff_t>(contacts.padded_size()), 0.0);
}

LawForce weighted_force(const ContactBuffer& contacts, double K) noexcept {
  return {-K * weighted_depth(contacts), stiffness_tensor(contacts)};
}

}  // namespace hapbench
