#pragma once

#include <cstddef>
#include <filesystem>

#include "results/io/io_error.hpp"

namespace hapbench {

/// Removes the temporaries of AtomicFile that killed processes left in `directory` and returns how many. Temporaries
/// that are being written stay, and so does every other file. Call when a run starts to write there. A directory that
/// does not exist has none; one that cannot be listed throws IoError. A file that cannot be removed is left.
std::size_t remove_stale_temporaries(const std::filesystem::path& directory);

}  // namespace hapbench
