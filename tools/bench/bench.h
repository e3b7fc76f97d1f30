#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "tools/command.h"

namespace condyle {

struct BenchOptions {
  std::filesystem::path patient;                    // case folder; empty: the built-in patient
  int heads = 10;                                   // of each kind of scan
  int repeats = 3;                                  // whole openings
  std::vector<int> sizes = {10000, 50000, 100000};  // nodes of larger tissues
  std::vector<int> study_sizes = {1000, 2000, 4000, 8000, 16000, 32000};  // nodes compared
  std::vector<int> patient_sizes = {2080, 6000, 10000, 30000};            // of its own tissue
  std::string part;  // of the measurements; empty: all
};

// Each returns the program's exit code.
int run_bench_frame(const BenchOptions& options, const CommonOptions& common);
int run_bench_table1(const BenchOptions& options, const CommonOptions& common);
int run_bench_table2(const CommonOptions& common);
int run_bench_tissue(const BenchOptions& options, const CommonOptions& common);
int run_bench_collide(const BenchOptions& options, const CommonOptions& common);
int run_bench_patient(const BenchOptions& options, const CommonOptions& common);
int run_bench_cut(const BenchOptions& options, const CommonOptions& common);
int run_bench_predict(const BenchOptions& options, const CommonOptions& common);
int run_bench_drag(const BenchOptions& options, const CommonOptions& common);
int run_bench_appliances(const BenchOptions& options, const CommonOptions& common);
int run_bench_import(const BenchOptions& options, const CommonOptions& common);
int run_bench_mesh(const BenchOptions& options, const CommonOptions& common);
int run_bench_convergence(const BenchOptions& options, const CommonOptions& common);
int run_bench_landmarks(const BenchOptions& options, const CommonOptions& common);

}  // namespace condyle
