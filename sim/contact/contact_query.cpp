#include "sim/contact/contact_query.hpp"

#include "sim/contact/neighbour_list_query.hpp"
#include "sim/contact/shell_query.hpp"

namespace hapbench {

std::unique_ptr<ContactQuery> make_contact_query(const PointShell& shell, const ToolShape& tool, Skips skips) {
  if (skips == Skips::off) return std::make_unique<ShellQuery>(shell, tool);
  return std::make_unique<NeighbourListQuery>(shell, tool);
}

}  // namespace hapbench
