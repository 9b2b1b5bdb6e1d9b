// SPDX-License-Identifier: Apache-2.0
// Parses the command line, finds the command and runs it. Commands are listed in commands.cpp, each is defined in
// command_NAME.cpp.
#include <algorithm>
#include <csignal>
#include <map>

#include "c3de/core/crash_journal.h"
#include "c3de/core/log.h"
#include "c3de/core/program_arguments.h"
#include "c3de/core/text.h"
#include "commands/command_line.h"
#include "commands/commands.h"
#include "commands/exit_code.h"
#include "commands/standard_output.h"
#include "commands/version.h"
#ifdef C3DE_HAS_MPI
#include "mpi/mpi_ranks.h"
#endif

namespace {

using namespace c3de;
using namespace c3de::app;

#ifdef C3DE_HAS_WINDOW
constexpr auto kOpenWindow = runWorkstation;
#else
constexpr std::nullptr_t kOpenWindow = nullptr;
#endif

/// One line. For an unknown option, it proposes the nearest one.
std::string describeParseError(const CLI::ParseError &error, const CLI::App &app, const CLI::App &at) {
  if (dynamic_cast<const CLI::ExtrasError *>(&error) == nullptr) return error.what();
  std::vector<std::string> known;
  for (const CLI::Option *option : at.get_options())
    for (const std::string &name : option->get_lnames()) known.push_back("--" + name);
  std::string text;
  std::vector<std::string> extras = app.remaining(true);
  // The text after an unknown option is most often its value.
  const auto isOption = [](const std::string &extra) { return extra.starts_with('-'); };
  if (std::any_of(extras.begin(), extras.end(), isOption))
    std::erase_if(extras, [&](const std::string &extra) { return !isOption(extra); });
  for (const std::string &extra : extras) {
    const std::string name = extra.substr(0, extra.find('='));
    const std::string nearest = name.starts_with("--") ? nearestName(name, known) : "";
    text += (text.empty() ? "" : "; ") + ("'" + extra + "' is not accepted here") +
            (nearest.empty() ? "" : ", did you mean " + nearest + "?");
  }
  return text;
}

int runCommandLine(int argc, char **argv, StudyRanks *ranks) {
  CommandLine line{argc, argv, kOpenWindow, ranks};
  CLI::App app(
      "Workstation for medical images that hosts simulation plugins.\n"
      "Without a command: open the workstation on FILES, or on its start page.",
      "c3de");
  app.allow_windows_style_options(false);  // "/scans/a.nii" and "//server/share/a.nii" are paths
  app.set_help_flag("-h,--help", "Show this help");
  app.require_subcommand(0, 1);
  std::map<const CLI::App *, Handler> handlers{{&app, declareWorkstation(app, line)}};
  for (const Command *command : commands()) {
    CLI::App *sub = app.add_subcommand(command->name, command->summary);
    if (command->isHidden) sub->group("");
    if (command->declare)
      handlers[sub] = command->declare(*sub, line);
    else
      sub->allow_extras();
  }

  const auto chosen = [&]() -> const CLI::App & {
    return app.get_subcommands().empty() ? app : *app.get_subcommands().front();
  };
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError &error) {
    const CLI::App &at = chosen();
    const bool isRoot = &at == &app;
    if (error.get_exit_code() == static_cast<int>(CLI::ExitCodes::Success)) {
      printOut(at.help(isRoot ? "" : "c3de"));
      return kDone;
    }
    return reportError({ErrorCode::usage, describeParseError(error, app, at) + "; see " +
                                              (isRoot ? "c3de" : "c3de " + at.get_name()) + " --help"});
  }

  if (line.verbose) setLogThreshold(LogLevel::debug);
  if (line.quiet) setLogThreshold(LogLevel::error);
  const auto handler = handlers.find(&chosen());
  if (handler == handlers.end())
    return reportError({ErrorCode::usage, "'" + chosen().get_name() + "' is not available yet; this version provides " +
                                              availableCommands(" and ")});
  if (line.version) {
    printVersion(line.json);
    return kDone;
  }
  return handler->second();
}

}  // namespace

int main(int argc, char **argv) {
#ifdef SIGXFSZ
  // A file that reaches its size limit is an output that cannot be written; it does not end the process.
  std::signal(SIGXFSZ, SIG_IGN);
#endif
  c3de::installFatalErrorReport();
  StudyRanks *ranks = nullptr;
#ifdef C3DE_HAS_MPI
  MpiRanks mpi(argc, argv);
  if (!mpi.isFirst()) return mpi.work();
  ranks = &mpi;
#endif
  int exitCode = kFailed;
  try {
    ProgramArguments arguments(argc, argv);
    exitCode = exitCodeAfterOutput(runCommandLine(arguments.count(), arguments.values(), ranks));
  } catch (const std::exception &error) {
    exitCode = reportError({ErrorCode::internal, std::string("unexpected: ") + error.what()});
  }
#ifdef C3DE_HAS_MPI
  mpi.end(exitCode);
#endif
  return exitCode;
}
