#include <CLI/CLI.hpp>
#include <algorithm>
#include <csignal>
#include <cstdio>
#include <exception>
#include <iostream>
#include <new>
#include <thread>

#include "engine/core/error.h"
#include "tools/commands.h"
#include "tools/pair_options.h"
#include "tools/shared_options.h"

namespace {

using namespace condyle;

constexpr const char* examples = R"(
Examples
  condyle                                                    the window, on the built-in patient
  condyle record --motion opening --out out --film           a film of the opening mouth, no display needed
  condyle import meshes --mandible jaw.stl --maxilla maxilla.stl --landmarks marks.csv --out mycase
  condyle check mycase --motion opening --margin 1 --out out collisions and clearances
  condyle occlude mycase --out out                           the settled bite, its contacts
  condyle run mycase --motion chew.csv --out out             a recorded motion, without pictures

Exit codes: 0 done; 1 the machine or the program failed, or no bite is stable; 2 the input or the
command line is wrong; 3 check found a violation. For research and education, not for clinical use.)";

CLI::App* add_command(CLI::App& app, const char* name, const char* what, const char* example) {
  auto* command = app.add_subcommand(name, what);
  command->footer(std::string("\nExample\n  ") + example);
  return command;
}

/// CLI11 calls an unknown verb an unexpected argument; a person wants to hear which verbs there
/// are.
std::string unknown_verb(const CLI::App& app, int argc, char** argv) {
  if (argc < 2 || argv[1][0] == '-') return {};
  std::string known;
  for (const auto* command : app.get_subcommands([](const CLI::App*) { return true; })) {
    if (command->get_name() == argv[1]) return {};
    known += " " + command->get_name();
  }
  return std::string("unknown command \"") + argv[1] + "\"; known are" + known;
}

