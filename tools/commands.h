#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "sim/case/case_io.h"
#include "sim/dynamics/muscle_motion.h"
#include "sim/motion/motion.h"

/// One function per subcommand; each returns the program's exit code.
namespace condyle {

struct CommonOptions {
  bool json = false;   // the result as JSON on standard output
  bool quiet = false;  // no progress and no summary on standard error
  int threads = 2;
};

/// How the soft tissue differs from the case's own, as the user wrote it.
struct TissueOptions {
  std::optional<int> layers = std::nullopt;
  std::optional<double> turgor = std::nullopt, lambda = std::nullopt;
  std::string gravity = {};
  bool glued = false;
  std::vector<std::string> attach = {}, detach = {};
};

/// What is cut, laid over and written on pictures, as the user wrote it.
struct PictureOptions {
  std::string size = "1280x720";
  std::string camera = "three-quarter";  // several by commas
  std::string show = "all";
  double distance_near_mm = 2;  // end of the map of distances
  std::string clip = {}, clip_parts = {}, cut_away = {}, overlay = {};
  bool clip_open = false;
  std::optional<double> wipe = std::nullopt;
  bool before_after = false;
  std::string caption = {};
  bool transparent = false, light = false;
  std::string edges = "msaa4";
  int supersample = 1;
  bool shadows = true;
};

/// Who moves, and how.
struct MotionOptions {
  std::filesystem::path patient;  // case folder; empty = the built-in patient
  std::string motion;
  MotionSettings settings;
  MuscleMotionSettings muscles;
  bool respect_contact = false;  // recorded motion, too, slides where bones meet
  double friction = 0;
  std::vector<std::string> pairs = {};  // rules as the user wrote them
  bool tissue = true;
  int surface_nodes = 520;
  TissueOptions tissue_model = {};
};

struct RecordOptions {
  MotionOptions motion;
  std::filesystem::path out;
  int frames = 0;  // 0 = duration x fps
  double fps = 30;
  bool plots = false;
  // pictures; `run` has none
  bool pictures = false;
  PictureOptions picture = {};
  bool film = false;
  bool resume = false;
};

struct CheckOptions {
  MotionOptions motion;
  std::filesystem::path out;
  double margin_mm = 0;
  int frames = 0;  // 0 = duration x fps
  double fps = 30;
};

struct OccludeOptions {
  std::filesystem::path patient;  // case folder; empty = the built-in patient
  std::filesystem::path out;
  std::string start;      // pose file or offsets; empty = as the case is
  double paper_mm = 0.1;  // what is marked when bitten on
};

struct LetGoOptions {
  std::filesystem::path patient, out;
  std::string part;  // empty: the only free one
  std::vector<double> push_N;
  double friction = 0.3;
  std::vector<std::string> yielding;  // parts that are pushed along
};

struct ViewOptions {
  MotionOptions motion;
  std::optional<double> ui_scale = {};  // none: as the window was left, at first by the screen
  std::optional<bool> light = {};       // none: as the window was left
  std::string size = {};                // "1280x720"; empty: as the window was left
  std::filesystem::path state_file;     // kept up to date with what the window shows; empty = none
};

struct ImportOptions {
  ImportRequest request;
  bool push_out = false;  // free parts that start deep inside others
  std::filesystem::path out;
};

struct BenchOptions {
  std::filesystem::path patient;
  int repeats = 3;                                  // whole openings
  std::vector<int> sizes = {10000, 50000, 100000};  // nodes of larger tissues
};

int run_record(const RecordOptions& options, const CommonOptions& common);
int run_check(const CheckOptions& options, const CommonOptions& common);
int run_occlude(const OccludeOptions& options, const CommonOptions& common);
int run_let_go(const LetGoOptions& options, const CommonOptions& common);
int run_view(const ViewOptions& options, const CommonOptions& common);
int run_import(const ImportOptions& options, const CommonOptions& common);
int run_info(const std::filesystem::path& what, const CommonOptions& common);
int run_phantom(const std::filesystem::path& out, const CommonOptions& common);
int run_bench_frame(const BenchOptions& options, const CommonOptions& common);
int run_bench_table1(const BenchOptions& options, const CommonOptions& common);
int run_bench_table2(const CommonOptions& common);
int run_bench_tissue(const BenchOptions& options, const CommonOptions& common);
int run_bench_collide(const BenchOptions& options, const CommonOptions& common);

}  // namespace condyle
