// This file is compiled into every program that links the installed static libraries. The libraries search the folder
// HAPBENCH_SHARE for scenarios (scenarios/input/installed_folder.hpp).
extern "C" {
[[gnu::weak]] extern const char hapbench_share_folder[];
const char hapbench_share_folder[] = HAPBENCH_SHARE;
}
