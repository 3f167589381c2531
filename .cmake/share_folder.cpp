// Compiled into every program that links the installed static libraries. The libraries search this folder for scenarios
// (scenarios/input/installed_folder.hpp).
extern "C" {
[[gnu::weak]] extern const char hapbench_share_folder[];
const char hapbench_share_folder[] = HAPBENCH_SHARE;
}
