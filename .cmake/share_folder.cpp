// Compiled into what links the installed static libraries, which look here for scenarios
// (scenarios/input/installed_folder.hpp).
extern "C" {
[[gnu::weak]] extern const char hapbench_share_folder[];
const char hapbench_share_folder[] = HAPBENCH_SHARE;
}
