#include <fmt/format.h>

#include <csignal>
#include <exception>
#include <string_view>

#include "results/io/io_error.hpp"
#include "scenarios/input/input_error.hpp"
#include "scenarios/program/command.hpp"
#include "scenarios/program/program.hpp"
#include "scenarios/run/stop_signal.hpp"

namespace hapbench {
namespace {

int fail(std::string_view what, int status) {
  print_error(what);
  return status;
}

}  // namespace
}  // namespace hapbench

int main(int argc, char** argv) {
  using namespace hapbench;
  // Exceeding the file size limit should be an ordinary write error and not terminate the process.
  std::signal(SIGXFSZ, SIG_IGN);
  try {
    const StopSignal signals;
    return run_program(argc, argv);
  } catch (const InputError& error) {
    print_errors(error);
    return kBadInput;
  } catch (const IoError& error) {
    return fail(error.what(), kInternalFault);
  } catch (const std::bad_alloc&) {
    return fail("out of memory", kInternalFault);
  } catch (const std::exception& error) {
    return fail(one_line(fmt::format("internal fault: {}", error.what())), kInternalFault);
  }
}
