#pragma once

#include "tools/command.h"

/// Each declares a command with its options; its run function is in the same file.
namespace condyle {

void add_view(Commands& commands);
void add_record(Commands& commands);
void add_run(Commands& commands);  // in record.cpp
void add_check(Commands& commands);
void add_occlude(Commands& commands);
void add_release(Commands& commands);
void add_import(Commands& commands);
void add_plan(Commands& commands);
void add_splint(Commands& commands);  // in appliance/, as is the next
void add_guide(Commands& commands);
void add_predict(Commands& commands);
void add_compare(Commands& commands);
void add_report(Commands& commands);
void add_export(Commands& commands);
void add_demo(Commands& commands);  // in demo/demo.cpp
void add_info(Commands& commands);
void add_help(Commands& commands);
void add_phantom(Commands& commands);
void add_sample(Commands& commands);
void add_bench(Commands& commands);  // in bench/bench.cpp

/// Each adds a subcommand of `import`.
void add_import_ct(Commands& commands, CLI::App& import);
void add_import_face(Commands& commands, CLI::App& import);
void add_import_teeth(Commands& commands, CLI::App& import);

/// Prints a page of the manual; without a subject their list. throws: InputError.
int run_help(const std::string& subject);

}  // namespace condyle
