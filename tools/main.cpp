#include <CLI/CLI.hpp>
#include <algorithm>
#include <csignal>
#include <cstdio>
#include <exception>
#include <iostream>
#include <new>
#include <thread>

#include "engine/core/error.h"
#include "engine/core/similar_word.h"
#include "tools/commands.h"
#include "tools/help_format.h"

namespace {

using namespace condyle;

constexpr const char* examples = R"(Examples
  The window, on the built-in patient:
    condyle
  A film of the opening mouth; no display is needed:
    condyle record --motion opening --out out --film
  A case of your own surfaces:
    condyle import meshes --mandible jaw.stl --skull skull.stl --landmarks marks.csv --out mycase
  Its collisions and clearances:
    condyle check mycase --motion opening --margin 1 --out out
  Its maximum intercuspation, with all contacts:
    condyle occlude mycase --out out
  A recorded motion, without pictures:
    condyle run mycase --motion chew.csv --out out

condyle COMMAND --help lists the options of a command; condyle help prints the manual.
Exit codes: 0 done; 1 the machine or the program failed, or no bite is stable; 2 the input or the
command line is wrong; 3 check found a violation. For research and education, not for clinical use.)";

void add_common(CLI::App& app, CommonOptions& common) {
  app.set_help_flag("-h,--help", "Print this help and exit");
  app.set_version_flag("--version", CONDYLE_VERSION, "Print the version and exit");
  app.add_flag("--json", common.json, "Print the result as JSON on standard output");
  app.add_flag("--quiet", common.quiet, "No progress, notes and summary");
  app.add_flag_callback(
      "--no-summary", [&common] { common.summary = false; }, "Progress, but no notes and summary");
  app.add_flag("--verbose", common.verbose,
               "Also print the notes on the built-in patient, which report.json has");
  common.threads = static_cast<int>(std::clamp(std::thread::hardware_concurrency(), 1u, 8u));
  in_range(app.add_option("--threads", common.threads,
                          "Threads; results are bit-identical for any number"),
           1, 64);
}

/// CLI11 calls an unknown command an unexpected argument; this message lists the valid ones.
std::string unknown_command(const CLI::App& app, int argc, char** argv) {
  if (argc < 2 || argv[1][0] == '-') return {};
  std::vector<std::string> known;
  for (const auto* command : app.get_subcommands([](const CLI::App*) { return true; })) {
    if (command->get_name() == argv[1]) return {};
    if (!command->get_group().empty()) known.push_back(command->get_name());
  }
  return std::string("unknown command \"") + argv[1] + "\"" + suggestion(argv[1], known) +
         "; known are " + CLI::detail::join(known, " ");
}

int run_program(int argc, char** argv) {
  CLI::App app{"Condyle: real-time jaw-motion simulator with collision handling", "condyle"};
  app.footer(examples);
  app.formatter(help_format());
  app.fallthrough();
  CommonOptions common;
  add_common(app, common);
  Commands commands(app);
  for (const auto add : {add_view, add_record, add_run, add_check, add_occlude, add_release,
                         add_import, add_plan, add_splint, add_guide, add_predict, add_compare,
                         add_report, add_export, add_demo, add_info, add_help, add_phantom,
                         add_sample, add_bench})
    add(commands);

  // Pages of the manual may have the names of commands.
  if (argc == 3 && argv[1] == std::string("help") && argv[2][0] != '-') return run_help(argv[2]);
  if (const auto problem = unknown_command(app, argc, argv); !problem.empty())
    throw InputError(problem);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return app.exit(error);
    throw InputError(std::string(error.what()) + ". See condyle --help");
  }
  return commands.run(common);
}

}  // namespace

int main(int argc, char** argv) {
  // A closed pipe and a file that may not grow are errors of the write, reported below.
  std::signal(SIGPIPE, SIG_IGN);
  std::signal(SIGXFSZ, SIG_IGN);
  try {
    const int code = run_program(argc, argv);
    if (std::fflush(stdout) != 0 || !std::cout.flush())
      throw MachineError("standard output cannot be written");
    return code;
  } catch (const InputError& error) {
    std::fprintf(stderr, "condyle: %s\n", error.what());
    return 2;
  } catch (const std::bad_alloc&) {
    std::fprintf(stderr, "condyle: not enough memory\n");
    return 1;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "condyle: %s\n", error.what());
    return 1;
  }
}
