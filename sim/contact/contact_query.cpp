#include "sim/contact/contact_query.hpp"

#include <cstdint>
#include <numeric>
#include <vector>

#include "sim/contact/neighbour_list_query.hpp"
#include "sim/core/simd.hpp"

namespace hapbench {
namespace {

/// Compares every point of the shell with the tool, eight points at a time. Serves as the reference for the search by
/// neighbour lists. O(shell size), about 0.3 ns for each point with 512-bit registers.
class ShellQuery final : public ContactQuery {
 public:
  ShellQuery(const PointShell& shell, const ToolShape& tool)
      : shell_(shell), tool_(tool), numbers_(shell.padded_size()) {
    std::iota(numbers_.begin(), numbers_.end(), 0u);
  }

  void contacts_at(const ToolPose& pose, ContactBuffer& contacts) noexcept override {
    contacts.clear();
    tool_.push_inside(pose,
                      {numbers_.data(), shell_.x(), shell_.y(), shell_.z(), shell_.nx(), shell_.ny(), shell_.nz()},
                      shell_.padded_size() / simd::lanes, contacts);
    ++work_.queries;
    work_.points_tested += shell_.size();
  }
  std::size_t capacity() const noexcept override { return shell_.size(); }

 private:
  const PointShell& shell_;
  const ToolShape& tool_;
  std::vector<std::uint32_t> numbers_;  ///< point numbers 0, 1, …
};

}  // namespace

std::unique_ptr<ContactQuery> make_contact_query(const PointShell& shell, const ToolShape& tool, Skips skips) {
  if (skips == Skips::off) return std::make_unique<ShellQuery>(shell, tool);
  return make_neighbour_list_query(shell, tool);
}

}  // namespace hapbench
