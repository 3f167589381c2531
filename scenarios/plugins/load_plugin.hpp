#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace hapbench {

/// A shared library with a law (algorithms/plugin/hapbench_plugin.h) that has been loaded.
struct LoadedPlugin {
  std::filesystem::path file;  ///< absolute
  std::string algorithm;
};

/// Loads a plugin and adds its law to the algorithms, for as long as the program runs; one that is there already is
/// not loaded again. Floating-point modes that loading it would change are put back. Not while another thread reads
/// the table of algorithms. Throws InputError.
void load_plugin(const std::filesystem::path& file);

/// The same for every *.so in folders that are separated by colons, in the order of their names. `what` names the list
/// in messages. Throws InputError.
void load_plugins_in(const std::string& what, const std::string& folders);

/// `guard` is called before a plugin that is not there yet is loaded, and what it returns is kept until it is: where
/// several threads may want one, it refuses, by an InputError, while others read the table, and keeps them from it.
void guard_loading(std::function<std::shared_ptr<void>()> guard);

/// In the order in which they were loaded.
const std::vector<LoadedPlugin>& loaded_plugins();

}  // namespace hapbench
