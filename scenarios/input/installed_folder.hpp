#pragma once

#include <filesystem>
#include <string>

namespace hapbench {

/// A folder of the files that come with hapbench: the first share/hapbench/NAME there is
///   - beside the folder of the running program: hapbench, installed or in its build tree;
///   - above the shared object that this library is in: libhapbench.so, a Python module;
///   - at the place of which the build tells: where another project took this one in by find_package or
///     add_subdirectory.
/// Throws InputError when there is none.
std::filesystem::path installed_folder(const std::string& name);

}  // namespace hapbench