int run_program(int argc, char** argv) {
  CLI::App app{"Condyle: real-time jaw-motion simulator with collision handling", "condyle"};
  app.footer(examples);
  app.set_version_flag("--version", CONDYLE_VERSION);
  app.fallthrough();
  CommonOptions common;
  common.threads = static_cast<int>(std::clamp(std::thread::hardware_concurrency(), 1u, 8u));
  app.add_flag("--json", common.json, "Print the result as JSON on standard output");
  app.add_flag("--quiet", common.quiet, "No progress and no summary");
  app.add_option("--threads", common.threads, "Threads; results have the same bits for any number")
      ->check(CLI::Range(1, 64));

  ViewOptions view;
  auto* view_command =
      add_command(app, "view", "Open the window", "condyle view mycase --motion opening");
  add_motion(view_command, view.motion, false);
  view_command->get_option("CASE")->description(
      "Folder with case.json, or of loose surfaces: the window asks what each is (default: the "
      "built-in patient)");
  add_contact(view_command, view.motion);
  add_respect_contact(view_command, view.motion);
  add_tissue(view_command, view.motion);
  view_command
      ->add_option(
          "--ui-scale", view.ui_scale,
          "Size of the panels (as they were left; at first 1, and 1.5 in windows 3840 pixels wide "
          "where the screen tells none)")
      ->check(within(0.5, 4.0));
  view_command->add_option("--size", view.size,
                           "Of the window (as it was left; at first 1280x720)");
  view_command->add_option("--state-file", view.state_file,
                           "Keep a JSON file up to date with what the window shows, for programs "
                           "that use the window");
  view_command->add_flag_callback(
      "--light", [&view] { view.light = true; },
      "Light panels and view (as they were left; at first dark; key T)");
  view_command->add_flag_callback(
      "--dark", [&view] { view.light = false; }, "Dark panels and view");

  RecordOptions record;
  record.pictures = true;
  auto* record_command = add_command(
      app, "record", "Record a motion as pictures, off-screen",
      "condyle record --motion opening --out out --camera spin --show bones,teeth,skin:0.4 --film");
  add_recording(record_command, record);
  add_pictures(record_command, record.picture);
  record_command->add_flag("--film", record.film, "Also make film.mp4 (needs the ffmpeg program)");
  record_command->add_flag("--resume", record.resume, "Complete an interrupted recording");

  RecordOptions run;
  auto* run_command = add_command(app, "run", "Simulate a motion without pictures",
                                  "condyle run mycase --motion chew.csv --out out --json");
  add_recording(run_command, run);

  CheckOptions check;
  check.motion.motion = "opening";
  check.motion.tissue = false;
  auto* check_command =
      add_command(app, "check", "Check the bones for collisions and clearances along a motion",
                  "condyle check mycase --motion opening --margin 1 --out out; echo $?");
  add_motion(check_command, check.motion, false);
  add_contact(check_command, check.motion);
  check_command->add_option("--margin", check.margin_mm, "Clearance that bones must keep, mm (0)")
      ->check(within(0.0, 50.0));
  check_command
      ->add_option("--frames", check.frames,
                   "Tell the whole motion in this many frames, both ends included")
      ->check(CLI::Range(1, 100000));
  check_command
      ->add_option("--fps", check.fps,
                   "Frames a second of the motion's own time (30); in between nothing thicker than "
                   "0.1 mm is passed through unseen")
      ->check(within(0.1, 1000.0));
  check_command->add_option("--out", check.out,
                            "Folder for report.html with its pictures, report.json, pairs.csv");

  OccludeOptions occlude;
  auto* occlude_command = add_command(
      app, "occlude", "Settle the bite: close the teeth until they rest, and tell every contact",
      "condyle occlude mycase --start 1,-2,0 --out out");
  occlude_command->add_option("CASE", occlude.patient,
                              "Folder with case.json (default: the built-in patient)");
  occlude_command
      ->add_option("--start", occlude.start,
                   "Where the mandible starts: a pose file, or mm left,back,up of the "
                   "case's pose, and degrees about these axes if wanted (the case's pose)")
      ->type_name("FILE|X,Y,Z[,RX,RY,RZ]");
  occlude_command
      ->add_option("--paper", occlude.paper_mm,
                   "Thickness of the articulating paper that is bitten on, mm (0.1)")
      ->check(within(0.02, 0.3));
  occlude_command->add_option("--out", occlude.out,
                              "Folder for report.html with its picture, report.json, pose.csv, "
                              "motion.csv");

  LetGoOptions let_go;
  auto* let_go_command =
      add_command(app, "let-go", "Let a segment or transplant settle on the bone under a push",
                  "condyle let-go mycase --part transplant --push 0,5,0 --out settled");
  let_go_command->add_option("CASE", let_go.patient, "Folder with case.json")->required();
  let_go_command->add_option("--part", let_go.part, "Name of the part (the only free one)");
  let_go_command
      ->add_option("--push", let_go.push_N, "Push of the hand to the left, back and up, N")
      ->delimiter(',')
      ->expected(3)
      ->type_name("X,Y,Z")
      ->required();
  let_go_command
      ->add_option("--yields", let_go.yielding,
                   "Another free part that gives way when it is pushed; may be repeated")
      ->type_name("PART");
  let_go_command->add_option("--friction", let_go.friction, "Coefficient of friction (0.3)")
      ->check(within(0.0, 2.0));
  let_go_command->add_option("--out", let_go.out,
                             "Folder of the case with the parts where they lie");

  ImportOptions import;
  auto* import_command =
      add_command(app, "import", "Make a case from your files",
                  "condyle import meshes --mandible jaw.stl --maxilla maxilla.stl --out mycase");
  import_command->require_subcommand(1);
  auto* meshes =
      add_command(*import_command, "meshes", "From surfaces: STL, PLY, OBJ or GLB",
                  "condyle import meshes --mandible jaw.stl --maxilla maxilla.ply --face skin.obj\n"
                  "      --landmarks marks.csv --units m --frame RAS --out mycase");
  struct RoleOption {
    const char* name;
    Role role;
    std::vector<std::filesystem::path> files;
  };
  std::vector<RoleOption> roles = {{"--skull", Role::skull, {}},
                                   {"--maxilla", Role::maxilla, {}},
                                   {"--mandible", Role::mandible, {}},
                                   {"--upper-teeth", Role::upper_teeth, {}},
                                   {"--lower-teeth", Role::lower_teeth, {}},
                                   {"--face", Role::face, {}},
                                   {"--segment", Role::segment, {}},
                                   {"--transplant", Role::transplant, {}}};
  for (auto& role : roles)
    meshes->add_option(role.name, role.files, "Surface file; may be given several times")
        ->type_name("FILE");
  std::vector<std::string> carriers;
  meshes
      ->add_option("--carrier-of", carriers,
                   "What a segment or transplant goes along with (default: the nearer one), e.g. "
                   "segment-2=mandible")
      ->type_name("NAME=mandible|cranium");
  meshes->add_flag("--push-out", import.push_out,
                   "Move segments and transplants that start deep inside a bone out of it");
  meshes->add_option("--landmarks", import.request.landmarks,
                     "CSV with name,x_mm,y_mm,z_mm, or 3D Slicer .mrk.json");
  meshes->add_option(
      "--muscles", import.request.muscles,
      "CSV of muscles: name,origin_body,insertion_body,ox_mm,oy_mm,oz_mm,ix_mm,iy_mm,"
      "iz_mm,max_force_N and more");
  meshes->add_option("--mechanics", import.request.mechanics,
                     "JSON of the jaw as a body: mass, inertia, damping, guide of the condyles");
  meshes->add_option("--units", import.request.units, "Unit of the files: mm m cm in (mm)");
  meshes->add_option("--frame", import.request.frame, "Axes of the files: LPS, RAS, ... (LPS)");
  meshes->add_option("--name", import.request.name, "Name of the case");
  meshes->add_option("--out", import.out, "Folder of the new case")->required();

  std::filesystem::path what;
  auto* info_command = add_command(app, "info", "Tell what a case or a surface file holds",
                                   "condyle info mycase --json");
  info_command->add_option("CASE|FILE", what,
                           "Case folder or surface file (default: the built-in patient)");

  std::filesystem::path phantom_out;
  auto* phantom_command = add_command(app, "phantom", "Write the built-in patient as a case folder",
                                      "condyle phantom --out patient");
  phantom_command->add_option("--out", phantom_out, "Folder of the case")->required();

  BenchOptions bench;
  auto* bench_command = add_command(app, "bench", "Measure speed", "condyle bench frame --json");
  bench_command->require_subcommand(1);
  auto* bench_frame =
      add_command(*bench_command, "frame", "Each stage of a frame, median and 95th percentile",
                  "condyle bench frame --json");
  bench_frame->add_option("CASE", bench.patient, "Case folder (default: the built-in patient)");
  bench_frame->add_option("--repeats", bench.repeats, "Openings to measure (3)")
      ->check(CLI::Range(1, 1000));
  auto* bench_table1 =
      add_command(*bench_command, "table1", "Minimisers compared, beside the published table",
                  "condyle bench table1 --json");
  bench_table1->add_option("CASE", bench.patient,
                           "Case folder whose tissue goes forward in one step and in ten (default: "
                           "the built-in patient)");
  auto* bench_table2 =
      add_command(*bench_command, "table2", "Time of a prediction, beside the published one",
                  "condyle bench table2 --json");
  auto* bench_tissue =
      add_command(*bench_command, "tissue", "Soft tissue: cold solves, warm frames, large sets",
                  "condyle bench tissue --sizes 10000 --json");
  bench_tissue->add_option("--repeats", bench.repeats, "Runs to measure of the slow methods (3)")
      ->check(CLI::Range(1, 1000));
  bench_tissue->add_option("--sizes", bench.sizes, "Nodes of larger tissues (10000 50000 100000)")
      ->check(CLI::Range(200, 1000000));
  auto* bench_collide =
      add_command(*bench_command, "collide",
                  "Contact, sliding, dynamics and distance fields, beside FCL's and Bullet's own",
                  "condyle bench collide --json");
  bench_collide->add_option("CASE", bench.patient, "Case folder (default: the built-in patient)");

  if (const auto problem = unknown_verb(app, argc, argv); !problem.empty())
    throw InputError(problem);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return app.exit(error);
    throw InputError(std::string(error.what()) + ". See condyle --help");
  }

  if (record_command->parsed()) return run_record(record, common);
  if (run_command->parsed()) return run_record(run, common);
  if (check_command->parsed()) return run_check(check, common);
  if (occlude_command->parsed()) return run_occlude(occlude, common);
  if (let_go_command->parsed()) return run_let_go(let_go, common);
  if (meshes->parsed()) {
    for (const auto& role : roles)
      for (const auto& file : role.files) import.request.files.push_back({role.role, file});
    import.request.carriers = parse_carriers(carriers);
    return run_import(import, common);
  }
  if (info_command->parsed()) return run_info(what, common);
  if (phantom_command->parsed()) return run_phantom(phantom_out, common);
  if (bench_frame->parsed()) return run_bench_frame(bench, common);
  if (bench_table1->parsed()) return run_bench_table1(bench, common);
  if (bench_table2->parsed()) return run_bench_table2(common);
  if (bench_tissue->parsed()) return run_bench_tissue(bench, common);
  if (bench_collide->parsed()) return run_bench_collide(bench, common);
  return run_view(view, common);
}

}  // namespace

int main(int argc, char** argv) {
  // A closed pipe and a file that may not grow are errors of the write, told below.
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
