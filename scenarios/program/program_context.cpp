#include "scenarios/program/program_context.hpp"

#include <system_error>

namespace hapbench {

Layout ProgramContext::layout() const {
  return Layout::of_output(in_full);
}

std::filesystem::path file_of_this_process() {
  std::error_code ignored;
  return std::filesystem::read_symlink("/proc/self/exe", ignored);
}

}  // namespace hapbench
