// facezip: one command with verbs.
#include <fcntl.h>
#include <fmt/format.h>
#include <sys/resource.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <exception>
#include <new>
#include <string>

#include "commands.hpp"
#include "exit_codes.hpp"
#include "facezip/device.hpp"
#include "facezip/error.hpp"
#include "facezip/printable.hpp"
#include "facezip/progress.hpp"
#include "facezip/version.hpp"
#include "terminal.hpp"
#include "usage.hpp"

namespace facezip::cli {
namespace {

int fail(ExitCode code, const std::string& what) {
  printError("facezip: error: " + what + "\n");
  return code;
}

int failToPrint() {
  return fail(kExitOutput, fmt::format("standard output: cannot write: {}; is the disk full?", std::strerror(errno)));
}

/// A standard stream that the caller closed would be the next file to be opened, and get notes among its bytes.
void holdStandardStreams() {
  int stream = 0;
  do {
    stream = ::open("/dev/null", O_RDWR);
  } while (0 <= stream && stream <= STDERR_FILENO);
  if (stream >= 0) ::close(stream);
}

/// Compressing keeps every texture of a capture open.
void raiseLimitOfOpenFiles() {
  rlimit limit{};
  if (::getrlimit(RLIMIT_NOFILE, &limit) != 0) return;
  limit.rlim_cur = limit.rlim_max;
  ::setrlimit(RLIMIT_NOFILE, &limit);  // where it may not be raised, opening a file says so
}

/// Runs the parsed command and turns what it throws into one line and an exit code.
int runCommand(CLI::App& app, int argc, char** argv) {
  try {
    app.parse(argc, argv);
    return kExitSuccess;
  } catch (const CLI::Success& request) {
    return app.exit(request);  // --help, --version
  } catch (const CLI::ParseError& error) {
    const std::string fault = usageFault(app, error, argc, argv);
    return fail(kExitUsage, printable(fault) + "; --help says more");
  } catch (const Cancelled&) {
    return fail(kExitCancelled, "cancelled; nothing was written");
  } catch (const InputError& error) {
    return fail(kExitInput, error.what());
  } catch (const DeviceError& error) {
    return fail(kExitDevice, error.what());
  } catch (const OutputError& error) {
    return fail(kExitOutput, error.what());
  } catch (const SolverError& error) {
    return fail(kExitSolver, error.what());
  } catch (const std::bad_alloc&) {
    return fail(kExitInternal, "out of memory; lower --memory");
  } catch (const std::exception& error) {
    return std::ferror(stdout) != 0 ? failToPrint() : fail(kExitInternal, printable(error.what()));
  }
}

}  // namespace
}  // namespace facezip::cli

int main(int argc, char** argv) {
  using namespace facezip::cli;
  holdStandardStreams();
  raiseLimitOfOpenFiles();
  std::signal(SIGXFSZ, SIG_IGN);  // a file that may not grow is an error of the write, which cleans up
  CLI::App app{
      "Compresses the textures of facial blendshapes into a neutral, a few difference textures and weight maps."};
  app.name("facezip");
  app.set_version_flag("--version", "facezip " FACEZIP_VERSION);
  app.require_subcommand(1);
  app.get_formatter()->column_width(34);
  CommonOptions common;
  app.add_flag("-q,--quiet", common.quiet, "No progress and no notes on standard error");
  app.fallthrough();
  addSynthCommand(app, common);
  addCompressCommand(app, common);
  addConvertCommand(app, common);
  addReconstructCommand(app, common);
  addBlendCommand(app, common);
  addEvaluateCommand(app, common);
  addExportCommand(app, common);
  addReportCommand(app, common);
  addViewCommand(app, common);
  addAlignCommand(app, common);
  addRegisterCommand(app, common);
  addLandmarksCommand(app, common);
  addRigCommand(app, common);
  addTrainCommand(app, common);
  addGenerateCommand(app, common);
  addSolveWeightsCommand(app, common);
  addInfoCommand(app, common);
  addDevicesCommand(app, common);
  addDemoCommand(app, common);
  const int code = runCommand(app, argc, argv);
  return code == kExitSuccess && std::fflush(stdout) != 0 ? failToPrint() : code;
}
