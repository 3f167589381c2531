#pragma once

#include <filesystem>
#include <string>

namespace hapbench {

/// A folder of the files that come with hapbench: the first existing share/hapbench/NAME of
///   - the folders above the shared object that contains this library: libhapbench.so, a Python module;
///   - the parent of the running program's folder: hapbench, installed or in its build tree;
///   - the place that the build defines, for projects that use this one by find_package or add_subdirectory.
/// Throws InputError when there is none.
std::filesystem::path installed_folder(const std::string& name);

}  // namespace hapbench
