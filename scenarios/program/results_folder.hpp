#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "scenarios/program/program_context.hpp"
#include "scenarios/run/folder_lock.hpp"

namespace hapbench {

/// Returns `out`, or results/out/`name` if `out` is empty.
std::filesystem::path results_directory(const std::string& out, const std::string& name);

/// Creates the directory. The context's destructor removes it again if it is still empty. Throws InputError,
/// with the option's name, if results cannot be written to it.
void require_writable_directory(ProgramContext& context, const std::filesystem::path& directory,
                                const std::string& option = "--out");

/// Creates the directory like require_writable_directory() and locks a set of its files (folder_lock.hpp). `writer`:
/// the command that writes the set. Prints a note if the file system has no locks. Throws InputError like
/// require_writable_directory(), and IoError if another command has locked the set.
FolderLock locked_results(ProgramContext& context, const std::filesystem::path& directory, const std::string& set,
                          const std::string& writer, const std::string& option = "--out");

/// Locks the directory of a run. Throws like locked_results(). Also throws IoError if a command that writes to all
/// subdirectories of a folder, such as `compare`, has locked a folder around `directory`.
FolderLock locked_run(ProgramContext& context, const std::filesystem::path& directory);

/// Throws IoError if another command has locked the files of this set in one of the folders. Precondition: the caller
/// has locked the outer folder, so that no other command can lock the inner folders afterwards.
void require_unlocked(const std::vector<std::filesystem::path>& folders, const std::string& set);

}  // namespace hapbench
