#pragma once

#include <filesystem>
#include <string>

namespace hapbench {

/// Returns a folder of files that come with hapbench. Searches for share/hapbench/NAME in this order and returns the
/// first existing folder:
///   1. in each folder above the shared object that contains this library (libhapbench.so or a Python module);
///   2. in the parent of the running program's folder (an installed hapbench, or its build tree);
///   3. in the share folder that the build defines, for projects that use hapbench by find_package or
///   add_subdirectory.
/// Throws InputError if no folder exists.
std::filesystem::path installed_folder(const std::string& name);

}  // namespace hapbench
