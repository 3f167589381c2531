#include <fmt/format.h>

#include <csignal>
#include <cstdio>
#include <exception>

#include "results/io/io_error.hpp"
#include "results/provenance.hpp"
#include "scenarios/codec/input_error.hpp"
#include "scenarios/commands/command.hpp"

namespace hapbench {
namespace {

int fail(const char* kind, const char* what, int status) {
  fmt::print(stderr, "hapbench: {}: {}\n", kind, what);
  return status;
}

int run_program(int argc, char** argv) {
  CLI::App app("hapbench: an offline bench for haptic rendering", "hapbench");
  const Provenance program = provenance();
  app.set_version_flag("--version", fmt::format("hapbench {} ({})", program.version, program.commit));
  app.require_subcommand(1);
  app.footer(
      "Exit status: 0 success, 1 internal fault, 2 bad input or usage, 3 a run did not end as its scenario expects.");
  Action chosen;
  add_run(app, chosen);
  add_compare(app, chosen);
  add_stability(app, chosen);
  add_sweep(app, chosen);
  add_merge(app, chosen);
  add_precision(app, chosen);
  add_reproduce(app, chosen);
  add_shell(app, chosen);
  add_list(app, chosen);
  add_describe(app, chosen);
  add_validate(app, chosen);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    const int status = app.exit(error);
    return status == 0 ? kSuccess : kBadInput;
  }
  return chosen();
}

}  // namespace
}  // namespace hapbench

int main(int argc, char** argv) {
  using namespace hapbench;
  // A file that becomes larger than the user's limit is an error of writing like others, not the end of the process.
  std::signal(SIGXFSZ, SIG_IGN);
  try {
    return run_program(argc, argv);
  } catch (const InputError& error) {
    return fail("error", error.what(), kBadInput);
  } catch (const IoError& error) {
    return fail("error", error.what(), kInternalFault);
  } catch (const std::bad_alloc&) {
    return fail("error", "out of memory", kInternalFault);
  } catch (const std::exception& error) {
    return fail("internal fault", error.what(), kInternalFault);
  }
}
