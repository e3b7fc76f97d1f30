#include "tools/bench/bench.h"

#include <CLI/CLI.hpp>
#include <memory>

#include "tools/commands.h"

namespace condyle {
namespace {

void add_patient(CLI::App& command, BenchOptions& options) {
  command.add_option("CASE", options.patient,
                     "Folder with case.json (default: the built-in patient)");
}

}  // namespace

void add_bench(Commands& commands) {
  const auto options = std::make_shared<BenchOptions>();
  CLI::App& bench = commands.add_parent("bench", "Measure speed", "condyle bench frame --json");
  const auto add = [&](const char* name, const char* what, const char* example,
                       int (*run)(const BenchOptions&, const CommonOptions&)) -> CLI::App& {
    return commands.add_below(
        bench, name, what, example,
        [options, run](const CommonOptions& common) { return run(*options, common); });
  };
  CLI::App& frame = add("frame", "Each stage of a frame, median and 95th percentile",
                        "condyle bench frame --json", run_bench_frame);
  add_patient(frame, *options);
  in_range(frame.add_option("--repeats", options->repeats, "Openings to measure; default 3"), 1,
           1000);
  add_patient(add("table1", "Minimisers compared, beside the published table",
                  "condyle bench table1 --json", run_bench_table1),
              *options);
  add("table2", "Time of a prediction, beside the published one", "condyle bench table2 --json",
      [](const BenchOptions&, const CommonOptions& common) { return run_bench_table2(common); });
  CLI::App& tissue = add("tissue", "Soft tissue: cold solves, warm frames, large meshes",
                         "condyle bench tissue --sizes 10000 --json", run_bench_tissue);
  in_range(tissue.add_option("--repeats", options->repeats, "Runs of the slow methods; default 3"),
           1, 1000);
  in_range(tissue.add_option("--sizes", options->sizes,
                             "Nodes of larger tissues; default 10000 50000 100000"),
           200, 1000000);
  CLI::App& collide = add(
      "collide", "Contact, sliding, dynamics and distance fields, beside FCL's and Bullet's own",
      "condyle bench collide --json", run_bench_collide);
  add_patient(collide, *options);
  collide
      .add_option("--only", options->part,
                  "Measure one part: pair, blocked_jaw, recorded_overlap, segments, rigid_step, "
                  "field_build, dynamics or chewing; default all")
      ->check(CLI::IsMember({"pair", "blocked_jaw", "recorded_overlap", "segments", "rigid_step",
                             "field_build", "dynamics", "chewing"}));
  CLI::App& cut = add("cut", "Saw cuts and osteotomies of a patient's bones",
                      "condyle bench cut --json", run_bench_cut);
  add_patient(cut, *options);
  in_range(cut.add_option("--repeats", options->repeats, "Runs to measure; default 3"), 1, 1000);
  CLI::App& predict =
      add("predict", "Cuts previewed, plans applied, and faces predicted, first and after a change",
          "condyle bench predict --json", run_bench_predict);
  in_range(predict.add_option("--repeats", options->repeats, "Runs to measure; default 3"), 1,
           1000);
  CLI::App& drag = add("drag", "Segments of the class III plan dragged, free and blocked",
                       "condyle bench drag --json", run_bench_drag);
  in_range(drag.add_option("--repeats", options->repeats, "Runs to measure; default 3"), 1, 1000);
  CLI::App& appliances = add("appliances", "Splints and cutting guides of the class III plan",
                             "condyle bench appliances --json", run_bench_appliances);
  in_range(appliances.add_option("--repeats", options->repeats, "Runs to measure; default 3"), 1,
           1000);
  CLI::App& import = add("import", "Scans of the built-in head segmented, beside the truth",
                         "condyle bench import --json", run_bench_import);
  import.add_option("--only", options->part,
                    "Measure one scan (plain, \"flat voxels\", blurred, fillings, table, \"dark "
                    "marrow\", \"teeth touch\", turned), other heads with seeds of the fitted "
                    "template (fitted), or the time; default all");
  CLI::App& convergence =
      add("convergence", "The displayed face of tissues of several sizes, beside the finest",
          "condyle bench convergence --sizes 1000 2000 --json", run_bench_convergence);
  add_patient(convergence, *options);
  in_range(convergence.add_option("--sizes", options->study_sizes,
                                  "Nodes; default 1000 2000 4000 8000 16000 32000"),
           400, 200000);
  CLI::App& patient =
      add("patient", "Warm frames of the patient's tissue, beside synthetic sets of equal size",
          "condyle bench patient --sizes 2080 6000 --json", run_bench_patient);
  add_patient(patient, *options);
  in_range(
      patient.add_option("--sizes", options->patient_sizes, "Nodes; default 2080 6000 10000 30000"),
      400, 200000);
  CLI::App& mesh = add("mesh", "The decimators on the built-in patient's surfaces",
                       "condyle bench mesh --json", run_bench_mesh);
  in_range(mesh.add_option("--repeats", options->repeats, "Runs to measure; default 3"), 1, 1000);
  CLI::App& landmarks =
      add("landmarks", "Landmarks proposed by fitting the built-in patient to other heads",
          "condyle bench landmarks --heads 2 --json", run_bench_landmarks);
  in_range(landmarks.add_option("--heads", options->heads, "Heads of each scan; default 10"), 1,
           1000);
}

}  // namespace condyle
